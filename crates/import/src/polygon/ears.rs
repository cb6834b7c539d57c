//! Ears of a polygon: triangles of three corners in a row that nothing of the outline enters.

use super::turn;
use glam::DVec2;
use std::collections::{HashMap, VecDeque};

/// Cuts off ear after ear and adds them to `triangles`, n - 2 of them. False if it finds none before that, or if `work`,
/// from which each comparison is taken, comes to its end. Triangles whose doubled area is within `slack` may be turned over.
pub(super) fn cut_off(points: &[DVec2], slack: f64, work: &mut u64, triangles: &mut Vec<[u32; 3]>) -> bool {
    Outline::new(points, slack).cut_off(work, triangles)
}

/// What may be an ear, the strictest first: later ones are tried where there is none of the earlier.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Kind {
    /// Nothing touches it.
    Clear,
    /// Corners may lie on its edges.
    Touched,
    /// It has no area worth the name.
    Flat,
}

struct Outline<'p> {
    points: &'p [DVec2],
    /// Twice the area that is none.
    slack: f64,
    before: Vec<u32>,
    after: Vec<u32>,
    is_cut: Vec<bool>,
    /// Corners that may lie in an ear, by x: those that do not stand out, and those where the outline comes by twice.
    watched: Vec<u32>,
    is_double: Vec<bool>,
    left: usize,
    /// Corners that were left when `watched` was cleared last.
    left_when_cleared: usize,
}

impl<'p> Outline<'p> {
    fn new(points: &'p [DVec2], slack: f64) -> Self {
        let count = points.len() as u32;
        let mut outline = Self {
            points,
            slack,
            before: (0..count).map(|i| (i + count - 1) % count).collect(),
            after: (0..count).map(|i| (i + 1) % count).collect(),
            is_cut: vec![false; points.len()],
            watched: Vec::new(),
            is_double: doubles(points),
            left: points.len(),
            left_when_cleared: points.len(),
        };
        outline.watched = (0..count).filter(|&i| outline.is_watched(i)).collect();
        outline.watched.sort_by(|a, b| points[*a as usize].x.total_cmp(&points[*b as usize].x));
        outline
    }

    fn point(&self, i: u32) -> DVec2 {
        self.points[i as usize]
    }

    /// A corner and its neighbours, in order.
    fn around(&self, i: u32) -> [u32; 3] {
        [self.before[i as usize], i, self.after[i as usize]]
    }

    fn is_watched(&self, i: u32) -> bool {
        let [a, b, c] = self.around(i).map(|i| self.point(i));
        !self.is_cut[i as usize] && (self.is_double[i as usize] || turn(a, b, c) <= 0.0)
    }

    fn cut_off(mut self, work: &mut u64, triangles: &mut Vec<[u32; 3]>) -> bool {
        let mut kind = Kind::Clear;
        // First come, first cut off: what is left stays as round as it can.
        let all = 0..self.points.len() as u32;
        let (spikes, others): (Vec<u32>, Vec<u32>) = all.partition(|&i| self.is_spike(self.around(i)));
        let mut waiting: VecDeque<u32> = spikes.into_iter().chain(others).collect();
        let (mut some_corner, mut has_cut) = (0, false);
        while self.left > 3 {
            let Some(corner) = waiting.pop_front() else {
                // What was in the way of others may be gone.
                kind = match kind {
                    _ if has_cut => Kind::Clear,
                    Kind::Clear => Kind::Touched,
                    Kind::Touched => Kind::Flat,
                    Kind::Flat => return false,
                };
                has_cut = false;
                waiting.extend(std::iter::successors(Some(some_corner), |&i| {
                    Some(self.after[i as usize]).filter(|&next| next != some_corner)
                }));
                continue;
            };
            let Some(left) = work.checked_sub(1) else { return false };
            *work = left;
            let ear = self.around(corner);
            if !self.is_cut[corner as usize] && self.is_ear(ear, kind, work) {
                triangles.push(ear);
                self.cut(ear);
                for neighbour in [ear[0], ear[2]] {
                    if self.is_spike(self.around(neighbour)) {
                        waiting.push_front(neighbour);
                    } else {
                        waiting.push_back(neighbour);
                    }
                }
                (some_corner, has_cut) = (ear[0], true);
            }
        }
        let last = self.around(some_corner);
        triangles.push(last);
        let [a, b, c] = last.map(|i| self.point(i));
        turn(a, b, c) >= -self.slack
    }

