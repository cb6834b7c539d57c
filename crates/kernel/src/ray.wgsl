const ORIGINAL_EPSILON: f32 = 0.001;
const RELATIVE_EPSILON: f32 = 2e-5;
const SLAB_SLACK: f32 = 1.0 + 4e-7;
const SAFE_LEAST: f32 = 1e-20;
const NONE: u32 = 0xffffffffu;
// Stands for infinity, which the language does not spell: larger than any distance.
const FAR: f32 = 3.40282346638528859812e+38;

struct Ray {
    origin: vec3<f32>,
    t_min: f32,
    direction: vec3<f32>,
    t_max: f32,
    inside: bool,
}

struct Hit {
    t: f32,
    primitive: u32,
    u: f32,
    v: f32,
}

fn no_hit(t_max: f32) -> Hit {
    return Hit(t_max, NONE, 0.0, 0.0);
}

fn take_nearer(best: Hit, other: Hit) -> Hit {
    if (other.t < best.t || (other.t == best.t && other.primitive < best.primitive)) {
        return other;
    }
    return best;
}

fn spawn_epsilon(rules: u32, point: vec3<f32>, distance: f32) -> f32 {
    if (rules == RULES_ORIGINAL) {
        return ORIGINAL_EPSILON;
    }
    return RELATIVE_EPSILON * max(max_element(abs(point)), distance);
}

fn shadow_ray(rules: u32, point: vec3<f32>, to_light: vec3<f32>, epsilon: f32) -> Ray {
    if (rules == RULES_ORIGINAL) {
        return Ray(point, ORIGINAL_EPSILON, to_light, 1.0, false);
    }
    let relative = epsilon / max(length3(to_light), MIN_POSITIVE);
    return Ray(point, relative, to_light, 1.0 - relative, false);
}

fn safe_component(c: f32) -> f32 {
    if (abs(c) < SAFE_LEAST) {
        return 1.0 / copy_sign(SAFE_LEAST, c);
    }
    return 1.0 / c;
}

fn safe_reciprocal(direction: vec3<f32>) -> vec3<f32> {
    return vec3<f32>(safe_component(direction.x), safe_component(direction.y), safe_component(direction.z));
}

fn normalize_or_zero(v: vec3<f32>) -> vec3<f32> {
    let length = length3(v);
    let reciprocal = quotient(1.0, length);
    // Neither 1 / 0 nor 1 / infinity is a factor.
    if (length > 0.0 && reciprocal > 0.0 && reciprocal <= FAR) {
        return scaled(v, reciprocal);
    }
    return vec3<f32>(0.0);
}
