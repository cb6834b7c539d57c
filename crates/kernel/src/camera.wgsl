const PIXEL_PITCH: f32 = 0.01;
const THESIS_SIZE: u32 = 512u;

struct Camera {
    center: vec3<f32>,
    pitch: f32,
    view: vec3<f32>,
    eye_distance: f32,
    right: vec3<f32>,
    width: u32,
    up: vec3<f32>,
    height: u32,
}

fn camera_ray(camera: Camera, i: u32, j: u32, shift: vec2<f32>, rules: u32) -> Ray {
    let x = rounded_product(f32(i) - f32(camera.width) / 2.0, camera.pitch);
    let y = rounded_product(f32(j) - f32(camera.height) / 2.0, camera.pitch);
    let pixel = camera.center + scaled(camera.right, x) + scaled(camera.up, y);
    let moved = vec2<f32>(rounded_product(shift.x, camera.pitch), rounded_product(shift.y, camera.pitch));
    let origin = pixel + scaled(camera.right, moved.x) + scaled(camera.up, moved.y);
    var direction = camera.view;
    if (camera.eye_distance > 0.0) {
        direction = normalize_or_zero(origin - (camera.center - scaled(camera.view, camera.eye_distance)));
    }
    let t_min = select(0.0, ORIGINAL_EPSILON, rules == RULES_ORIGINAL);
    return Ray(origin, t_min, direction, FAR, false);
}
