//! Station 3 and 4, pass by pass: as many VPLs as are wanted, under their tree.

use super::cluster_tree::ClusterTree;
use super::emission::Origins;
use super::rejection::Rejection;
use super::scene::Scene;
use super::vpls::trace_vpls;
use super::watch::Watch;
use crate::settings::Settings;
use crate::stats::{Stats, VplWork};
use lightcuts_kernel::rng::stream;
use lightcuts_kernel::virtual_light::VirtualLight;

/// Purposes of random numbers; each has its own stream.
const LIGHT_PATHS: u32 = 17;
const REPRESENTATIVES: u32 = 18;
const PLACES: u32 = 21;

/// Light paths by which the number of virtual lights per path is found.
const PILOT_PATHS: u32 = 1024;

/// Places virtual lights, and learns from pass to pass what light paths leave.
pub(crate) struct Placing<'a> {
    scene: Scene<'a>,
    settings: &'a Settings,
    origins: &'a Origins,
    rejection: Option<Rejection>,
    /// Light paths so far, and the virtual lights that they left.
    paths: u64,
    lights: u64,
}

impl<'a> Placing<'a> {
    /// Finds what light paths leave, before any pass: how many virtual lights, and how much they bring.
    pub(crate) fn new(
        scene: Scene<'a>,
        settings: &'a Settings,
        origins: &'a Origins,
        watch: &Watch<'_>,
        stats: &mut Stats,
    ) -> Self {
        let mut placing = Self { scene, settings, origins, rejection: None, paths: 0, lights: 0 };
        if settings.physical.rejection {
            let lens = scene.world.lens(settings.image.width, settings.image.height);
            placing.rejection = Some(Rejection::new(&scene, &lens, placing.stream(PLACES, 0), placing.clamp()));
        }
        let stream = stream(settings.run.seed, LIGHT_PATHS);
        // Twice: the second time lights are kept as they will be.
        for _ in 0..2 {
            (placing.paths, placing.lights) = (0, 0);
            placing.trace(PILOT_PATHS, stream, watch, stats);
        }
        placing
    }

    /// Distance below which a virtual light's contribution no longer grows, in scene units.
    pub(crate) fn clamp(&self) -> f32 {
        let (lower, upper) = self.scene.world.bounds;
        self.settings.physical.clamp * (upper - lower).length()
    }

    fn stream(&self, purpose: u32, pass: u32) -> u32 {
        stream(stream(self.settings.run.seed, purpose), pass)
    }

    /// Virtual lights of a pass under their tree; `None` if there is no time for it.
    pub(crate) fn build_light_tree(&mut self, pass: u32, watch: &Watch<'_>, stats: &mut Stats) -> Option<ClusterTree> {
        let mut work: VplWork = stats.vpl_work;
        let lights = work.placing.add(|| self.place(pass, watch, stats));
        let stream = self.stream(REPRESENTATIVES, pass);
        let tree = work.tree.add(|| ClusterTree::build(&lights, stream, &|| watch.is_over()));
        let bytes = size_of_val(&tree.lights[..]) + size_of_val(&tree.nodes[..]);
        work.bytes = work.bytes.max(bytes as u64);
        stats.vpl_work = work;
        (!watch.is_over()).then_some(tree)
    }

    /// Virtual lights of a pass. Their number is about what is wanted, by the experience of earlier passes; the number
    /// of paths is fixed before they are traced.
    fn place(&mut self, pass: u32, watch: &Watch<'_>, stats: &mut Stats) -> Vec<VirtualLight> {
        let lights_per_path = self.lights as f64 / self.paths.max(1) as f64;
        let wanted = f64::from(self.settings.physical.vpls) / lights_per_path.max(1e-3);
        let paths = (wanted as u32).clamp(1, self.settings.physical.vpls.saturating_mul(8));
        let lights = self.trace(paths, self.stream(LIGHT_PATHS, pass), watch, stats);
        stats.vpl_count = lights.len() as u64;
        lights
    }

    /// Traces light paths, and learns from them.
    fn trace(&mut self, paths: u32, stream: u32, watch: &Watch<'_>, stats: &mut Stats) -> Vec<VirtualLight> {
        let rejection = self.rejection.as_ref();
        let left = trace_vpls(&self.scene, self.origins, rejection, paths, stream, &|| watch.is_over());
        let lights: Vec<VirtualLight> = left.items.iter().filter_map(|judged| judged.light).collect();
        if let Some(rejection) = &mut self.rejection {
            rejection.learn(&left.items);
        }
        self.paths += u64::from(paths);
        self.lights += lights.len() as u64;
        stats.rays.photon += left.rays;
        lights
    }
}
