const STRETCH: u32 = 0u;
const REPEAT: u32 = 1u;
const STRAIGHT: u32 = 2u;
const FARTHEST_TEXEL: f32 = 1e9;

struct Texture {
    first: u32,
    width: u32,
    height: u32,
    padding: u32,
}

struct SurfacePoint {
    uv: vec2<f32>,
    size: vec2<f32>,
}

fn place_on_axis(from_top_left: f32, size: f32, image_size: f32, mode: u32) -> f32 {
    let in_units = mode != STRETCH && size > 0.0;
    return from_top_left * select(image_size, size, in_units);
}

fn sample_texture(texture: Texture, mode: u32, at: SurfacePoint, rules: u32) -> vec3<f32> {
    let image_size = vec2<f32>(f32(texture.width), f32(texture.height));
    let x = place_on_axis(at.uv.x, at.size.x, image_size.x, mode);
    let y = place_on_axis(1.0 - at.uv.y, at.size.y, image_size.y, mode);
    let outside = !(x >= 0.0 && y >= 0.0 && x <= image_size.x && y <= image_size.y);
    if ((mode == STRAIGHT && outside) || !(abs(x) <= FAR && abs(y) <= FAR)) {
        return vec3<f32>(0.0);
    }
    if (rules == RULES_ORIGINAL) {
        return texel(texture, mode, floor(x), floor(y));
    }
    let x0 = floor(x - 0.5);
    let y0 = floor(y - 0.5);
    let fx = x - 0.5 - x0;
    let fy = y - 0.5 - y0;
    let lower = texel(texture, mode, x0, y0) * (1.0 - fx) + texel(texture, mode, x0 + 1.0, y0) * fx;
    let upper = texel(texture, mode, x0, y0 + 1.0) * (1.0 - fx) + texel(texture, mode, x0 + 1.0, y0 + 1.0) * fx;
    return lower * (1.0 - fy) + upper * fy;
}

fn texel(texture: Texture, mode: u32, x: f32, y: f32) -> vec3<f32> {
    let at = texture.first + texel_index(y, texture.height, mode) * texture.width + texel_index(x, texture.width, mode);
    let word = texels[at];
    return vec3<f32>(f32(word & 0xffu), f32((word >> 8u) & 0xffu), f32((word >> 16u) & 0xffu)) / 255.0;
}

fn texel_index(place: f32, size: u32, mode: u32) -> u32 {
    let length = i32(size);
    let index = i32(clamp(place, -FARTHEST_TEXEL, FARTHEST_TEXEL));
    if (mode == REPEAT) {
        return u32(((index % length) + length) % length);
    }
    return u32(clamp(index, 0, length - 1));
}

fn sphere_coordinates(unit: vec3<f32>) -> vec2<f32> {
    let u = 0.5 + arctangent(unit.x, unit.z) / TAU;
    let v = arctangent(sqrt(unit.x * unit.x + unit.z * unit.z), -unit.y) * (2.0 / TAU);
    return vec2<f32>(u, v);
}

fn arctangent(y: f32, x: f32) -> f32 {
    let steep = abs(y) >= abs(x);
    let small = select(abs(y), abs(x), steep);
    let large = select(abs(x), abs(y), steep);
    if (large == 0.0) {
        return 0.0;
    }
    let r = small / large;
    let s = r * r;
    let octant = r * (0.999866 + s * (-0.3302995 + s * (0.180141 + s * (-0.085133 + s * 0.0208351))));
    let quadrant = select(octant, 1.57079632679489661923 - octant, steep);
    let half = select(quadrant, 3.14159265358979323846 - quadrant, x < 0.0);
    return copy_sign(half, y);
}

fn surface_point(hit: Hit, surface: Surface) -> SurfacePoint {
    let primitive = primitive_record(hit.primitive);
    if (primitive.kind == TRIANGLE) {
        let uv = triangle_corners(primitive.index).texture_coordinates;
        let a = vec2<f32>(uv[0], uv[1]);
        let b = vec2<f32>(uv[2], uv[3]);
        let c = vec2<f32>(uv[4], uv[5]);
        return SurfacePoint(a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v, vec2<f32>(0.0));
    }
    if (primitive.kind == SPHERE) {
        let around = spheres[primitive.index].radius * TAU;
        return SurfacePoint(sphere_coordinates(surface.normal), vec2<f32>(around, around / 2.0));
    }
    let square = squares[primitive.index];
    let offset = surface.point - square.center;
    let size = vec2<f32>(2.0 * square.half_width, 2.0 * square.half_height);
    let uv = vec2<f32>(0.5 - dot3(offset, square.across) / size.x, 0.5 + dot3(offset, square.along) / size.y);
    return SurfacePoint(uv, size);
}
