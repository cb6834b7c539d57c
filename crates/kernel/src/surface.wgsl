struct Primitive {
    kind: u32,
    index: u32,
    object: u32,
    material: u32,
}

struct TriangleCorners {
    normals: array<f32, 9>,
    texture_coordinates: array<f32, 6>,
    slack: f32,
}

struct Surface {
    point: vec3<f32>,
    normal: vec3<f32>,
    material: u32,
    object: u32,
}

fn surface_at(ray: Ray, hit: Hit) -> Surface {
    let primitive = primitive_record(hit.primitive);
    let point = ray.origin + ray.direction * hit.t;
    var normal: vec3<f32>;
    if (primitive.kind == TRIANGLE) {
        let n = triangle_corners(primitive.index).normals;
        let a = vec3<f32>(n[0], n[1], n[2]);
        let b = vec3<f32>(n[3], n[4], n[5]);
        let c = vec3<f32>(n[6], n[7], n[8]);
        normal = normalize_or_zero(a * (1.0 - hit.u - hit.v) + b * hit.u + c * hit.v);
    } else if (primitive.kind == SPHERE) {
        normal = normalize_or_zero(point - spheres[primitive.index].center);
    } else {
        normal = squares[primitive.index].normal;
    }
    return Surface(point, normal, primitive.material, primitive.object);
}
