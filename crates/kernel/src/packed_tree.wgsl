const BLOCK_SIZE: u32 = 8u;
const EMPTY_CORNER: f32 = 3e38;
const MORTON_LEVELS: u32 = 10u;
const NORMAL_LEVELS: u32 = 42u;
const ROUNDING: f32 = 2.4e-7;
const COSINE_MARGIN: f32 = 1e-6;

struct PackedLightNode {
    lower: vec3<f32>,
    intensity: f32,
    extent_xy: u32,
    extent_z_spread: u32,
    axis: u32,
    intensities: u32,
}

fn round_up_16(x: f32) -> u32 {
    return (bitcast<u32>(x) + 0xffffu) >> 16u;
}

fn round_down_16(x: f32) -> u32 {
    return bitcast<u32>(x) >> 16u;
}

fn widen_16(half: u32) -> f32 {
    return bitcast<f32>(half << 16u);
}

fn sign_factor(x: f32) -> f32 {
    return select(1.0, -1.0, x < 0.0);
}

fn pack_axis(axis: vec3<f32>) -> u32 {
    let sum = abs(axis.x) + abs(axis.y) + abs(axis.z);
    if (sum == 0.0) {
        return pack_octahedral(0.0, 0.0);
    }
    let x = axis.x / sum;
    let y = axis.y / sum;
    if (axis.z < 0.0) {
        return pack_octahedral((1.0 - abs(y)) * sign_factor(x), (1.0 - abs(x)) * sign_factor(y));
    }
    return pack_octahedral(x, y);
}

fn pack_octahedral(x: f32, y: f32) -> u32 {
    return u32(floor(x * 32767.0 + 0.5) + 32767.0) | (u32(floor(y * 32767.0 + 0.5) + 32767.0) << 16u);
}

fn unpack_axis(packed: u32) -> vec3<f32> {
    let x = f32(i32(packed & 0xffffu) - 32767) * (1.0 / 32767.0);
    let y = f32(i32(packed >> 16u) - 32767) * (1.0 / 32767.0);
    let z = 1.0 - abs(x) - abs(y);
    if (z < 0.0) {
        return normalize_or_zero(vec3<f32>((1.0 - abs(y)) * sign_factor(x), (1.0 - abs(x)) * sign_factor(y), z));
    }
    return normalize_or_zero(vec3<f32>(x, y, z));
}

fn empty_cluster() -> LightCluster {
    return LightCluster(
        vec3<f32>(EMPTY_CORNER), vec3<f32>(-EMPTY_CORNER), vec3<f32>(0.0), 1.0, 0.0, EMPTY_CORNER, 0.0,
    );
}

fn is_empty_cluster(cluster: LightCluster) -> bool {
    return cluster.lower.x >= EMPTY_CORNER;
}

fn pack_extent(lower: f32, upper: f32) -> u32 {
    return round_up_16((upper - lower) + (abs(lower) + abs(upper)) * ROUNDING);
}

fn pack_cluster(cluster: LightCluster, intensity: f32) -> PackedLightNode {
    if (is_empty_cluster(cluster)) {
        return PackedLightNode(cluster.lower, 0.0, 0u, 0u, pack_axis(cluster.axis), 0u);
    }
    let sin_half = sqrt(max((1.0 - cluster.cos_spread) * 0.5, 0.0));
    let spread = u32(min(ceil(sin_half * (65535.0 * (1.0 + COSINE_MARGIN))), 65535.0));
    return PackedLightNode(
        cluster.lower,
        intensity,
        pack_extent(cluster.lower.x, cluster.upper.x) | (pack_extent(cluster.lower.y, cluster.upper.y) << 16u),
        pack_extent(cluster.lower.z, cluster.upper.z) | (spread << 16u),
        pack_axis(cluster.axis),
        round_down_16(cluster.min_intensity) | (round_up_16(cluster.max_intensity) << 16u),
    );
}

fn sine_of(cosine: f32) -> f32 {
    return sqrt(max(1.0 - rounded_product(cosine, cosine), 0.0));
}

