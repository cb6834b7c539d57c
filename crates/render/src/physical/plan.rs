//! What each tile gets in a pass: which technique pays most there, and how many samples.
//!
//! A technique costs time and leaves variance. By inverse variance two of them together are never worse than the better alone, but
//! time is best spent on the one with the smallest product of variance and time of a sample. The others are probed at a few
//! pixels, with a small share of the time, so that the choice can change.

use super::mixture::Mixture;
use super::pass::{Extent, SampledTile, Task};
use super::technique::Technique;

/// Probes after which techniques are known a little: two samples in each half.
const FIRST_PROBES: u32 = 4;

/// Share of a tile's time for later ones.
const PROBE_SHARE: f64 = 0.03;

/// A tile gets at least and at most so many times the mean number of samples.
const RATES: [f64; 2] = [0.5, 2.0];

/// What the variance of paths is taken to be more than few samples show: they miss rare bright ones, which VPLs leave out.
const RARE: f64 = 2.0;

/// Decides for a render.
pub(crate) struct Plan {
    techniques: Vec<Technique>,
    tiles: Vec<TilePlan>,
    /// Seconds that the VPLs of a pass take, for each pixel of the picture.
    vpl_seconds: f64,
}

/// What is known of a tile.
#[derive(Default)]
struct TilePlan {
    /// Of each technique.
    spent: Vec<Spent>,
    /// Samples that are due to each pixel, with their fraction.
    due: f64,
    /// How often it got samples, and probes.
    turns: u32,
    probes: u32,
    probe_seconds: f64,
    /// Of all tasks.
    seconds: f64,
}

/// What went into a technique at a tile.
#[derive(Default, Clone)]
struct Spent {
    seconds: f64,
    samples: u64,
}

/// A technique for a tile, and how many samples it deserves relative to others.
struct Choice {
    technique: usize,
    rate: Option<f64>,
}

impl Plan {
    pub(crate) fn new(techniques: Vec<Technique>, tiles: usize) -> Self {
        let of_tile = || TilePlan { spent: vec![Spent::default(); techniques.len()], ..TilePlan::default() };
        Self { tiles: (0..tiles).map(|_| of_tile()).collect(), techniques, vpl_seconds: 0.0 }
    }

    pub(crate) fn techniques(&self) -> &[Technique] {
        &self.techniques
    }

    /// The tasks of a pass.
    pub(crate) fn tasks(&mut self, mixture: &Mixture, pass: u32) -> Vec<Task> {
        if self.techniques.len() == 1 {
            let whole = |tile| Task { tile, technique: 0, half: 0, extent: Extent::Whole(1) };
            return (0..self.tiles.len()).map(whole).collect();
        }
        let halves: Vec<usize> = self.tiles.iter().map(|plan| mixture.half_of(plan.turns)).collect();
        let choices: Vec<Choice> =
            halves.iter().enumerate().map(|(tile, &half)| self.choose(mixture, half, tile)).collect();
        let rates = self.rates(&choices);
        let mut tasks = Vec::new();
        for (tile, (choice, rate)) in choices.iter().zip(rates).enumerate() {
            let plan = &mut self.tiles[tile];
            // Until something is known, time is better spent on getting to know it.
            let is_asking = pass > 0 && plan.probes < FIRST_PROBES;
            // The first choice is for every tile.
            plan.due += if is_asking {
                0.0
            } else if plan.turns == 1 {
                1.0
            } else {
                rate
            };
            let samples = plan.due as u32;
            plan.due -= f64::from(samples);
            if samples > 0 {
                plan.turns += 1;
                let extent = Extent::Whole(samples);
                tasks.push(Task { tile, technique: choice.technique, half: halves[tile], extent });
            }
            // Cuts need to know what a pixel's light is.
            if is_asking || (pass > 0 && plan.probe_seconds <= PROBE_SHARE * plan.seconds) {
                // All of them, the chosen one too: with more samples it would show more of its rare bright ones, and seem worse.
                let (half, extent) = (mixture.half_of(plan.probes), Extent::Probe(plan.probes / 2));
                tasks.extend((0..self.techniques.len()).map(|technique| Task { tile, technique, half, extent }));
                plan.probes += 1;
            }
        }
        tasks
    }

    /// The technique with the smallest product of variance and time; the first as long as nothing is known.
    fn choose(&self, mixture: &Mixture, half: usize, tile: usize) -> Choice {
        let known = |technique: usize| {
            let unseen = if self.techniques[technique].uses_vpls() { 1.0 } else { RARE };
            let variance = mixture.variance_for(technique, half, tile)? * unseen;
            let seconds = self.seconds(tile, technique)?;
            Some((technique, variance, seconds))
        };
        let best = (0..self.techniques.len())
            .filter_map(known)
            .min_by(|(_, v1, t1), (_, v2, t2)| (v1 * t1).total_cmp(&(v2 * t2)));
        // The error of all tiles together is least if each gets samples by the root of variance over time.
        best.map_or(Choice { technique: 0, rate: None }, |(technique, variance, seconds)| Choice {
            technique,
            rate: Some((variance / seconds).sqrt()),
        })
    }

    /// Time of a technique's sample at a tile.
    fn seconds(&self, tile: usize, technique: usize) -> Option<f64> {
        let spent = &self.tiles[tile].spent[technique];
        let vpls = if self.techniques[technique].uses_vpls() { self.vpl_seconds } else { 0.0 };
        (spent.samples > 0 && spent.seconds > 0.0).then(|| spent.seconds / spent.samples as f64 + vpls)
    }

    /// Samples for each pixel of the tiles. VPLs of a pass light a pixel at most once: a second time would show nothing new.
    fn rates(&self, choices: &[Choice]) -> Vec<f64> {
        let known: Vec<f64> = choices.iter().filter_map(|choice| choice.rate).collect();
        let mean = known.iter().sum::<f64>() / known.len().max(1) as f64;
        let rate = |choice: &Choice| match choice.rate {
            Some(rate) if mean > 0.0 => (rate / mean).clamp(RATES[0], RATES[1]),
            _ => 1.0,
        };
        let greatest =
            choices.iter().filter(|choice| self.techniques[choice.technique].uses_vpls()).map(rate).fold(1.0, f64::max);
        choices.iter().map(|choice| rate(choice) / greatest).collect()
    }

    /// Learns what a task took.
    pub(crate) fn learn(&mut self, sampled: &SampledTile) {
        let plan = &mut self.tiles[sampled.task.tile];
        let spent = &mut plan.spent[sampled.task.technique];
        spent.seconds += sampled.seconds;
        spent.samples += sampled.counts.primary;
        plan.seconds += sampled.seconds;
        if let Extent::Probe(_) = sampled.task.extent {
            plan.probe_seconds += sampled.seconds;
        }
    }

    /// Learns what the VPLs of a pass took, in seconds of one thread.
    pub(crate) fn learn_vpls(&mut self, seconds: f64, pixels: usize) {
        self.vpl_seconds = seconds / pixels as f64;
    }
}
