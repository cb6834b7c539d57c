//! Light at a hit: the scene's lights in the first pass, VPLs in the second.

use crate::cpu::{
    Blocks, Candidates, Gathered, HalfSpaces, Receiver, Tracer, evaluate, evaluate_together, select,
    select_exhaustively,
};
use crate::device::{Lighting, VplLighting};
use crate::settings::Strategy;
use crate::stats::{Rays, TreeVisits};
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::light::DIRECTIONAL;
use lightcuts_kernel::material::Material;
use lightcuts_kernel::phong::{incidence, phong};
use lightcuts_kernel::ray::{Hit, NONE, Ray, shadow_ray, spawn_epsilon};
use lightcuts_kernel::surface::{Surface, surface_at};
use lightcuts_kernel::texture::{sample_texture, surface_point};
use lightcuts_world::World;
use lightcuts_world::bvh::LANES;
use std::ops::Range;

/// Camera rays that are traced and lit together: as many as there are shadow rays to one VPL in a bundle.
pub(crate) const TOGETHER: usize = 32;

/// Neighbours choose VPLs together if at most this many are left to be tested at each of them, or one for each
/// [`CERTAIN_PER_TESTED`] that need no test.
const MOST_TESTED: u64 = 256;
const CERTAIN_PER_TESTED: u64 = 4;

/// What a ray hit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) hit: Hit,
    pub(crate) surface: Surface,
    /// Distance that separates rays and VPLs from this surface.
    pub(crate) epsilon: f32,
}

/// Shades hits and counts the work. One per worker and tile.
pub(crate) struct Shader<'a> {
    world: &'a World,
    tracer: Tracer<'a>,
    /// None if rays are only traced.
    lighting: Option<Lighting<'a>>,
    half_spaces: &'a HalfSpaces,
    /// Place of the camera ray in the run, for random numbers: pixel and sample.
    pub(crate) place: (u32, u32),
    pub(crate) rays: Rays,
    pub(crate) visits: TreeVisits,
    /// VPLs that lit each shaded hit of the current ray tree, in order of shading.
    pub(crate) selected: Vec<u32>,
    /// VPLs of the current hit; those of every hit if all are gathered.
    candidates: Vec<Candidates>,
    /// The same for hits that are gathered together, one after the other.
    candidates_together: Vec<Candidates>,
    /// Results of [`Shader::trace_primary`]: what camera rays hit, and the VPLs' light there.
    firsts: Vec<Option<Found>>,
    gathered: Vec<Option<(Gathered, TreeVisits)>>,
    /// The index of the current camera ray.
    current: usize,
}

impl<'a> Shader<'a> {
    pub(crate) fn new(
        world: &'a World,
        tracer: Tracer<'a>,
        lighting: Option<Lighting<'a>>,
        half_spaces: &'a HalfSpaces,
    ) -> Self {
        let candidates = match lighting {
            Some(Lighting::Vpls(VplLighting { tree, strategy: Strategy::All, .. })) => tree.every_block(true).collect(),
            _ => Vec::new(),
        };
        Self {
            world,
            tracer,
            lighting,
            half_spaces,
            place: (0, 0),
            rays: Rays::default(),
            visits: TreeVisits::default(),
            selected: Vec::new(),
            candidates,
            candidates_together: Vec::new(),
            firsts: Vec::new(),
            gathered: Vec::new(),
            current: 0,
        }
    }

    pub(crate) fn rules(&self) -> Rules {
        self.tracer.rules
    }

    /// Colour of a ray that leaves the scene.
    pub(crate) fn background(&self) -> Vec3 {
        match self.lighting {
            Some(Lighting::Scene { .. }) => self.world.background,
            Some(Lighting::Vpls(_)) | None => Vec3::ZERO,
        }
    }

    /// What a ray hits first. The ray's direction is of unit length.
    pub(crate) fn find(&mut self, ray: &Ray, secondary: bool) -> Option<Found> {
        *if secondary { &mut self.rays.secondary } else { &mut self.rays.primary } += 1;
        if secondary { self.found(ray, self.tracer.closest(ray)) } else { self.firsts[self.current] }
    }

