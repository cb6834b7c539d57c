//! The statue: a standing woman without arms, draped from the hips down, on an oval plinth. Our own design.
//!
//! Modelled as a field of blended bodies, turned into a fine mesh by marching tetrahedra, and reduced to the exact number of
//! triangles. The figure is designed in heights above its soles, about 1.2 units to a centimetre.

use anyhow::Result;

use super::field::{blend, bump, capsule, common, ellipsoid, gradient, half_space, project, step};
use super::model::{Material, Model, Shading};
use super::part::Part;
use super::reduce::reduce;
use super::surface::{Grid, surface};
use super::vector::{Vec3, vec3};

/// The thesis' own statue has as many.
pub(super) const TRIANGLES: usize = 1418;
pub(super) const TITLE: &str = "A draped statue on a plinth, stand-in for the thesis' Venus.";
pub(super) const MATERIALS: [Material; 3] = [
    Material { name: "marble", diffuse: [0.62, 0.60, 0.56], specular: [0.25, 0.25, 0.25], exponent: 40.0 },
    Material { name: "drapery", diffuse: [0.34, 0.40, 0.52], specular: [0.06, 0.06, 0.06], exponent: 12.0 },
    Material { name: "plinth", diffuse: [0.30, 0.19, 0.14], specular: [0.15, 0.15, 0.15], exponent: 25.0 },
];

/// Where the soles stand; the plinth reaches from here down to the floor of the 400-unit room (-200 / 1.3).
const SOLES: f64 = -118.0;
const FLOOR: f64 = -153.8;
const PLINTH_SIDES: usize = 22;

/// The whole model.
pub(super) fn build() -> Result<Model> {
    let mut model = Model::default();
    let plinth = plinth();
    model.add("plinth", &plinth, Shading::Crease(0.8))?;
    let fine = surface(&figure, &Grid::covering(vec3(-62.0, -6.0, -46.0), vec3(62.0, 256.0, 50.0), 2.0));
    let mut figure_part = reduce(&fine, TRIANGLES - plinth.triangle_count(), detail)?;
    for point in &mut figure_part.positions {
        *point = project(&figure, *point, 0.6);
    }
    let normals: Vec<Vec3> = figure_part.positions.iter().map(|&point| gradient(&figure, point).normalised()).collect();
    let draped: Vec<bool> = figure_part.faces.iter().map(|face| is_draped(&figure_part, face)).collect();
    let standing = figure_part.mapped(|point| vec3(point.x, point.y + SOLES, point.z));
    let material = |face: usize| if draped[face] { "drapery" } else { "marble" };
    model.add_by(material, &standing, Shading::Given(&normals))?;
    Ok(model)
}

/// An oval plinth with a foot, a recessed drum and a cornice.
fn plinth() -> Part {
    const HALF_WIDTH: f64 = 65.4;
    const HALF_DEPTH: f64 = 47.5;
    let height = SOLES - FLOOR;
    let ring = |up: f64, size: f64| -> Vec<Vec3> {
        let turn = |side: usize| std::f64::consts::TAU * (side as f64 + 0.5) / PLINTH_SIDES as f64;
        let at = |side: usize| {
            let (sin, cos) = turn(side).sin_cos();
            let widest = (std::f64::consts::PI / PLINTH_SIDES as f64).cos();
            vec3(HALF_WIDTH / widest * size * cos, FLOOR + height * up, HALF_DEPTH * size * sin)
        };
        (0..PLINTH_SIDES).map(at).collect()
    };
    Part::loft(&[ring(0.0, 1.0), ring(0.22, 1.0), ring(0.34, 0.9), ring(0.78, 0.88), ring(0.9, 0.96), ring(1.0, 0.95)])
}

/// How much of the reduction's error counts at a point: the face and the front count most, the back least.
fn detail(point: Vec3) -> f64 {
    let front = 0.35 + 0.65 * step(-8.0, 10.0, point.z);
    let head = 1.0 + 18.0 * step(212.0, 222.0, point.y);
    front * head
}

fn is_draped(part: &Part, face: &[usize]) -> bool {
    let sum = face.iter().fold(Vec3::default(), |sum, &corner| sum + part.positions[corner]);
    let middle = sum * (1.0 / face.len() as f64);
    drapery(middle) < skin(middle)
}

