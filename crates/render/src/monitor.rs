//! Watching a render and breaking it off.

use std::sync::atomic::{AtomicU64, Ordering};

/// Told how far a render is; asked whether to go on. Called from the rendering thread between and from worker threads
/// during batches of tiles.
pub trait Monitor: Sync {
    /// A stage begins with this many steps, all of about the same duration. Of most stages they are tiles or rows. Of the physical
    /// model's [`Stage::Samples`] they are samples of tiles (so many for each tile as there are samples of a pixel), or thousandths
    /// of the render where a limit of time or noise may end it: of whichever limit will probably be reached first.
    fn begin(&self, _stage: Stage, _steps: u64) {}
    /// A step of the current stage is done. A render that ends early need not have told all of them.
    fn advance(&self) {}
    /// The current stage is done.
    fn end(&self) {}
    /// Something that a person should know: a device did not return a result, and what is done about it.
    fn note(&self, _text: &str) {}
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
    /// Passes of the physical model.
    Samples,
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
            Self::Samples => "samples",
            Self::Develop => "develop",
        }
    }
}

/// Passes on what a device tells, though it may tell a part twice: steps that it did before a fault are not told again.
pub(crate) struct Retold<'a> {
    monitor: &'a dyn Monitor,
    /// Steps done in the attempts that count.
    done: AtomicU64,
    /// Steps done before the current attempt.
    start: u64,
    /// Steps told before the current attempt, fruitless ones included.
    told: u64,
}

impl<'a> Retold<'a> {
    pub(crate) fn new(monitor: &'a dyn Monitor) -> Self {
        Self { monitor, done: AtomicU64::new(0), start: 0, told: 0 }
    }

    /// From here on steps may have to be done again.
    pub(crate) fn begin_attempt(&mut self) {
        self.start = *self.done.get_mut();
    }

    /// The attempt was fruitless.
    pub(crate) fn rewind(&mut self) {
        let done = self.done.get_mut();
        self.told = self.told.max(*done);
        *done = self.start;
    }
}

impl Monitor for Retold<'_> {
    fn begin(&self, stage: Stage, steps: u64) {
        self.monitor.begin(stage, steps);
    }

    fn advance(&self) {
        if self.done.fetch_add(1, Ordering::Relaxed) >= self.told {
            self.monitor.advance();
        }
    }

    fn end(&self) {
        self.monitor.end();
    }

    fn note(&self, text: &str) {
        self.monitor.note(text);
    }

    fn cancelled(&self) -> bool {
        self.monitor.cancelled()
    }
}

/// Watches nothing and never stops.
#[derive(Debug, Clone, Copy, Default)]
pub struct Unwatched;

impl Monitor for Unwatched {}
