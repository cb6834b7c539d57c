//! The ways to find light, behind one function.

use super::lightcuts::Pending;
use super::pass::{SamplePass, Start};
use super::path::trace_path;
use super::sums::{Counts, Sampled};
use crate::settings::{Integrator, Settings, Strategy};

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
    /// Those that a render may use; it chooses among them by measurement where there are several. The one to begin with
    /// is first.
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

    /// The light against a camera ray. Without VPLs there is none from them; what they send at some points is left to
    /// [`Technique::gather`], which is to follow.
    pub(crate) fn sample(
        self,
        pass: &SamplePass<'_>,
        start: Start,
        pending: &mut Vec<Pending>,
        counts: &mut Counts,
    ) -> Sampled {
        if let (Self::Vpls(strategy), Some(vpls)) = (self, &pass.vpls) {
            return vpls.sample(pass, strategy, start, pending, counts);
        }
        let (radiance, first) = trace_path(pass, start, counts);
        Sampled { radiance, first, cut: 0.0, bound: 0.0 }
    }

    /// Adds the light of the VPLs at points that samples have left, and forgets the points.
    pub(crate) fn gather(
        self,
        pass: &SamplePass<'_>,
        pending: &mut Vec<Pending>,
        sampled: &mut [Sampled],
        counts: &mut Counts,
    ) {
        if let (Self::Vpls(strategy), Some(vpls)) = (self, &pass.vpls) {
            vpls.gather(&pass.scene, strategy, pending, sampled, counts);
        }
        pending.clear();
    }
}
