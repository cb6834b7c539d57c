//! Progress and cancellation of a render.

use std::sync::atomic::{AtomicU64, Ordering};

/// Receives the progress of a render and may cancel it. Called from the rendering thread between batches of tiles, and
/// from worker threads during them.
pub trait Monitor: Sync {
    /// A stage begins with this many steps, all of about the same duration. Of most stages they are tiles or rows. Of
    /// the physical model's [`Stage::Samples`] they are samples of tiles (so many for each tile as there are samples of
    /// a pixel), or thousandths of the render where a limit of time or noise may end it: of whichever limit will
    /// probably be reached first.
    fn begin(&self, _stage: Stage, _steps: u64) {}
    /// A step of the current stage is done. A render that ends early need not have told all of them.
    fn advance(&self) {}
    /// The current stage is done.
    fn end(&self) {}
    /// A note for the user: a device failed, and how the render continues.
    fn note(&self, _text: &str) {}
    /// Return true to cancel; the partial picture is kept.
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

/// Deduplicates progress when work is retried: steps that were done before a fault are not reported again.
pub(crate) struct RetryMonitor<'a> {
    monitor: &'a dyn Monitor,
    /// Steps done in the attempts that count.
    done: AtomicU64,
    /// Steps done before the current attempt.
    start: u64,
    /// Steps reported before the current attempt, failed ones included.
    reported: u64,
}

impl<'a> RetryMonitor<'a> {
    pub(crate) fn new(monitor: &'a dyn Monitor) -> Self {
        Self { monitor, done: AtomicU64::new(0), start: 0, reported: 0 }
    }

    /// The steps from here on may have to be repeated.
    pub(crate) fn begin_attempt(&mut self) {
        self.start = *self.done.get_mut();
    }

    /// The attempt failed.
    pub(crate) fn rewind(&mut self) {
        let done = self.done.get_mut();
        self.reported = self.reported.max(*done);
        *done = self.start;
    }
}

impl Monitor for RetryMonitor<'_> {
    fn begin(&self, stage: Stage, steps: u64) {
        self.monitor.begin(stage, steps);
    }

    fn advance(&self) {
        if self.done.fetch_add(1, Ordering::Relaxed) >= self.reported {
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
