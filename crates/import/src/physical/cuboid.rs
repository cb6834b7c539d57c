//! The box: one mesh for all of them, a cube of edge length 1 about the origin.

use glam::Vec3;
use lightcuts_scene::{MeshDesc, MeshTriangle};

/// Texture coordinates of a face's corners, counterclockwise as seen from outside.
const CORNERS: [[f32; 2]; 4] = [[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]];

/// Directions of u and v on each face; their cross product points outwards. On the sides v points up.
const FACES: [(Vec3, Vec3); 6] = [
    (Vec3::NEG_Z, Vec3::Y),
    (Vec3::Z, Vec3::Y),
    (Vec3::X, Vec3::NEG_Z),
    (Vec3::X, Vec3::Z),
    (Vec3::X, Vec3::Y),
    (Vec3::NEG_X, Vec3::Y),
];

/// Twelve triangles, two per face, each face covered once by a texture.
pub(super) fn unit_cube() -> MeshDesc {
    let corner =
        |(u, v): (Vec3, Vec3), [s, t]: [f32; 2]| (u.cross(v) + u * (2.0 * s - 1.0) + v * (2.0 * t - 1.0)) * 0.5;
    let positions = FACES.iter().flat_map(|face| CORNERS.map(|at| corner(*face, at))).collect();
    let triangles = (0..FACES.len() as u32).flat_map(|face| [[0, 1, 2], [0, 2, 3]].map(|corners| (face, corners)));
    let triangle = |(face, corners): (u32, [u32; 3])| MeshTriangle {
        positions: corners.map(|corner| 4 * face + corner),
        normals: None,
        texture_coordinates: Some(corners),
        material: None,
    };
    MeshDesc {
        // Those of `[[mesh]]` have one.
        name: String::new(),
        positions,
        normals: Vec::new(),
        texture_coordinates: CORNERS.to_vec(),
        triangles: triangles.map(triangle).collect(),
        crease_degrees: None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_cube_is_closed_and_faces_outwards() {
        let cube = unit_cube();
        let mut volume = 0.0_f32;
        for triangle in &cube.triangles {
            let [a, b, c] = triangle.positions.map(|i| cube.positions[i as usize]);
            let normal = (b - a).cross(c - a);
            assert!(normal.dot(a) > 0.0, "{triangle:?}");
            volume += a.dot(b.cross(c)) / 6.0;
        }
        assert!(cube.triangles.len() == 12 && (volume - 1.0).abs() < 1e-6, "{volume}");
        assert!(cube.positions.iter().all(|p| p.abs() == Vec3::splat(0.5)));
    }
}
