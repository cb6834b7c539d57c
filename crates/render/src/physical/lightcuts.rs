//! Indirect light from the virtual lights of a pass.
//!
//! A vertex sends light on by matt lobes, which virtual lights stand for, and by others, which paths follow. So a path carries
//! two factors: one on what the next vertex sends by its matt lobes, one on the rest. Where a vertex gathers virtual lights
//! the first one is left with what the clamp of their distance takes away (Kollig & Keller 2004).

use super::cluster_tree::ClusterTree;
use super::direct::{Before, DirectLight};
use super::gather::{CutHeap, Gathered, Receiver};
use super::pass::{Counts, FirstHit, SamplePass, Sampled};
use super::path::{MAX_VERTICES, Radiance};
use super::randoms::Randoms;
use super::scene::{Cone, Interaction, Scene};
use crate::settings::{Physical, Strategy};
use glam::Vec3;
use lightcuts_kernel::bsdf::{ALL_LOBES, Bsdf, CONDUCTOR, GLOSSY, MATT, PHONG, PLASTIC, SPECULAR, Transport, lobes_of};
use lightcuts_kernel::ray::Ray;
use std::cell::RefCell;

/// Narrower lobes are followed by paths: too few virtual lights lie in them.
pub(crate) const LEAST_GATHERED_ALPHA: f32 = 0.15;
/// The same of Phong's.
const GREATEST_GATHERED_EXPONENT: f32 = 60.0;

/// Lights that are drawn at a vertex that gathers a whole cut: its share of the time is small.
const FIRST_LIGHTS: u32 = 8;

/// Virtual lights that are drawn where a path comes to its second matt vertex.
const DRAWN_LIGHTS: u32 = 4;

/// Virtual lights that the strategy `stochastic` draws.
const STOCHASTIC_LIGHTS: u32 = 16;

/// Vertices after which paths end by chance.
const SURE_VERTICES: u32 = 2;

/// Virtual lights of a pass with what decides how they are gathered.
pub(crate) struct Lightcuts<'a> {
    pub(crate) tree: ClusterTree,
    pub(crate) settings: &'a Physical,
    /// Distance below which light no longer grows, in scene units.
    pub(crate) clamp: f32,
    /// What the light of each pixel is, from earlier passes: sums of channels.
    pub(crate) references: &'a [f32],
}

thread_local! {
    static HEAP: RefCell<CutHeap> = RefCell::default();
}

/// A path on its way.
struct Walk {
    /// Factor on what the next vertex sends by its matt lobes.
    matt: Vec3,
    /// The same that a short ray may give back, before its length is known.
    compensated: Vec3,
    /// Factor on everything else that it sends.
    rest: Vec3,
    /// Whether no gathering vertex lies before it.
    is_first: bool,
    before: Option<Before>,
    ray: Ray,
    cone: Cone,
    /// Surfaces before the next one.
    vertex: u32,
}

/// How a path goes on from a vertex.
struct Drawn {
    lobes: u32,
    /// Lights that were drawn there.
    lights: u32,
    random: [f32; 3],
    has_photons: bool,
}

impl Lightcuts<'_> {
    /// The light against a camera ray, with VPLs that a strategy gathers.
    #[allow(clippy::too_many_arguments)] // what a sample is made of
    pub(crate) fn sample(
        &self,
        pass: &SamplePass<'_>,
        strategy: Strategy,
        ray: Ray,
        cone: Cone,
        pixel: u32,
        randoms: &mut Randoms,
        counts: &mut Counts,
    ) -> Sampled {
        let mut sampled = Sampled { radiance: Radiance::default(), first: None, cut: 0.0, bound: 0.0 };
        let gathering = Gathering { lightcuts: self, pass, strategy, pixel };
        let mut walk = Some(Walk::new(ray, cone));
        while let Some(path) = walk {
            walk = gathering.step(path, randoms, counts, &mut sampled);
        }
        sampled
    }

    /// Share of a virtual light's contribution at a distance that the clamp takes away.
    fn compensation(&self, distance: f32) -> f32 {
        if !self.settings.compensation || distance >= self.clamp {
            return 0.0;
        }
        1.0 - distance * distance / (self.clamp * self.clamp)
    }
}

