//! Squares that a shadow ray need not be tested against, because both of its ends lie on the same side of them.
//!
//! The thesis' scenes are rooms of squares: nothing in a room is behind its walls, and five tests per ray would find that out
//! again and again.

use super::tracer::Tracer;
use crate::light_node::{LANES, VplBlock};
use crate::light_tree::LightTree;
use glam::{DVec3, Vec3};
use lightcuts_kernel::intersect::Square;
use lightcuts_world::bvh::Geometry;
use rayon::prelude::*;

/// Most squares that are looked at.
pub(crate) const FEW: usize = 16;

/// Relative error of a difference, a product and the sum of three of them in single precision, with some to spare.
const ROUNDING: f64 = 5.0 * (f32::EPSILON / 2.0) as f64;

/// On which side of the first squares something lies, a bit each; in neither mask where that is not sure.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Sides {
    /// Where the normal points to.
    pub(crate) front: u32,
    pub(crate) back: u32,
}

impl Sides {
    /// Squares that have both on the same side.
    pub(crate) fn shared(self, other: Self) -> u32 {
        self.front & other.front | self.back & other.back
    }
}

/// On which sides of the squares the VPLs of every block lie.
#[derive(Debug, Clone, Default)]
pub(crate) struct Walls {
    blocks: Vec<Sides>,
    /// What points lie in for which that holds.
    pub(crate) lower: Vec3,
    pub(crate) upper: Vec3,
}

impl Walls {
    /// For points on the surfaces of a tracer's geometry.
    pub(crate) fn new(tracer: &Tracer<'_>, tree: &LightTree) -> Self {
        let geometry = &tracer.geometry;
        if geometry.squares.is_empty() || geometry.squares.len() > FEW {
            return Self { blocks: vec![Sides::default(); tree.blocks.len()], ..Self::default() };
        }
        let (lower, upper) = surroundings(geometry);
        let sides = |(number, block): (usize, &VplBlock)| {
            let lanes = tree.lanes(number as u32);
            let all = (1 << geometry.squares.len()) - 1;
            (0..LANES).filter(|lane| lanes >> lane & 1 == 1).fold(Sides { front: all, back: all }, |sides, lane| {
                let vpl = sides_of(geometry.squares, block.vpl(lane).position, (lower, upper));
                Sides { front: sides.front & vpl.front, back: sides.back & vpl.back }
            })
        };
        Self { blocks: tree.blocks.par_iter().enumerate().map(sides).collect(), lower, upper }
    }

    pub(crate) fn of_block(&self, block: u32) -> Sides {
        self.blocks[block as usize]
    }
}

/// A box around everything, with some room for how points on surfaces are rounded.
fn surroundings(geometry: &Geometry<'_>) -> (Vec3, Vec3) {
    let Some(root) = geometry.nodes.first() else { return (Vec3::ZERO, Vec3::ZERO) };
    let children = (0..LANES).map(|lane| root.child_box(lane)).filter(|(lower, upper)| lower.cmple(*upper).all());
    let (lower, upper) = children
        .fold((Vec3::INFINITY, Vec3::NEG_INFINITY), |(lower, upper), child| (lower.min(child.0), upper.max(child.1)));
    let room = Vec3::splat((upper - lower).max_element() * 1e-3);
    (lower - room, upper + room)
}

