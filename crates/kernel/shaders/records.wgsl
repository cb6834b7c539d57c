// A sample of a pixel: where a camera ray goes.
struct CameraSample {
    pixel: u32,
    sample: u32,
    shift: vec2<f32>,
}

// Ray trees are stored as arrays: a node is a ray, what it hit, its colour, and where its children are. Layers follow
// one another; a node of the first layer has the number of its sample.
struct NodeRay {
    origin: vec3<f32>,
    t_min: f32,
    direction: vec3<f32>,
    inside: u32,
}

struct NodeSurface {
    point: vec3<f32>,
    epsilon: f32,
    normal: vec3<f32>,
    material: u32,
    t: f32,
    primitive: u32,
    u: f32,
    v: f32,
}

// `tally`: first pass: 1 if any light arrived. Second pass: 1 + the number of chosen VPLs of a shaded hit, else 0.
struct NodeColor {
    color: vec3<f32>,
    tally: u32,
}

// `reflected` and `refracted`: the children, or NONE, with the factors on their colours. `size`: hits in the subtree.
// `rank`: hits of the wave before the subtree, in post-order.
struct NodeLink {
    sample: u32,
    slot: u32,
    reflected: u32,
    refracted: u32,
    reflection: f32,
    refraction: f32,
    size: u32,
    rank: u32,
}

// Shaded hits of a subtree, and the VPLs that lit them.
struct NodeTotal {
    selected: u32,
    shaded: u32,
}

// The samples of a pixel.
struct PixelRecord {
    first: u32,
    count: u32,
}

fn node_ray(node: NodeRay) -> Ray {
    return Ray(node.origin, node.t_min, node.direction, FAR, node.inside != 0u);
}

fn node_hit(node: NodeSurface) -> Hit {
    return Hit(node.t, node.primitive, node.u, node.v);
}
