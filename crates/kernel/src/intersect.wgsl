const TRIANGLE: u32 = 0u;
const SPHERE: u32 = 1u;
const SQUARE: u32 = 2u;
const ORIGINAL_MIN_DETERMINANT: f32 = 0.001;

struct Triangle {
    corner: vec3<f32>,
    primitive: u32,
    edge1: vec3<f32>,
    padding0: u32,
    edge2: vec3<f32>,
    padding1: u32,
}

struct Sphere {
    center: vec3<f32>,
    radius: f32,
    primitive: u32,
    padding: array<u32, 3>,
}

struct Square {
    center: vec3<f32>,
    half_height: f32,
    normal: vec3<f32>,
    half_width: f32,
    along: vec3<f32>,
    primitive: u32,
    across: vec3<f32>,
    padding: u32,
}

fn min_determinant(rules: u32) -> f32 {
    return select(MIN_POSITIVE, ORIGINAL_MIN_DETERMINANT, rules == RULES_ORIGINAL);
}

fn intersect_triangle(triangle: Triangle, ray: Ray, min_determinant: f32) -> Hit {
    let p = cross3(ray.direction, triangle.edge2);
    let determinant = dot3(triangle.edge1, p);
    if (abs(determinant) < min_determinant) {
        return no_hit(ray.t_max);
    }
    let inverse = 1.0 / determinant;
    let to_origin = ray.origin - triangle.corner;
    let u = dot3(to_origin, p) * inverse;
    let q = cross3(to_origin, triangle.edge1);
    let v = dot3(ray.direction, q) * inverse;
    let t = dot3(triangle.edge2, q) * inverse;
    // Both are at least 0 where the sum counts; without `max` drivers take the common factor out of it.
    if (u >= 0.0 && v >= 0.0 && max(u, 0.0) + max(v, 0.0) <= 1.0 && t > ray.t_min && t < ray.t_max) {
        return Hit(t, triangle.primitive, u, v);
    }
    return no_hit(ray.t_max);
}

fn intersect_sphere(sphere: Sphere, ray: Ray, rules: u32) -> Hit {
    var t: f32;
    if (rules == RULES_ORIGINAL) {
        t = sphere_root_original(sphere, ray);
    } else {
        t = sphere_root(sphere, ray);
    }
    if (t > ray.t_min && t < ray.t_max) {
        return Hit(t, sphere.primitive, 0.0, 0.0);
    }
    return no_hit(ray.t_max);
}

// A root that is no hit is -1, below every t_min.
fn sphere_root(sphere: Sphere, ray: Ray) -> f32 {
    let offset = ray.origin - sphere.center;
    let a = dot3(ray.direction, ray.direction);
    let half_b = -dot3(offset, ray.direction);
    if (a == 0.0) {
        return -1.0;
    }
    let nearest = offset + ray.direction * (half_b / a);
    let discriminant = a * (sphere.radius * sphere.radius - dot3(nearest, nearest));
    if (discriminant < 0.0) {
        return -1.0;
    }
    let c = dot3(offset, offset) - sphere.radius * sphere.radius;
    let q = half_b + copy_sign(sqrt(discriminant), half_b);
    var first = 0.0;
    var second = 0.0;
    if (q != 0.0) {
        first = c / q;
        second = q / a;
    }
    let near = select(second, first, first < second);
    let far = select(first, second, first < second);
    return select(far, near, near > ray.t_min);
}

fn sphere_root_original(sphere: Sphere, ray: Ray) -> f32 {
    let offset = ray.origin - sphere.center;
    let a = dot3(ray.direction, ray.direction);
    let b = 2.0 * dot3(ray.direction, offset);
    let c = dot3(offset, offset) - sphere.radius * sphere.radius;
    let discriminant = b * b - 4.0 * a * c;
    if (discriminant < 0.0) {
        return -1.0;
    }
    let root = sqrt(discriminant);
    let near = (-b - root) / (2.0 * a);
    let far = (-b + root) / (2.0 * a);
    let t = select(far, near, !ray.inside && near > 0.0);
    return select(-1.0, t, t > ORIGINAL_EPSILON);
}

fn intersect_square(square: Square, ray: Ray) -> Hit {
    let slope = dot3(ray.direction, square.normal);
    if (slope == 0.0) {
        return no_hit(ray.t_max);
    }
    let t = quotient(dot3(square.center - ray.origin, square.normal), slope);
    if (!(t > ray.t_min && t < ray.t_max)) {
        return no_hit(ray.t_max);
    }
    let offset = ray.origin + scaled(ray.direction, t) - square.center;
    if (abs(dot3(offset, square.along)) <= square.half_height && abs(dot3(offset, square.across)) <= square.half_width) {
        return Hit(t, square.primitive, 0.0, 0.0);
    }
    return no_hit(ray.t_max);
}
