//! Clusters of virtual lights, and how much one may send to a point at most (Walter et al. 2005, "Lightcuts").

use crate::bsdf::{Bsdf, CONDUCTOR, DIFFUSE, GLOSSY, PHONG, PLASTIC, energy_at, lobes_of, mean_energy};
use crate::ggx::ggx_distribution;
use crate::power::power;
use crate::sampling::frame;
use bytemuck::{Pod, Zeroable};
use glam::Vec3;
use std::f32::consts::PI;

/// Bit of a child that is a light, not a cluster.
pub const LIGHT_CHILD: u32 = 1 << 31;

/// Margin of bounds above the rounding errors of their terms.
pub const BOUND_MARGIN: f32 = 1.0 + 1e-4;

/// A cluster of two children. 64 bytes.
#[repr(C)]
#[derive(Debug, Clone, Copy, PartialEq, Pod, Zeroable)]
pub struct ClusterNode {
    /// Lower corner of a box around its lights.
    pub lower: Vec3,
    /// First child: a cluster, or with [`LIGHT_CHILD`] a light.
    pub left: u32,
    /// Upper corner.
    pub upper: Vec3,
    /// Second child.
    pub right: u32,
    /// Unit axis of a cone around its lights' normals.
    pub axis: Vec3,
    /// Cosine of the cone's half angle.
    pub cos_cone: f32,
    /// Sum of its lights' [`light_power`]s.
    pub power: f32,
    /// The light that stands for it.
    pub representative: u32,
    /// Unused.
    pub padding: [u32; 2],
}

/// What errors of clusters are measured by: the sum of the channels of a light's intensity.
pub fn light_power(intensity: Vec3) -> f32 {
    intensity.x + intensity.y + intensity.z
}

/// Who is lit: bounds hold for its material, seen from one direction.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BoundReceiver {
    /// Position.
    pub point: Vec3,
    /// Unit normal for shading, on the side of the viewer.
    pub normal: Vec3,
    /// The viewer's direction, mirrored about the normal.
    pub mirror: Vec3,
    /// Squared distance below which light is clamped.
    pub clamp_sq: f32,
    /// The material, as the viewer sees it.
    pub bsdf: BsdfBound,
}

/// The least squared distance from the origin to a box.
pub fn box_distance_sq(center: Vec3, half: Vec3) -> f32 {
    let outside = (center.abs() - half).max(Vec3::ZERO);
    outside.length_squared()
}

/// The greatest cosine, at least 0, between a unit axis at the origin and a point of a box.
///
/// In a frame whose third axis is the given one the box lies in an interval for each coordinate; the cosine grows with
/// the third and falls with the size of the others.
pub fn box_cosine(axis: Vec3, center: Vec3, half: Vec3) -> f32 {
    let along = |unit: Vec3| (unit.dot(center), unit.abs().dot(half));
    let (z, reach) = along(axis);
    let z_max = z + reach;
    if z_max <= 0.0 {
        return 0.0;
    }
    let (tangent, bitangent) = frame(axis);
    let least = |unit: Vec3| {
        let (c, reach) = along(unit);
        (c.abs() - reach).max(0.0)
    };
    let (x, y) = (least(tangent), least(bitangent));
    (z_max / (x * x + y * y + z_max * z_max).sqrt()).min(1.0)
}

/// The greatest cosine to any axis of a cone, where that to its middle is at most `cos`.
pub fn widened_cosine(cos: f32, cos_cone: f32) -> f32 {
    if cos >= cos_cone {
        return 1.0;
    }
    let sin = |c: f32| (1.0 - c * c).max(0.0).sqrt();
    (cos * cos_cone + sin(cos) * sin(cos_cone)).clamp(0.0, 1.0)
}

/// What bounds the greatest channel of a BSDF times the cosine, seen from one direction: the terms that are the same
/// for all clusters.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct BsdfBound {
    /// Factor on the cosine to the normal.
    pub even: f32,
    /// Factor on the distribution of facets; 0 without.
    pub facets: f32,
    /// Roughness of the facets; 1 without.
    pub alpha: f32,
    /// Factor on a Phong lobe times the cosine to the normal; 0 without.
    pub lobe: f32,
    /// The lobe's exponent.
    pub exponent: f32,
}

