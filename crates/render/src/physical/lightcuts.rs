//! Indirect light from the virtual lights of a pass.
//!
//! A vertex sends light on by diffuse lobes, which virtual lights stand for, and by others, which paths follow. So a path
//! carries two factors: one on what the next vertex sends by its diffuse lobes, one on the rest. Where a vertex gathers
//! virtual lights the first one is left with what the clamp of their distance takes away (Kollig & Keller 2004).

use super::bundle::{Bundle, Clusters, Cutting, Fineness};
use super::cluster_tree::ClusterTree;
use super::direct::{DirectLight, PrevVertex};
use super::gather::{CutHeap, Gathered, Receiver};
use super::pass::{SamplePass, Start};
use super::path::MAX_VERTICES;
use super::randoms::Randoms;
use super::scene::{Cone, Interaction, Scene};
use super::sums::{Counts, FirstHit, Radiance, Sampled};
use crate::settings::{Physical, Strategy};
use glam::Vec3;
use lightcuts_kernel::bsdf::{
    ALL_LOBES, Bsdf, CONDUCTOR, DIFFUSE, GLOSSY, PHONG, PLASTIC, SPECULAR, Transport, lobes_of,
};
use lightcuts_kernel::ray::{Hit, Ray};
use lightcuts_world::bvh::LANES;
use std::cell::RefCell;

/// Narrower lobes are followed by paths: too few virtual lights lie in them.
pub(crate) const LEAST_GATHERED_ALPHA: f32 = 0.15;
/// The same of Phong's.
const GREATEST_GATHERED_EXPONENT: f32 = 60.0;

/// Lights that are drawn at a vertex that gathers a whole cut: its share of the time is small.
const FIRST_LIGHTS: u32 = 4;

/// Lights that are drawn at a vertex with a glossy lobe: the fewer, the more is left to rays that meet a light by
/// chance, which is where single pixels come out too bright.
const GLOSSY_LIGHTS: u32 = 8;

/// Virtual lights that are drawn where a path comes to its second diffuse vertex.
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

/// A point of a sample at which the virtual lights are still to be gathered.
pub(crate) struct Pending {
    /// Place of the sample among those that are taken together.
    slot: usize,
    pixel: u32,
    /// Surfaces before it.
    vertex: u32,
    at: Interaction,
    /// Factors on what its diffuse and its glossy lobes send.
    diffuse: Vec3,
    glossy: Vec3,
}

impl Pending {
    fn receiver<'a>(&'a self, scene: &'a Scene<'a>, clamp: f32) -> Receiver<'a> {
        Receiver::new(scene, &self.at, self.diffuse, self.glossy, clamp * clamp)
    }
}

#[derive(Default)]
struct Heaps {
    single: CutHeap,
    bundle: Clusters,
}

thread_local! {
    static HEAPS: RefCell<Heaps> = RefCell::default();
}

/// A path on its way.
struct Walk {
    /// Factor on what the next vertex sends by its diffuse lobes.
    diffuse: Vec3,
    /// The same that a short ray may give back, before its length is known.
    compensated: Vec3,
    /// Factor on everything else that it sends.
    rest: Vec3,
    /// Whether no gathering vertex lies before it.
    is_first: bool,
    before: Option<PrevVertex>,
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
    /// The light against a camera ray, with VPLs that a strategy gathers; points whose light is a sum over all of them
    /// or over a cut are left in `pending`.
    pub(crate) fn sample(
        &self,
        pass: &SamplePass<'_>,
        strategy: Strategy,
        start: Start,
        pending: &mut Vec<Pending>,
        counts: &mut Counts,
    ) -> Sampled {
        let Start { ray, cone, hit: mut next, mut randoms, slot, pixel } = start;
        let mut sampled = Sampled { radiance: Radiance::default(), first: None, cut: 0.0, bound: 0.0 };
        let gathering = Gathering { lightcuts: self, pass, strategy, slot, pixel };
        let mut walk = Walk::new(ray, cone);
        while let Some(further) = gathering.step(walk, next, &mut randoms, pending, counts, &mut sampled) {
            next = pass.scene.closest(&further.ray);
            walk = further;
        }
        sampled
    }

