const LOG2_E: f32 = 1.44269504088896340736;
const FILTER_BOX: u32 = 0u;
const FILTER_TRIANGLE: u32 = 1u;
const FILTER_GAUSSIAN: u32 = 2u;
const FILTER_MITCHELL: u32 = 3u;

struct PixelFilter {
    kind: u32,
    radius: f32,
    alpha: f32,
    mitchell_b: f32,
    mitchell_c: f32,
    padding0: u32,
    padding1: u32,
    padding2: u32,
}

fn filter_weight(filter_: PixelFilter, x: f32, y: f32) -> f32 {
    return filter_along(filter_, x) * filter_along(filter_, y);
}

fn filter_along(filter_: PixelFilter, x: f32) -> f32 {
    let radius = filter_.radius;
    if (!(x >= -radius && x < radius)) {
        return 0.0;
    }
    switch (filter_.kind) {
        case FILTER_BOX: { return 1.0; }
        case FILTER_TRIANGLE: { return radius - abs(x); }
        case FILTER_GAUSSIAN: {
            return max(gaussian(filter_, x) - gaussian(filter_, radius), 0.0);
        }
        default: { return mitchell(filter_, abs(x) * 2.0 / radius); }
    }
}

fn gaussian(filter_: PixelFilter, x: f32) -> f32 {
    return exp2_polynomial(-(filter_.alpha * LOG2_E) * (x * x));
}

fn mitchell(filter_: PixelFilter, x: f32) -> f32 {
    let b = filter_.mitchell_b;
    let c = filter_.mitchell_c;
    var value: f32;
    if (x < 1.0) {
        value = ((12.0 - 9.0 * b - 6.0 * c) * x + (-18.0 + 12.0 * b + 6.0 * c)) * x * x + (6.0 - 2.0 * b);
    } else {
        value = (((-b - 6.0 * c) * x + (6.0 * b + 30.0 * c)) * x + (-12.0 * b - 48.0 * c)) * x + (8.0 * b + 24.0 * c);
    }
    return value / 6.0;
}
