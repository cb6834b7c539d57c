//! Rows: lights, the light model, mirrors and glass, photons, and bounds of clusters.

use crate::functions::case::Case;
use crate::functions::table::{Row, twin, unlike};
use crate::functions::word::Words;
use glam::Vec3;
use lightcuts_kernel::light::{emission_cosine, to_light};
use lightcuts_kernel::light_tree::{decide, is_relevant, relevance_bounds};
use lightcuts_kernel::optics::{reflect_at, refract_at};
use lightcuts_kernel::phong::{Incidence, VplIncidence, incidence, phong, phong_vpl, vpl_incidence};
use lightcuts_kernel::photon::{PhotonStart, photon_start};
use lightcuts_kernel::ray::Ray;

/// The rows.
pub(crate) const ROWS: [Row; 13] = [
    twin("vpl_intensity", |c| c.put(c.vpl().intensity())),
    twin("to_light", |c| c.put(to_light(&c.light(), c.point()))),
    twin("emission_cosine", |c| c.put(emission_cosine(&c.light(), c.direction()))),
    unlike(
        "incidence",
        "let at = incidence(get_Light(), get_vec3_f32(), get_vec3_f32());
        put_bool(is_incident(at));
        if (is_incident(at)) { put_Incidence(at); }",
        |c| put_incidence(c, incidence(&c.light(), c.point(), c.direction())),
    ),
    unlike(
        "vpl_incidence",
        "let at = vpl_incidence(get_Vpl(), get_vec3_f32(), get_vec3_f32());
        put_bool(at.cosines > 0.0);
        if (at.cosines > 0.0) { put_VplIncidence(at); }",
        |c| put_incidence(c, vpl_incidence(&c.vpl(), c.point(), c.direction())),
    ),
    twin("phong", |c| {
        let (light, material, at) = (c.light(), c.material(), at(c));
        c.put(phong(&light, &material, &at, c.direction(), c.point(), c.rules()));
    }),
    twin("phong_vpl", |c| c.put(phong_vpl(&c.vpl(), c.color(), &vpl_at(c)))),
    twin("reflect_at", |c| c.put(reflect_at(c.direction(), c.direction()))),
    // No refracted ray is the zero vector on devices.
    twin("refract_at", |c| {
        let bent = refract_at(c.direction(), c.direction(), c.take(|| ratio(c)), c.rules());
        c.put(bent.unwrap_or(Vec3::ZERO));
    }),
    twin("photon_start", |c| {
        let start = photon_start(&c.light(), &c.photon_target(), c.below(1000), c.below(1000));
        // What is as far as infinity is as far as the largest number on devices.
        c.put(PhotonStart { ray: Ray { t_max: f32::MAX, ..start.ray }, ..start });
    }),
    twin("is_relevant", |c| c.put(is_relevant(&c.vpl(), c.positive(), c.point(), c.take(|| threshold(c))))),
    twin("relevance_bounds", |c| {
        let (cluster, (lower, upper)) = (c.cluster(), corners(c));
        c.put(relevance_bounds(&cluster, lower, upper));
    }),
    twin("decide", |c| {
        let (cluster, (lower, upper)) = (c.cluster(), corners(c));
        c.put(decide(&cluster, lower, upper, c.take(|| threshold(c))));
    }),
];

fn put_incidence(c: &Case<'_>, at: Option<impl Words + Copy>) {
    c.put(at.is_some());
    if let Some(at) = at {
        c.put(at);
    }
}

/// Of a box around points, or of one point.
fn corners(c: &Case<'_>) -> (Vec3, Vec3) {
    let lower = c.point();
    (lower, c.take(|| lower.max(c.raw_point())))
}

/// A light that neither faces away nor is faced away from.
fn at(c: &Case<'_>) -> Incidence {
    c.take(|| Incidence { to_light: c.raw_point(), cos_theta: c.raw_fraction(), cos_phi: c.raw_fraction() })
}

/// The same of a VPL.
fn vpl_at(c: &Case<'_>) -> VplIncidence {
    c.take(|| {
        let to_light = c.raw_point();
        let dist_sq = to_light.length_squared();
        VplIncidence { to_light, cosines: c.raw_fraction() * dist_sq, dist_sq }
    })
}

/// A ratio of refractive indices, that of nothing included.
fn ratio(c: &Case<'_>) -> f32 {
    [1.0, 0.0, 0.667, 1.5, 0.1 + 2.0 * c.random()][c.choice(5)]
}

fn threshold(c: &Case<'_>) -> f32 {
    [0.0, 0.05, 1.0, 10.0_f32.powf(8.0 * c.random() - 6.0)][c.choice(4)]
}
