//! The ways to find light, behind one function.

use super::pass::{Counts, SamplePass, Sampled};
use super::path::trace_path;
use super::randoms::Randoms;
use super::scene::Cone;
use crate::settings::{Integrator, Settings, Strategy};
use lightcuts_kernel::ray::Ray;

/// A way to find light.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Technique {
    /// Path tracing.
    Path,
    /// VPLs of the pass, gathered by a strategy.
    Vpls(Strategy),
}

/// Strategies among which `auto` chooses, the one to begin with first.
const STRATEGIES: [Strategy; 3] = [Strategy::Lightcuts, Strategy::Stochastic, Strategy::All];

impl Technique {
    /// Those that a render may use; it chooses among them by measurement where there are several. The one to begin with is first.
    pub(crate) fn of(settings: &Settings) -> Vec<Self> {
        let gathered: &[Strategy] = match &settings.gather.strategy {
            Strategy::Auto => &STRATEGIES,
            one => std::slice::from_ref(one),
        };
        let vpls = gathered.iter().map(|&strategy| Self::Vpls(strategy));
        match settings.physical.integrator {
            Integrator::Path => vec![Self::Path],
            Integrator::Lightcuts => vpls.collect(),
            Integrator::Auto => std::iter::once(Self::Path).chain(vpls).collect(),
        }
    }

    /// Whether it needs the VPLs of a pass.
    pub(crate) fn uses_vpls(self) -> bool {
        matches!(self, Self::Vpls(_))
    }

    /// The light against a camera ray. Without VPLs there is none from them.
    pub(crate) fn sample(
        self,
        pass: &SamplePass<'_>,
        ray: Ray,
        cone: Cone,
        pixel: u32,
        randoms: &mut Randoms,
        counts: &mut Counts,
    ) -> Sampled {
        if let (Self::Vpls(strategy), Some(vpls)) = (self, &pass.vpls) {
            return vpls.sample(pass, strategy, ray, cone, pixel, randoms, counts);
        }
        let (radiance, first) = trace_path(pass, ray, cone, randoms, counts);
        Sampled { radiance, first, cut: 0.0, bound: 0.0 }
    }
}
