const FAR_SIDE: f32 = 4.0;

struct Photon {
    position: vec3<f32>,
    cell_x: i32,
    normal: vec3<f32>,
    cell_y: i32,
    power: vec3<f32>,
    cell_z: i32,
}

struct PhotonTarget {
    center: vec3<f32>,
    radius: f32,
    light: u32,
    object: u32,
    side: u32,
    padding: u32,
}

struct PhotonStart {
    ray: Ray,
    area: f32,
}

fn photon_start(light: Light, target_: PhotonTarget, row: u32, column: u32) -> PhotonStart {
    let spacing = 2.0 * target_.radius / f32(target_.side);
    var axis = light.direction;
    if (light.kind != DIRECTIONAL) {
        axis = normalize_or_zero(target_.center - light.position);
    }
    let axes = frame(axis);
    let x = (f32(column) + 0.5) * spacing - target_.radius;
    let y = (f32(row) + 0.5) * spacing - target_.radius;
    let on_disk = target_.center + axes.tangent * x + axes.bitangent * y;
    var origin = light.position;
    var direction = normalize_or_zero(on_disk - light.position);
    if (light.kind == DIRECTIONAL) {
        origin = on_disk - axis * (FAR_SIDE * max(target_.radius, max_element(abs(on_disk))));
        direction = axis;
    }
    var cosine = 1.0;
    if (light.kind == HEMISPHERE) {
        cosine = dot3(light.direction, direction);
    }
    let outside = x * x + y * y > target_.radius * target_.radius || all(axis == vec3<f32>(0.0));
    let ray = Ray(origin, 0.0, direction, FAR, false);
    return PhotonStart(ray, select(spacing * spacing * cosine, 0.0, outside || cosine <= 0.0));
}
