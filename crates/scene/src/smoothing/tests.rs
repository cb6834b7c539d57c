use super::*;
use crate::MeshTriangle;

fn mesh(positions: Vec<Vec3>, triangles: &[[u32; 3]]) -> MeshDesc {
    let triangle = |positions| MeshTriangle { positions, normals: None, texture_coordinates: None, material: None };
    MeshDesc {
        positions,
        triangles: triangles.iter().map(|corners| triangle(*corners)).collect(),
        ..MeshDesc::default()
    }
}

fn smoothed(mut mesh: MeshDesc, degrees: f32) -> MeshDesc {
    smooth_normals(&mut mesh, degrees, |_| Some(1));
    mesh
}

/// Position and normal of each corner.
fn corners(mesh: &MeshDesc) -> Vec<(Vec3, Vec3)> {
    let of = |t: &MeshTriangle| {
        let points = t.positions.map(|i| mesh.positions[i as usize]);
        let face = (points[1] - points[0]).cross(points[2] - points[0]).normalize();
        [0, 1, 2].map(|i| (points[i], t.normals.map_or(face, |normals| mesh.normals[normals[i] as usize])))
    };
    mesh.triangles.iter().flat_map(of).collect()
}

/// A cylinder of radius 1 about z from 0 to 1, with lids, of so many sides.
fn cylinder(sides: u32) -> MeshDesc {
    let ring = |z: f32| {
        (0..sides).map(move |i| {
            let angle = std::f32::consts::TAU * i as f32 / sides as f32;
            Vec3::new(angle.cos(), angle.sin(), z)
        })
    };
    let positions = ring(0.0).chain(ring(1.0)).chain([Vec3::ZERO, Vec3::Z]).collect();
    let triangles: Vec<[u32; 3]> = (0..sides)
        .flat_map(|i| {
            let j = (i + 1) % sides;
            let (low, high) = (2 * sides, 2 * sides + 1);
            [[i, j, sides + j], [i, sides + j, sides + i], [low, j, i], [high, sides + i, sides + j]]
        })
        .collect();
    mesh(positions, &triangles)
}

/// A sphere of radius 2 in longitude and latitude, with uneven spacing.
fn globe() -> MeshDesc {
    let (rows, columns) = (7, 11);
    let point = |row: u32, column: u32| {
        let polar = std::f32::consts::PI * (row as f32 / rows as f32).powf(1.3);
        let angle = std::f32::consts::TAU * ((column % columns) as f32 / columns as f32).powf(0.8);
        Vec3::new(polar.sin() * angle.cos(), polar.sin() * angle.sin(), polar.cos()) * 2.0
    };
    let mut positions = vec![Vec3::Z * 2.0, Vec3::NEG_Z * 2.0];
    positions.extend((1..rows).flat_map(|row| (0..columns).map(move |column| point(row, column))));
    let at = |row: u32, column: u32| match row {
        0 => 0,
        row if row == rows => 1,
        row => 2 + (row - 1) * columns + column % columns,
    };
    let mut triangles = Vec::new();
    for row in 0..rows {
        for column in 0..columns {
            let [a, b] = [at(row, column), at(row, column + 1)];
            let [c, d] = [at(row + 1, column), at(row + 1, column + 1)];
            triangles
                .extend([[a, c, d], [a, d, b]].into_iter().filter(|t| t[0] != t[1] && t[1] != t[2] && t[0] != t[2]));
        }
    }
    mesh(positions, &triangles)
}

#[test]
fn normals_of_vertices_on_a_sphere_are_exact() {
    let globe = smoothed(globe(), 180.0);
    for (position, normal) in corners(&globe) {
        assert!((normal - position / 2.0).length() < 1e-5, "{position} {normal}");
    }
    assert_eq!(globe.normals.len(), globe.positions.len(), "one normal per vertex");
}

#[test]
fn edges_above_the_angle_stay_sharp() {
    for (sides, degrees, is_round) in
        [(12, 40.0, true), (12, 29.0, false), (12, 30.0, true), (8, 40.0, false), (8, 45.0, true)]
    {
        for (position, normal) in corners(&smoothed(cylinder(sides), degrees)) {
            let radial = Vec3::new(position.x, position.y, 0.0);
            let is_lid = normal.z.abs() > 0.9;
            assert!(is_lid == (normal.z != 0.0) && (normal.length() - 1.0).abs() < 1e-6);
            assert!(
                is_lid || is_round == ((normal - radial).length() < 1e-5),
                "{sides} {degrees}: {position} {normal}"
            );
        }
    }
}

#[test]
fn flat_meshes_and_given_normals_do_not_change() {
    let flat = cylinder(12);
    assert_eq!(smoothed(flat.clone(), 0.0), flat);
    assert_eq!(smoothed(flat.clone(), 29.0), flat);
    // Lids are flat, sides are not.
    let round = smoothed(flat, 40.0);
    assert_eq!((round.crease_degrees, round.normals.len()), (Some(40.0), 24));
    assert!(round.triangles.chunks(4).all(|side| side[1].normals.is_some() && side[2].normals.is_none()));
    let mut given = cylinder(12);
    given.normals.push(Vec3::X);
    given.triangles[5].normals = Some([0; 3]);
    let made = smoothed(given, 40.0);
    assert_eq!((made.normals[0], made.triangles[5].normals), (Vec3::X, Some([0; 3])));
    assert!(made.triangles[8].normals.is_some_and(|normals| !normals.contains(&0)));
}

#[test]
fn vertices_at_one_place_are_one_and_groups_are_kept_apart() {
    let round = smoothed(cylinder(12), 40.0);
    let mut split = cylinder(12);
    split.positions = split.triangles.iter().flat_map(|t| t.positions.map(|i| split.positions[i as usize])).collect();
    for (i, triangle) in split.triangles.iter_mut().enumerate() {
        triangle.positions = [0, 1, 2].map(|k| 3 * i as u32 + k);
    }
    assert_eq!(corners(&smoothed(split, 40.0)), corners(&round));
    let mut grouped = cylinder(12);
    smooth_normals(&mut grouped, 180.0, |triangle| (triangle >= 4).then_some(triangle as u32 % 4 / 2));
    assert!(grouped.triangles[..4].iter().all(|t| t.normals.is_none()));
    // Sides are in one group, lids in another: edges between them stay sharp at any angle.
    let bare = |t: &&MeshTriangle| t.normals.is_some();
    for triangle in grouped.triangles.iter().filter(bare) {
        let normals = triangle.normals.expect("it has some").map(|i| grouped.normals[i as usize].z.abs());
        assert!(normals.iter().all(|z| *z < 1e-6) || normals.iter().all(|z| *z > 0.999_999), "{normals:?}");
    }
}

#[test]
fn broken_meshes_are_safe() {
    let point = Vec3::new(1.0, 2.0, 3.0);
    let positions = vec![point, point, Vec3::ZERO, Vec3::X * 1e9, Vec3::Y * 1e9, Vec3::X * -1e-30, Vec3::Y * 1e-30];
    let triangles = [[0, 1, 2], [2, 3, 4], [3, 2, 4], [2, 4, 3], [2, 5, 6], [2, 2, 2], [2, 3, 4]];
    let made = smoothed(mesh(positions, &triangles), 60.0);
    assert_eq!(made.triangles[0].normals, None);
    assert!(made.normals.iter().all(|normal| normal.is_finite()));
}
