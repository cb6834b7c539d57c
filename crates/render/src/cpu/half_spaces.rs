//! What a shadow ray need not be tested against: squares that have both of its ends on one side, the mesh and spheres
//! where both lie beyond one face of their boxes, and VPLs that look the same way as the surface does.
//!
//! The thesis' scenes are rooms of squares around a mesh or spheres: nothing in a room is behind its walls, and a
//! test per ray and wall would find that out again and again.

use super::enclosure::Enclosure;
use super::tracer::Tracer;
use crate::light_node::{LANES, VplBlock};
use crate::light_tree::LightTree;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::{NONE, ORIGINAL_EPSILON};
use lightcuts_world::bvh::Geometry;
use rayon::prelude::*;

/// Maximum number of squares that are considered.
pub(crate) const FEW: usize = 16;

/// A VPL is far from a plane that is this part of the enclosure's diagonal away.
const FAR: f32 = 64.0;

/// Faces of a box: the lower one of each axis, then the upper ones; normals outwards.
const FACES: usize = 6;

/// So many spheres' boxes have bits for their faces, and the mesh's.
const BOXED: usize = (u64::BITS as usize - FEW) / FACES - 1;

/// Relative error of a difference, a product and the sum of three of them in single precision, with some to spare.
const ROUNDING: f64 = 5.0 * (f32::EPSILON / 2.0) as f64;

/// On which side of some planes something lies, a bit each; in neither mask where that is not sure.
///
/// The planes are those of the first squares and, from [`FEW`] on, the faces of boxes: the mesh's, then those of the
/// first spheres.
#[derive(Debug, Clone, Copy, Default, PartialEq, Eq)]
pub(crate) struct Sides {
    /// Where the normal points to.
    pub(crate) front: u64,
    pub(crate) back: u64,
    /// Far enough from the plane for [`HalfSpaces::plane_tolerance`].
    far: u64,
}

/// Planes that some rays do not cross where hits count, a bit each: most have both ends of the rays on the same side.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct Shared(u64);

/// Where shadow rays begin.
#[derive(Debug, Clone, Copy)]
pub(crate) struct RayStart {
    pub(crate) sides: Sides,
    /// Planes that all origins are within the [plane tolerance](HalfSpaces::plane_tolerance) of, a bit each.
    pub(crate) on: u64,
}

impl RayStart {
    /// On no side for certain.
    pub(crate) const NOWHERE: Self = Self { sides: Sides { front: 0, back: 0, far: 0 }, on: 0 };

    /// Of shadow rays to places on some sides.
    pub(crate) fn shared(self, ends: Sides) -> Shared {
        let Self { sides: Sides { front, back, .. }, on } = self;
        Shared(front & ends.front | back & ends.back | on & ends.far)
    }
}

impl Sides {
    /// What holds for what lies on these sides and for what lies on others.
    fn both(self, other: Self) -> Self {
        Self { front: self.front & other.front, back: self.back & other.back, far: self.far & other.far }
    }

    /// Takes that a point is beyond some faces of a box, a bit each.
    pub(crate) fn add_faces(&mut self, number: usize, beyond: u32) {
        self.front |= u64::from(beyond) << first_face(number);
    }
}

impl Shared {
    /// Of so many squares those that a ray may cross.
    pub(crate) fn crossed(self, squares: usize) -> u32 {
        (((1 << squares) - 1) & !self.0) as u32
    }

    /// Whether a ray may meet the mesh.
    pub(crate) fn may_meet_mesh(self) -> bool {
        self.may_meet(0)
    }

    /// Whether a ray may meet a sphere.
    pub(crate) fn may_meet_sphere(self, index: usize) -> bool {
        index >= BOXED || self.may_meet(index + 1)
    }

    fn may_meet(self, number: usize) -> bool {
        self.0 >> first_face(number) & ((1 << FACES) - 1) == 0
    }
}

/// The bit of a box's first face.
fn first_face(number: usize) -> usize {
    FEW + FACES * number
}

/// What the VPLs of a block have in common.
#[derive(Debug, Clone, Copy)]
struct Placing {
    sides: Sides,
    /// The number of their direction, if it is the same for all, else [`NONE`].
    direction: u32,
    /// Whether all are in the enclosure.
    is_inside: bool,
}

/// The number of a normal among the directions of blocks.
#[derive(Debug, Clone, Copy)]
pub(crate) struct FacingId(u32);

/// On which sides of planes the VPLs of every block lie.
#[derive(Debug, Clone, Default)]
pub(crate) struct HalfSpaces {
    blocks: Vec<Placing>,
    /// The box of the points for which that holds.
    pub(crate) enclosure: Enclosure,
    /// The boxes whose faces have bits.
    pub(crate) boxes: Vec<(Vec3, Vec3)>,
    /// The [clearance](Enclosure::clearance) of each of the first spheres.
    pub(crate) clearances: Vec<f64>,
    /// Directions of whole blocks: those that are met first.
    directions: Vec<Vec3>,
}