    fn found(&self, ray: &Ray, hit: Hit) -> Option<Found> {
        hit.is_some().then(|| {
            let surface = surface_at(&self.world.shapes.surfaces(), ray, &hit);
            Found { hit, surface, epsilon: spawn_epsilon(self.tracer.rules, surface.point, hit.t) }
        })
    }

    pub(crate) fn material(&self, found: &Found) -> &'a Material {
        &self.world.materials[found.surface.material as usize]
    }

    /// Traces camera rays, and gathers the VPLs' light at their hits. Rays that follow each other in `order` are
    /// neighbours.
    pub(crate) fn trace_primary(&mut self, rays: &[Ray], order: &[usize]) {
        self.firsts.resize(rays.len(), None);
        for eight in order.chunks(LANES) {
            let hits = self.tracer.closest8(&std::array::from_fn(|lane| rays[eight[lane.min(eight.len() - 1)]]));
            for (&k, hit) in eight.iter().zip(hits) {
                self.firsts[k] = self.found(&rays[k], hit);
            }
        }
        if let Some(Lighting::Vpls(vpls)) = self.lighting {
            self.gathered.clear();
            self.gathered.resize(rays.len(), None);
            order.chunks(TOGETHER).for_each(|neighbours| self.gather_together(&vpls, neighbours));
        }
    }

    /// Makes a traced camera ray the current one.
    pub(crate) fn make_current(&mut self, current: usize, place: (u32, u32)) {
        (self.current, self.place) = (current, place);
        self.selected.clear();
    }

    fn gather_together(&mut self, vpls: &VplLighting<'_>, neighbours: &[usize]) {
        let (mut places, mut receivers) = (Vec::with_capacity(TOGETHER), Vec::with_capacity(TOGETHER));
        for &place in neighbours {
            let found = self.firsts[place].filter(|found| self.material(found).local != 0.0);
            let Some(found) = found else { continue };
            places.push(place);
            receivers.push(self.receiver(&found));
        }
        let choices = choose_together(vpls, &self.tracer, &receivers, &mut self.candidates_together);
        let list = |(own, _): &(Range<usize>, TreeVisits)| match vpls.strategy {
            Strategy::All => &self.candidates[..],
            _ => &self.candidates_together[own.clone()],
        };
        let lists: Vec<&[Candidates]> = choices.iter().map(list).collect();
        let gathered =
            evaluate_together(&self.tracer, &blocks(vpls, self.half_spaces), &lists, threshold(vpls), &receivers);
        for ((place, gathered), (_, visits)) in places.into_iter().zip(gathered).zip(choices) {
            self.gathered[place] = Some((gathered, visits));
        }
    }

    /// The local colour of a hit: E times the incident light, plus glow.
    pub(crate) fn local(&mut self, slot: u32, ray: &Ray, found: &Found) -> Vec3 {
        let Material { local, glow, .. } = *self.material(found);
        match self.lighting {
            None => Vec3::ZERO,
            Some(Lighting::Scene { .. }) if local == 0.0 => glow,
            Some(Lighting::Scene { occlusion }) => {
                let lit = self.direct(ray, found);
                let open = occlusion.map_or(1.0, |occlusion| {
                    occlusion.openness(&self.tracer, found, (self.place, slot), &mut self.rays)
                });
                lit * local * open + glow
            }
            Some(Lighting::Vpls(_)) if local == 0.0 => Vec3::ZERO,
            Some(Lighting::Vpls(vpls)) => self.gather(&vpls, found, slot == 0) * local,
        }
    }

    /// The scene's lights: each clamped, summed; a texture is added where at least one arrives.
    fn direct(&mut self, ray: &Ray, found: &Found) -> Vec3 {
        let Found { hit, surface, epsilon } = found;
        let (rules, material) = (self.tracer.rules, self.material(found));
        let mut color = Vec3::ZERO;
        let mut lit = false;
        for light in &self.world.lights {
            let Some(at) = incidence(light, surface.point, surface.normal) else { continue };
            let mut shadow = shadow_ray(rules, surface.point, at.to_light, *epsilon);
            if light.kind == DIRECTIONAL {
                shadow.t_max = f32::INFINITY;
            }
            self.rays.shadow += 1;
            if !self.tracer.occluded(&shadow) {
                lit = true;
                color += phong(light, material, &at, surface.normal, ray.origin - surface.point, rules);
            }
        }
        if lit && material.texture != NONE {
            let surfaces = self.world.shapes.surfaces();
            let at = surface_point(&surfaces, hit, surface);
            let texture = &self.world.textures[material.texture as usize];
            color += sample_texture(&self.world.texels, texture, material.texture_mode, &at, rules);
        }
        color
    }

    /// The VPLs chosen for a hit, and caustics.
    fn gather(&mut self, vpls: &VplLighting<'_>, found: &Found, is_first: bool) -> Vec3 {
        let surface = &found.surface;
        let known = if is_first { self.gathered[self.current] } else { None };
        let (gathered, visits) = known.unwrap_or_else(|| {
            if vpls.strategy != Strategy::All {
                self.candidates.clear();
            }
            let visits = choose(vpls, &self.tracer, (surface.point, surface.point), &mut self.candidates);
            let receiver = self.receiver(found);
            (
                evaluate(&self.tracer, &blocks(vpls, self.half_spaces), &self.candidates, threshold(vpls), &receiver),
                visits,
            )
        });
        self.visits.add(&TreeVisits { shaded_hits: 1, selected: u64::from(gathered.chosen), ..visits });
        self.selected.push(gathered.chosen);
        self.rays.shadow += gathered.shadow_rays;
        let caustics = vpls.photons.map_or(Vec3::ZERO, |photons| photons.gather(surface.point, surface.normal));
        gathered.color + caustics * self.material(found).diffuse
    }

    fn receiver(&self, found: &Found) -> Receiver {
        let Found { surface, epsilon, .. } = *found;
        Receiver { point: surface.point, normal: surface.normal, diffuse: self.material(found).diffuse, epsilon }
    }
}

