struct RowParams {
    camera: Camera,
    row: u32,
    max_depth: u32,
    seed: u32,
    padding: u32,
    // The ten shifts that a draw can give: constants would be folded, and a bit of one decides what is hit at edges.
    shifts: array<vec4<f32>, 3>,
}

const ROW_OPEN: u32 = 16u;

struct OpenRay {
    ray: NodeRay,
    depth: u32,
}

fn original_shift(draw: u32) -> f32 {
    let tenth = draw % 10u;
    return params.shifts[tenth / 4u][tenth % 4u];
}

// The hits of a ray tree, without shading: each takes one of the original's draws.
fn count_hits(camera_ray: Ray) -> u32 {
    var open: array<OpenRay, ROW_OPEN>;
    open[0] = OpenRay(NodeRay(camera_ray.origin, camera_ray.t_min, camera_ray.direction, 0u), 1u);
    var size = 1u;
    var hits = 0u;
    while (size > 0u) {
        size -= 1u;
        let depth = open[size].depth;
        let ray = node_ray(open[size].ray);
        let hit = closest_hit(ray, RULES_ORIGINAL);
        if (hit.primitive == NONE) {
            continue;
        }
        hits += 1u;
        if (depth >= params.max_depth) {
            continue;
        }
        let surface = surface_at(ray, hit);
        let material = materials[surface.material];
        let epsilon = spawn_epsilon(RULES_ORIGINAL, surface.point, hit.t);
        if (material.reflection > 0.0) {
            let direction = reflect_at(ray.direction, surface.normal);
            open[size] = OpenRay(NodeRay(surface.point, epsilon, direction, select(0u, 1u, ray.inside)), depth + 1u);
            size += 1u;
        }
        if (material.refraction > 0.0) {
            let bent = refract_at(ray.direction, surface.normal, material.refraction_ratio, RULES_ORIGINAL);
            if (any(bent != vec3<f32>(0.0))) {
                open[size] = OpenRay(NodeRay(surface.point, epsilon, bent, select(1u, 0u, ray.inside)), depth + 1u);
                size += 1u;
            }
        }
    }
    return hits;
}

// The shifts of a row's samples, and where in the sequence of draws the next row begins: two draws per pixel of this row
// and one per hit further on. `words[row]` is where this row begins.
@compute @workgroup_size(64)
fn draw_row(@builtin(global_invocation_id) id: vec3<u32>) {
    let width = params.camera.width;
    if (id.x >= width) {
        return;
    }
    let begin = atomicLoad(&row_starts[params.row]);
    let state = original_skip(params.seed, begin + 2u * id.x + 1u);
    let shift = vec2<f32>(original_shift(original_value(state)), original_shift(original_value(original_next(state))));
    shifts[params.row * width + id.x] = shift;
    let hits = count_hits(camera_ray(params.camera, id.x, params.row, shift, RULES_ORIGINAL));
    atomicAdd(&row_starts[params.row + 1u], hits + select(0u, begin + 2u * width, id.x == 0u));
}