impl HalfSpaces {
    /// For points on the surfaces of a tracer's geometry.
    pub(crate) fn new(tracer: &Tracer<'_>, tree: &LightTree) -> Self {
        let Tracer { geometry, mesh, .. } = tracer;
        let enclosure = Enclosure::around(geometry);
        let spheres = geometry.spheres.iter().take(BOXED).map(|sphere| enclosure.sphere_box(sphere));
        let boxes: Vec<_> = std::iter::once(*mesh).chain(spheres).collect();
        let planes = planes(geometry, &boxes);
        let common = |(number, block): (usize, &VplBlock)| {
            let lanes = tree.lanes(number as u32);
            let vpls = || (0..LANES).filter(move |lane| lanes >> lane & 1 == 1).map(|lane| block.vpl(lane));
            let all = Sides { front: u64::MAX, back: u64::MAX, far: u64::MAX };
            let sides = vpls().map(|vpl| sides_of(&planes, vpl.position, &enclosure)).fold(all, Sides::both);
            let direction = block.vpl(0).direction;
            let is_inside = vpls().all(|vpl| enclosure.contains(vpl.position));
            (sides, vpls().all(|vpl| vpl.direction == direction).then_some(direction), is_inside)
        };
        let common: Vec<_> = tree.blocks.par_iter().enumerate().map(common).collect();
        let mut directions = Vec::new();
        let mut placing = |(sides, direction, is_inside): (Sides, Option<Vec3>, bool)| {
            let number = direction.and_then(|direction| number_among(&mut directions, direction));
            Placing { sides, direction: number.unwrap_or(NONE), is_inside }
        };
        let blocks = common.into_iter().map(&mut placing).collect();
        let clearances = geometry.spheres.iter().take(FEW).map(|sphere| enclosure.clearance(sphere)).collect();
        Self { blocks, enclosure, boxes, clearances, directions }
    }

    /// The sides that all VPLs of a block are on.
    pub(crate) fn sides(&self, block: u32) -> Sides {
        self.blocks[block as usize].sides
    }

    /// How near to a square's plane a shadow ray may begin, on either side, to cross it before hits count, if it ends
    /// in the enclosure far from the plane. `epsilon` is `spawn_epsilon` at its origin.
    ///
    /// A surface is rarely in its own plane to the last bit, and no light would be on its side for certain. With the
    /// height p where the ray begins, the plane is crossed at |t| < |p| / (v - |p|), v being a [`FAR`]th of the
    /// diagonal or more; with all errors, less than 2 % above |p| / v. Hits count from 0.001 or from epsilon by the
    /// ray's length, which is no more than the diagonal.
    pub(crate) fn plane_tolerance(&self, rules: Rules, epsilon: f32) -> f32 {
        let t_min = match rules {
            Rules::Original => ORIGINAL_EPSILON,
            Rules::Repaired => (epsilon / self.enclosure.diagonal()).min(0.01),
        };
        0.9 * t_min * self.enclosure.diagonal() / FAR
    }

    /// Whether all VPLs of a block are in the enclosure.
    pub(crate) fn has_inside(&self, block: u32) -> bool {
        self.blocks[block as usize].is_inside
    }

    /// The number of a surface's normal.
    pub(crate) fn facing(&self, normal: Vec3) -> FacingId {
        // One past those of blocks where there is none.
        FacingId(self.directions.iter().take_while(|&&direction| direction != normal).count() as u32)
    }

    /// Whether the VPLs of a block look the way that a surface does, and so neither lights the other: where normal and
    /// direction are equal, the cosine at one is that at the other with the other sign, to the last bit.
    pub(crate) fn is_turned_away(&self, block: u32, FacingId(number): FacingId) -> bool {
        self.blocks[block as usize].direction == number
    }
}

/// The number of a direction among a few: of a new one as long as there is room.
fn number_among(directions: &mut Vec<Vec3>, direction: Vec3) -> Option<u32> {
    let number = directions.iter().position(|&known| known == direction).unwrap_or(directions.len());
    if number == directions.len() && number < FEW {
        directions.push(direction);
    }
    (number < directions.len()).then_some(number as u32)
}

/// A plane: its bit, a point, and its normal.
type Plane = (usize, Vec3, Vec3);

/// The planes of all squares, if they are few, and of the boxes' faces.
fn planes(geometry: &Geometry<'_>, boxes: &[(Vec3, Vec3)]) -> Vec<Plane> {
    let squares = if geometry.squares.len() > FEW { &[] } else { geometry.squares };
    let squares = squares.iter().enumerate().map(|(bit, square)| (bit, square.center, square.normal));
    let faces = boxes.iter().enumerate().flat_map(|(number, &(lower, upper))| {
        (0..FACES).map(move |face| {
            let (corner, sign) = if face < 3 { (lower, -1.0) } else { (upper, 1.0) };
            (first_face(number) + face, corner, Vec3::AXES[face % 3] * sign)
        })
    });
    squares.chain(faces).collect()
}