fn blocks<'a>(vpls: &VplLighting<'a>, half_spaces: &'a HalfSpaces) -> Blocks<'a> {
    Blocks { vpls: &vpls.tree.blocks, half_spaces }
}

/// The relevance that a VPL must reach; `None` if all are chosen.
fn threshold(vpls: &VplLighting<'_>) -> Option<f32> {
    (vpls.strategy != Strategy::All).then_some(vpls.threshold)
}

/// Appends the VPLs that may light points of a box; nothing if all are chosen.
fn choose(
    vpls: &VplLighting<'_>,
    tracer: &Tracer<'_>,
    points: (Vec3, Vec3),
    candidates: &mut Vec<Candidates>,
) -> TreeVisits {
    match vpls.strategy {
        Strategy::All => TreeVisits::default(),
        // `stochastic` and `auto` belong to the physical model; settings with them are not rendered here.
        Strategy::Lightcuts | Strategy::Stochastic | Strategy::Auto => {
            select(vpls.tree, tracer.avx2, points, vpls.threshold, candidates)
        }
        Strategy::LightcutsExhaustive => select_exhaustively(vpls.tree, candidates),
    }
}

/// The same for neighbours: for each, the range of its candidates, and the work. They descend the tree together, and
/// separately only if that leaves too many VPLs to be tested.
fn choose_together(
    vpls: &VplLighting<'_>,
    tracer: &Tracer<'_>,
    at: &[Receiver],
    candidates: &mut Vec<Candidates>,
) -> Vec<(Range<usize>, TreeVisits)> {
    candidates.clear();
    if at.is_empty() {
        return Vec::new();
    }
    let points = || at.iter().map(|at| at.point);
    let corners = (points().fold(Vec3::INFINITY, Vec3::min), points().fold(Vec3::NEG_INFINITY, Vec3::max));
    let common = choose(vpls, tracer, corners, candidates);
    let mut choices = vec![(0..candidates.len(), TreeVisits { nodes: 0, ..common }); at.len()];
    let certain: u32 = candidates.iter().filter(|some| some.certain).map(|some| some.lanes.count_ones()).sum();
    let most_tested = MOST_TESTED.max(u64::from(certain) / CERTAIN_PER_TESTED);
    if common.lights > most_tested && vpls.strategy != Strategy::LightcutsExhaustive {
        candidates.clear();
        for (at, (own, visits)) in at.iter().zip(&mut choices) {
            own.start = candidates.len();
            *visits = choose(vpls, tracer, (at.point, at.point), candidates);
            own.end = candidates.len();
        }
    }
    choices[0].1.nodes += common.nodes;
    choices
}