/// The bound of a BSDF seen under a cosine. `weights` are factors on its diffuse and on its glossy lobes.
pub fn bsdf_bound(bsdf: &Bsdf, tables: &[f32], weights: [f32; 2], cos_o: f32) -> BsdfBound {
    let lobes = lobes_of(bsdf);
    let lost = || 1.0 - energy_at(tables, bsdf.table, false, cos_o);
    let mean_lost = || (1.0 - mean_energy(tables, bsdf.table, false)).max(1e-4);
    let mut bound = BsdfBound { even: 0.0, facets: 0.0, alpha: 1.0, lobe: 0.0, exponent: 1.0 };
    if lobes & DIFFUSE != 0 && weights[0] > 0.0 {
        let coat = if bsdf.kind == PLASTIC { lost() / mean_lost() } else { 1.0 };
        bound.even = weights[0] * bsdf.diffuse.max_element() * coat * (1.0 / PI);
    }
    if lobes & GLOSSY == 0 || weights[1] <= 0.0 {
        return bound;
    }
    if bsdf.kind == PHONG {
        bound.lobe = weights[1] * bsdf.specular.max_element() * (bsdf.exponent + 2.0) / (2.0 * PI);
        bound.exponent = bsdf.exponent;
    }
    if bsdf.kind == CONDUCTOR || bsdf.kind == PLASTIC {
        // F and G are at most 1.
        bound.facets = weights[1] / (4.0 * cos_o.max(1e-6));
        bound.alpha = bsdf.alpha;
    }
    if bsdf.kind == CONDUCTOR {
        bound.even += weights[1] * lost().max(0.0) / (PI * mean_lost());
    }
    bound
}

/// Whether a bound goes by the mirror direction, too.
pub fn is_shiny(bound: &BsdfBound) -> bool {
    bound.facets > 0.0 || bound.lobe > 0.0
}

/// An upper bound of the greatest channel times the cosine, over directions of which the cosines to the normal and to
/// the mirror direction are at most the given ones.
pub fn greatest_bsdf(bound: &BsdfBound, cos_normal: f32, cos_mirror: f32) -> f32 {
    let mut greatest = bound.even * cos_normal;
    if bound.facets > 0.0 {
        // Two half turns, about the normal and about the half vector, turn the mirror direction into the light's by
        // twice the angle between both at most; the distribution falls with that angle.
        let cos_half = (0.5 + 0.5 * cos_mirror).sqrt();
        greatest += bound.facets * ggx_distribution(cos_half, bound.alpha);
    }
    if bound.lobe > 0.0 {
        greatest += bound.lobe * power(cos_mirror, bound.exponent) * cos_normal;
    }
    greatest
}

/// How much a cluster may matter: an upper bound of its light but for the distance, and between which squared distances
/// its lights are.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ClusterReach {
    /// Light, as a sum of channels, at a distance of 1 at most.
    pub factor: f32,
    /// Squared distance of the nearest corner of its box, at least that of the clamp; 0 from within without one.
    pub nearest_sq: f32,
    /// Squared distance of the farthest corner, at least that of the clamp.
    pub farthest_sq: f32,
}

/// What a cluster may send.
pub fn cluster_reach(node: &ClusterNode, receiver: &BoundReceiver) -> ClusterReach {
    let half = (node.upper - node.lower) * 0.5;
    let center = (node.upper + node.lower) * 0.5 - receiver.point;
    let nearest_sq = box_distance_sq(center, half).max(receiver.clamp_sq);
    let farthest_sq = (center.abs() + half).length_squared().max(receiver.clamp_sq);
    let nothing = ClusterReach { factor: 0.0, nearest_sq, farthest_sq };
    let emitted = widened_cosine(box_cosine(node.axis, -center, half), node.cos_cone);
    if emitted <= 0.0 {
        return nothing;
    }
    let cos_normal = box_cosine(receiver.normal, center, half);
    if cos_normal <= 0.0 {
        return nothing;
    }
    let cos_mirror = if is_shiny(&receiver.bsdf) { box_cosine(receiver.mirror, center, half) } else { 0.0 };
    ClusterReach { factor: node.power * greatest_bsdf(&receiver.bsdf, cos_normal, cos_mirror) * emitted, ..nothing }
}

/// At most so much light, as a sum of channels, comes from a cluster.
pub fn reach_bound(reach: &ClusterReach) -> f32 {
    reach.factor / reach.nearest_sq.max(f32::MIN_POSITIVE) * BOUND_MARGIN
}

