//! Rays by themselves, for tests, measurements and programs that embed the device.

use crate::engine::Engine;
use crate::records::{ProbeHit, ProbeRay, RangeParams};
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::Hit;
use lightcuts_render::device::DeviceFault;

impl Engine {
    /// Hits of some rays, in their order.
    pub(crate) fn trace(&mut self, rays: &[ProbeRay], rules: Rules, any: bool) -> Result<Vec<Hit>, DeviceFault> {
        let entry = if any { "any_hits" } else { "closest_hits" };
        self.upload("probe_rays", rays)?;
        self.reserve("probe_hits", size_of_val(rays) as u64 / 2)?;
        self.over(entry, rays.len() as u32, 1.0, |engine, first, count| {
            let params = RangeParams { first, count, rules: rules as u32, padding: 0 };
            engine.run(entry, &params, count, f64::from(count))
        })?;
        let hits: Vec<ProbeHit> = self.read_as("probe_hits", rays.len())?;
        Ok(hits.into_iter().map(|ProbeHit { t, primitive, u, v }| Hit { t, primitive, u, v }).collect())
    }
}
