//! Photons shot on the device: counted first, then stored where the counts say, so that their order is that of
//! emission.

use crate::counters::{self, Counter};
use crate::engine::Engine;
use crate::records::ShootParams;
use bytemuck::Zeroable;
use lightcuts_kernel::photon::{Photon, PhotonTarget};
use lightcuts_render::Caustics;
use lightcuts_render::Monitor;
use lightcuts_render::device::{DeviceFault, PhotonMap, View, photon_targets};

impl Engine {
    /// Photons from every light at every mirror and glass object, and the number of rays.
    pub(crate) fn shoot_photons(
        &mut self,
        view: &View<'_>,
        settings: &Caustics,
        monitor: &dyn Monitor,
    ) -> Result<(PhotonMap, u64), DeviceFault> {
        self.require_rounds_of_trees(view.max_depth, "photons through so many mirrors")?;
        let mut photons = Vec::new();
        let counters = self.buffer("counters");
        self.dispatcher.clear(&self.context, &counters);
        for target in &photon_targets(view.world, settings) {
            let params = ShootParams {
                light: view.world.lights[target.light as usize],
                target_: *target,
                rules: view.rules as u32,
                max_depth: view.max_depth,
                min_diffuse: settings.min_diffuse,
                ..ShootParams::zeroed()
            };
            self.shoot_target(&params, target, monitor, &mut photons)?;
        }
        let rays = counters::sum(&self.read(&[("counters", counters::BYTES)])?[0], Counter::PhotonRays);
        // The map's own buffer is uploaded when it is gathered from, sorted into cells.
        self.photons = None;
        Ok((PhotonMap::new(photons, settings), rays))
    }

    /// Whole rows of a target's grid at a time.
    fn shoot_target(
        &mut self,
        params: &ShootParams,
        target: &PhotonTarget,
        monitor: &dyn Monitor,
        photons: &mut Vec<Photon>,
    ) -> Result<(), DeviceFault> {
        let rows_at_once = (self.capacity.words() / target.side).max(1);
        let mut row = 0;
        while row < target.side && !monitor.cancelled() {
            let rows = rows_at_once.min(target.side - row);
            let params = ShootParams { round: row * target.side, ..*params };
            let total = rows * target.side;
            self.reserve_words(total)?;
            self.shoot_round("count_photons", &params, total)?;
            let stored = self.scan_words(total)?;
            if stored > 0 {
                self.reserve("photons", u64::from(stored) * size_of::<Photon>() as u64)?;
                self.shoot_round("store_photons", &params, total)?;
                photons.extend(self.read_as::<Photon>("photons", stored as usize)?);
            }
            for _ in 0..rows {
                monitor.advance();
            }
            row += rows;
        }
        Ok(())
    }

    fn shoot_round(&mut self, entry: &'static str, params: &ShootParams, total: u32) -> Result<(), DeviceFault> {
        self.over(entry, total, 1.0, |engine, first, count| {
            let params = ShootParams { first, count, ..*params };
            engine.run(entry, &params, count, f64::from(count))
        })
    }
}
