//! Light at a hit: the scene's lights in the first pass, VPLs in the second.

use crate::cpu::{
    Blocks, Candidates, Gathered, Receiver, Tracer, Walls, evaluate, evaluate_together, select, select_exhaustively,
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

/// What a ray hit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) hit: Hit,
    pub(crate) surface: Surface,
    /// Distance that separates rays and VPLs from this surface.
    pub(crate) epsilon: f32,
}

/// What a camera ray found, and the VPLs' light there: of neighbouring rays together, which is quicker.
#[derive(Debug, Clone, Copy, Default)]
pub(crate) struct First {
    found: Option<Found>,
    gathered: Option<(Gathered, TreeVisits)>,
}

/// Shades hits and counts what that takes. One per worker and tile.
pub(crate) struct Shader<'a> {
    world: &'a World,
    tracer: Tracer<'a>,
    lighting: Lighting<'a>,
    walls: &'a Walls,
    /// Place of the camera ray in the run, for random numbers: pixel and sample.
    pub(crate) place: (u32, u32),
    pub(crate) rays: Rays,
    pub(crate) visits: TreeVisits,
    /// VPLs that lit each shaded hit of the current ray tree, in order of shading.
    pub(crate) selected: Vec<u32>,
    /// VPLs of the current hit; those of every hit where all are gathered.
    candidates: Vec<Candidates>,
    /// The same of hits that are gathered together, one after the other.
    candidates_together: Vec<Candidates>,
    /// What is known of the current camera ray before it is traced.
    pub(crate) first: Option<First>,
}

impl<'a> Shader<'a> {
    pub(crate) fn new(world: &'a World, tracer: Tracer<'a>, lighting: Lighting<'a>, walls: &'a Walls) -> Self {
        let candidates = match lighting {
            Lighting::Vpls(VplLighting { tree, strategy: Strategy::All, .. }) => tree.every_block(true).collect(),
            _ => Vec::new(),
        };
        Self {
            world,
            tracer,
            lighting,
            walls,
            place: (0, 0),
            rays: Rays::default(),
            visits: TreeVisits::default(),
            selected: Vec::new(),
            candidates,
            candidates_together: Vec::new(),
            first: None,
        }
    }

    pub(crate) fn rules(&self) -> Rules {
        self.tracer.rules
    }

    /// Colour of a ray that leaves the scene.
    pub(crate) fn background(&self) -> Vec3 {
        match self.lighting {
            Lighting::Scene { .. } => self.world.background,
            Lighting::Vpls(_) => Vec3::ZERO,
        }
    }

    /// What a ray hits first. The ray's direction is of unit length.
    pub(crate) fn find(&mut self, ray: &Ray, secondary: bool) -> Option<Found> {
        *if secondary { &mut self.rays.secondary } else { &mut self.rays.primary } += 1;
        match self.first {
            Some(first) if !secondary => first.found,
            _ => self.found(ray, self.tracer.closest(ray)),
        }
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

    /// What neighbouring camera rays find, and the VPLs' light there.
    pub(crate) fn look(&mut self, rays: &[Ray], firsts: &mut [First]) {
        for (rays, firsts) in rays.chunks(LANES).zip(firsts.chunks_mut(LANES)) {
            let hits = self.tracer.closest8(&std::array::from_fn(|lane| rays[lane.min(rays.len() - 1)]));
            for ((ray, hit), first) in rays.iter().zip(hits).zip(firsts) {
                *first = First { found: self.found(ray, hit), gathered: None };
            }
        }
        // Among few spheres and squares alone, eight VPLs for one point are as quick: there is no way down a hierarchy to share.
        if let Lighting::Vpls(vpls) = self.lighting
            && !self.tracer.geometry.triangles.is_empty()
        {
            self.gather_together(&vpls, firsts);
        }
    }

    fn gather_together(&mut self, vpls: &VplLighting<'_>, firsts: &mut [First]) {
        let mut places = Vec::with_capacity(firsts.len());
        let mut receivers = Vec::with_capacity(firsts.len());
        let (mut all_visits, mut ends) = (Vec::with_capacity(firsts.len()), Vec::with_capacity(firsts.len()));
        self.candidates_together.clear();
        for (place, first) in firsts.iter().enumerate() {
            let Some(found) = first.found.filter(|found| self.material(found).local != 0.0) else { continue };
            places.push(place);
            receivers.push(self.receiver(&found));
            all_visits.push(choose(vpls, &self.tracer, found.surface.point, &mut self.candidates_together));
            ends.push(self.candidates_together.len());
        }
        let list = |k: usize| match vpls.strategy {
            Strategy::All => &self.candidates[..],
            _ => &self.candidates_together[if k == 0 { 0 } else { ends[k - 1] }..ends[k]],
        };
        let lists: Vec<&[Candidates]> = (0..places.len()).map(list).collect();
        let gathered = evaluate_together(&self.tracer, &blocks(vpls, self.walls), &lists, threshold(vpls), &receivers);
        for ((place, gathered), visits) in places.into_iter().zip(gathered).zip(all_visits) {
            firsts[place].gathered = Some((gathered, visits));
        }
    }

    /// The colour that a hit shows by itself: E times the light that arrives, plus glow.
    pub(crate) fn local(&mut self, slot: u32, ray: &Ray, found: &Found) -> Vec3 {
        let Material { local, glow, .. } = *self.material(found);
        match self.lighting {
            Lighting::Scene { .. } if local == 0.0 => glow,
            Lighting::Scene { occlusion } => {
                let lit = self.direct(ray, found);
                let open = occlusion.map_or(1.0, |occlusion| {
                    occlusion.openness(&self.tracer, found, (self.place, slot), &mut self.rays)
                });
                lit * local * open + glow
            }
            Lighting::Vpls(_) if local == 0.0 => Vec3::ZERO,
            Lighting::Vpls(vpls) => self.gather(&vpls, found, slot == 0) * local,
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
        let known = self.first.filter(|_| is_first).and_then(|first| first.gathered);
        let (gathered, visits) = known.unwrap_or_else(|| {
            if vpls.strategy != Strategy::All {
                self.candidates.clear();
            }
            let visits = choose(vpls, &self.tracer, surface.point, &mut self.candidates);
            let receiver = self.receiver(found);
            (evaluate(&self.tracer, &blocks(vpls, self.walls), &self.candidates, threshold(vpls), &receiver), visits)
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

fn blocks<'a>(vpls: &VplLighting<'a>, walls: &'a Walls) -> Blocks<'a> {
    Blocks { vpls: &vpls.tree.blocks, walls }
}

/// The relevance that a VPL must reach; `None` where all count.
fn threshold(vpls: &VplLighting<'_>) -> Option<f32> {
    (vpls.strategy != Strategy::All).then_some(vpls.threshold)
}

/// Appends the VPLs that may light a point; none where all do.
fn choose(vpls: &VplLighting<'_>, tracer: &Tracer<'_>, point: Vec3, candidates: &mut Vec<Candidates>) -> TreeVisits {
    match vpls.strategy {
        Strategy::All => TreeVisits::default(),
        // `stochastic` is of the physical model; settings with it are not rendered here.
        Strategy::Lightcuts | Strategy::Stochastic | Strategy::Auto => {
            select(vpls.tree, tracer.avx2, point, vpls.threshold, candidates)
        }
        Strategy::LightcutsExhaustive => select_exhaustively(vpls.tree, candidates),
    }
}
