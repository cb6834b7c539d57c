//! Indirect light from the virtual lights of a pass.
//!
//! A vertex sends light on by matt lobes, which virtual lights stand for, and by others, which paths follow. So a path carries
//! two factors: one on what the next vertex sends by its matt lobes, one on the rest. Where a vertex gathers virtual lights
//! the first one is left with what the clamp of their distance takes away (Kollig & Keller 2004).

use super::cluster_tree::ClusterTree;
use super::direct::{Before, DirectLight};
use super::gather::{CutHeap, Gathered, Receiver};
use super::pass::{Counts, FirstHit, Sampled};
use super::path::{MAX_VERTICES, Radiance};
use super::randoms::Randoms;
use super::scene::{Cone, Interaction, Scene};
use crate::settings::{Physical, Strategy};
use glam::Vec3;
use lightcuts_kernel::bsdf::{ALL_LOBES, Bsdf, CONDUCTOR, GLOSSY, MATT, PHONG, PLASTIC, SPECULAR, Transport, lobes_of};
use lightcuts_kernel::ray::Ray;
use std::cell::RefCell;

/// Narrower lobes are followed by paths: too few virtual lights lie in them.
const LEAST_GATHERED_ALPHA: f32 = 0.15;
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
    pub(crate) strategy: Strategy,
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
    /// Factor on everything else that it sends.
    rest: Vec3,
    /// Whether no gathering vertex lies before it.
    is_first: bool,
    before: Option<Before>,
}

