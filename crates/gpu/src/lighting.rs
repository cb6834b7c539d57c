//! Light at the hits of a layer.

use crate::engine::Engine;
use crate::records::{DirectParams, FinishParams, GatherParams, OccludeParams, ScaleParams};
use crate::wave::Layer;
use bytemuck::Zeroable;
use lightcuts_kernel::packed_tree::BLOCK_SIZE;
use lightcuts_kernel::photon::Photon;
use lightcuts_render::device::{DeviceFault, Lighting, Occlusion, Pass, PhotonMap, SLOTS, VplLighting};
use lightcuts_render::{Monitor, Strategy};

impl Engine {
    /// The colours that the hits of a layer show by themselves.
    pub(crate) fn light(&mut self, pass: &Pass<'_>, layer: Layer, monitor: &dyn Monitor) -> Result<(), DeviceFault> {
        match pass.lighting {
            Lighting::Scene { occlusion } => self.light_by_scene(pass, layer, occlusion, monitor),
            Lighting::Vpls(vpls) => self.light_by_vpls(pass, layer, &vpls, monitor),
        }
    }

    fn light_by_scene(
        &mut self,
        pass: &Pass<'_>,
        layer: Layer,
        occlusion: Option<&Occlusion>,
        monitor: &dyn Monitor,
    ) -> Result<(), DeviceFault> {
        let (world, rules) = (pass.view.world, pass.view.rules as u32);
        let at_once = self.rays_at_once();
        self.over_lights(
            "direct",
            (layer.count, world.lights.len() as u32, at_once),
            false,
            monitor,
            |engine, part| {
                let params = DirectParams {
                    first: layer.first + part.first,
                    count: part.count,
                    rules,
                    first_light: part.first_light,
                    light_count: part.light_count,
                    ..DirectParams::zeroed()
                };
                engine.run("direct", &params, part.count, f64::from(part.count) * f64::from(part.light_count))
            },
        )?;
        if let Some(occlusion) = occlusion {
            self.occlude(layer, rules, occlusion, monitor)?;
        }
        let params = FinishParams {
            rules,
            occlusion_rays: occlusion.map_or(0, |occlusion| occlusion.rays),
            background: world.background,
            occlusion_factor: occlusion.map_or(1.0, |occlusion| occlusion.factor),
            ..FinishParams::zeroed()
        };
        self.over("finish", layer.count, 1.0, |engine, first, count| {
            let params = FinishParams { first: layer.first + first, count, ..params };
            engine.run("finish", &params, count, f64::from(count))
        })
    }

    fn occlude(
        &mut self,
        layer: Layer,
        rules: u32,
        occlusion: &Occlusion,
        monitor: &dyn Monitor,
    ) -> Result<(), DeviceFault> {
        let Occlusion { rays, sin_max, range, stream, .. } = *occlusion;
        let at_once = self.rays_at_once();
        self.over_lights("occlude", (layer.count, rays, at_once), false, monitor, |engine, part| {
            let params = OccludeParams {
                first: layer.first + part.first,
                count: part.count,
                rules,
                first_ray: part.first_light,
                ray_count: part.light_count,
                rays,
                sin_max,
                range,
                stream,
                slots: SLOTS,
                ..OccludeParams::zeroed()
            };
            engine.run("occlude", &params, part.count, f64::from(part.count) * f64::from(part.light_count))
        })
    }

    fn light_by_vpls(
        &mut self,
        pass: &Pass<'_>,
        layer: Layer,
        vpls: &VplLighting<'_>,
        monitor: &dyn Monitor,
    ) -> Result<(), DeviceFault> {
        self.bring_tree(vpls.tree)?;
        let total_vpls = vpls.tree.vpl_count() as u32;
        let params = GatherParams {
            rules: pass.view.rules as u32,
            threshold: vpls.threshold,
            total_vpls,
            exhaustive: u32::from(vpls.strategy == Strategy::LightcutsExhaustive),
            ..GatherParams::zeroed()
        };
        match vpls.strategy {
            // `stochastic` is of the physical model; settings with it are not rendered here.
            Strategy::Lightcuts | Strategy::Stochastic | Strategy::Auto => self.gather_cut(&params, layer, monitor)?,
            Strategy::All | Strategy::LightcutsExhaustive => self.gather_all(&params, layer, monitor)?,
        }
        self.scale(layer, vpls.photons)
    }

    fn gather_all(&mut self, params: &GatherParams, layer: Layer, monitor: &dyn Monitor) -> Result<(), DeviceFault> {
        let at_once = self.rays_at_once();
        self.over_lights("gather_all", (layer.count, params.total_vpls, at_once), false, monitor, |engine, part| {
            let params = GatherParams {
                first: layer.first + part.first,
                count: part.count,
                first_vpl: part.first_light,
                vpl_count: part.light_count,
                ..*params
            };
            engine.run("gather_all", &params, part.count, f64::from(part.count) * f64::from(part.light_count))
        })
    }

    fn gather_cut(&mut self, params: &GatherParams, layer: Layer, monitor: &dyn Monitor) -> Result<(), DeviceFault> {
        let blocks = params.total_vpls.div_ceil(BLOCK_SIZE);
        let leaves = blocks.max(1).next_power_of_two();
        // Every VPL of a range may be chosen.
        let at_once = 1 << (self.rays_at_once() / BLOCK_SIZE).ilog2();
        self.over_lights("gather_cut", (layer.count, leaves, at_once), true, monitor, |engine, part| {
            // The tree is filled up with empty leaves; that they cost nothing says nothing of the others.
            let existing = blocks.saturating_sub(part.first_light).min(part.light_count);
            if existing == 0 {
                return Ok(());
            }
            let params = GatherParams {
                first: layer.first + part.first,
                count: part.count,
                // The root of the subtree over this range of blocks.
                root: (leaves + part.first_light) / part.light_count,
                first_block: part.first_light,
                block_count: part.light_count,
                ..*params
            };
            engine.run("gather_cut", &params, part.count, f64::from(part.count) * f64::from(existing))
        })
    }

    fn scale(&mut self, layer: Layer, photons: Option<&PhotonMap>) -> Result<(), DeviceFault> {
        if let Some(map) = photons
            && self.photons != Some(map.id())
        {
            self.photons = None;
            self.require_rounds(neighbourhood(map), "a dense photon map")?;
            self.upload("photons", &map.photons)?;
            self.photons = Some(map.id());
        }
        let params = ScaleParams {
            has_photons: u32::from(photons.is_some_and(|map| !map.photons.is_empty())),
            min_photons: photons.map_or(0, |map| map.min_photons),
            radius: photons.map_or(1.0, |map| map.radius),
            ..ScaleParams::zeroed()
        };
        self.over("scale", layer.count, 1.0, |engine, first, count| {
            let params = ScaleParams { first: layer.first + first, count, ..params };
            engine.run("scale", &params, count, f64::from(count))
        })
    }
}

/// Photons of the 27 cells around a point, at most.
fn neighbourhood(map: &PhotonMap) -> u64 {
    let cell = |photon: &Photon| [photon.cell_x, photon.cell_y, photon.cell_z];
    let fullest = map.photons.chunk_by(|a, b| cell(a) == cell(b)).map(<[Photon]>::len).max().unwrap_or(0);
    27 * fullest as u64
}
