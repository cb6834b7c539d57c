//! Whether a polygon's outline crosses itself.

use super::turn;
use glam::DVec2;

/// Whether two edges cross at a point that is no corner. Edges are swept from left to right; each comparison is taken from
/// `work`, and when there is none left the answer is yes.
pub(super) fn crosses_itself(points: &[DVec2], work: &mut u64) -> bool {
    let edge = |i: u32| (points[i as usize], points[(i as usize + 1) % points.len()]);
    let left = |i: u32| edge(i).0.x.min(edge(i).1.x);
    let mut order: Vec<u32> = (0..points.len() as u32).collect();
    order.sort_by(|a, b| left(*a).total_cmp(&left(*b)));
    for (i, first) in order.iter().enumerate() {
        let (a, b) = edge(*first);
        let right = a.x.max(b.x);
        for second in order[i + 1..].iter().take_while(|second| left(**second) < right) {
            let (c, d) = edge(*second);
            if *work == 0 || cross(a, b, c, d) {
                return true;
            }
            *work -= 1;
        }
    }
    false
}

/// Whether each of two edges has the ends of the other on both of its sides. Those that touch do not cross.
fn cross(a: DVec2, b: DVec2, c: DVec2, d: DVec2) -> bool {
    let apart = |x: f64, y: f64| (x > 0.0 && y < 0.0) || (x < 0.0 && y > 0.0);
    apart(turn(a, b, c), turn(a, b, d)) && apart(turn(c, d, a), turn(c, d, b))
}
