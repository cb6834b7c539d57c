//! Path tracing: the reference (Kajiya 1986), with light drawn at every vertex and weighed by multiple importance
//! sampling (Veach 1997).

use super::direct::{DirectLight, PrevVertex};
use super::pass::{SamplePass, Start};
use super::scene::{Cone, Interaction};
use super::sums::{Counts, FirstHit, Radiance};
use glam::Vec3;
use lightcuts_kernel::bsdf::{ALL_LOBES, SPECULAR, Transport};

/// Vertices after which paths end by chance.
const SURE_VERTICES: u32 = 4;

/// Vertices after which they end at all: no path of weight gets there.
pub(crate) const MAX_VERTICES: u32 = 4096;

/// The radiance against a camera ray, what it first met, and how much light is indirect.
pub(crate) fn trace_path(pass: &SamplePass<'_>, start: Start, counts: &mut Counts) -> (Radiance, Option<FirstHit>) {
    let SamplePass { scene, caustics, .. } = pass;
    let tables = &scene.world.tables[..];
    let Start { mut ray, mut cone, hit: mut next, mut randoms, .. } = start;
    let mut throughput = Vec3::ONE;
    let mut sum = Radiance::default();
    let mut first = None;
    let mut before: Option<PrevVertex> = None;
    for vertex in 0..MAX_VERTICES {
        let Some(hit) = next else {
            let (light, pdf) = scene.environment_light(ray.direction);
            sum.add(vertex, throughput * light * PrevVertex::weight(before.as_ref(), |_| pdf));
            break;
        };
        let [r0, r1, r2, r3] = randoms.next();
        let at = scene.interaction(&ray, &hit, cone, r3);
        first.get_or_insert_with(|| FirstHit::new(&at, &ray, hit.t));
        if at.emitted != Vec3::ZERO {
            let pdf = |from: &Interaction| scene.light_pdf(from, &at, ray.direction, hit.t);
            sum.add(vertex, throughput * at.emitted * PrevVertex::weight(before.as_ref(), pdf));
        }
        let point = randoms.next();
        let value = |direction| at.scattered(tables, ALL_LOBES, direction, Transport::Radiance);
        let direct = DirectLight { scene, at: &at, lobes: ALL_LOBES, before: before.as_ref() };
        let direct = direct.estimate([point], counts, value);
        sum.add(vertex + 1, throughput * direct);
        if let Some(caustics) = caustics {
            sum.add(vertex + 2, throughput * caustics.gather(&at, value));
        }
        let Some(sample) = at.sample(tables, ALL_LOBES, [r0, r1, r2], Transport::Radiance) else { break };
        throughput *= sample.weight;
        if vertex + 1 >= SURE_VERTICES {
            let survives = throughput.max_element().min(0.95);
            if point[3] >= survives {
                break;
            }
            throughput /= survives;
        }
        if throughput == Vec3::ZERO {
            break;
        }
        // Behind a diffuse vertex textures are looked up at points, as light paths do.
        cone = if sample.lobe == SPECULAR { cone.after(hit.t) } else { Cone::NONE };
        let (is_focused, has_diffuse_bounce) =
            PrevVertex::classify_bounce(before.as_ref(), &at, sample.lobe, caustics.is_some());
        before = Some(PrevVertex { at, pdf: sample.pdf, lights: 1, is_focused, has_diffuse_bounce });
        ray = at.ray(sample.wi, f32::INFINITY);
        next = scene.closest(&ray);
        counts.bounces += 1;
    }
    (sum, first)
}