/// The standing figure: negative inside.
fn figure(point: Vec3) -> f64 {
    blend(skin(point), drapery(point), 1.0)
}

fn skin(point: Vec3) -> f64 {
    let bust = blend(torso(point), neck(point), 7.0);
    let bust = blend(bust, head(turned_head(point)), 1.5);
    blend(bust, arms(point), 6.0)
}

/// Pelvis to shoulders, in contrapposto: the pelvis shifted and tilted over the right leg, the chest against it.
fn torso(point: Vec3) -> f64 {
    let pelvis = ellipsoid(point, vec3(-5.0, 128.0, -1.0), vec3(32.0, 27.0, 22.0));
    let belly = ellipsoid(point, vec3(-3.0, 146.0, 3.0), vec3(24.0, 24.0, 17.0));
    let waist = ellipsoid(point, vec3(-1.0, 162.0, 0.0), vec3(22.0, 20.0, 15.5));
    let chest = ellipsoid(point, vec3(2.0, 188.0, -1.0), vec3(27.0, 27.0, 17.5));
    let shoulders = capsule(point, vec3(-26.0, 203.0, -3.0), vec3(30.0, 207.0, -3.0), 9.5, 9.5);
    let trunk = blend(blend(pelvis, belly, 9.0), waist, 10.0);
    let trunk = blend(blend(trunk, chest, 12.0), shoulders, 12.0);
    let bosom = [vec3(-10.5, 186.5, 12.5), vec3(15.5, 188.0, 12.5)]
        .map(|centre| ellipsoid(point, centre, vec3(10.2, 10.6, 9.6)))
        .into_iter()
        .fold(trunk, |body, breast| blend(body, breast, 5.0));
    bosom + belly_marks(point)
}

/// Shallow hollows: navel, the line down the belly and chest, and the spine at the back.
fn belly_marks(point: Vec3) -> f64 {
    let front = step(4.0, 10.0, point.z);
    let back = step(-4.0, -9.0, point.z);
    let line = point.x - (-3.0 + (point.y - 146.0) * 0.12);
    let upright = bump((point.y - 168.0) / 42.0);
    let navel = bump((point.y - 149.0) / 4.5) * bump((point.x + 2.8) / 4.5);
    front * (1.4 * navel + 0.9 * bump(line / 7.0) * upright) + back * 2.4 * bump(line / 8.0) * upright
}

fn neck(point: Vec3) -> f64 {
    let column = capsule(point, vec3(2.0, 204.0, -4.0), vec3(1.5, 229.0, 0.0), 9.2, 8.0);
    let slope_right = capsule(point, vec3(0.0, 215.0, -5.0), vec3(-22.0, 206.0, -4.0), 6.0, 6.0);
    let slope_left = capsule(point, vec3(4.0, 215.0, -5.0), vec3(26.0, 210.0, -4.0), 6.0, 6.0);
    blend(column, blend(slope_right, slope_left, 5.0), 7.0)
}

/// The head's own frame: origin in the middle of the skull, turned a little to its left and bowed.
fn turned_head(point: Vec3) -> Vec3 {
    let p = point - vec3(1.5, 236.0, 2.0);
    // Turned by the angle whose cosine and sine are 12/13 and 5/13, and tilted sideways by about 7 degrees.
    let p = vec3(p.x * 12.0 / 13.0 - p.z * 5.0 / 13.0, p.y, p.x * 5.0 / 13.0 + p.z * 12.0 / 13.0);
    vec3(p.x * 0.993 + p.y * 0.12, p.y * 0.993 - p.x * 0.12, p.z)
}

/// Skull, face and hair with a bun, in the head's own frame.
fn head(point: Vec3) -> f64 {
    let skull = ellipsoid(point, vec3(0.0, 1.5, -0.5), vec3(11.6, 13.6, 14.0));
    let jaw = ellipsoid(point, vec3(0.0, -7.5, 4.5), vec3(8.6, 9.6, 9.0));
    let chin = ellipsoid(point, vec3(0.0, -14.0, 9.4), vec3(3.4, 3.0, 3.0));
    let face = blend(blend(skull, jaw, 6.0), chin, 4.0);
    let sockets = [-4.9, 4.9]
        .map(|x| ellipsoid(point, vec3(x, 0.6, 14.2), vec3(3.4, 2.4, 2.6)))
        .into_iter()
        .fold(face, |face, socket| common(face, -socket, 2.0));
    let nose = capsule(point, vec3(0.0, 2.2, 12.6), vec3(0.0, -4.6, 15.4), 1.5, 2.3);
    let lips = ellipsoid(point, vec3(0.0, -9.2, 12.6), vec3(3.6, 1.5, 1.8));
    let face = blend(blend(sockets, nose, 2.2), lips, 1.6);
    blend(face, hair(point), 0.8)
}