fn unpack_cluster(node: PackedLightNode) -> LightCluster {
    if (node.lower.x >= EMPTY_CORNER) {
        return empty_cluster();
    }
    let extent = vec3<f32>(
        widen_16(node.extent_xy & 0xffffu), widen_16(node.extent_xy >> 16u), widen_16(node.extent_z_spread & 0xffffu),
    );
    let sin_half = f32(node.extent_z_spread >> 16u) * (1.0 / 65535.0);
    let cos_spread = max((1.0 - ROUNDING) - rounded_product(2.0 * sin_half, sin_half), -1.0);
    return LightCluster(
        node.lower,
        node.lower + extent,
        unpack_axis(node.axis),
        cos_spread,
        sine_of(cos_spread),
        widen_16(node.intensities & 0xffffu),
        widen_16(node.intensities >> 16u),
    );
}

fn below_cosine(cosine: f32) -> f32 {
    return max(cosine, COSINE_MARGIN - 1.0) - COSINE_MARGIN;
}

fn vpl_cluster(vpl: Vpl) -> LightCluster {
    let axis = unpack_axis(pack_axis(vpl.direction));
    let cos_spread = below_cosine(dot3(axis, vpl.direction));
    let intensity = vpl_intensity(vpl);
    return LightCluster(
        vpl.position,
        vpl.position,
        axis,
        cos_spread,
        sine_of(cos_spread),
        least_intensity(intensity, cos_spread),
        intensity,
    );
}

fn least_intensity(intensity: f32, cos_spread: f32) -> f32 {
    return select(0.0, intensity, cos_spread > 0.0);
}

fn enclosing_cosine(axis: vec3<f32>, cluster: LightCluster) -> f32 {
    let cosine = clamp(dot3(axis, cluster.axis), -1.0, 1.0);
    if (cosine <= -cluster.cos_spread || all(axis == vec3<f32>(0.0))) {
        return -1.0;
    }
    let sine = sine_of(cosine);
    return below_cosine(cosine * cluster.cos_spread - sine * cluster.sin_spread);
}

fn merge_clusters(a: LightCluster, b: LightCluster) -> LightCluster {
    if (is_empty_cluster(a)) {
        return b;
    }
    if (is_empty_cluster(b)) {
        return a;
    }
    let axis = unpack_axis(pack_axis(normalize_or_zero(a.axis + b.axis)));
    let cos_spread = min(enclosing_cosine(axis, a), enclosing_cosine(axis, b));
    return LightCluster(
        min(a.lower, b.lower),
        max(a.upper, b.upper),
        axis,
        cos_spread,
        sine_of(cos_spread),
        least_intensity(min(a.min_intensity, b.min_intensity), cos_spread),
        max(a.max_intensity, b.max_intensity),
    );
}

fn quantize(value: f32, lower: f32, extent: f32, levels: u32) -> u32 {
    if (extent <= 0.0) {
        return 0u;
    }
    let steps = f32(1u << levels);
    return u32(min(max((value - lower) / extent * steps, 0.0), steps - 1.0));
}

fn morton_key(vpl: Vpl, lower: vec3<f32>, extent: vec3<f32>) -> u32 {
    let normal_levels = countOneBits(NORMAL_LEVELS);
    let position_levels = MORTON_LEVELS - normal_levels;
    let place = vec3<u32>(
        quantize(vpl.position.x, lower.x, extent.x, position_levels),
        quantize(vpl.position.y, lower.y, extent.y, position_levels),
        quantize(vpl.position.z, lower.z, extent.z, position_levels),
    );
    let normal = vec3<u32>(
        quantize(vpl.direction.x, -1.0, 2.0, normal_levels),
        quantize(vpl.direction.y, -1.0, 2.0, normal_levels),
        quantize(vpl.direction.z, -1.0, 2.0, normal_levels),
    );
    var key = 0u;
    var next_place = position_levels;
    var next_normal = normal_levels;
    for (var level = 0u; level < MORTON_LEVELS; level++) {
        if (((NORMAL_LEVELS >> level) & 1u) == 1u) {
            next_normal -= 1u;
            key = append_bits(key, normal, next_normal);
        } else {
            next_place -= 1u;
            key = append_bits(key, place, next_place);
        }
    }
    return key;
}

fn append_bits(key: u32, numbers: vec3<u32>, bit: u32) -> u32 {
    return (key << 3u) | (((numbers.x >> bit) & 1u) << 2u) | (((numbers.y >> bit) & 1u) << 1u) | ((numbers.z >> bit) & 1u);
}
