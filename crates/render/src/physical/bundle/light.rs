//! What a light sends to eight points.

use super::Bundle;
use super::vectors::{Wide3, add, divided, dot, loaded, product, scaled, splat3, stored, sub};
use crate::cpu::{Lanes, RayLanes};
use crate::physical::sums::Counts;
use glam::Vec3;
use lightcuts_kernel::ray::NONE;
use lightcuts_kernel::rounding::{APPROACH, REACH};
use lightcuts_kernel::virtual_light::{LEAST_COSINE, VirtualLight, shading_normal, virtual_emission};
use lightcuts_world::bvh::LANES;

impl Bundle<'_> {
    /// What a light sends to each point.
    #[inline(always)]
    pub(super) fn light<L: Lanes>(&self, light: &VirtualLight, counts: &mut Counts) -> Wide3<L> {
        let zero = L::splat(0.0);
        let sent: Wide3<L> = if self.is_lambert { self.unshadowed(light) } else { self.unshadowed_each(light) };
        let asked = sent[0].max(sent[1]).max(sent[2]).greater(zero).bits() & self.asked();
        if asked == 0 {
            return [zero; 3];
        }
        counts.shadow += u64::from(asked.count_ones());
        let visible = L::mask(self.visible::<L>(light, asked));
        [sent[0].and(visible), sent[1].and(visible), sent[2].and(visible)]
    }

    /// What a light sends if nothing is between, to points of Lambert's material; twin of [`Receiver::unshadowed`].
    #[inline(always)]
    fn unshadowed<L: Lanes>(&self, light: &VirtualLight) -> Wide3<L> {
        let zero = L::splat(0.0);
        let to_light: Wide3<L> = sub(splat3(light.position), loaded(&self.point));
        let distance_sq = dot(to_light, to_light);
        let distance = distance_sq.sqrt();
        let direction = divided(to_light, distance);
        let cos_light = zero - dot(splat3(light.normal), direction);
        let cos = dot(loaded(&self.normals[0]), direction);
        let cos_face = dot(loaded(&self.face), direction);
        let mut facing = cos_light.min(cos).min(cos_face);
        if light.is_bent != 0 {
            facing = facing.min(zero - dot(splat3(shading_normal(light)), direction));
        }
        let emitted = if light.table == NONE {
            cos_light
        } else {
            let direction = stored(direction);
            let tables = &self.receivers[0].scene.world.tables[..];
            let each = |lane: usize| -Vec3::new(direction[0][lane], direction[1][lane], direction[2][lane]);
            L::load(&std::array::from_fn(|lane| virtual_emission(light, tables, each(lane))))
        };
        let clamped = distance_sq.max(L::splat(self.receivers[0].bound.clamp_sq));
        let geometry = (emitted / clamped).and(facing.greater(L::splat(LEAST_COSINE)));
        let color: Wide3<L> = loaded(&self.color);
        scaled(product(scaled(color, cos), splat3(light.intensity)), geometry)
    }

    /// The same one by one, for points of any material.
    #[inline(always)]
    fn unshadowed_each<L: Lanes>(&self, light: &VirtualLight) -> Wide3<L> {
        let mut sent = [[0.0; LANES]; 3];
        for (lane, receiver) in self.receivers[..self.count].iter().enumerate() {
            let light = receiver.unshadowed(light);
            (0..3).for_each(|axis| sent[axis][lane] = light[axis]);
        }
        loaded(&sent)
    }

    /// Which of the points in `asked`, a bit each, see a place; twin of `Interaction::ray_to`.
    #[inline(always)]
    fn visible<L: Lanes>(&self, light: &VirtualLight, asked: u32) -> u32 {
        let scene = self.receivers[0].scene;
        if scene.world.has_masks {
            let is_free = |lane: &usize| {
                asked >> lane & 1 == 1 && scene.is_free(&self.receivers[*lane].at.ray_to(light.position, light.normal))
            };
            return (0..self.count).filter(is_free).fold(0, |bits, lane| bits | 1 << lane);
        }
        let place = splat3(light.position);
        let way: Wide3<L> = sub(place, loaded(&self.point));
        let is_behind = L::splat(0.0).greater(dot(loaded(&self.face), way));
        let (front, back): (Wide3<L>, Wide3<L>) = (loaded(&self.front), loaded(&self.back));
        let origin: Wide3<L> = std::array::from_fn(|axis| L::select(is_behind, back[axis], front[axis]));
        let rise = dot(way, way).sqrt() * L::splat(APPROACH);
        let direction = sub(add(place, scaled(splat3(light.normal), rise)), origin);
        let rays = RayLanes { origin: stored(origin), direction: stored(direction), t_max: [REACH; LANES] };
        asked & !scene.occluded_lanes(&rays, asked)
    }
}