    /// Adds the light of the virtual lights at points that samples have left. Points of Lambert's material are computed
    /// with one another, which is quicker.
    pub(crate) fn gather(
        &self,
        scene: &Scene<'_>,
        strategy: Strategy,
        pending: &[Pending],
        sampled: &mut [Sampled],
        counts: &mut Counts,
    ) {
        for is_lambert in [true, false] {
            let points: Vec<&Pending> = pending.iter().filter(|p| Bundle::is_lambert(&p.at) == is_lambert).collect();
            for points in points.chunks(LANES) {
                let receivers: Vec<Receiver<'_>> = points.iter().map(|p| p.receiver(scene, self.clamp)).collect();
                let gathered = self.gather_together(strategy, points, &receivers, counts);
                for (point, gathered) in points.iter().zip(gathered) {
                    let sampled = &mut sampled[point.slot];
                    sampled.radiance.add(point.vertex + 2, gathered.light);
                    sampled.cut += gathered.size as f32;
                    sampled.bound += gathered.bound;
                }
            }
        }
    }

    /// The light at up to eight points; one alone goes the plain way.
    fn gather_together(
        &self,
        strategy: Strategy,
        points: &[&Pending],
        receivers: &[Receiver<'_>],
        counts: &mut Counts,
    ) -> [Gathered; LANES] {
        let Self { tree, settings, references, .. } = self;
        let fineness = Fineness { error: settings.cut_error, max_cut: settings.max_cut };
        let reference = |point: &Pending| references.get(point.pixel as usize).copied();
        match (receivers, strategy) {
            ([receiver], Strategy::All) => [receiver.all(tree, counts); LANES],
            (_, Strategy::All) => Bundle::new(receivers).all(tree, counts),
            ([receiver], _) => HEAPS.with_borrow_mut(|heaps| {
                [receiver.cut(tree, fineness, reference(points[0]), &mut heaps.single, counts); LANES]
            }),
            _ => {
                let known = |lane: usize| reference(points[lane.min(points.len() - 1)]).unwrap_or_default();
                let references = (!references.is_empty()).then(|| std::array::from_fn(known));
                let (bundle, cutting) = (Bundle::new(receivers), Cutting { tree, fineness, references });
                HEAPS.with_borrow_mut(|heaps| bundle.cut(&cutting, &mut heaps.bundle, counts))
            }
        }
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
    slot: usize,
    pixel: u32,
}

impl Gathering<'_> {
    /// Takes a path to its next vertex, which its ray has hit; returns how it goes on from there.
    fn step(
        &self,
        mut walk: Walk,
        hit: Option<Hit>,
        randoms: &mut Randoms,
        pending: &mut Vec<Pending>,
        counts: &mut Counts,
        sampled: &mut Sampled,
    ) -> Option<Walk> {
        let SamplePass { scene, caustics, .. } = self.pass;
        let (vertex, ray) = (walk.vertex, walk.ray);
        let Some(hit) = hit else {
            let (light, pdf) = scene.environment_light(ray.direction);
            sampled.radiance.add(vertex, walk.rest * light * PrevVertex::weight(walk.before.as_ref(), |_| pdf));
            return None;
        };
        walk.diffuse += walk.compensated * self.lightcuts.compensation(hit.t);
        let [r0, r1, r2, mixed] = randoms.next();
        let at = scene.interaction(&ray, &hit, walk.cone, mixed);
        sampled.first.get_or_insert_with(|| FirstHit::new(&at, &ray, hit.t));
        if at.emitted != Vec3::ZERO {
            let weight =
                PrevVertex::weight(walk.before.as_ref(), |from| scene.light_pdf(from, &at, ray.direction, hit.t));
            sampled.radiance.add(vertex, walk.rest * at.emitted * weight);
        }
        let lobes = if walk.diffuse == Vec3::ZERO { ALL_LOBES & !DIFFUSE } else { ALL_LOBES };
        if lobes & lobes_of(&at.bsdf) == 0 || vertex + 1 == MAX_VERTICES {
            return None;
        }
        let is_glossy = lobes & lobes_of(&at.bsdf) & GLOSSY != 0;
        let lights = if is_glossy {
            GLOSSY_LIGHTS
        } else if walk.is_first {
            FIRST_LIGHTS
        } else {
            1
        };
        let direct = DirectLight { scene, at: &at, lobes, before: walk.before.as_ref() };
        let value = |direction| walk.value(scene, &at, direction);
        let mut point = |_| randoms.next();
        let direct = match lights {
            GLOSSY_LIGHTS => direct.estimate::<{ GLOSSY_LIGHTS as usize }>(std::array::from_fn(point), counts, value),
            FIRST_LIGHTS => direct.estimate::<{ FIRST_LIGHTS as usize }>(std::array::from_fn(point), counts, value),
            _ => direct.estimate([point(0)], counts, value),
        };
        sampled.radiance.add(vertex + 1, direct);
        if let Some(caustics) = caustics {
            let light = caustics.gather(&at, |direction| walk.value(scene, &at, direction));
            sampled.radiance.add(vertex + 2, light);
        }
        self.gather(&at, &walk, randoms, pending, counts, sampled);
        let drawn = Drawn { lobes, lights, random: [r0, r1, r2], has_photons: caustics.is_some() };
        let mut next = walk.scatter(scene, &at, hit.t, &drawn)?;
        if vertex + 1 >= SURE_VERTICES {
            let [survival, ..] = randoms.next();
            let survives = next.rest.max(next.diffuse + next.compensated).max_element().min(0.95);
            if survival >= survives {
                return None;
            }
            next.diffuse /= survives;
            next.rest /= survives;
            next.compensated /= survives;
        }
        counts.bounces += 1;
        Some(next)
    }

    /// Adds light of virtual lights that are drawn at a vertex, or leaves the vertex to [`Lightcuts::gather`].
    fn gather(
        &self,
        at: &Interaction,
        walk: &Walk,
        randoms: &mut Randoms,
        pending: &mut Vec<Pending>,
        counts: &mut Counts,
        sampled: &mut Sampled,
    ) {
        let has = gathered_lobes(&at.bsdf);
        let diffuse = if has & DIFFUSE != 0 { walk.diffuse } else { Vec3::ZERO };
        let glossy = if has & GLOSSY != 0 { walk.rest } else { Vec3::ZERO };
        if diffuse == Vec3::ZERO && glossy == Vec3::ZERO {
            return;
        }
        let Self { lightcuts: Lightcuts { tree, clamp, .. }, slot, pixel, .. } = *self;
        let drawn = match self.strategy {
            _ if !walk.is_first => DRAWN_LIGHTS,
            Strategy::Stochastic => STOCHASTIC_LIGHTS,
            _ => {
                pending.push(Pending { slot, pixel, vertex: walk.vertex, at: *at, diffuse, glossy });
                return;
            }
        };
        let receiver = Receiver::new(&self.pass.scene, at, diffuse, glossy, clamp * clamp);
        let light = receiver.drawn(tree, drawn, || randoms.next()[0], counts);
        sampled.radiance.add(walk.vertex + 2, light);
        if walk.is_first {
            sampled.cut += drawn as f32;
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
    lobes_of(bsdf) & if is_wide { DIFFUSE | GLOSSY } else { DIFFUSE }
}

impl Walk {
    fn new(ray: Ray, cone: Cone) -> Self {
        Self {
            diffuse: Vec3::ONE,
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
        let diffuse = if self.diffuse == Vec3::ZERO { Vec3::ZERO } else { of(DIFFUSE) * self.diffuse };
        diffuse + of(GLOSSY) * self.rest
    }

    /// Goes on from a vertex in a drawn direction.
    fn scatter(&self, scene: &Scene<'_>, at: &Interaction, distance: f32, drawn: &Drawn) -> Option<Self> {
        let tables = &scene.world.tables[..];
        let Drawn { lobes, lights, random, has_photons } = *drawn;
        let sample = at.sample(tables, lobes, random, Transport::Radiance)?;
        let (is_focused, has_diffuse_bounce) =
            PrevVertex::classify_bounce(self.before.as_ref(), at, sample.lobe, has_photons);
        let next = Self {
            diffuse: Vec3::ZERO,
            compensated: Vec3::ZERO,
            rest: Vec3::ZERO,
            is_first: self.is_first,
            before: Some(PrevVertex { at: *at, pdf: sample.pdf, lights, is_focused, has_diffuse_bounce }),
            ray: at.ray(sample.wi, f32::INFINITY),
            cone: if sample.pdf == 0.0 { self.cone.after(distance) } else { Cone::NONE },
            vertex: self.vertex + 1,
        };
        if sample.lobe == SPECULAR {
            let factor = self.rest * sample.weight;
            return (factor != Vec3::ZERO).then_some(Self { diffuse: factor, rest: factor, ..next });
        }
        let of = |lobes| at.scattered(tables, lobes, sample.wi, Transport::Radiance) / sample.pdf;
        let diffuse = if lobes & DIFFUSE != 0 { of(DIFFUSE) * self.diffuse } else { Vec3::ZERO };
        let glossy = of(GLOSSY) * self.rest;
        let is_gathered = gathered_lobes(&at.bsdf) & GLOSSY != 0;
        let (gathered, followed) = if is_gathered { (diffuse + glossy, Vec3::ZERO) } else { (diffuse, glossy) };
        let is_first = self.is_first && followed.max_element() > gathered.max_element();
        let rest = gathered + followed;
        (rest != Vec3::ZERO).then_some(Self { diffuse: followed, compensated: gathered, rest, is_first, ..next })
    }
}
