//! What each tile gets in a pass: which technique pays most there.
//!
//! A technique costs time and leaves variance. By inverse variance two of them together are never worse than the better
//! alone, but time is best spent on the one with the smallest product of variance and time of a sample. All of them are
//! probed at a few pixels of every tile now and then, so that the choice can change.

use super::mixture::Mixture;
use super::pass::SampledTile;
use super::task::{Extent, Task};
use super::technique::Technique;

/// Probes before the first choice.
const FIRST_PROBES: u32 = 4;

/// Share of the time for later ones.
const PROBE_SHARE: f64 = 0.03;

/// Samples of every pixel in a pass at most.
const MOST_SAMPLES: u32 = 8;

/// Decides for a render.
pub(crate) struct Plan {
    techniques: Vec<Technique>,
    /// Of each tile and technique.
    spent: Vec<Vec<Spent>>,
    /// Passes that probe, so far, and seconds of their probes.
    probes: u32,
    probe_seconds: f64,
    /// Of all tasks.
    seconds: f64,
    /// Seconds that the VPLs of a pass take, for each pixel of the picture.
    vpl_seconds: f64,
}

/// What went into a technique at a tile.
#[derive(Default, Clone)]
struct Spent {
    seconds: f64,
    samples: u64,
}

impl Plan {
    pub(crate) fn new(techniques: Vec<Technique>, tiles: usize) -> Self {
        let spent = vec![vec![Spent::default(); techniques.len()]; tiles];
        Self { techniques, spent, probes: 0, probe_seconds: 0.0, seconds: 0.0, vpl_seconds: 0.0 }
    }

    pub(crate) fn techniques(&self) -> &[Technique] {
        &self.techniques
    }

    /// The tasks of a pass.
    pub(crate) fn tasks(&mut self, mixture: &Mixture, pass: u32) -> Vec<Task> {
        let tiles = 0..self.spent.len();
        if pass == 0 || self.techniques.len() == 1 {
            return tiles.map(|tile| Task { tile, technique: 0, extent: Extent::Whole(1) }).collect();
        }
        let mut tasks = Vec::new();
        // Until something is known, time is better spent on getting to know it.
        let is_asking = self.probes < FIRST_PROBES;
        if !is_asking {
            let choices: Vec<usize> = tiles.clone().map(|tile| self.choose(mixture, tile)).collect();
            tasks.extend(choices.iter().enumerate().map(|(tile, &technique)| {
                let extent = Extent::Whole(self.samples(&choices, technique));
                Task { tile, technique, extent }
            }));
        }
        // All tiles in one pass, for which VPLs are traced, and all techniques, the chosen one too: with more samples
        // it would show more of its rare bright ones, and seem worse.
        if is_asking || self.probe_seconds <= PROBE_SHARE * self.seconds {
            let extent = Extent::Probe(self.probes);
            let of_tile = |tile| (0..self.techniques.len()).map(move |technique| Task { tile, technique, extent });
            tasks.extend(tiles.flat_map(of_tile));
            self.probes += 1;
        }
        tasks
    }

    /// The technique with the smallest product of variance and time; the first as long as nothing is known.
    fn choose(&self, mixture: &Mixture, tile: usize) -> usize {
        let work = |technique: usize| {
            Some((technique, mixture.variance_in(technique, tile)? * self.seconds_in(tile, technique)?))
        };
        let best = (0..self.techniques.len()).filter_map(work).min_by(|(_, a), (_, b)| a.total_cmp(b));
        best.map_or(0, |(technique, _)| technique)
    }

    /// Samples of a technique in a pass. VPLs of a pass light a pixel once: a second time would show nothing new. For
    /// the same variance the error of all tiles together is least if each gets samples by the root of their time.
    fn samples(&self, choices: &[usize], technique: usize) -> u32 {
        if self.techniques[technique].uses_vpls() {
            return 1;
        }
        let mean = |is_counted: &dyn Fn(usize) -> bool| {
            let tiles = choices.iter().enumerate().filter(|&(_, &choice)| is_counted(choice));
            let seconds = tiles.filter_map(|(tile, &choice)| self.seconds_in(tile, choice));
            let (sum, count) = seconds.fold((0.0, 0.0), |(sum, count), seconds| (sum + seconds, count + 1.0));
            (count > 0.0).then(|| sum / count)
        };
        let with_vpls = mean(&|choice| self.techniques[choice].uses_vpls());
        let ratio = with_vpls.zip(mean(&|choice| choice == technique)).map_or(1.0, |(vpls, own)| vpls / own);
        (ratio.sqrt().round() as u32).clamp(1, MOST_SAMPLES)
    }

    /// Time of a technique's sample at a tile.
    fn seconds_in(&self, tile: usize, technique: usize) -> Option<f64> {
        let spent = &self.spent[tile][technique];
        let vpls = if self.techniques[technique].uses_vpls() { self.vpl_seconds } else { 0.0 };
        (spent.samples > 0 && spent.seconds > 0.0).then(|| spent.seconds / spent.samples as f64 + vpls)
    }

    /// Learns what a task took.
    pub(crate) fn learn(&mut self, sampled: &SampledTile) {
        let Task { tile, technique, extent } = sampled.task;
        let spent = &mut self.spent[tile][technique];
        spent.seconds += sampled.seconds;
        spent.samples += sampled.counts.primary;
        self.seconds += sampled.seconds;
        if let Extent::Probe(_) = extent {
            self.probe_seconds += sampled.seconds;
        }
    }

    /// Learns what the VPLs of a pass took, in seconds of one thread.
    pub(crate) fn learn_vpls(&mut self, seconds: f64, pixels: usize) {
        self.vpl_seconds = seconds / pixels as f64;
    }
}
