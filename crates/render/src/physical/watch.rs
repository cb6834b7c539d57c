//! How far a render is, and whether it has to stop: one clock for all that it does, whatever the stage.

use crate::monitor::{Monitor, Stage};
use crate::settings::Settings;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::{Duration, Instant};

/// Steps of a render whose end time or noise decides.
const THOUSANDTHS: u64 = 1000;

/// Time to make a picture of the samples, for each pixel: what is left of a limit of time for it, on two cores. Much of
/// it goes into memory that is touched for the first time.
const DEVELOPING: Duration = Duration::from_nanos(40);

/// Watches the time, the samples and the person at the other end.
pub(crate) struct Watch<'a> {
    monitor: &'a dyn Monitor,
    started: Instant,
    /// Time for samples.
    limit: Option<Duration>,
    /// Samples of tiles that are wanted; `None` where only time, noise or a person ends the render.
    wanted: Option<u64>,
    /// Those that were taken.
    taken: AtomicU64,
    /// Those with which noise will be as low as is wanted; 0 as long as nobody knows.
    expected: AtomicU64,
    /// Steps that the monitor knows of, and all.
    told: AtomicU64,
    total: u64,
    /// Whether steps are samples of tiles; else they are thousandths of the render.
    is_of_samples: bool,
}

impl<'a> Watch<'a> {
    /// Of a picture of so many tiles. Time runs from here.
    pub(crate) fn new(monitor: &'a dyn Monitor, settings: &Settings, tiles: usize) -> Self {
        let seconds = settings.physical.time_limit;
        let image = settings.image;
        let limit = (seconds > 0.0).then(|| {
            let all = Duration::try_from_secs_f32(seconds).unwrap_or(Duration::MAX);
            let pixels = f64::from(image.width) * f64::from(image.height);
            all.saturating_sub(DEVELOPING.mul_f64(pixels).min(all / 2))
        });
        let samples = settings.sampling.samples;
        let wanted = (samples > 0).then(|| u64::from(samples) * tiles as u64);
        let is_of_samples = wanted.is_some() && limit.is_none() && settings.physical.noise <= 0.0;
        let total = wanted.filter(|_| is_of_samples).unwrap_or(THOUSANDTHS);
        let (taken, expected, told) = Default::default();
        Self { monitor, started: Instant::now(), limit, wanted, taken, expected, told, total, is_of_samples }
    }

    pub(crate) fn begin(&self) {
        self.monitor.begin(Stage::Samples, self.total);
    }

    /// The samples are taken; unless somebody broke them off, nothing is left to do.
    pub(crate) fn end(&self) {
        if !self.is_cancelled() {
            self.tell(self.total);
        }
        self.monitor.end();
    }

    pub(crate) fn is_cancelled(&self) -> bool {
        self.monitor.cancelled()
    }

    /// Whether no more samples may be taken. Asked often, between a few pixels; tells the monitor of the time on the
    /// way.
    pub(crate) fn is_over(&self) -> bool {
        if self.monitor.cancelled() {
            return true;
        }
        let Some(limit) = self.limit else { return false };
        self.advance();
        self.started.elapsed() >= limit
    }

    /// Time that is left for samples, where it has an end.
    pub(crate) fn left(&self) -> Option<Duration> {
        Some(self.limit?.saturating_sub(self.started.elapsed()))
    }

    /// A tile got so many samples of every pixel.
    pub(crate) fn take(&self, samples: u32) {
        self.taken.fetch_add(u64::from(samples), Relaxed);
        self.advance();
    }

    /// Whether there are as many samples as are wanted.
    pub(crate) fn has_all(&self) -> bool {
        self.wanted.is_some_and(|wanted| self.taken.load(Relaxed) >= wanted)
    }

    /// The noise is what it is: its square falls as samples grow.
    pub(crate) fn expect(&self, noise: f64, wanted: f64) {
        let times = (noise / wanted).powi(2);
        if times.is_finite() {
            self.expected.store((self.taken.load(Relaxed) as f64 * times.max(1.0)) as u64, Relaxed);
        }
    }

    /// Tells the monitor of the steps that are done.
    fn advance(&self) {
        let taken = self.taken.load(Relaxed);
        if self.is_of_samples {
            self.tell(taken.min(self.total));
            return;
        }
        let of_samples = self.wanted.map_or(0.0, |wanted| taken as f64 / wanted as f64);
        let of_noise = match self.expected.load(Relaxed) {
            0 => 0.0,
            expected => taken as f64 / expected as f64,
        };
        let of_time = self.limit.map_or(0.0, |limit| self.started.elapsed().as_secs_f64() / limit.as_secs_f64());
        let done = of_samples.max(of_noise).max(of_time).min(1.0);
        self.tell((done * self.total as f64) as u64);
    }

    fn tell(&self, due: u64) {
        if self.told.load(Relaxed) >= due {
            return;
        }
        let before = self.told.fetch_max(due, Relaxed);
        for _ in before..due {
            self.monitor.advance();
        }
    }
}