/// A cap of hair, parted in the middle, waved, with a ribbon's groove and a knot at the back.
fn hair(point: Vec3) -> f64 {
    let cap = ellipsoid(point, vec3(0.0, 3.0, -1.6), vec3(13.8, 13.8, 15.2));
    let hairline = half_space(point, vec3(0.0, 7.4, 9.0), vec3(0.0, -0.55, 0.83));
    let waves =
        0.7 * bump((point.z - 5.0) / 3.0) - 0.9 * bump((point.z + 2.5) / 2.6) + 0.5 * bump((point.z + 8.0) / 3.0);
    let parting = 1.2 * bump(point.x / 2.6) * step(-4.0, 2.0, point.z);
    let cap = common(cap - waves * step(-6.0, 4.0, point.y) + parting, hairline, 1.6);
    let knot = ellipsoid(point, vec3(0.0, 2.0, -18.5), vec3(7.6, 7.2, 7.0));
    let nape = ellipsoid(point, vec3(0.0, -6.0, -9.5), vec3(8.0, 7.0, 5.5));
    blend(blend(cap, nape, 4.0), knot, 3.0)
}

/// The right arm is broken off above the elbow, the left one below the shoulder.
fn arms(point: Vec3) -> f64 {
    let right = capsule(point, vec3(-31.0, 201.5, -3.0), vec3(-41.0, 160.0, -2.0), 9.6, 8.2);
    let right = common(right, half_space(point, vec3(-39.0, 168.0, -2.0), vec3(-0.35, -0.92, 0.18)), 1.2);
    let left = capsule(point, vec3(34.0, 206.0, -3.0), vec3(52.0, 186.0, 3.0), 9.4, 8.4);
    let left = common(left, half_space(point, vec3(44.5, 193.5, 0.5), vec3(0.74, -0.62, 0.26)), 1.2);
    right.min(left)
}

/// The garment: cloth over both legs, folds, and the rolled edge around the hips.
fn drapery(point: Vec3) -> f64 {
    let right_leg = capsule(point, vec3(-14.0, 124.0, -1.0), vec3(-13.0, 2.0, -5.0), 20.0, 13.5);
    let left_thigh = capsule(point, vec3(11.0, 122.0, 1.0), vec3(17.0, 74.0, 19.0), 20.5, 13.5);
    let left_shin = capsule(point, vec3(17.0, 74.0, 19.0), vec3(22.0, 2.0, 4.0), 13.5, 12.0);
    let legs = blend(blend(left_thigh, left_shin, 5.0), right_leg, 8.0);
    let hips = ellipsoid(point, vec3(-4.0, 122.0, -1.0), vec3(34.5, 32.0, 25.0));
    let train = capsule(point, vec3(-4.0, 112.0, -10.0), vec3(2.0, 0.0, -12.0), 17.0, 22.0);
    let hem = ellipsoid(point, vec3(2.0, -4.0, 0.0), vec3(45.0, 20.0, 33.0));
    let cloth = blend(blend(blend(legs, hips, 8.0), train, 14.0), hem, 10.0);
    let cloth = cloth - folds(point);
    let upper = half_space(point, vec3(0.0, rolled_edge(point.x), 0.0), vec3(0.12, 0.99, 0.0));
    let lower = half_space(point, vec3(0.0, -2.5, 0.0), vec3(0.0, -1.0, 0.0));
    let cloth = common(common(cloth, upper, 2.0), lower, 1.0);
    blend(cloth, roll(point), 3.0)
}

/// Height of the garment's upper edge.
fn rolled_edge(x: f64) -> f64 {
    137.0 - 0.14 * x
}

