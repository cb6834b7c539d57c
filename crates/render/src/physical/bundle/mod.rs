//! Station 5 for eight points at once: the light of all virtual lights, or of one cut that is fine enough for each of
//! the points.
//!
//! Points of neighbouring pixels need much the same cut, and rays from them to one light go much the same way. So a
//! cluster is bounded for all of them at once, and opened where the bound is too much for any.

mod bound;
mod cut;
mod light;
mod vectors;

pub(crate) use cut::{Clusters, Cutting, Fineness};

use super::cluster_tree::ClusterTree;
use super::gather::{Gathered, Receiver};
use super::scene::Interaction;
use super::sums::Counts;
use crate::cpu::{Lanes, Plain};
use glam::Vec3;
use lightcuts_kernel::bsdf::LAMBERT;
use lightcuts_kernel::cluster::is_shiny;
use lightcuts_kernel::sampling::frame;
use lightcuts_world::bvh::LANES;
use std::f32::consts::PI;
use vectors::{Frames, Vectors, Wide3, add, stored};

/// Points that are lit together.
pub(crate) struct Bundle<'a> {
    /// The last one fills what is left.
    receivers: [Receiver<'a>; LANES],
    /// How many there are.
    count: usize,
    /// Whether all of them are of Lambert's material: what a light sends is computed for all at once.
    is_lambert: bool,
    point: Vectors,
    face: Vectors,
    /// Where rays begin that go to the viewer's side, and those that go behind.
    front: Vectors,
    back: Vectors,
    /// Normals and what is across them.
    normals: Frames,
    /// BSDF and factor on it, of Lambert's material.
    color: Vectors,
    /// Factors of `BsdfBound`.
    even: [f32; LANES],
    /// Whether any point has facets or lobes, and so the mirror's directions count.
    is_shiny: bool,
    mirrors: Frames,
    facets: [f32; LANES],
    alpha: [f32; LANES],
}

impl<'a> Bundle<'a> {
    /// Whether a point can be computed with others at once.
    pub(crate) fn is_lambert(at: &Interaction) -> bool {
        at.bsdf.kind == LAMBERT
    }

    /// One to eight points.
    pub(crate) fn new(receivers: &[Receiver<'a>]) -> Self {
        let count = receivers.len();
        let receivers = std::array::from_fn(|lane| receivers[lane.min(count - 1)]);
        let each = |of: &dyn Fn(&Receiver<'_>) -> f32| std::array::from_fn(|lane| of(&receivers[lane]));
        let vectors = |of: &dyn Fn(&Receiver<'_>) -> Vec3| -> Vectors {
            std::array::from_fn(|axis| each(&|receiver| of(receiver)[axis]))
        };
        let frames = |of: &dyn Fn(&Receiver<'_>) -> Vec3| -> Frames {
            let across = receivers.each_ref().map(|receiver| frame(of(receiver)));
            let tangent = |axis: usize| across.map(|(tangent, _)| tangent[axis]);
            let bitangent = |axis: usize| across.map(|(_, bitangent)| bitangent[axis]);
            [vectors(of), std::array::from_fn(tangent), std::array::from_fn(bitangent)]
        };
        // Towards the viewer.
        let side = |receiver: &Receiver<'_>| 1.0_f32.copysign(receiver.at.wo.z);
        let any_shiny = receivers.iter().any(|receiver| is_shiny(&receiver.bound.bsdf));
        Self {
            receivers,
            count,
            is_lambert: receivers.iter().all(|receiver| Self::is_lambert(receiver.at)),
            point: vectors(&|receiver| receiver.at.point),
            face: vectors(&|receiver| receiver.at.face * side(receiver)),
            front: vectors(&|receiver| receiver.at.point + receiver.at.lift),
            back: vectors(&|receiver| receiver.at.point - receiver.at.face * (side(receiver) * receiver.at.epsilon)),
            normals: frames(&|receiver| receiver.bound.normal),
            color: vectors(&|receiver| receiver.at.bsdf.diffuse * (1.0 / PI) * receiver.diffuse),
            even: each(&|receiver| receiver.bound.bsdf.even),
            is_shiny: any_shiny,
            mirrors: if any_shiny { frames(&|receiver| receiver.bound.mirror) } else { Frames::default() },
            facets: each(&|receiver| receiver.bound.bsdf.facets),
            alpha: each(&|receiver| receiver.bound.bsdf.alpha),
        }
    }

    fn asked(&self) -> u32 {
        (1 << self.count) - 1
    }

    /// The sum over all lights, at each point.
    pub(crate) fn all(&self, tree: &ClusterTree, counts: &mut Counts) -> [Gathered; LANES] {
        #[cfg(target_arch = "x86_64")]
        if self.receivers[0].scene.simd.has_avx2() {
            // SAFETY: the machine has the features.
            #[allow(unsafe_code)]
            return unsafe { self.all_avx2(tree, counts) };
        }
        self.sum_of_all::<Plain>(tree, counts)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn all_avx2(&self, tree: &ClusterTree, counts: &mut Counts) -> [Gathered; LANES] {
        self.sum_of_all::<crate::cpu::Wide>(tree, counts)
    }

    /// The sum over a cut, at each point (Walter et al. 2005): as [`Receiver::cut`], but that a cluster is opened where
    /// its bound is too much for any of the points.
    pub(crate) fn cut(&self, cutting: &Cutting<'_>, clusters: &mut Clusters, counts: &mut Counts) -> [Gathered; LANES] {
        #[cfg(target_arch = "x86_64")]
        if self.receivers[0].scene.simd.has_avx2() {
            // SAFETY: the machine has the features.
            #[allow(unsafe_code)]
            return unsafe { self.cut_avx2(cutting, clusters, counts) };
        }
        self.sum_of_cut::<Plain>(cutting, clusters, counts)
    }

    #[cfg(target_arch = "x86_64")]
    #[target_feature(enable = "avx2,fma,bmi1,popcnt")]
    fn cut_avx2(&self, cutting: &Cutting<'_>, clusters: &mut Clusters, counts: &mut Counts) -> [Gathered; LANES] {
        self.sum_of_cut::<crate::cpu::Wide>(cutting, clusters, counts)
    }

    #[inline(always)]
    fn sum_of_all<L: Lanes>(&self, tree: &ClusterTree, counts: &mut Counts) -> [Gathered; LANES] {
        counts.gathered += self.count as u64;
        counts.cut += (self.count * tree.lights.len()) as u64;
        let mut sum = [L::splat(0.0); 3];
        for light in &tree.lights {
            sum = add(sum, self.light(light, counts));
        }
        gathered(sum, tree.lights.len() as u32, L::splat(0.0))
    }
}

/// What was gathered, point by point.
#[inline(always)]
fn gathered<L: Lanes>(light: Wide3<L>, size: u32, bound: L) -> [Gathered; LANES] {
    let (light, bound) = (stored(light), bound.store());
    std::array::from_fn(|lane| Gathered {
        light: Vec3::new(light[0][lane], light[1][lane], light[2][lane]),
        size,
        bound: bound[lane],
    })
}
