//! Vectors of lanes.
//!
//! Written out: a closure would be a function of its own, without the features of the one around it.

use crate::cpu::Lanes;
use glam::Vec3;
use lightcuts_world::bvh::LANES;

/// A vector for each point, by axes.
pub(super) type Vectors = [[f32; LANES]; 3];

/// Three perpendicular unit vectors for each point.
pub(super) type Frames = [Vectors; 3];

/// Three lanes of numbers.
pub(super) type Wide3<L> = [L; 3];

#[inline(always)]
pub(super) fn splat3<L: Lanes>(v: Vec3) -> Wide3<L> {
    [L::splat(v.x), L::splat(v.y), L::splat(v.z)]
}

#[inline(always)]
pub(super) fn loaded<L: Lanes>(vectors: &Vectors) -> Wide3<L> {
    [L::load(&vectors[0]), L::load(&vectors[1]), L::load(&vectors[2])]
}

#[inline(always)]
pub(super) fn stored<L: Lanes>(v: Wide3<L>) -> Vectors {
    [v[0].store(), v[1].store(), v[2].store()]
}

#[inline(always)]
pub(super) fn dot<L: Lanes>(a: Wide3<L>, b: Wide3<L>) -> L {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}

#[inline(always)]
pub(super) fn add<L: Lanes>(a: Wide3<L>, b: Wide3<L>) -> Wide3<L> {
    [a[0] + b[0], a[1] + b[1], a[2] + b[2]]
}

#[inline(always)]
pub(super) fn sub<L: Lanes>(a: Wide3<L>, b: Wide3<L>) -> Wide3<L> {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

#[inline(always)]
pub(super) fn product<L: Lanes>(a: Wide3<L>, b: Wide3<L>) -> Wide3<L> {
    [a[0] * b[0], a[1] * b[1], a[2] * b[2]]
}

#[inline(always)]
pub(super) fn scaled<L: Lanes>(v: Wide3<L>, factor: L) -> Wide3<L> {
    [v[0] * factor, v[1] * factor, v[2] * factor]
}

#[inline(always)]
pub(super) fn divided<L: Lanes>(v: Wide3<L>, divisor: L) -> Wide3<L> {
    [v[0] / divisor, v[1] / divisor, v[2] / divisor]
}

#[inline(always)]
pub(super) fn absolute<L: Lanes>(v: Wide3<L>) -> Wide3<L> {
    [v[0].abs(), v[1].abs(), v[2].abs()]
}
