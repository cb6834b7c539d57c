//! Light at a hit: the scene's lights in the first pass, VPLs in the second.

use crate::cpu::{Candidates, Receiver, Tracer, evaluate, select, select_exhaustively};
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

/// What a ray hit.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Found {
    pub(crate) hit: Hit,
    pub(crate) surface: Surface,
    pub(crate) material: Material,
    /// Distance that separates rays and VPLs from this surface.
    pub(crate) epsilon: f32,
}

/// Shades hits and counts what that takes. One per worker and tile.
pub(crate) struct Shader<'a> {
    world: &'a World,
    tracer: Tracer<'a>,
    lighting: Lighting<'a>,
    /// Place of the camera ray in the run, for random numbers: pixel and sample.
    pub(crate) place: (u32, u32),
    pub(crate) rays: Rays,
    pub(crate) visits: TreeVisits,
    /// VPLs that lit each shaded hit of the current ray tree, in order of shading.
    pub(crate) selected: Vec<u32>,
    /// VPLs of the current hit; those of every hit where all are gathered.
    candidates: Vec<Candidates>,
}

impl<'a> Shader<'a> {
    pub(crate) fn new(world: &'a World, tracer: Tracer<'a>, lighting: Lighting<'a>) -> Self {
        let candidates = match lighting {
            Lighting::Vpls(VplLighting { tree, strategy: Strategy::All, .. }) => tree.every_block(true).collect(),
            _ => Vec::new(),
        };
        Self {
            world,
            tracer,
            lighting,
            place: (0, 0),
            rays: Rays::default(),
            visits: TreeVisits::default(),
            selected: Vec::new(),
            candidates,
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
        let hit = self.tracer.closest(ray);
        hit.is_some().then(|| {
            let surface = surface_at(&self.world.shapes.surfaces(), ray, &hit);
            let material = self.world.materials[surface.material as usize];
            Found { hit, surface, material, epsilon: spawn_epsilon(self.tracer.rules, surface.point, hit.t) }
        })
    }

    /// The colour that a hit shows by itself: E times the light that arrives, plus glow.
    pub(crate) fn local(&mut self, slot: u32, ray: &Ray, found: &Found) -> Vec3 {
        let Material { local, glow, .. } = found.material;
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
            Lighting::Vpls(vpls) => self.gather(&vpls, found) * local,
        }
    }

    /// The scene's lights: each clamped, summed; a texture is added where at least one arrives.
    fn direct(&mut self, ray: &Ray, Found { hit, surface, material, epsilon }: &Found) -> Vec3 {
        let rules = self.tracer.rules;
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
    fn gather(&mut self, vpls: &VplLighting<'_>, Found { surface, material, epsilon, .. }: &Found) -> Vec3 {
        let (tree, point) = (vpls.tree, surface.point);
        let threshold = (vpls.strategy != Strategy::All).then_some(vpls.threshold);
        if threshold.is_some() {
            self.candidates.clear();
        }
        let candidates = &mut self.candidates;
        let visits = match vpls.strategy {
            Strategy::All => TreeVisits::default(),
            // `stochastic` is of the physical model; settings with it are not rendered here.
            Strategy::Lightcuts | Strategy::Stochastic | Strategy::Auto => {
                select(tree, self.tracer.avx2, point, vpls.threshold, candidates)
            }
            Strategy::LightcutsExhaustive => select_exhaustively(tree, candidates),
        };
        let receiver = Receiver { point, normal: surface.normal, diffuse: material.diffuse, epsilon: *epsilon };
        let gathered = evaluate(&self.tracer, &tree.blocks, candidates, threshold, &receiver);
        self.visits.add(&TreeVisits { shaded_hits: 1, selected: u64::from(gathered.chosen), ..visits });
        self.selected.push(gathered.chosen);
        self.rays.shadow += gathered.shadow_rays;
        let caustics = vpls.photons.map_or(Vec3::ZERO, |photons| photons.gather(point, surface.normal));
        gathered.color + caustics * material.diffuse
    }
}
