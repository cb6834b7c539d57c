//! The WGSL sources: every module's twin by its stem, and the entry points in `shaders/`.
//!
//! A pipeline's program is a list of these, joined. Nothing is included by text: the list is the include.

/// A WGSL file of this crate.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Source {
    /// Path from the crate's root.
    pub path: &'static str,
    /// Its text.
    pub text: &'static str,
}

macro_rules! source {
    ($path:literal) => {
        Source { path: $path, text: include_str!(concat!("../", $path)) }
    };
}

/// Twin of [`crate::rules`].
pub const RULES: Source = source!("src/rules.wgsl");
/// Twin of [`crate::vector`].
pub const VECTOR: Source = source!("src/vector.wgsl");
/// Twin of [`crate::ray`].
pub const RAY: Source = source!("src/ray.wgsl");
/// Twin of [`crate::rng`].
pub const RNG: Source = source!("src/rng.wgsl");
/// Twin of [`crate::sampling`].
pub const SAMPLING: Source = source!("src/sampling.wgsl");
/// Twin of [`crate::power`].
pub const POWER: Source = source!("src/power.wgsl");
/// Twin of [`crate::intersect`].
pub const INTERSECT: Source = source!("src/intersect.wgsl");
/// Twin of [`crate::surface`].
pub const SURFACE: Source = source!("src/surface.wgsl");
/// Twin of [`crate::cwbvh`].
pub const CWBVH: Source = source!("src/cwbvh.wgsl");
/// Twin of [`crate::camera`].
pub const CAMERA: Source = source!("src/camera.wgsl");
/// Twin of [`crate::material`].
pub const MATERIAL: Source = source!("src/material.wgsl");
/// Twin of [`crate::light`].
pub const LIGHT: Source = source!("src/light.wgsl");
/// Twin of [`crate::phong`].
pub const PHONG: Source = source!("src/phong.wgsl");
/// Twin of [`crate::optics`].
pub const OPTICS: Source = source!("src/optics.wgsl");
/// Twin of [`crate::texture`].
pub const TEXTURE: Source = source!("src/texture.wgsl");
/// Twin of [`crate::light_tree`].
pub const LIGHT_TREE: Source = source!("src/light_tree.wgsl");
/// Twin of [`crate::packed_tree`].
pub const PACKED_TREE: Source = source!("src/packed_tree.wgsl");
/// Twin of [`crate::filter`].
pub const FILTER: Source = source!("src/filter.wgsl");
/// Twin of [`crate::photon_gather`].
pub const PHOTON_GATHER: Source = source!("src/photon_gather.wgsl");
/// Twin of [`crate::photon`].
pub const PHOTON: Source = source!("src/photon.wgsl");

/// The twins, each after those that it uses.
pub const TWINS: [Source; 20] = [
    RULES,
    VECTOR,
    RAY,
    RNG,
    SAMPLING,
    POWER,
    INTERSECT,
    SURFACE,
    CWBVH,
    CAMERA,
    MATERIAL,
    LIGHT,
    PHONG,
    OPTICS,
    TEXTURE,
    LIGHT_TREE,
    PACKED_TREE,
    FILTER,
    PHOTON,
    PHOTON_GATHER,
];

/// Entry points and what they share.
pub mod shaders {
    use super::Source;

    /// Records of ray trees.
    pub const RECORDS: Source = source!("shaders/records.wgsl");
    /// Parameters of programs over a range.
    pub const RANGE: Source = source!("shaders/range.wgsl");
    /// Sums over all invocations.
    pub const COUNTERS: Source = source!("shaders/counters.wgsl");
    /// Camera rays.
    pub const START: Source = source!("shaders/start.wgsl");
    /// Nearest hits and surfaces.
    pub const TRACE: Source = source!("shaders/trace.wgsl");
    /// The scene's lights.
    pub const DIRECT: Source = source!("shaders/direct.wgsl");
    /// Ambient occlusion.
    pub const OCCLUDE: Source = source!("shaders/occlude.wgsl");
    /// Colours of the first pass.
    pub const FINISH: Source = source!("shaders/finish.wgsl");
    /// VPLs.
    pub const GATHER: Source = source!("shaders/gather.wgsl");
    /// Colours of the second pass.
    pub const SCALE: Source = source!("shaders/scale.wgsl");
    /// Mirrored and refracted rays.
    pub const SPAWN: Source = source!("shaders/spawn.wgsl");
    /// Sums over ray trees.
    pub const SUM: Source = source!("shaders/sum.wgsl");
    /// VPLs placed at hits.
    pub const PLACE: Source = source!("shaders/place.wgsl");
    /// Films.
    pub const FILM: Source = source!("shaders/film.wgsl");
    /// What pixels saw.
    pub const SEE: Source = source!("shaders/see.wgsl");
    /// Prefix sums.
    pub const SCAN: Source = source!("shaders/scan.wgsl");
    /// Radix sort.
    pub const SORT: Source = source!("shaders/sort.wgsl");
    /// The light tree.
    pub const TREE: Source = source!("shaders/tree.wgsl");
    /// Photons.
    pub const SHOOT: Source = source!("shaders/shoot.wgsl");
    /// The original's draws, row by row.
    pub const ROWS: Source = source!("shaders/rows.wgsl");
    /// Rays by themselves.
    pub const PROBE: Source = source!("shaders/probe.wgsl");
    /// Tone mapping.
    pub const TONE: Source = source!("shaders/tone.wgsl");
    /// Bloom.
    pub const BLOOM: Source = source!("shaders/bloom.wgsl");
}
