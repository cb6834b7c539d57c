//! What a device is: the stations that may run anywhere, and the flat data that goes in and comes out.
//!
//! Every result has one layout on all devices, so that a station's result can be computed on one device and used on
//! another: that is how a fault is isolated. A device returns a complete result or a [`DeviceFault`], never a part of a
//! result.

pub use crate::cpu::{CpuDevice, Tracer, processor_name};
pub use crate::film::{Film, Tile};
pub use crate::light_tree::{LightTree, PackedTree, TreeLayout, position_bounds};
pub use crate::occlusion::{Occlusion, SLOTS};
pub use crate::original::original_shift;
pub use crate::photon_map::{PhotonMap, photon_targets};
pub use crate::ray_tree::TreeHit;
pub use crate::sampler::Sampler;
pub use crate::stats::{Rays, TreeVisits};

use crate::monitor::Monitor;
use crate::settings::{Caustics, Filter, Strategy};
use glam::Vec3;
use lightcuts_image::{Image, ToneMapping};
use lightcuts_kernel::Rules;
use lightcuts_kernel::camera::Camera;
use lightcuts_kernel::light::Vpl;
use lightcuts_world::World;

/// Where stations run.
///
/// Its functions take `&self`: a device that keeps state guards it. They are called from one thread at a time.
pub trait Device: Sync {
    /// What it is.
    fn info(&self) -> DeviceInfo;

    /// Preferred batch size, in tiles.
    fn batch(&self) -> usize;

    /// Stations 3 and 5: one pass over some tiles. Calls [`Monitor::advance`] once per tile and checks
    /// [`Monitor::cancelled`]: a tile that was therefore not rendered is `None`. Results are in the order of `tiles`.
    fn render_tiles(
        &self,
        pass: &Pass<'_>,
        tiles: &[Tile],
        monitor: &dyn Monitor,
    ) -> Result<Vec<Option<TileResult>>, DeviceFault>;

    /// Shifts of all pixels' samples in the original's first pass, bottom row first, in pixels: each row's depend on
    /// the number of hits in the rows below.
    fn original_shifts(&self, view: &View<'_>) -> Result<Vec<[f32; 2]>, DeviceFault>;

    /// Photons for caustics, with the number of rays traced. Calls [`Monitor::advance`] once per row of each of the
    /// [`photon_targets`]. A monitor that cancels gets those shot so far.
    fn shoot_photons(
        &self,
        view: &View<'_>,
        settings: &Caustics,
        monitor: &dyn Monitor,
    ) -> Result<(PhotonMap, u64), DeviceFault>;

    /// The layout of the light tree that this device gathers fastest with.
    fn preferred_layout(&self) -> TreeLayout;

    /// Station 4. The tree has the requested layout if the device can build it, else another one.
    fn build_tree(&self, vpls: &[Vpl], wanted: TreeLayout) -> Result<LightTree, DeviceFault>;

    /// Bloom of the finished picture; see [`lightcuts_image::bloom`].
    fn bloom(&self, image: &Image, radius: f32, weight: f32) -> Result<Image, DeviceFault>;

    /// The picture as it is shown; see [`ToneMapping::apply`].
    fn tone_map(&self, image: &Image, operator: &ToneMapping) -> Result<Image, DeviceFault>;

    /// Reopens the device after a fault. An error means that it is lost for good.
    fn revive(&self) -> Result<(), DeviceFault>;
}

/// What a device is, for people and statistics.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct DeviceInfo {
    /// CPU, GPU, or a GPU driver that runs on the CPU.
    pub kind: DeviceKind,
    /// Name of the processor or card.
    pub name: String,
}

/// Kinds of device.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum DeviceKind {
    /// The processor, through this crate.
    Cpu,
    /// A graphics card.
    Gpu,
    /// A graphics driver that runs on the processor.
    SoftwareGpu,
}

impl DeviceKind {
    /// Name in statistics.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Cpu => "cpu",
            Self::Gpu => "gpu",
            Self::SoftwareGpu => "software gpu",
        }
    }
}

/// Why a device did not return a result. Earlier results stay valid.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
pub enum DeviceFault {
    /// The device went away, or its driver reset it.
    #[error("the device was lost: {0}")]
    Lost(String),
    /// Its memory is too small.
    #[error("out of memory on the device: {0}")]
    OutOfMemory(String),
    /// It refused the work.
    #[error("the device failed: {0}")]
    Failed(String),
}

