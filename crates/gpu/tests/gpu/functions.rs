//! Fence 2: every function of the kernel computes the same on the adapter as in Rust.

mod case;
mod clusters;
mod compare;
mod draw;
mod drawn_records;
mod driver;
mod lights;
mod numbers;
mod rays;
mod shader;
mod surfaces;
mod table;
mod tables;
mod trial;
mod word;

use crate::support::has_adapter;
use crate::twins::declared;
use compare::check;
use lightcuts_kernel::wgsl::TWINS;
use table::Row;

/// Functions that are called within others only, and by which.
const WITHIN: [(&str, &str); 4] = [
    ("sphere_root", "intersect_sphere"),
    ("sphere_root_original", "intersect_sphere"),
    ("texel", "sample_texture"),
    ("is_incident", "incidence"),
];

fn compare(scene: &str, rows: &[Row]) {
    if has_adapter() {
        check(scene, rows);
    }
}

#[test]
fn numbers_are_equal() {
    compare("thesis/simple.txt", &numbers::ROWS);
}

#[test]
fn rays_are_equal() {
    compare("gallery/cubes.txt", &rays::ROWS);
}

#[test]
fn lights_are_equal() {
    compare("thesis/simple.txt", &lights::ROWS);
}

#[test]
fn clusters_are_equal() {
    compare("thesis/simple.txt", &clusters::ROWS);
}

#[test]
fn surfaces_are_equal() {
    compare("gallery/textures.txt", &surfaces::ROWS);
}

#[test]
fn traversals_of_a_simple_scene_are_equal() {
    compare("thesis/simple.txt", &surfaces::TRAVERSALS);
}

#[test]
fn traversals_of_a_mesh_are_equal() {
    compare("thesis/ship.txt", &surfaces::TRAVERSALS);
}

#[test]
fn every_function_is_compared() {
    let tables: [&[Row]; 6] =
        [&numbers::ROWS, &rays::ROWS, &lights::ROWS, &clusters::ROWS, &surfaces::ROWS, &surfaces::TRAVERSALS];
    for name in TWINS.iter().flat_map(|twin| declared(twin.text, "fn")) {
        let is_called = tables.iter().any(|rows| rows.iter().any(|row| row.name == name));
        let is_within = WITHIN.iter().any(|(inner, _)| *inner == name);
        assert!(is_called != is_within, "`{name}`: called {is_called}, within another {is_within}");
    }
}