/// The probability with which the first of two clusters is drawn; `None` if neither sends anything. The mean of what
/// their nearest and what their farthest corners suggest: the nearest alone would favour a large box near by (Yuksel
/// 2019, "Stochastic Lightcuts", section 3.2).
pub fn first_probability(first: &ClusterReach, second: &ClusterReach) -> Option<f32> {
    if first.factor <= 0.0 || second.factor <= 0.0 {
        let is_any = first.factor + second.factor > 0.0;
        return is_any.then_some(if first.factor > 0.0 { 1.0 } else { 0.0 });
    }
    let share = |a: f32, b: f32| a / (a + b);
    let far = share(first.factor * second.farthest_sq, second.factor * first.farthest_sq);
    if first.nearest_sq <= 0.0 || second.nearest_sq <= 0.0 {
        return Some(far);
    }
    Some(0.5 * (far + share(first.factor * second.nearest_sq, second.factor * first.nearest_sq)))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsdf::{ALL_LOBES, LAMBERT, Transport, bsdf_value};
    use crate::energy::energy_tables;
    use crate::ray::NONE;
    use crate::rng::random4;
    use crate::virtual_light::{VirtualLight, pack_direction, virtual_emission};

    fn random3(k: u32, purpose: u32) -> Vec3 {
        let [a, b, c, _] = random4(k, purpose, 0, 13);
        Vec3::new(a, b, c)
    }

    fn unit(k: u32, purpose: u32) -> Vec3 {
        (random3(k, purpose) - 0.5).normalize()
    }

    #[test]
    fn no_point_of_a_box_exceeds_its_cosine_or_distance() {
        for k in 0..20_000 {
            let (axis, center) = (unit(k, 0), (random3(k, 1) - 0.5) * 4.0);
            let half = random3(k, 2) * random3(k, 3);
            let bound = box_cosine(axis, center, half);
            let nearest = box_distance_sq(center, half);
            for m in 0..40 {
                // Corners, and points within.
                let place = if m < 8 {
                    Vec3::new((m & 1) as f32, (m >> 1 & 1) as f32, (m >> 2) as f32) * 2.0 - 1.0
                } else {
                    random3(k * 64 + m, 4) * 2.0 - 1.0
                };
                let point = center + half * place;
                let cos = axis.dot(point) / point.length().max(1e-20);
                assert!(cos <= bound + 1e-5, "{cos} {bound}");
                assert!(point.length_squared() >= nearest * 0.999_99);
            }
        }
    }

    #[test]
    fn no_axis_of_a_cone_exceeds_the_widened_cosine() {
        for k in 0..20_000 {
            let (axis, direction) = (unit(k, 0), unit(k, 1));
            let cos_cone = random4(k, 2, 0, 13)[0];
            let bound = widened_cosine(axis.dot(direction).max(0.0), cos_cone);
            let (tangent, bitangent) = frame(axis);
            for m in 0..16 {
                let [a, b, ..] = random4(k * 16 + m, 3, 0, 13);
                let cos = 1.0 - a * (1.0 - cos_cone);
                let (s, c) = (b * 2.0 * PI).sin_cos();
                let tilted = axis * cos + (tangent * c + bitangent * s) * (1.0 - cos * cos).max(0.0).sqrt();
                assert!(tilted.dot(direction) <= bound + 1e-5);
            }
        }
    }

    /// Materials of every kind that is gathered.
    fn materials() -> Vec<(&'static str, Bsdf, Vec<f32>)> {
        let base = Bsdf {
            diffuse: Vec3::new(0.7, 0.2, 0.4),
            specular: Vec3::new(0.1, 0.3, 0.2),
            ior: 1.5,
            exponent: 30.0,
            ..Bsdf::zeroed()
        };
        let of = |name, bsdf: Bsdf| (name, bsdf, energy_tables(bsdf.kind, bsdf.alpha, bsdf.ior).to_vec());
        let metal = Bsdf { kind: CONDUCTOR, specular: Vec3::splat(0.3), absorption: Vec3::splat(3.0), ..base };
        vec![
            of("lambert", Bsdf { kind: LAMBERT, ..base }),
            of("phong", Bsdf { kind: PHONG, ..base }),
            of("sharp phong", Bsdf { kind: PHONG, exponent: 500.0, ..base }),
            of("metal", Bsdf { alpha: 0.15, ..metal }),
            of("rough metal", Bsdf { alpha: 0.7, ..metal }),
            of("plastic", Bsdf { kind: PLASTIC, ..base }),
            of("rough plastic", Bsdf { kind: PLASTIC, alpha: 0.3, ..base }),
        ]
    }

    #[test]
    fn clusters_are_drawn_by_what_they_may_send() {
        let reach = |factor, nearest_sq, farthest_sq| ClusterReach { factor, nearest_sq, farthest_sq };
        let near = |a: &ClusterReach, b: &ClusterReach| first_probability(a, b).unwrap();
        assert_eq!(first_probability(&reach(0.0, 1.0, 1.0), &reach(0.0, 1.0, 1.0)), None);
        assert_eq!(near(&reach(0.0, 1.0, 1.0), &reach(1.0, 1.0, 1.0)), 0.0);
        assert_eq!(near(&reach(3.0, 2.0, 2.0), &reach(1.0, 2.0, 2.0)), 0.75);
        assert_eq!(near(&reach(1.0, 0.0, 4.0), &reach(1.0, 1.0, 4.0)), 0.5);
        let (a, b) = (reach(1.0, 1.0, 9.0), reach(1.0, 4.0, 16.0));
        assert!((near(&a, &b) - 0.5 * (0.8 + 0.64)).abs() < 1e-6);
        assert!((near(&a, &b) + near(&b, &a) - 1.0).abs() < 1e-6);
    }

    /// 10,000 random clusters for every material: no light of a cluster sends more than its share of the bound.
    #[test]
    fn no_light_of_a_cluster_exceeds_the_bound() {
        for (name, bsdf, tables) in materials() {
            let (mut tightest, mut lit) = (0.0_f32, 0);
            for k in 0..10_000 {
                let lower = (random3(k, 0) - 0.5) * 3.0;
                let upper = lower + random3(k, 1) * random3(k, 2) * 2.0;
                let cos_cone = random4(k, 3, 0, 13)[0] * 2.0 - 1.0;
                let node =
                    ClusterNode { lower, upper, axis: unit(k, 4), cos_cone, power: 3.0, ..ClusterNode::zeroed() };
                let normal = unit(k, 5);
                let viewer = unit(k, 6);
                let viewer = if viewer.dot(normal) < 0.0 { -viewer } else { viewer };
                let cos_o = viewer.dot(normal);
                let receiver = BoundReceiver {
                    point: (random3(k, 7) - 0.5) * 3.0,
                    normal,
                    mirror: normal * (2.0 * cos_o) - viewer,
                    clamp_sq: 0.01,
                    bsdf: bsdf_bound(&bsdf, &tables, [1.0; 2], cos_o),
                };
                let bound = reach_bound(&cluster_reach(&node, &receiver));
                let tangents = frame(normal);
                let local = |v: Vec3| Vec3::new(tangents.0.dot(v), tangents.1.dot(v), normal.dot(v));
                for m in 0..8 {
                    let position = lower + (upper - lower) * random3(k * 8 + m, 8);
                    let [a, b, ..] = random4(k * 8 + m, 9, 0, 13);
                    let cos = 1.0 - a * (1.0 - cos_cone);
                    let (s, c) = (b * 2.0 * PI).sin_cos();
                    let around = frame(node.axis);
                    let emitter = node.axis * cos + (around.0 * c + around.1 * s) * (1.0 - cos * cos).max(0.0).sqrt();
                    let light = VirtualLight {
                        position,
                        table: NONE,
                        normal: emitter,
                        shading: pack_direction(emitter),
                        intensity: Vec3::ONE,
                        is_bent: 1,
                    };
                    let to_light = position - receiver.point;
                    let direction = to_light.normalize();
                    let value =
                        bsdf_value(&bsdf, &tables, ALL_LOBES, local(viewer), local(direction), Transport::Radiance)
                            * local(direction).z.max(0.0);
                    let sent = light_power(value * light.intensity) * virtual_emission(&light, &tables, -direction)
                        / to_light.length_squared().max(receiver.clamp_sq);
                    assert!(sent <= bound, "{name}, cluster {k}: {sent} > {bound}");
                    lit += u32::from(sent > 0.0);
                    tightest = tightest.max(sent / bound.max(1e-30));
                }
            }
            println!("{name}: {lit} of 80000 lights shine; the closest reaches {tightest:.3} of its bound");
            assert!(lit > 5_000);
        }
    }
}
