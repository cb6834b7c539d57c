//! Where a pixel's samples lie.

use lightcuts_kernel::rng::{hash4, random4, unit_float};
use lightcuts_scene::SamplerKind;

/// Number of best-candidate patterns; pixels share them, each shifted by its own amount.
const PATTERNS: u32 = 32;

/// Candidates per point already placed (Mitchell 1991, "Spectrally Optimal Sampling for Distribution Ray Tracing").
const CANDIDATES_PER_POINT: usize = 4;

/// Points of one batch of samples: all pixels first get the base batch, some later the adaptive one.
#[derive(Debug, Clone)]
pub struct Sampler {
    kind: SamplerKind,
    stream: u32,
    /// Index of the batch's first sample; distinguishes batches.
    first: u32,
    count: u32,
    /// Best-candidate patterns, `count` points each.
    patterns: Vec<[f32; 2]>,
}

impl Sampler {
    /// A sampler for `count` samples of every pixel, numbered from `first`.
    pub fn new(kind: SamplerKind, stream: u32, first: u32, count: u32) -> Self {
        let patterns =
            if kind == SamplerKind::BestCandidate { best_candidates(stream, first, count) } else { Vec::new() };
        Self { kind, stream, first, count, patterns }
    }

    /// Number of samples of every pixel.
    pub fn count(&self) -> u32 {
        self.count
    }

    /// Fills `shifts` with the samples of a pixel, as shifts from its centre in pixels, -0.5..0.5.
    pub fn fill(&self, pixel: u32, shifts: &mut Vec<[f32; 2]>) {
        shifts.clear();
        match self.kind {
            SamplerKind::Stratified => self.fill_stratified(pixel, shifts),
            SamplerKind::LowDiscrepancy => {
                let seed = hash4([pixel, self.stream, 0, 0])[0];
                let point = |s: u32| [sobol_burley::sample(s, 0, seed), sobol_burley::sample(s, 1, seed)];
                shifts.extend((self.first..self.first + self.count).map(point));
            }
            SamplerKind::BestCandidate => {
                let [pattern, x, y, _] = hash4([pixel, self.first, 0, self.stream]);
                let start = ((pattern % PATTERNS) * self.count) as usize;
                let shift = [unit_float(x), unit_float(y)];
                let points = &self.patterns[start..start + self.count as usize];
                shifts.extend(points.iter().map(|p| [(p[0] + shift[0]).fract(), (p[1] + shift[1]).fract()]));
            }
        }
        for shift in shifts {
            *shift = shift.map(|c| c - 0.5);
        }
    }

    /// One random point per cell of the squarest grid that has as many cells as there are samples.
    fn fill_stratified(&self, pixel: u32, shifts: &mut Vec<[f32; 2]>) {
        let columns =
            (1..=self.count).filter(|c| c * c <= self.count && self.count.is_multiple_of(*c)).max().unwrap_or(1);
        let rows = self.count / columns;
        for s in 0..self.count {
            let [x, y, ..] = random4(pixel, self.first + s, 0, self.stream);
            let cell =
                |index: u32, cells: u32, inside: f32| ((index as f32 + inside) / cells as f32).min(1.0 - f32::EPSILON);
            shifts.push([cell(s / rows, columns, x), cell(s % rows, rows, y)]);
        }
    }
}

/// Patterns of points on the unit torus, each point the farthest from its predecessors among random candidates.
fn best_candidates(stream: u32, first: u32, count: u32) -> Vec<[f32; 2]> {
    let mut patterns = Vec::with_capacity((PATTERNS * count) as usize);
    for pattern in 0..PATTERNS {
        let start = patterns.len();
        for point in 0..count {
            let placed = &patterns[start..];
            let candidate = |c: usize| {
                let [x, y, ..] = random4(pattern, first + point, c as u32 + 1, stream);
                [x, y]
            };
            let nearest = |p: [f32; 2]| placed.iter().map(|&q| torus_dist_sq(p, q)).fold(f32::INFINITY, f32::min);
            let tries = (placed.len() * CANDIDATES_PER_POINT).clamp(1, 64);
            let best = (0..tries).map(candidate).max_by(|&p, &q| nearest(p).total_cmp(&nearest(q)));
            patterns.push(best.expect("at least one candidate"));
        }
    }
    patterns
}

fn torus_dist_sq(p: [f32; 2], q: [f32; 2]) -> f32 {
    let along = |axis: usize| {
        let d = (p[axis] - q[axis]).abs();
        d.min(1.0 - d)
    };
    along(0) * along(0) + along(1) * along(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ALL: [SamplerKind; 3] = [SamplerKind::Stratified, SamplerKind::LowDiscrepancy, SamplerKind::BestCandidate];

    fn points(kind: SamplerKind, pixel: u32, count: u32) -> Vec<[f32; 2]> {
        let mut shifts = Vec::new();
        Sampler::new(kind, 11, 0, count).fill(pixel, &mut shifts);
        shifts
    }

    #[test]
    fn samples_stay_in_their_pixel_and_average_to_its_centre() {
        for kind in ALL {
            let mut mean = [0.0_f64; 2];
            for pixel in 0..2000 {
                for p in points(kind, pixel, 4) {
                    assert!(p.iter().all(|c| (-0.5..0.5).contains(c)), "{kind:?} {p:?}");
                    mean = [mean[0] + f64::from(p[0]), mean[1] + f64::from(p[1])];
                }
            }
            // 8,000 samples: standard deviation of the mean at most 0.29 / sqrt(8000) = 0.0032.
            assert!(mean.iter().all(|m| (m / 8000.0).abs() < 0.015), "{kind:?} {mean:?}");
        }
    }

    #[test]
    fn every_cell_of_the_grid_has_one_sample() {
        for kind in [SamplerKind::Stratified, SamplerKind::LowDiscrepancy] {
            let mut cells: Vec<i32> = points(kind, 5, 16)
                .iter()
                .map(|p| ((p[0] + 0.5) * 4.0) as i32 * 4 + ((p[1] + 0.5) * 4.0) as i32)
                .collect();
            cells.sort_unstable();
            assert_eq!(cells, (0..16).collect::<Vec<_>>(), "{kind:?}");
        }
    }

    #[test]
    fn best_candidates_keep_their_distance() {
        let least = |points: &[[f32; 2]]| {
            let mut least = f32::INFINITY;
            for (i, &p) in points.iter().enumerate() {
                for &q in &points[i + 1..] {
                    least = least.min(torus_dist_sq(p, q).sqrt());
                }
            }
            least
        };
        let blue: f32 = (0..50).map(|pixel| least(&points(SamplerKind::BestCandidate, pixel, 16))).sum();
        let random: f32 = (0..50)
            .map(|pixel| {
                let white: Vec<[f32; 2]> = (0..16).map(|s| random4(pixel, s, 9, 9)).map(|[x, y, ..]| [x, y]).collect();
                least(&white)
            })
            .sum();
        assert!(blue > 2.0 * random, "{blue} {random}");
    }
}
