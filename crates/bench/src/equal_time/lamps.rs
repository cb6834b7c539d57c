//! A room of 100,000 triangles with a thousand small lamps, made by formulas.

use anyhow::{Context as _, Result};
use glam::Vec3;
use lightcuts_kernel::rng::random4;
use lightcuts_kernel::sampling::sin_cos_turns;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

/// Half the edges of the room, in scene units.
const HALF: Vec3 = Vec3::new(5.0, 2.0, 5.0);
/// Squares along an edge of a wall: six walls of two triangles per square are 99,372.
const SQUARES: u32 = 91;
/// How far walls go in and out.
const RELIEF: f32 = 0.12;
const LAMPS: u32 = 1000;
/// Edge of a lamp.
const LAMP_SIZE: f32 = 0.05;
const RADIANCE: f32 = 70.0;
/// Stream of the random numbers.
const STREAM: u32 = 61;

/// Writes the scene with its mesh into a folder; returns the scene file.
pub(super) fn write(folder: &Path) -> Result<PathBuf> {
    let path = folder.join("lamps.toml");
    for (path, text) in [(folder.join("walls.ply"), walls()), (path.clone(), scene())] {
        fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
    }
    Ok(path)
}

/// Six uneven walls about the origin.
fn walls() -> String {
    let (mut vertices, mut faces) = (String::new(), String::new());
    let mut count = 0;
    for side in [1.0, -1.0] {
        for axis in 0..3 {
            let [outwards, u, v] = [0, 1, 2].map(|step| Vec3::AXES[(axis + step) % 3]);
            for (i, j) in (0..=SQUARES).flat_map(|j| (0..=SQUARES).map(move |i| (i, j))) {
                let [a, b] = [i, j].map(|k| k as f32 / SQUARES as f32);
                let place =
                    outwards * (side * (1.0 - relief(a, b) / HALF[axis])) + u * (2.0 * a - 1.0) + v * (2.0 * b - 1.0);
                let Vec3 { x, y, z } = place * HALF;
                let _ = writeln!(vertices, "{x} {y} {z}");
            }
            for (i, j) in (0..SQUARES).flat_map(|j| (0..SQUARES).map(move |i| (i, j))) {
                let [a, b, c, d] =
                    [(0, 0), (1, 0), (1, 1), (0, 1)].map(|(k, l)| count + (j + l) * (SQUARES + 1) + i + k);
                let _ = writeln!(faces, "3 {a} {b} {c}\n3 {a} {c} {d}");
            }
            count += (SQUARES + 1) * (SQUARES + 1);
        }
    }
    let faces_count = faces.lines().count();
    format!(
        "ply\nformat ascii 1.0\nelement vertex {count}\nproperty float x\nproperty float y\nproperty float z\n\
         element face {faces_count}\nproperty list uchar int vertex_indices\nend_header\n{vertices}{faces}"
    )
}

/// How far a wall comes in: waves, flat at its edges so that walls meet.
fn relief(a: f32, b: f32) -> f32 {
    let wave = |turns: f32| sin_cos_turns(turns.fract()).0;
    let flat = 16.0 * a * (1.0 - a) * b * (1.0 - b);
    RELIEF * flat * (0.5 + 0.5 * wave(7.0 * a + 2.0) * wave(9.0 * b + 2.0))
}

fn scene() -> String {
    let mut text = "format = \"lightcuts-scene\"\nversion = 1\n\n[camera]\nposition = [0, -0.4, 4.7]\n\
                    target = [0, -0.3, 0]\nfov = 62\n\n\
                    [[material]]\nname = \"plaster\"\ntype = \"lambert\"\nalbedo = [0.6, 0.57, 0.52]\n\n\
                    [[material]]\nname = \"stone\"\ntype = \"lambert\"\nalbedo = [0.45, 0.47, 0.5]\n\n\
                    [[mesh]]\nname = \"walls\"\nfile = \"walls.ply\"\n\n\
                    [[object]]\ntype = \"mesh\"\nmesh = \"walls\"\nmaterial = \"plaster\"\nsmooth = false\n"
        .to_owned();
    for (x, z) in [-3.0, 0.0, 3.0].iter().flat_map(|x| [-3.0, -0.5, 2.0].map(|z| (x, z))) {
        let _ = write!(
            text,
            "\n[[object]]\ntype = \"box\"\nmaterial = \"stone\"\ncenter = [{x:?}, 0, {z:?}]\nsize = [0.4, 4, 0.4]\n"
        );
    }
    for k in 0..LAMPS {
        text += &lamp(k);
    }
    text
}

/// A lamp somewhere in the room, that shines somewhere in a colour of its own.
fn lamp(k: u32) -> String {
    let [a, b, c, red] = random4(k, 0, 0, STREAM);
    let [d, e, f, green] = random4(k, 1, 0, STREAM);
    let center = (Vec3::new(a, b, c) * 2.0 - 1.0) * (HALF - 0.25);
    let normal = (Vec3::new(d, e, f) - 0.5).normalize_or(Vec3::Y);
    let color = Vec3::new(0.2 + red, 0.2 + green, 1.2 - red) * RADIANCE;
    let head = normal.any_orthogonal_vector();
    format!(
        "\n[[light]]\ntype = \"rectangle\"\ncenter = {:?}\nnormal = {:?}\nhead = {:?}\nwidth = {LAMP_SIZE}\n\
         height = {LAMP_SIZE}\nradiance = {:?}\n",
        center.to_array(),
        normal.to_array(),
        head.to_array(),
        color.to_array()
    )
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::physical::load;

    #[test]
    fn the_room_has_its_lamps_and_triangles() {
        let folder = tempfile::tempdir().unwrap();
        let world = load(&write(folder.path()).unwrap(), &[]).unwrap();
        assert_eq!(world.emitters.len(), LAMPS as usize);
        assert_eq!(walls().lines().filter(|line| line.starts_with("3 ")).count(), 99_372);
        assert!((HALF - 0.13).cmple(world.bounds.1).all() && world.bounds.1.cmple(HALF + 0.01).all());
    }
}
