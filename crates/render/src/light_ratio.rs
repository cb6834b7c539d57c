//! The light ratio: how many of the VPLs are needed.

use crate::device::TileResult;

/// The mean share of the VPLs that lit a shaded hit.
pub(crate) struct LightRatio {
    vpls: usize,
    /// The original adds up float32 shares hit by hit, which loses some of the sum.
    original_sum: Option<f32>,
    selected: u64,
    hits: u64,
}

impl LightRatio {
    pub(crate) fn new(vpls: usize, original: bool) -> Self {
        Self { vpls, original_sum: original.then_some(0.0), selected: 0, hits: 0 }
    }

    pub(crate) fn add(&mut self, result: &TileResult) {
        let Some(sum) = &mut self.original_sum else {
            self.selected += result.seen.iter().map(|seen| seen.selected).sum::<u64>();
            self.hits += result.seen.iter().map(|seen| seen.shaded).sum::<u64>();
            return;
        };
        for &selected in &result.selections {
            *sum += selected as f32 / self.vpls as f32;
            self.selected += u64::from(selected);
        }
        self.hits += result.selections.len() as u64;
    }

    pub(crate) fn percent(&self) -> f64 {
        match self.original_sum {
            _ if self.hits == 0 || self.vpls == 0 => 0.0,
            Some(sum) => f64::from(sum / self.hits as f32) * 100.0,
            None => self.selected as f64 / (self.hits as f64 * self.vpls as f64) * 100.0,
        }
    }
}
