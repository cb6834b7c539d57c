//! What a shadow ray need not be tested against: squares that have both of its ends on one side, and the mesh where both lie
//! beyond one face of its box.
//!
//! The thesis' scenes are rooms of squares around a mesh: nothing in a room is behind its walls, and five tests per ray would
//! find that out again and again.

use super::tracer::{Tracer, root_box};
use crate::light_node::{LANES, VplBlock};
use crate::light_tree::LightTree;
use glam::{DVec3, Vec3};
use lightcuts_world::bvh::Geometry;
use rayon::prelude::*;

/// Most squares that are looked at.
pub(crate) const FEW: usize = 16;

/// Relative error of a difference, a product and the sum of three of them in single precision, with some to spare.
const ROUNDING: f64 = 5.0 * (f32::EPSILON / 2.0) as f64;

/// On which side of some planes something lies, a bit each; in neither mask where that is not sure.
///
/// The planes are those of the first squares and, from [`FEW`] on, the faces of the mesh's box with normals outwards: the lower one
/// of each axis, then the upper ones.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Sides {
    /// Where the normal points to.
    pub(crate) front: u32,
    pub(crate) back: u32,
}

impl Sides {
    /// Planes that have both on the same side.
    fn shared(self, other: Self) -> u32 {
        self.front & other.front | self.back & other.back
    }

    /// Of so many squares those that a ray between both may cross.
    pub(crate) fn crossed(self, other: Self, squares: usize) -> u32 {
        ((1 << squares) - 1) & !self.shared(other)
    }

    /// Whether a ray between both may meet the mesh.
    pub(crate) fn may_meet_mesh(self, other: Self) -> bool {
        (self.front & other.front) >> FEW == 0
    }
}

/// On which sides the VPLs of every block lie.
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
        let (lower, upper) = surroundings(&tracer.geometry);
        let planes = planes(tracer);
        let sides = |(number, block): (usize, &VplBlock)| {
            let lanes = tree.lanes(number as u32);
            let all = Sides { front: u32::MAX, back: u32::MAX };
            (0..LANES).filter(|lane| lanes >> lane & 1 == 1).fold(all, |sides, lane| {
                let vpl = sides_of(&planes, block.vpl(lane).position, (lower, upper));
                Sides { front: sides.front & vpl.front, back: sides.back & vpl.back }
            })
        };
        Self { blocks: tree.blocks.par_iter().enumerate().map(sides).collect(), lower, upper }
    }

    pub(crate) fn of_block(&self, block: u32) -> Sides {
        self.blocks[block as usize]
    }
}

/// A plane: its bit, a point, and its normal.
type Plane = (u32, Vec3, Vec3);

/// The planes of all squares, if they are few, and of the mesh's faces, if there is one.
fn planes(tracer: &Tracer<'_>) -> Vec<Plane> {
    let Tracer { geometry, mesh: (lower, upper), .. } = tracer;
    let squares = if geometry.squares.len() > FEW { &[] } else { geometry.squares };
    let squares = squares.iter().zip(0..).map(|(square, bit)| (bit, square.center, square.normal));
    let faces = [(*lower, Vec3::NEG_ONE), (*upper, Vec3::ONE)].into_iter().zip(0..).flat_map(|((corner, sign), k)| {
        [0, 1, 2].map(|axis| (FEW as u32 + 3 * k + axis, corner, Vec3::AXES[axis as usize] * sign))
    });
    squares.chain(faces.filter(|_| !geometry.triangles.is_empty())).collect()
}

/// A box around everything, with some room for how points on surfaces are rounded.
fn surroundings(geometry: &Geometry<'_>) -> (Vec3, Vec3) {
    let (lower, upper) = root_box(geometry, |_| 0);
    let room = Vec3::splat((upper - lower).max_element() * 1e-3);
    (lower - room, upper + room)
}

/// On which sides of planes a VPL lies so far that no rounding lets a ray from a point in a box towards it cross them, provided
/// that the point's height above the plane is not of the other sign.
///
/// With the heights p and v of point and VPL along the normal, seen from the plane, it is crossed at t = p / (p - v): at 1 or
/// beyond, or before 0, where v has the sign of p. `intersect_square` computes that from p and from the slope p - v; if |v| is
/// more than their errors together, what is rounded keeps that order. A box's face is met at a t that is rounded no worse.
fn sides_of(planes: &[Plane], position: Vec3, (lower, upper): (Vec3, Vec3)) -> Sides {
    let mut sides = Sides::default();
    let position = position.as_dvec3();
    let farthest = |from: DVec3| (from - lower.as_dvec3()).abs().max((from - upper.as_dvec3()).abs());
    for &(bit, point, normal) in planes {
        let (point, normal) = (point.as_dvec3(), normal.as_dvec3());
        let error = ROUNDING * normal.abs().dot(farthest(point) + farthest(position)) + f64::from(f32::MIN_POSITIVE);
        let height = (position - point).dot(normal);
        sides.front |= u32::from(height > error) << bit;
        sides.back |= u32::from(height < -error) << bit;
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::Simd;
    use crate::light_tree::TreeLayout;
    use lightcuts_kernel::Rules;
    use lightcuts_kernel::intersect::{Square, intersect_square};
    use lightcuts_kernel::light::Vpl;
    use lightcuts_kernel::ray::{shadow_ray, spawn_epsilon};
    use lightcuts_kernel::rng::random4;
    use lightcuts_world::bvh::{BvhNode, ChildRef};

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
        let planes: Vec<Plane> =
            squares.iter().zip(0..).map(|(square, bit)| (bit, square.center, square.normal)).collect();
        let bounds = (Vec3::splat(-420.0), Vec3::splat(420.0));
        let (mut claimed, mut hits) = (0, 0);
        for k in 0..400_000 {
            let from = near(&squares[(k % 4) as usize], k);
            let to = near(&squares[(k / 4 % 4) as usize], k + 1_000_000);
            let ends = sides_of(&planes, to, bounds);
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
        let mut root = BvhNode::EMPTY;
        root.set_child(0, (Vec3::splat(-4.0), Vec3::splat(4.0)), ChildRef::Square(0));
        let geometry = Geometry { nodes: &[root], triangles: &[], spheres: &[], squares: &[square] };
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