/// On which sides of planes a VPL lies so far that no rounding lets a ray from a point in an enclosure towards it cross
/// them, provided that the point's height above the plane is not of the other sign. None, for a VPL outside of the
/// enclosure.
///
/// With the heights p and v of point and VPL along the normal, seen from the plane, it is crossed at t = p / (p - v):
/// at 1 or beyond, or before 0, where v has the sign of p. `intersect_square` computes that from p and from the slope
/// (p - v); if |v| is more than their errors together, what is rounded keeps that order. A box's face is met at a t
/// that is rounded no worse.
fn sides_of(planes: &[Plane], position: Vec3, enclosure: &Enclosure) -> Sides {
    let mut sides = Sides::default();
    if !enclosure.contains(position) {
        return sides;
    }
    let far = f64::from(enclosure.diagonal() / FAR);
    let position = position.as_dvec3();
    for &(bit, point, normal) in planes {
        let (point, normal) = (point.as_dvec3(), normal.as_dvec3());
        let error = ROUNDING * normal.abs().dot(enclosure.farthest(point) + enclosure.farthest(position))
            + f64::from(f32::MIN_POSITIVE);
        let height = (position - point).dot(normal);
        sides.front |= u64::from(height > error) << bit;
        sides.back |= u64::from(height < -error) << bit;
        sides.far |= u64::from(height.abs() > far + error) << bit;
    }
    sides
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::Simd;
    use crate::light_tree::TreeLayout;
    use lightcuts_kernel::intersect::{Square, intersect_square};
    use lightcuts_kernel::light::Vpl;
    use lightcuts_kernel::ray::{shadow_ray, spawn_epsilon};
    use lightcuts_kernel::rng::random4;
    use lightcuts_world::bvh::{BvhNode, ChildRef, TriangleForm};

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
            squares.iter().enumerate().map(|(bit, square)| (bit, square.center, square.normal)).collect();
        let enclosure = Enclosure { lower: Vec3::splat(-420.0), upper: Vec3::splat(420.0) };
        let half_spaces = HalfSpaces { enclosure, ..HalfSpaces::default() };
        let (mut claimed, mut by_tolerance, mut hits) = (0, 0, 0);
        for k in 0..400_000 {
            let from = near(&squares[(k % 4) as usize], k);
            let to = near(&squares[(k / 4 % 4) as usize], k + 1_000_000);
            let ends = sides_of(&planes, to, &enclosure);
            for rules in [Rules::Original, Rules::Repaired] {
                let ray = shadow_ray(rules, from, to - from, spawn_epsilon(rules, from, 300.0));
                for (index, square) in squares.iter().enumerate() {
                    let height = (square.center - from).dot(square.normal);
                    let sides = Sides { front: u64::from(height <= 0.0), back: u64::from(height >= 0.0), far: 0 };
                    let plane_tolerance = half_spaces.plane_tolerance(rules, spawn_epsilon(rules, from, 300.0));
                    let start = RayStart { sides, on: u64::from(height.abs() <= plane_tolerance) };
                    let bit = |mask: u64| mask >> index & 1;
                    let ends = Sides { front: bit(ends.front), back: bit(ends.back), far: bit(ends.far) };
                    let (hit, crossed) = (intersect_square(square, &ray).is_some(), start.shared(ends).crossed(1));
                    assert!(!hit || crossed == 1, "square {index} between {from} and {to}");
                    claimed += 1 - crossed;
                    by_tolerance += RayStart { sides, on: 0 }.shared(ends).crossed(1) - crossed;
                    hits += u32::from(hit);
                }
            }
        }
        println!("{claimed} of 3200000 need no test, {by_tolerance} as they begin so near; {hits} are hit");
        assert!(claimed > 1_500_000 && by_tolerance > 10_000 && hits > 100_000);
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
        let geometry =
            Geometry { nodes: &[root], triangles: &[], form: TriangleForm::Edges, spheres: &[], squares: &[square] };
        let tracer = Tracer::new(geometry, Rules::Original, Simd::Off);
        let half_spaces = |vpls: &[Vpl]| HalfSpaces::new(&tracer, &LightTree::build(vpls, TreeLayout::Wide));
        let sides = |heights: &[f32]| {
            let sides = half_spaces(&heights.iter().map(|&y| vpl(y)).collect::<Vec<_>>()).sides(0);
            (sides.front & 1, sides.back & 1)
        };
        assert_eq!(sides(&[-2.0, -3.0]), (1, 0));
        assert_eq!(sides(&[2.0, 3.0]), (0, 1));
        assert_eq!(sides(&[2.0, -3.0]), (0, 0));
        assert_eq!(sides(&[2.0, 30.0]), (0, 0), "outside of the enclosure");
        let is_turned_away = |vpls: &[Vpl], normal: Vec3| {
            let half_spaces = half_spaces(vpls);
            half_spaces.is_turned_away(0, half_spaces.facing(normal))
        };
        assert!(is_turned_away(&[vpl(2.0), vpl(3.0)], Vec3::Y));
        assert!(!is_turned_away(&[vpl(2.0), vpl(3.0)], Vec3::NEG_Y));
        assert!(!is_turned_away(&[vpl(2.0), Vpl { direction: Vec3::X, ..vpl(3.0) }], Vec3::Y));
    }
}
