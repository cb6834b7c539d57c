//! What photons add up to around a point.

use crate::photon::Photon;
use glam::{IVec3, Vec3};

/// Cells beyond this number are taken as it, so that neighbours can be counted.
const FARTHEST_CELL: f32 = 1e9;

/// The cell of a point; cells are as wide as the gathered radius.
pub fn photon_cell(point: Vec3, radius: f32) -> IVec3 {
    let cell = (point / radius).floor();
    cell.clamp(Vec3::splat(-FARTHEST_CELL), Vec3::splat(FARTHEST_CELL)).as_ivec3()
}

/// Whether one cell comes before another: by x, then y, then z.
pub fn cell_before(a: IVec3, b: IVec3) -> bool {
    if a.x != b.x {
        return a.x < b.x;
    }
    if a.y != b.y {
        return a.y < b.y;
    }
    a.z < b.z
}

/// Index of the first photon whose cell is not before this one; photons are sorted by cell.
pub fn first_photon(photons: &[Photon], cell: IVec3) -> u32 {
    let (mut start, mut end) = (0, photons.len() as u32);
    while start < end {
        let middle = start + (end - start) / 2;
        let photon = &photons[middle as usize];
        if cell_before(IVec3::new(photon.cell_x, photon.cell_y, photon.cell_z), cell) {
            start = middle + 1;
        } else {
            end = middle;
        }
    }
    start
}

/// Light per area around a point on a surface with this normal, relative to the unfocused light; zero with fewer than
/// `min_photons`.
pub fn gather_photons(photons: &[Photon], point: Vec3, normal: Vec3, radius: f32, min_photons: u32) -> Vec3 {
    let cell = photon_cell(point, radius);
    let mut sum = Vec3::ZERO;
    let mut count = 0;
    for x in -1..=1 {
        for y in -1..=1 {
            // The three cells along z follow one another.
            let last = cell + IVec3::new(x, y, 1);
            let mut index = first_photon(photons, cell + IVec3::new(x, y, -1)) as usize;
            while index < photons.len() {
                let photon = &photons[index];
                if cell_before(last, IVec3::new(photon.cell_x, photon.cell_y, photon.cell_z)) {
                    break;
                }
                let offset = photon.position - point;
                // Photons on the other side of an edge or of a thin wall do not light this side.
                if offset.dot(offset) <= radius * radius && photon.normal.dot(normal) > 0.5 {
                    sum += photon.power;
                    count += 1;
                }
                index += 1;
            }
        }
    }
    if count < min_photons { Vec3::ZERO } else { sum / (std::f32::consts::PI * radius * radius) }
}
