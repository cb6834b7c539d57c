//! The CPU as a device: it never faults, so that it can take over from any other.

use super::{HalfSpaces, Simd, Tracer};
use crate::device::{Device, DeviceFault, DeviceInfo, DeviceKind, Lighting, Pass, TileResult, View};
use crate::film::Tile;
use crate::light_tree::{LightTree, TreeLayout};
use crate::monitor::Monitor;
use crate::original_rows::original_shifts;
use crate::photon_map::PhotonMap;
use crate::settings::Caustics;
use lightcuts_image::{Image, ToneMapping};
use lightcuts_kernel::light::Vpl;
use lightcuts_world::World;
use rayon::prelude::*;
use std::sync::{Arc, Mutex, OnceLock, PoisonError};

/// Tiles that are rendered between two looks at the monitor.
const BATCH: usize = 64;

/// The processor, on the threads of the current rayon pool.
#[derive(Debug)]
pub struct CpuDevice<'a> {
    world: &'a World,
    simd: Simd,
    /// Those of the last light tree, by its number.
    half_spaces: Mutex<Option<(u64, Arc<HalfSpaces>)>>,
}

impl<'a> CpuDevice<'a> {
    /// The processor, made ready for passes over a world.
    pub fn new(world: &'a World, simd: Simd) -> Self {
        Self { world, simd, half_spaces: Mutex::new(None) }
    }

    fn tracer(&self, view: &View<'_>) -> Tracer<'a> {
        Tracer::new(self.world.shapes.geometry(), view.rules, self.simd)
    }

    fn half_spaces(&self, tracer: &Tracer<'_>, tree: &LightTree) -> Arc<HalfSpaces> {
        let known = || self.half_spaces.lock().unwrap_or_else(PoisonError::into_inner);
        if let Some((id, half_spaces)) = &*known()
            && *id == tree.id()
        {
            return Arc::clone(half_spaces);
        }
        // Not while others wait: what is made in parallel may turn to another picture meanwhile.
        let half_spaces = Arc::new(HalfSpaces::new(tracer, tree));
        *known() = Some((tree.id(), Arc::clone(&half_spaces)));
        half_spaces
    }
}

impl Device for CpuDevice<'_> {
    fn info(&self) -> DeviceInfo {
        DeviceInfo { kind: DeviceKind::Cpu, name: processor_name() }
    }

    fn batch(&self) -> usize {
        BATCH
    }

    fn render_tiles(
        &self,
        pass: &Pass<'_>,
        tiles: &[Tile],
        monitor: &dyn Monitor,
    ) -> Result<Vec<Option<TileResult>>, DeviceFault> {
        let tracer = self.tracer(&pass.view);
        let half_spaces = match pass.lighting {
            Lighting::Vpls(vpls) => self.half_spaces(&tracer, vpls.tree),
            Lighting::Scene { .. } => Arc::default(),
        };
        let results = tiles
            .par_iter()
            .map(|tile| (!monitor.cancelled()).then(|| pass.render_tile(tracer, &half_spaces, tile)))
            .inspect(|_| monitor.advance())
            .collect();
        Ok(results)
    }

    fn original_shifts(&self, view: &View<'_>) -> Result<Vec<[f32; 2]>, DeviceFault> {
        Ok(original_shifts(view, self.tracer(view)))
    }

    fn shoot_photons(
        &self,
        view: &View<'_>,
        settings: &Caustics,
        monitor: &dyn Monitor,
    ) -> Result<(PhotonMap, u64), DeviceFault> {
        Ok(PhotonMap::shoot(self.world, &self.tracer(view), settings, view.max_depth, monitor))
    }

    fn preferred_layout(&self) -> TreeLayout {
        TreeLayout::Wide
    }

    fn build_tree(&self, vpls: &[Vpl], wanted: TreeLayout) -> Result<LightTree, DeviceFault> {
        Ok(LightTree::build(vpls, wanted))
    }

    fn bloom(&self, image: &Image, radius: f32, weight: f32) -> Result<Image, DeviceFault> {
        Ok(lightcuts_image::bloom(image, radius, weight))
    }

    fn tone_map(&self, image: &Image, operator: &ToneMapping) -> Result<Image, DeviceFault> {
        Ok(operator.apply(image))
    }

    fn revive(&self) -> Result<(), DeviceFault> {
        Ok(())
    }
}

/// The processor's name where the system tells it (Linux), else its architecture.
pub fn processor_name() -> String {
    static NAME: OnceLock<String> = OnceLock::new();
    let read = || {
        let info = std::fs::read_to_string("/proc/cpuinfo").unwrap_or_default();
        let line = info.lines().find_map(|line| line.strip_prefix("model name")?.split_once(':'));
        line.map_or(std::env::consts::ARCH, |(_, name)| name.trim()).to_owned()
    };
    NAME.get_or_init(read).clone()
}