/// On which sides of the squares a VPL lies so far that no rounding lets `intersect_square` find a hit from a point in a box
/// towards it, provided that the point's height is not of the other sign.
///
/// With the heights p and v of point and VPL along the normal, seen from the square, a hit is at t = p / (p - v): at 1 or
/// beyond, or before 0, where v has the sign of p. It is computed from p and from the slope p - v; if |v| is more than their
/// errors together, what is rounded keeps that order.
fn sides_of(squares: &[Square], position: Vec3, (lower, upper): (Vec3, Vec3)) -> Sides {
    let mut sides = Sides::default();
    let position = position.as_dvec3();
    let farthest = |from: DVec3| (from - lower.as_dvec3()).abs().max((from - upper.as_dvec3()).abs());
    for (index, square) in squares.iter().enumerate() {
        let (center, normal) = (square.center.as_dvec3(), square.normal.as_dvec3());
        let error = ROUNDING * normal.abs().dot(farthest(center) + farthest(position)) + f64::from(f32::MIN_POSITIVE);
        let height = (position - center).dot(normal);
        sides.front |= u32::from(height > error) << index;
        sides.back |= u32::from(height < -error) << index;
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::Simd;
    use crate::light_tree::TreeLayout;
    use lightcuts_kernel::Rules;
    use lightcuts_kernel::intersect::intersect_square;
    use lightcuts_kernel::light::Vpl;
    use lightcuts_kernel::ray::{shadow_ray, spawn_epsilon};
    use lightcuts_kernel::rng::random4;

    /// A point on a square or close to it, on either side.
    fn near(square: &Square, k: u32) -> Vec3 {
        let [a, b, c, d] = random4(k, 0, 0, 3);
        let on = square.center + square.along * (a - 0.5) * 1.9 * square.half_height;
        let off = [0.0, 1e-3, 1e-5, -1e-5, 1e-6, 0.3, 40.0, -1e-3][(d * 8.0) as usize % 8];
        on + square.across * (b - 0.5) * 1.9 * square.half_width + square.normal * off * (0.5 + c)
    }

    #[test]
    fn no_ray_crosses_a_square_that_has_both_ends_on_one_side() {
        // A box of walls, and one that stands askew in it.
        let wall = |center: Vec3, normal: Vec3, along: Vec3| Square {
            center,
            half_height: 200.0,
            normal,
            half_width: 200.0,
            along,
            primitive: 0,
            across: along.cross(normal),
            padding: 0,
        };
        let askew = Vec3::new(0.3, -0.5, 0.7).normalize();
        let squares = [
            wall(Vec3::new(0.0, -200.0, 0.0), Vec3::Y, Vec3::Z),
            wall(Vec3::new(200.0, 0.0, 0.0), Vec3::NEG_X, Vec3::Y),
            wall(Vec3::new(0.0, 0.0, -200.0), Vec3::Z, Vec3::Y),
            wall(Vec3::new(3.0, 7.0, -11.0), askew, askew.any_orthonormal_vector()),
        ];
        let bounds = (Vec3::splat(-420.0), Vec3::splat(420.0));
        let (mut claimed, mut hits) = (0, 0);
        for k in 0..400_000 {
            let from = near(&squares[(k % 4) as usize], k);
            let to = near(&squares[(k / 4 % 4) as usize], k + 1_000_000);
            let ends = sides_of(&squares, to, bounds);
            for rules in [Rules::Original, Rules::Repaired] {
                let ray = shadow_ray(rules, from, to - from, spawn_epsilon(rules, from, 300.0));
                for (index, square) in squares.iter().enumerate() {
                    let height = (square.center - from).dot(square.normal);
                    let start = Sides { front: u32::from(height <= 0.0), back: u32::from(height >= 0.0) };
                    let ends = Sides { front: ends.front >> index & 1, back: ends.back >> index & 1 };
                    let hit = intersect_square(square, &ray).is_some();
                    assert!(!hit || start.shared(ends) == 0, "square {index} between {from} and {to}");
                    claimed += start.shared(ends);
                    hits += u32::from(hit);
                }
            }
        }
        println!("{claimed} of 3200000 need no test, {hits} are hit");
        assert!(claimed > 1_500_000 && hits > 100_000);
    }

    #[test]
    fn all_lights_of_a_block_count_and_none_that_is_not_there() {
        let vpl =
            |y: f32| Vpl { position: Vec3::new(0.0, y, 0.0), direction: Vec3::Y, diffuse: Vec3::ONE, ..Vpl::default() };
        let square = Square {
            center: Vec3::new(0.0, -1.0, 0.0),
            half_height: 1.0,
            normal: Vec3::NEG_Y,
            half_width: 1.0,
            along: Vec3::X,
            primitive: 0,
            across: Vec3::Z,
            padding: 0,
        };
        let geometry = Geometry { nodes: &[], triangles: &[], spheres: &[], squares: &[square] };
        let tracer = Tracer::new(geometry, Rules::Original, Simd::Off);
        let sides = |heights: &[f32]| {
            let vpls: Vec<Vpl> = heights.iter().map(|&y| vpl(y)).collect();
            Walls::new(&tracer, &LightTree::build(&vpls, TreeLayout::Wide)).of_block(0)
        };
        assert_eq!(sides(&[-2.0, -3.0]), Sides { front: 1, back: 0 });
        assert_eq!(sides(&[2.0, 3.0]), Sides { front: 0, back: 1 });
        assert_eq!(sides(&[2.0, -3.0]), Sides::default());
    }
}
