struct ShootParams {
    light: Light,
    target_: PhotonTarget,
    first: u32,
    count: u32,
    rules: u32,
    max_depth: u32,
    min_diffuse: f32,
    // Number of the first photon of this round in the target's grid.
    round: u32,
    padding0: u32,
    padding1: u32,
}

// A photon may still have a mirrored and a refracted branch open at each bounce.
const MAX_OPEN: u32 = 32u;

struct OpenPhoton {
    ray: NodeRay,
    power: vec3<f32>,
    bounces: u32,
}

// Follows a photon through mirrors and glass; returns how many were stored, and stores them from `place` on if asked.
fn follow(row: u32, column: u32, place: u32, is_stored: bool, invocation: u32) -> u32 {
    let start = photon_start(params.light, params.target_, row, column);
    if (start.area == 0.0) {
        return 0u;
    }
    var open: array<OpenPhoton, MAX_OPEN>;
    let first = NodeRay(start.ray.origin, start.ray.t_min, start.ray.direction, 0u);
    open[0] = OpenPhoton(first, params.light.diffuse * (params.light.attenuation * start.area), 0u);
    var size = 1u;
    var stored = 0u;
    var rays = 0u;
    while (size > 0u) {
        size -= 1u;
        let photon = open[size];
        let ray = node_ray(photon.ray);
        rays += 1u;
        let hit = closest_hit(ray, params.rules);
        if (hit.primitive == NONE) {
            continue;
        }
        let surface = surface_at(ray, hit);
        if (photon.bounces == 0u && surface.object != params.target_.object) {
            continue;
        }
        let material = materials[surface.material];
        let diffuse = material.diffuse;
        if (photon.bounces > 0u && !ray.inside && diffuse.x + diffuse.y + diffuse.z >= params.min_diffuse) {
            if (is_stored) {
                photons[place + stored] = Photon(surface.point, 0, surface.normal, 0, photon.power, 0);
            }
            stored += 1u;
            continue;
        }
        if (photon.bounces + 1u >= params.max_depth || size + 2u > MAX_OPEN) {
            continue;
        }
        let epsilon = spawn_epsilon(params.rules, surface.point, hit.t);
        if (material.reflection > 0.0) {
            let mirrored = NodeRay(
                surface.point, epsilon, reflect_at(ray.direction, surface.normal), select(0u, 1u, ray.inside),
            );
            open[size] = OpenPhoton(mirrored, photon.power * material.reflection, photon.bounces + 1u);
            size += 1u;
        }
        let bent = refract_at(ray.direction, surface.normal, material.refraction_ratio, params.rules);
        if (material.refraction > 0.0 && any(bent != vec3<f32>(0.0))) {
            let refracted = NodeRay(surface.point, epsilon, bent, select(1u, 0u, ray.inside));
            open[size] = OpenPhoton(refracted, photon.power * material.refraction, photon.bounces + 1u);
            size += 1u;
        }
    }
    if (!is_stored) {
        count_up(COUNTER_PHOTON_RAYS, rays, invocation);
    }
    return stored;
}

// Counts what some photons of the target's grid leave behind.
@compute @workgroup_size(64)
fn count_photons(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        let photon = params.round + n;
        words[n] = follow(photon / params.target_.side, photon % params.target_.side, 0u, false, id.x);
    }
}

// Stores it; `words` are now the numbers of photons before each.
@compute @workgroup_size(64)
fn store_photons(@builtin(global_invocation_id) id: vec3<u32>) {
    if (id.x < params.count) {
        let n = params.first + id.x;
        let photon = params.round + n;
        _ = follow(photon / params.target_.side, photon % params.target_.side, words[n], true, id.x);
    }
}