    fn cut(&mut self, [before, ear, after]: [u32; 3]) {
        self.after[before as usize] = after;
        self.before[after as usize] = before;
        self.is_cut[ear as usize] = true;
        self.left -= 1;
        if self.left * 2 < self.left_when_cleared {
            self.left_when_cleared = self.left;
            let watched = std::mem::take(&mut self.watched);
            self.watched = watched.into_iter().filter(|&i| self.is_watched(i)).collect();
        }
    }

    /// Whether two of three corners in a row are one point: what is left of a part of the outline that has been cut off. It goes
    /// before anything else, for an ear beside it might reach across where the outline touches itself.
    fn is_spike(&self, ear: [u32; 3]) -> bool {
        let [a, b, c] = ear.map(|i| self.point(i));
        a == b || b == c || c == a
    }

    fn is_ear(&self, ear: [u32; 3], kind: Kind, work: &mut u64) -> bool {
        if self.is_spike(ear) {
            return true;
        }
        let corners = ear.map(|i| self.point(i));
        let [a, b, c] = corners;
        let area = turn(a, b, c);
        if kind == Kind::Flat && area.abs() <= self.slack {
            return true;
        }
        if area <= 0.0 || self.leaves_inwards(ear[0], corners, 0) || self.leaves_inwards(ear[2], corners, 2) {
            return false;
        }
        let (low, high) = (a.x.min(b.x).min(c.x), a.x.max(b.x).max(c.x));
        let start = self.watched.partition_point(|&i| self.point(i).x < low);
        let within = self.watched[start..].iter().take_while(|&&i| self.point(i).x <= high);
        for &i in within {
            *work = work.saturating_sub(1);
            if !ear.contains(&i) && self.is_watched(i) && self.enters(i, corners, kind) {
                return false;
            }
        }
        true
    }

    /// Whether the corner lies in the triangle, or where a corner of the triangle lies and the outline goes on inwards.
    fn enters(&self, i: u32, corners: [DVec2; 3], kind: Kind) -> bool {
        let point = self.point(i);
        if let Some(same) = corners.iter().position(|corner| *corner == point) {
            return self.leaves_inwards(i, corners, same);
        }
        let [a, b, c] = corners;
        let sides = [turn(a, b, point), turn(b, c, point), turn(c, a, point)];
        if kind == Kind::Clear { sides.iter().all(|side| *side >= 0.0) } else { sides.iter().all(|side| *side > 0.0) }
    }

    /// Whether an edge goes from outline corner `i`, which lies at the triangle's corner `k`, into the triangle.
    fn leaves_inwards(&self, i: u32, corners: [DVec2; 3], k: usize) -> bool {
        let (corner, next, previous) = (corners[k], corners[(k + 1) % 3], corners[(k + 2) % 3]);
        let [before, _, after] = self.around(i).map(|i| self.point(i));
        [before, after].iter().any(|end| turn(corner, next, *end) > 0.0 && turn(corner, *end, previous) > 0.0)
    }
}

/// Which points occur more than once.
fn doubles(points: &[DVec2]) -> Vec<bool> {
    // 0 and -0 are the same place.
    let key = |point: &DVec2| (point + DVec2::ZERO).to_array().map(f64::to_bits);
    let mut counts: HashMap<[u64; 2], u32> = HashMap::new();
    for point in points {
        *counts.entry(key(point)).or_default() += 1;
    }
    points.iter().map(|point| counts[&key(point)] > 1).collect()
}