/// A sample at work.
struct Gathering<'a> {
    lightcuts: &'a Lightcuts<'a>,
    pass: &'a SamplePass<'a>,
    strategy: Strategy,
    pixel: u32,
}

impl Gathering<'_> {
    /// Takes a path to its next vertex; returns how it goes on from there.
    fn step(&self, mut walk: Walk, randoms: &mut Randoms, counts: &mut Counts, sampled: &mut Sampled) -> Option<Walk> {
        let SamplePass { scene, caustics, .. } = self.pass;
        let (vertex, ray) = (walk.vertex, walk.ray);
        let Some(hit) = scene.closest(&ray) else {
            let (light, pdf) = scene.environment_light(ray.direction);
            sampled.radiance.add(vertex, walk.rest * light * Before::weight(walk.before.as_ref(), |_| pdf));
            return None;
        };
        walk.matt += walk.compensated * self.lightcuts.compensation(hit.t);
        let [r0, r1, r2, mixed] = randoms.next();
        let at = scene.interaction(&ray, &hit, walk.cone, mixed);
        sampled.first.get_or_insert_with(|| FirstHit::new(&at, &ray, hit.t));
        if at.emitted != Vec3::ZERO {
            let weight = Before::weight(walk.before.as_ref(), |from| scene.light_pdf(from, &at, ray.direction, hit.t));
            sampled.radiance.add(vertex, walk.rest * at.emitted * weight);
        }
        let lobes = if walk.matt == Vec3::ZERO { ALL_LOBES & !MATT } else { ALL_LOBES };
        if lobes & lobes_of(&at.bsdf) == 0 || vertex + 1 == MAX_VERTICES {
            return None;
        }
        let lights = if walk.is_first { FIRST_LIGHTS } else { 1 };
        let direct = DirectLight { scene, at: &at, lobes, lights, before: walk.before.as_ref() };
        let random = || {
            let [u, v, choice, _] = randoms.next();
            [u, v, choice]
        };
        let direct = direct.estimate(random, counts, |direction| walk.value(scene, &at, direction));
        sampled.radiance.add(vertex + 1, direct);
        if let Some(caustics) = caustics {
            let light = caustics.gather(&at, |direction| walk.value(scene, &at, direction));
            sampled.radiance.add(vertex + 2, light);
        }
        let gathered = self.gather(&at, &walk, randoms, counts);
        sampled.radiance.add(vertex + 2, gathered.light);
        sampled.cut += gathered.size as f32;
        sampled.bound += gathered.bound;
        let drawn = Drawn { lobes, lights, random: [r0, r1, r2], has_photons: caustics.is_some() };
        let mut next = walk.scatter(scene, &at, hit.t, &drawn)?;
        if vertex + 1 >= SURE_VERTICES {
            let [survival, ..] = randoms.next();
            let survives = next.rest.max(next.matt + next.compensated).max_element().min(0.95);
            if survival >= survives {
                return None;
            }
            next.matt /= survives;
            next.rest /= survives;
            next.compensated /= survives;
        }
        counts.bounces += 1;
        Some(next)
    }

    /// Light of the virtual lights at a vertex.
    fn gather(&self, at: &Interaction, walk: &Walk, randoms: &mut Randoms, counts: &mut Counts) -> Gathered {
        let has = gathered_lobes(&at.bsdf);
        let matt = if has & MATT != 0 { walk.matt } else { Vec3::ZERO };
        let glossy = if has & GLOSSY != 0 { walk.rest } else { Vec3::ZERO };
        if matt == Vec3::ZERO && glossy == Vec3::ZERO {
            return Gathered::default();
        }
        let Lightcuts { tree, settings, clamp, references } = self.lightcuts;
        let receiver = Receiver::new(&self.pass.scene, at, matt, glossy, clamp * clamp);
        if !walk.is_first {
            let light = receiver.drawn(tree, DRAWN_LIGHTS, || randoms.next()[0], counts);
            return Gathered { light, ..Gathered::default() };
        }
        match self.strategy {
            Strategy::All => receiver.all(tree, counts),
            Strategy::Stochastic => {
                let light = receiver.drawn(tree, STOCHASTIC_LIGHTS, || randoms.next()[0], counts);
                Gathered { light, size: STOCHASTIC_LIGHTS, bound: 0.0 }
            }
            Strategy::Lightcuts | Strategy::LightcutsExhaustive | Strategy::Auto => {
                let Physical { cut_error, max_cut, .. } = **settings;
                let reference = references.get(self.pixel as usize).copied();
                HEAP.with_borrow_mut(|heap| receiver.cut(tree, cut_error, max_cut, reference, heap, counts))
            }
        }
    }
}

