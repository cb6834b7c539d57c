//! Watching a render and breaking it off.

/// Told how far a render is; asked whether to go on. Called from the rendering thread between and from worker threads
/// during batches of tiles.
pub trait Monitor: Sync {
    /// A stage begins with this many steps.
    fn begin(&self, _stage: Stage, _steps: u64) {}
    /// A step of the current stage is done.
    fn advance(&self) {}
    /// The current stage is done.
    fn end(&self) {}
    /// Whether to stop; the picture then holds what there is.
    fn cancelled(&self) -> bool {
        false
    }
}

/// The stages of a render, in order.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Stage {
    /// Direct light, mirrors and refraction; places the VPLs.
    FirstPass,
    /// Photons for caustics.
    Photons,
    /// The tree over the VPLs.
    LightTree,
    /// Light of the VPLs.
    SecondPass,
    /// From samples to the finished picture.
    Develop,
}

impl Stage {
    /// Name in statistics.
    pub const fn name(self) -> &'static str {
        match self {
            Self::FirstPass => "first_pass",
            Self::Photons => "photons",
            Self::LightTree => "light_tree",
            Self::SecondPass => "second_pass",
            Self::Develop => "develop",
        }
    }
}

/// Watches nothing and never stops.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Monitor for Unwatched {}