/// What every pass over the picture shares.
#[derive(Debug, Clone, Copy)]
pub struct View<'a> {
    /// The scene.
    pub world: &'a World,
    /// The view with the picture's size.
    pub camera: Camera,
    /// Whether the original's defects hold.
    pub rules: Rules,
    /// Reconstruction filter.
    pub filter: &'a Filter,
    /// Maximum ray depth: mirrored and refracted rays, the camera ray included.
    pub max_depth: u32,
}

/// Where a pass takes its samples from.
#[derive(Debug, Clone, Copy)]
pub enum Shifts<'a> {
    /// A sampler's points.
    Sampler(&'a Sampler),
    /// One given shift per pixel of the whole picture, bottom row first.
    Given(&'a [[f32; 2]]),
}

/// What a pass does at each pixel.
#[derive(Debug, Clone, Copy)]
pub struct Pass<'a> {
    /// Scene, camera and rules.
    pub view: View<'a>,
    /// What lights hits.
    pub lighting: Lighting<'a>,
    /// Where samples lie.
    pub shifts: Shifts<'a>,
    /// Number of a pixel's first sample in this pass.
    pub first_sample: u32,
    /// Pixels to render; all where absent.
    pub mask: Option<&'a [bool]>,
    /// Results besides colours.
    pub wants: Wants<'a>,
}

/// What a pass reports besides colours.
#[derive(Debug, Clone, Copy)]
pub enum Wants<'a> {
    /// Nothing.
    Colors,
    /// Surfaces seen, and VPLs placed.
    SurfacesAndVpls(Option<&'a Placement>),
    /// Surfaces seen, and every hit in the original's order.
    SurfacesAndHits,
    /// Sums over each pixel of the VPLs that lit shaded hits.
    SelectedSums,
    /// The same, and the number of VPLs that lit each shaded hit, in order.
    Selections,
}

/// Chooses hits that become VPLs.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Placement {
    /// Probability that a hit becomes a VPL.
    pub probability: f32,
    /// Minimum r + g + b of its colour.
    pub min_illumination: f32,
    /// Factor on the VPL's light.
    pub attenuation: f32,
    /// Stream of its random numbers.
    pub stream: u32,
}

/// What lights a hit.
#[derive(Debug, Clone, Copy)]
pub enum Lighting<'a> {
    /// First pass: the scene's lights, with textures, background and glow.
    Scene {
        /// Ambient occlusion, if wanted.
        occlusion: Option<&'a Occlusion>,
    },
    /// Second pass: VPLs and photons.
    Vpls(VplLighting<'a>),
}

/// What the second pass gathers.
#[derive(Debug, Clone, Copy)]
pub struct VplLighting<'a> {
    /// The VPLs, in a tree.
    pub tree: &'a LightTree,
    /// How they are chosen.
    pub strategy: Strategy,
    /// Minimum relevance of a chosen VPL; not for [`Strategy::All`].
    pub threshold: f32,
    /// Photons for caustics, if there are any.
    pub photons: Option<&'a PhotonMap>,
}

/// What the camera rays of a pixel saw, summed over its samples.
#[derive(Debug, Clone, Copy, Default, PartialEq)]
pub struct Seen {
    /// Number of samples.
    pub samples: u32,
    /// Number of those that hit something.
    pub hits: u32,
    /// Sum of the diffuse colours of what they hit.
    pub albedo: Vec3,
    /// Sum of the normals.
    pub normal: Vec3,
    /// Sum of the distances along the rays.
    pub depth: f32,
    /// Object of the first sample that hit one, from 1; 0 for none.
    pub object: u32,
    /// VPLs that lit shaded hits.
    pub selected: u64,
    /// Number of shaded hits.
    pub shaded: u64,
}

/// Everything a tile yields.
#[derive(Debug, Clone)]
pub struct TileResult {
    /// Which tile.
    pub tile: Tile,
    /// Weighted sums of its samples, with a border.
    pub film: Film,
    /// What its pixels saw, bottom row first.
    pub seen: Vec<Seen>,
    /// VPLs placed, in order of pixels, samples, and hits in post-order of each ray tree.
    pub vpls: Vec<Vpl>,
    /// Every hit in that order, with [`Wants::SurfacesAndHits`].
    pub hits: Vec<TreeHit>,
    /// Numbers of VPLs that lit each shaded hit, in order of pixels, samples and slots, with [`Wants::Selections`].
    pub selections: Vec<u32>,
    /// Rays by kind.
    pub rays: Rays,
    /// Work of choosing VPLs.
    pub visits: TreeVisits,
}
