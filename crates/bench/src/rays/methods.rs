//! The tracers that are compared.

use super::batches::Batch;
use super::embree::Embree;
use crate::room::{HALF, Room, walls};
use anyhow::Result;
use glam::Vec3;
use lightcuts::Simd;
use lightcuts::device::Tracer;
use lightcuts_kernel::Rules;
use lightcuts_kernel::ray::Ray;
use obvhs::BvhBuildParams;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as ObvhsRay, RayHit};
use obvhs::triangle::Triangle;
use rayon::prelude::*;
use std::path::Path;
use std::time::Duration;

/// Rays that a thread takes at once: whole packets.
const GRAIN: usize = 1024;

/// A way to trace a batch.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Method {
    /// The compressed hierarchy of obvhs with its own traversal and triangles.
    Obvhs,
    /// Embree 4, ray by ray.
    Embree,
    /// Embree 4, eight rays at a time.
    EmbreePackets,
    /// Ours, ray by ray.
    Single,
    /// Ours, eight rays at a time.
    Packets,
}

impl Method {
    pub(super) fn title(self) -> &'static str {
        match self {
            Self::Obvhs => "obvhs CwBvh",
            Self::Embree => "Embree",
            Self::EmbreePackets => "Embree, packets of 8",
            Self::Single => "single",
            Self::Packets => "packets of 8",
        }
    }

    /// Whether it is ours: then answers are the same to the bit.
    pub(super) fn is_ours(self) -> bool {
        matches!(self, Self::Single | Self::Packets)
    }

    /// What each ray finds: 1 for a hit and 0 for none where any will do, else the parameter of the nearest.
    pub(super) fn trace(self, room: &Room, reference: &Reference, batch: &Batch) -> Vec<f32> {
        let tracer = Tracer::new(room.world.shapes.geometry(), Rules::Repaired, Simd::Auto);
        let mut found = vec![0.0; batch.rays.len()];
        found.par_chunks_mut(GRAIN).zip(batch.rays.par_chunks(GRAIN)).for_each(|(found, rays)| {
            match (self, batch.is_any) {
                (Self::Obvhs, true) => fill(found, rays, |ray| of_hit(reference.is_hit(ray))),
                (Self::Obvhs, false) => fill(found, rays, |ray| reference.nearest(ray)),
                (Self::Embree, true) => fill(found, rays, |ray| of_hit(reference.embree().is_hit(ray))),
                (Self::Embree, false) => fill(found, rays, |ray| reference.embree().nearest(ray)),
                (Self::EmbreePackets, true) => fill_eight(found, rays, |rays| reference.embree().are_hits(rays)),
                (Self::EmbreePackets, false) => {
                    fill_eight(found, rays, |rays| reference.embree().nearest_of_eight(rays));
                }
                (Self::Single, true) => fill(found, rays, |ray| of_hit(tracer.occluded(ray))),
                (Self::Single, false) => fill(found, rays, |ray| tracer.closest(ray).t),
                (Self::Packets, true) => fill_eight(found, rays, |rays| {
                    let hits = tracer.occluded8(rays, u8::MAX);
                    std::array::from_fn(|lane| of_hit(hits >> lane & 1 == 1))
                }),
                (Self::Packets, false) => fill_eight(found, rays, |rays| tracer.closest8(rays).map(|hit| hit.t)),
            }
        });
        found
    }
}

fn of_hit(is_hit: bool) -> f32 {
    f32::from(u8::from(is_hit))
}

fn fill(found: &mut [f32], rays: &[Ray], trace: impl Fn(&Ray) -> f32) {
    found.iter_mut().zip(rays).for_each(|(found, ray)| *found = trace(ray));
}

fn fill_eight(found: &mut [f32], rays: &[Ray], trace: impl Fn(&[Ray; 8]) -> [f32; 8]) {
    let packets = rays.as_chunks().0;
    found.as_chunks_mut().0.iter_mut().zip(packets).for_each(|(found, rays)| *found = trace(rays));
}

/// The room as others have it, its walls of two triangles each.
pub(super) struct Reference {
    hierarchy: CwBvh,
    /// In the order of the leaves.
    triangles: Vec<Triangle>,
    embree: Option<Embree>,
}

impl Reference {
    /// With Embree where its library is.
    pub(super) fn new(room: &Room, embree: Option<&Path>) -> Result<Self> {
        let all = triangles(room);
        let corner = |p: Vec3| p.to_array().into();
        let triangle = |&[a, b, c]: &[Vec3; 3]| Triangle { v0: corner(a), v1: corner(b), v2: corner(c) };
        let of_obvhs: Vec<Triangle> = all.iter().map(triangle).collect();
        // The presets' split triangles are no better here, where all are small or axis-parallel.
        let params = BvhBuildParams { pre_split: false, ..BvhBuildParams::slow_build() };
        let hierarchy = build_cwbvh_from_tris(&of_obvhs, params, &mut Duration::default());
        let triangles = hierarchy.primitive_indices.iter().map(|&index| of_obvhs[index as usize]).collect();
        let embree = embree.map(|library| Embree::open(library, &all)).transpose()?;
        Ok(Self { hierarchy, triangles, embree })
    }

    /// What can be measured of a kind of rays, the others first.
    pub(super) fn methods(&self, with_packets: bool) -> Vec<Method> {
        let all = [Method::Obvhs, Method::Embree, Method::EmbreePackets, Method::Single, Method::Packets];
        let is_there = |method: &Method| match method {
            Method::Obvhs | Method::Single => true,
            Method::Packets => with_packets,
            Method::Embree => self.embree.is_some(),
            Method::EmbreePackets => self.embree.is_some() && with_packets,
        };
        all.into_iter().filter(is_there).collect()
    }

    fn embree(&self) -> &Embree {
        self.embree.as_ref().expect("Embree is measured where it is there")
    }

    fn ray(ray: &Ray) -> ObvhsRay {
        ObvhsRay::new(ray.origin.to_array().into(), ray.direction.to_array().into(), ray.t_min, ray.t_max)
    }

    fn is_hit(&self, ray: &Ray) -> bool {
        !self.hierarchy.ray_traverse_miss(Self::ray(ray), |ray, index| self.triangles[index].intersect(ray))
    }

    fn nearest(&self, ray: &Ray) -> f32 {
        let mut hit = RayHit::none();
        self.hierarchy.ray_traverse(Self::ray(ray), &mut hit, |ray, index| self.triangles[index].intersect(ray));
        hit.t
    }
}

/// The body's triangles and two for each wall.
fn triangles(room: &Room) -> Vec<[Vec3; 3]> {
    let walls = walls().into_iter().flat_map(|[inwards, across, along]| {
        let at = |i: f32, j: f32| (across * i + along * j - inwards) * HALF;
        let [a, b, c, d] = [at(-1.0, -1.0), at(1.0, -1.0), at(1.0, 1.0), at(-1.0, 1.0)];
        [[a, b, c], [a, c, d]]
    });
    room.triangles.iter().copied().chain(walls).collect()
}