/// The lobes by which a material's virtual lights are gathered.
pub(crate) fn gathered_lobes(bsdf: &Bsdf) -> u32 {
    let is_wide = match bsdf.kind {
        PHONG => bsdf.exponent <= GREATEST_GATHERED_EXPONENT,
        CONDUCTOR | PLASTIC => bsdf.alpha >= LEAST_GATHERED_ALPHA,
        _ => false,
    };
    lobes_of(bsdf) & if is_wide { MATT | GLOSSY } else { MATT }
}

impl Walk {
    fn new(ray: Ray, cone: Cone) -> Self {
        Self {
            matt: Vec3::ONE,
            compensated: Vec3::ZERO,
            rest: Vec3::ONE,
            is_first: true,
            before: None,
            ray,
            cone,
            vertex: 0,
        }
    }

    /// BSDF times cosine, with both factors.
    fn value(&self, scene: &Scene<'_>, at: &Interaction, direction: Vec3) -> Vec3 {
        let tables = &scene.world.tables[..];
        let of = |lobes| at.scattered(tables, lobes, direction, Transport::Radiance);
        let matt = if self.matt == Vec3::ZERO { Vec3::ZERO } else { of(MATT) * self.matt };
        matt + of(GLOSSY) * self.rest
    }

    /// Goes on from a vertex in a drawn direction.
    fn scatter(&self, scene: &Scene<'_>, at: &Interaction, distance: f32, drawn: &Drawn) -> Option<Self> {
        let tables = &scene.world.tables[..];
        let Drawn { lobes, lights, random, has_photons } = *drawn;
        let sample = at.sample(tables, lobes, random, Transport::Radiance)?;
        let (is_focused, is_spread) = Before::course(self.before.as_ref(), at, sample.lobe, has_photons);
        let next = Self {
            matt: Vec3::ZERO,
            compensated: Vec3::ZERO,
            rest: Vec3::ZERO,
            is_first: self.is_first,
            before: Some(Before { at: *at, pdf: sample.pdf, lights, is_focused, is_spread }),
            ray: at.ray(sample.wi, f32::INFINITY),
            cone: if sample.pdf == 0.0 { self.cone.after(distance) } else { Cone::NONE },
            vertex: self.vertex + 1,
        };
        if sample.lobe == SPECULAR {
            let factor = self.rest * sample.weight;
            return (factor != Vec3::ZERO).then_some(Self { matt: factor, rest: factor, ..next });
        }
        let of = |lobes| at.scattered(tables, lobes, sample.wi, Transport::Radiance) / sample.pdf;
        let matt = if lobes & MATT != 0 { of(MATT) * self.matt } else { Vec3::ZERO };
        let glossy = of(GLOSSY) * self.rest;
        let is_gathered = gathered_lobes(&at.bsdf) & GLOSSY != 0;
        let (gathered, followed) = if is_gathered { (matt + glossy, Vec3::ZERO) } else { (matt, glossy) };
        let is_first = self.is_first && followed.max_element() > gathered.max_element();
        let rest = gathered + followed;
        (rest != Vec3::ZERO).then_some(Self { matt: followed, compensated: gathered, rest, is_first, ..next })
    }
}