impl Lightcuts<'_> {
    /// The light against a camera ray.
    pub(crate) fn sample(
        &self,
        scene: &Scene<'_>,
        ray: Ray,
        cone: Cone,
        pixel: u32,
        randoms: &mut Randoms,
        counts: &mut Counts,
    ) -> Sampled {
        let (mut ray, mut cone) = (ray, cone);
        let mut sampled = Sampled { radiance: Radiance::default(), first: None, cut: 0.0, bound: 0.0 };
        let mut walk = Walk { matt: Vec3::ONE, rest: Vec3::ONE, is_first: true, before: None };
        // What a short ray may still give to matt vertices, before its length is known.
        let mut compensated = Vec3::ZERO;
        for vertex in 0..MAX_VERTICES {
            let Some(hit) = scene.closest(&ray) else {
                let (light, pdf) = scene.environment_light(ray.direction);
                sampled.radiance.add(vertex, walk.rest * light * Before::weight(walk.before.as_ref(), |_| pdf));
                break;
            };
            walk.matt += compensated * self.compensation(hit.t);
            let [r0, r1, r2, mixed] = randoms.next();
            let at = scene.interaction(&ray, &hit, cone, mixed);
            sampled.first.get_or_insert_with(|| FirstHit::new(&at, &ray, hit.t));
            if at.emitted != Vec3::ZERO {
                let weight =
                    Before::weight(walk.before.as_ref(), |from| scene.light_pdf(from, &at, ray.direction, hit.t));
                sampled.radiance.add(vertex, walk.rest * at.emitted * weight);
            }
            let lobes = if walk.matt == Vec3::ZERO { ALL_LOBES & !MATT } else { ALL_LOBES };
            if lobes & lobes_of(&at.bsdf) == 0 {
                break;
            }
            let lights = if walk.is_first { FIRST_LIGHTS } else { 1 };
            let direct = DirectLight { scene, at: &at, lobes, lights };
            let random = || {
                let [u, v, choice, _] = randoms.next();
                [u, v, choice]
            };
            let direct = direct.estimate(random, counts, |direction| walk.value(scene, &at, direction));
            sampled.radiance.add(vertex + 1, direct);
            let gathered = self.gather(scene, &at, &walk, pixel, randoms, counts);
            sampled.radiance.add(vertex + 2, gathered.light);
            sampled.cut += gathered.size as f32;
            sampled.bound += gathered.bound;
            let Some((next, left, direction)) = walk.scatter(scene, &at, lobes, lights, [r0, r1, r2]) else { break };
            (walk, compensated) = (next, left);
            if vertex + 1 >= SURE_VERTICES {
                let [survival, ..] = randoms.next();
                let survives = walk.rest.max(walk.matt + compensated).max_element().min(0.95);
                if survival >= survives {
                    break;
                }
                walk.matt /= survives;
                walk.rest /= survives;
                compensated /= survives;
            }
            cone = if walk.before.as_ref().is_some_and(|before| before.pdf == 0.0) {
                cone.after(hit.t)
            } else {
                Cone::NONE
            };
            ray = at.ray(direction, f32::INFINITY);
            counts.bounces += 1;
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

    /// Light of the virtual lights at a vertex.
    fn gather(
        &self,
        scene: &Scene<'_>,
        at: &Interaction,
        walk: &Walk,
        pixel: u32,
        randoms: &mut Randoms,
        counts: &mut Counts,
    ) -> Gathered {
        let has = gathered_lobes(&at.bsdf);
        let matt = if has & MATT != 0 { walk.matt } else { Vec3::ZERO };
        let glossy = if has & GLOSSY != 0 { walk.rest } else { Vec3::ZERO };
        if matt == Vec3::ZERO && glossy == Vec3::ZERO {
            return Gathered::default();
        }
        let receiver = Receiver::new(scene, at, matt, glossy, self.clamp * self.clamp);
        if !walk.is_first {
            let light = receiver.drawn(&self.tree, DRAWN_LIGHTS, || randoms.next()[0], counts);
            return Gathered { light, ..Gathered::default() };
        }
        match self.strategy {
            Strategy::All => receiver.all(&self.tree, counts),
            Strategy::Stochastic => {
                let light = receiver.drawn(&self.tree, STOCHASTIC_LIGHTS, || randoms.next()[0], counts);
                Gathered { light, size: STOCHASTIC_LIGHTS, bound: 0.0 }
            }
            Strategy::Lightcuts | Strategy::LightcutsExhaustive => {
                let Physical { cut_error, max_cut, .. } = *self.settings;
                let reference = self.references.get(pixel as usize).copied();
                HEAP.with_borrow_mut(|heap| receiver.cut(&self.tree, cut_error, max_cut, reference, heap, counts))
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
    /// BSDF times cosine, with both factors.
    fn value(&self, scene: &Scene<'_>, at: &Interaction, direction: Vec3) -> Vec3 {
        let tables = &scene.world.tables[..];
        let of = |lobes| at.scattered(tables, lobes, direction, Transport::Radiance);
        let matt = if self.matt == Vec3::ZERO { Vec3::ZERO } else { of(MATT) * self.matt };
        matt + of(GLOSSY) * self.rest
    }

    /// Goes on in a drawn direction; with what a short ray may give to matt lobes besides.
    fn scatter(
        &self,
        scene: &Scene<'_>,
        at: &Interaction,
        lobes: u32,
        lights: u32,
        random: [f32; 3],
    ) -> Option<(Self, Vec3, Vec3)> {
        let tables = &scene.world.tables[..];
        let sample = at.sample(tables, lobes, random, Transport::Radiance)?;
        let before = Some(Before { at: *at, pdf: sample.pdf, lights });
        if sample.lobe == SPECULAR {
            let factor = self.rest * sample.weight;
            let next = Self { matt: factor, rest: factor, is_first: self.is_first, before };
            return (factor != Vec3::ZERO).then_some((next, Vec3::ZERO, sample.wi));
        }
        let of = |lobes| at.scattered(tables, lobes, sample.wi, Transport::Radiance) / sample.pdf;
        let matt = if lobes & MATT != 0 { of(MATT) * self.matt } else { Vec3::ZERO };
        let glossy = of(GLOSSY) * self.rest;
        let is_gathered = gathered_lobes(&at.bsdf) & GLOSSY != 0;
        let (gathered, followed) = if is_gathered { (matt + glossy, Vec3::ZERO) } else { (matt, glossy) };
        let is_first = self.is_first && followed.max_element() > gathered.max_element();
        let next = Self { matt: followed, rest: gathered + followed, is_first, before };
        (next.rest != Vec3::ZERO).then_some((next, gathered, sample.wi))
    }
}