/// The rolled edge: a thick, twisted band around the hips, with a knot and a falling end in front.
fn roll(point: Vec3) -> f64 {
    let (u, w) = ((point.x + 4.5) / 31.0, (point.z + 0.5) / 22.5);
    let around = (u * u + w * w).sqrt();
    let twist = 0.9 * (bump((pseudo_angle(point) * 2.6 + point.y * 0.06).fract().abs() * 2.0 - 1.0) - 0.5);
    let outward = (around - 1.0) * 25.0;
    let upward = point.y - rolled_edge(point.x) + 1.5;
    let band = (outward * outward + upward * upward * 0.5).sqrt() - 4.0 - twist;
    let fall = capsule(point, vec3(-14.0, 134.0, 23.5), vec3(-10.0, 104.0, 23.0), 5.0, 3.2);
    blend(band, fall, 3.0)
}

/// A fold of cloth: a ridge between two points of (pseudo angle, height), with its half width as a share of a quarter
/// turn and its height above the cloth.
struct Fold(f64, f64, f64, f64, f64, f64);

/// Folds that hang from the right hip and are drawn across to the bent left knee, and those at the sides and the back.
const FOLDS: [Fold; 19] = [
    Fold(-0.72, 118.0, 0.20, 84.0, 7.0, 3.2),
    Fold(-0.55, 102.0, 0.16, 70.0, 7.0, 3.4),
    Fold(-0.70, 134.0, 0.34, 104.0, 6.5, 2.4),
    Fold(-0.40, 84.0, 0.10, 56.0, 6.5, 3.0),
    Fold(0.04, 74.0, 0.02, 0.0, 6.0, 5.0),
    Fold(-0.16, 62.0, -0.20, 0.0, 6.0, 4.6),
    Fold(-0.40, 66.0, -0.44, 0.0, 6.0, 4.4),
    Fold(-0.66, 80.0, -0.70, 0.0, 6.5, 4.4),
    Fold(-0.95, 104.0, -0.96, 0.0, 7.0, 4.6),
    Fold(0.26, 52.0, 0.22, 0.0, 5.5, 3.6),
    Fold(0.52, 62.0, 0.48, 0.0, 6.0, 4.0),
    Fold(0.80, 82.0, 0.74, 0.0, 6.5, 4.6),
    Fold(0.98, 112.0, 1.02, 0.0, 7.0, 4.6),
    Fold(-1.25, 112.0, -1.28, 0.0, 8.0, 4.2),
    Fold(-1.55, 108.0, -1.58, 0.0, 8.0, 4.2),
    Fold(-1.86, 110.0, -1.88, 0.0, 8.0, 4.2),
    Fold(1.30, 110.0, 1.32, 0.0, 8.0, 4.2),
    Fold(1.58, 108.0, 1.60, 0.0, 8.0, 4.2),
    Fold(1.84, 104.0, 1.86, 0.0, 8.0, 4.2),
];

/// Units of surface to a quarter turn of the pseudo angle.
const QUARTER: f64 = 42.0;

/// Height of the folds above the cloth; where two meet, the higher one counts.
fn folds(point: Vec3) -> f64 {
    let angle = pseudo_angle(point) * QUARTER;
    let ridge = |&Fold(from_angle, from, to_angle, to, width, height): &Fold| {
        let (start, axis) = ((from_angle * QUARTER, from), ((to_angle - from_angle) * QUARTER, to - from));
        let (dx, dy) = (angle - start.0, point.y - start.1);
        let along = ((dx * axis.0 + dy * axis.1) / (axis.0 * axis.0 + axis.1 * axis.1)).clamp(0.0, 1.0);
        let (rx, ry) = (dx - axis.0 * along, dy - axis.1 * along);
        let ends = step(0.0, 0.3, along);
        height * (0.35 + 0.65 * ends) * bump((rx * rx + ry * ry).sqrt() / width)
    };
    FOLDS.iter().map(ridge).fold(0.0, f64::max)
}

/// A measure of direction around the figure without trigonometry: 0 in front, 1 on its left, -1 on its right, 2 behind.
fn pseudo_angle(point: Vec3) -> f64 {
    let (u, w) = ((point.x - 1.0) / 36.0, (point.z + 2.0) / 27.0);
    let size = u.abs() + w.abs();
    let side = if size > 0.0 { u / size } else { 0.0 };
    match (w >= 0.0, u >= 0.0) {
        (true, _) => side,
        (false, true) => 2.0 - side,
        (false, false) => -2.0 - side,
    }
}
