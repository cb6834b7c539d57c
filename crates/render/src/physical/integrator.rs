//! The ways to find light, behind one function.

use super::lightcuts::Lightcuts;
use super::pass::{Counts, Sampled};
use super::path::trace_path;
use super::randoms::Randoms;
use super::scene::{Cone, Scene};
use lightcuts_kernel::ray::Ray;

/// How the samples of a pass find light.
pub(crate) enum Sampler<'a> {
    /// Path tracing.
    Path,
    /// VPLs of this pass.
    Lightcuts(Lightcuts<'a>),
}

impl Sampler<'_> {
    /// The light against a camera ray.
    pub(crate) fn sample(
        &self,
        scene: &Scene<'_>,
        ray: Ray,
        cone: Cone,
        pixel: u32,
        randoms: &mut Randoms,
        counts: &mut Counts,
    ) -> Sampled {
        match self {
            Self::Path => {
                let (radiance, first) = trace_path(scene, ray, cone, randoms, counts);
                Sampled { radiance, first, cut: 0.0, bound: 0.0 }
            }
            Self::Lightcuts(lightcuts) => lightcuts.sample(scene, ray, cone, pixel, randoms, counts),
        }
    }
}
