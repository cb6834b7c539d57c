const BOUND_MARGIN: f32 = 1e-3;
const REJECT: u32 = 0u;
const ACCEPT: u32 = 1u;
const DESCEND: u32 = 2u;

struct LightCluster {
    lower: vec3<f32>,
    upper: vec3<f32>,
    axis: vec3<f32>,
    cos_spread: f32,
    sin_spread: f32,
    min_intensity: f32,
    max_intensity: f32,
}

struct RelevanceBounds {
    least_flux: f32,
    greatest_volume: f32,
    greatest_flux: f32,
    least_volume: f32,
}

fn is_relevant(vpl: Vpl, intensity: f32, point: vec3<f32>, threshold: f32) -> bool {
    let towards = vpl.position - point;
    let dist_sq = dot3(towards, towards);
    return max(-dot3(vpl.direction, towards), 0.0) * intensity >= threshold * (dist_sq * sqrt(dist_sq));
}

fn relevance_bounds(cluster: LightCluster, lower: vec3<f32>, upper: vec3<f32>) -> RelevanceBounds {
    let from_upper = lower - cluster.upper;
    let from_lower = upper - cluster.lower;
    let outside = max(max(from_upper, -from_lower), vec3<f32>(0.0));
    let farthest = max(abs(from_lower), abs(from_upper));
    let near_sq = dot3(outside, outside);
    let far_sq = dot3(farthest, farthest);
    let a = cluster.axis * from_upper;
    let b = cluster.axis * from_lower;
    let least = dot3(min(a, b), vec3<f32>(1.0));
    let greatest = dot3(max(a, b), vec3<f32>(1.0));
    let far = sqrt(far_sq);
    let near = sqrt(select(far_sq, near_sq, greatest > 0.0));
    let faced = greatest >= near * cluster.cos_spread;
    let widened = min(greatest * cluster.cos_spread + near * cluster.sin_spread, near);
    return RelevanceBounds(
        (least * cluster.cos_spread - far * cluster.sin_spread) * cluster.min_intensity,
        far_sq * far,
        select(max(widened, 0.0), near, faced) * cluster.max_intensity,
        near_sq * near,
    );
}

fn decide(cluster: LightCluster, lower: vec3<f32>, upper: vec3<f32>, threshold: f32) -> u32 {
    let bounds = relevance_bounds(cluster, lower, upper);
    if (bounds.greatest_flux < threshold * (1.0 - BOUND_MARGIN) * bounds.least_volume) {
        return REJECT;
    }
    if (bounds.least_flux >= threshold * (1.0 + BOUND_MARGIN) * bounds.greatest_volume && bounds.least_flux > 0.0) {
        return ACCEPT;
    }
    return DESCEND;
}
