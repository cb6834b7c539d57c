//! Records that programs read and write, as this side sees them. A test compares their layouts with those in WGSL.

use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use lightcuts_kernel::camera::Camera;
use lightcuts_kernel::filter::PixelFilter;
use lightcuts_kernel::light::Light;
use lightcuts_kernel::photon::PhotonTarget;

/// Declares plain records with all fields visible.
macro_rules! records {
    ($($(#[$doc:meta])* $name:ident { $($field:ident: $ty:ty),* $(,)? })*) => {
        $(
            $(#[$doc])*
            #[repr(C)]
            #[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
            #[allow(missing_docs)]
            pub struct $name { $(pub $field: $ty),* }
        )*

        /// Name, size and field offsets of every record, for comparison with WGSL.
        pub fn layouts() -> Vec<Layout> {
            vec![$(Layout {
                name: stringify!($name),
                size: size_of::<$name>(),
                fields: vec![$((stringify!($field), std::mem::offset_of!($name, $field))),*],
            }),*]
        }
    };
}

/// The layout of a record.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Layout {
    /// Name of the type, the same in WGSL.
    pub name: &'static str,
    /// Bytes of an element of an array.
    pub size: usize,
    /// Fields with their offsets in bytes.
    pub fields: Vec<(&'static str, usize)>,
}

records! {
    /// A sample of a pixel.
    CameraSample { pixel: u32, sample: u32, shift: [f32; 2] }
    /// A ray of a ray tree.
    NodeRay { origin: Vec3, t_min: f32, direction: Vec3, inside: u32 }
    /// What it hit.
    NodeSurface {
        point: Vec3, epsilon: f32, normal: Vec3, material: u32, t: f32, primitive: u32, u: f32, v: f32
    }
    /// Its colour.
    NodeColor { color: Vec3, tally: u32 }
    /// Its place in the tree.
    NodeLink {
        sample: u32, slot: u32, reflected: u32, refracted: u32, reflection: f32, refraction: f32, size: u32, rank: u32
    }
    /// Sums over its subtree.
    NodeTotal { selected: u32, shaded: u32 }
    /// A tile of a wave.
    TileRecord {
        i: u32, j: u32, width: u32, height: u32, film: u32, pixel: u32, padding0: u32, padding1: u32
    }
    /// The samples of a pixel.
    PixelRecord { first: u32, count: u32 }
    /// A pixel of a tile's film.
    Place { tile: u32, x: u32, y: u32 }
    /// What a pixel's samples saw.
    SeenRecord {
        albedo: Vec3, samples: u32, normal: Vec3, hits: u32, depth: f32, object: u32, selected: u32, shaded: u32
    }
    /// A ray by itself.
    ProbeRay { origin: Vec3, t_min: f32, direction: Vec3, t_max: f32 }
    /// What it hit.
    ProbeHit { t: f32, primitive: u32, u: f32, v: f32 }
    /// Parameters of `start`.
    StartParams { camera: Camera, first: u32, count: u32, rules: u32, padding: u32 }
    /// Parameters of `trace`, `sum_layer` and `see`.
    RangeParams { first: u32, count: u32, rules: u32, padding: u32 }
    /// Parameters of `direct`.
    DirectParams {
        first: u32, count: u32, rules: u32, first_light: u32,
        light_count: u32, padding0: u32, padding1: u32, padding2: u32
    }
    /// Parameters of `occlude`.
    OccludeParams {
        first: u32, count: u32, rules: u32, first_ray: u32, ray_count: u32, rays: u32,
        sin_max: f32, range: f32, stream: u32, slots: u32, padding0: u32, padding1: u32
    }
    /// Parameters of `finish`.
    FinishParams {
        first: u32, count: u32, rules: u32, occlusion_rays: u32, background: Vec3, occlusion_factor: f32
    }
    /// Parameters of `gather_all` and `gather_cut`.
    GatherParams {
        first: u32, count: u32, rules: u32, threshold: f32, first_vpl: u32, vpl_count: u32,
        root: u32, first_block: u32, block_count: u32, total_vpls: u32, exhaustive: u32, padding: u32
    }
    /// Parameters of `scale`.
    ScaleParams {
        first: u32, count: u32, has_photons: u32, min_photons: u32,
        radius: f32, padding0: u32, padding1: u32, padding2: u32
    }
    /// Parameters of `count_children` and `spawn`.
    SpawnParams {
        first: u32, count: u32, rules: u32, layer: u32, next: u32, padding0: u32, padding1: u32, padding2: u32
    }
    /// Parameters of the programs that place VPLs.
    PlaceParams {
        first: u32, count: u32, probability: f32, min_illumination: f32,
        attenuation: f32, stream: u32, padding0: u32, padding1: u32
    }
    /// Parameters of `film`.
    FilmParams { first: u32, count: u32, border: u32, width: u32, filter_: PixelFilter }
    /// Parameters of prefix sums.
    ScanParams { count: u32, padding0: u32, padding1: u32, padding2: u32 }
    /// Parameters of the radix sort.
    SortParams { count: u32, shift: u32, groups: u32, first_group: u32 }
    /// Parameters of the programs that build a light tree.
    TreeParams {
        lower: Vec3, first: u32, extent: Vec3, count: u32, vpl_count: u32, level: u32, padding0: u32, padding1: u32
    }
    /// Parameters of the programs that shoot photons.
    ShootParams {
        light: Light, target_: PhotonTarget, first: u32, count: u32, rules: u32, max_depth: u32,
        min_diffuse: f32, round: u32, padding0: u32, padding1: u32
    }
    /// Parameters of `draw_row`.
    RowParams { camera: Camera, row: u32, max_depth: u32, seed: u32, padding: u32, shifts: [f32; 12] }
    /// Parameters of tone mapping.
    ToneParams {
        first: u32, count: u32, width: u32, height: u32, white: f32, factor: f32, reach: u32, floor_: f32,
        epsilon: f32, padding0: u32, padding1: u32, padding2: u32
    }
    /// Parameters of `bloom`.
    BloomParams {
        first: u32, count: u32, width: u32, height: u32, radius: f32, weight: f32, reach: u32, padding: u32
    }
}
