//! What a render of the physical model yields.

use super::develop::Undeveloped;
use crate::stats::Stats;
use lightcuts_image::{Image, LayerData, Layers, Plane};
use std::fmt;
use std::sync::OnceLock;

/// A picture of the physical model with everything that was learnt on the way. All planes have one size, row 0 at the top.
///
/// A pixel that a broken-off first pass left without samples has the nearest sample of a coarse one, in all planes; its `samples` are 0.
pub struct PhysicalRendering {
    /// Radiance, linear.
    pub beauty: Image,
    /// Counts and times. `stats.complete` tells whether the render ran to its end.
    pub stats: Stats,
    /// What the rest is made of when it is asked for: it takes longer than the beauty, and several times its memory.
    undeveloped: Undeveloped,
    aovs: OnceLock<Aovs>,
}

/// The planes beside the beauty.
#[derive(Debug, Clone)]
pub struct Aovs {
    /// Part of the radiance that was emitted towards the camera or scattered once.
    pub direct: Image,
    /// Part that was scattered more often.
    pub indirect: Image,
    /// Colour of the surface seen, mean over the samples.
    pub albedo: Image,
    /// Normal of the surface seen, mean over the samples that hit something.
    pub normal: Image,
    /// Position of the surface seen, in scene units, mean over the samples that hit something.
    pub position: Image,
    /// Distance along the ray, in scene units, mean over the samples that hit; infinite where none did.
    pub depth: Plane<f32>,
    /// Number of the object that the first sample saw, from 1; 0 for none.
    pub object_id: Plane<u32>,
    /// Number of its material, from 1; 0 for none.
    pub material_id: Plane<u32>,
    /// Number of samples.
    pub samples: Plane<f32>,
    /// Variance of the pixel's brightness, (r + g + b) / 3, as an estimate of what endless samples would give.
    pub variance: Plane<f32>,
    /// Mean number of clusters and virtual lights in the cuts of a sample that gathers VPLs.
    pub cut_size: Plane<f32>,
    /// Mean bound of a sample's cuts' error, as a sum of channels.
    pub error_bound: Plane<f32>,
}

impl PhysicalRendering {
    pub(super) fn new(beauty: Image, stats: Stats, undeveloped: Undeveloped) -> Self {
        Self { beauty, stats, undeveloped, aovs: OnceLock::new() }
    }

    /// The planes beside the beauty, made when they are first asked for.
    pub fn aovs(&self) -> &Aovs {
        self.aovs.get_or_init(|| self.undeveloped.aovs(&self.beauty))
    }

    /// Beauty and AOVs, ready for an EXR file; copies of them. [`into_layers`](Self::into_layers) copies nothing.
    pub fn layers(&self) -> Layers {
        self.aovs().clone().into_layers(self.beauty.clone())
    }

    /// Beauty and AOVs, ready for an EXR file.
    pub fn into_layers(self) -> Layers {
        let Self { beauty, undeveloped, aovs, .. } = self;
        let aovs = aovs.into_inner().unwrap_or_else(|| undeveloped.into_aovs(&beauty));
        aovs.into_layers(beauty)
    }
}

impl fmt::Debug for PhysicalRendering {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.debug_struct("PhysicalRendering").field("stats", &self.stats).finish_non_exhaustive()
    }
}

impl Aovs {
    fn into_layers(self, beauty: Image) -> Layers {
        let mut layers = Layers::new(beauty);
        let aovs = [
            ("direct", LayerData::Color(self.direct)),
            ("indirect", LayerData::Color(self.indirect)),
            ("albedo", LayerData::Color(self.albedo)),
            ("normal", LayerData::Vector(self.normal)),
            ("position", LayerData::Vector(self.position)),
            ("depth", LayerData::Depth(self.depth)),
            ("object_id", LayerData::Id(self.object_id)),
            ("material_id", LayerData::Id(self.material_id)),
            ("samples", LayerData::Scalar(self.samples)),
            ("variance", LayerData::Scalar(self.variance)),
            ("cut_size", LayerData::Scalar(self.cut_size)),
            ("error_bound", LayerData::Scalar(self.error_bound)),
        ];
        for (name, data) in aovs {
            layers.push(name, data).expect("all planes have the picture's size and each its own name");
        }
        layers
    }
}
