//! Cornell University's box as others have rendered it, with their figures.

use crate::physical;
use anyhow::{Context as _, Result};
use lightcuts::PhysicalWorld;
use serde::Deserialize;
use std::fmt::Write as _;
use std::fs;
use std::path::{Path, PathBuf};

use crate::place;

/// Where it may lie, beside the checkout: it is not part of the project.
const FOLDER: &str = "../shared/data/peers/cornell";

/// relMSE of others at 1, 3, 10 and 30 s of two threads, without denoising, as the README beside the scene has them.
pub(super) const PEERS: [(&str, [Option<f64>; 4]); 4] = [
    ("Mitsuba 3.9.1 llvm_ad_rgb", [Some(5.3e-3), Some(1.47e-3), Some(4.6e-4), Some(1.5e-4)]),
    ("Mitsuba 3.9.1 scalar_rgb", [Some(2.3e-2), Some(6.3e-3), None, None]),
    ("Cycles 5.2.3", [Some(4.3e-2), Some(1.34e-2), Some(3.5e-3), Some(1.0e-3)]),
    ("LuxCore 2.11.2 PATHCPU", [Some(6.5e-2), Some(1.8e-2), None, None]),
];
pub(super) const PEERS_SECONDS: [f64; 4] = [1.0, 3.0, 10.0, 30.0];

#[derive(Debug, Deserialize)]
struct Description {
    camera: Camera,
    meshes: Vec<Mesh>,
}

#[derive(Debug, Deserialize)]
struct Camera {
    origin: [f32; 3],
    target: [f32; 3],
    up: [f32; 3],
    fov_deg: f32,
}

#[derive(Debug, Deserialize)]
struct Mesh {
    name: String,
    ply: String,
    albedo: [f32; 3],
    emission: [f32; 3],
}

/// Its folder; a line is printed where it is absent.
pub(super) fn find() -> Option<PathBuf> {
    let folder = place::root().join(FOLDER);
    if folder.is_dir() {
        return Some(folder);
    }
    println!("skipped: the Cornell box, {FOLDER}, is not here");
    None
}

/// The world of the box; its scene file is written to `made`.
pub(super) fn load(folder: &Path, made: &Path) -> Result<PhysicalWorld> {
    let json = fs::read_to_string(folder.join("scene.json")).context("cannot read the Cornell box's scene.json")?;
    let description: Description = serde_json::from_str(&json).context("scene.json lacks something")?;
    let path = made.join("cornell.toml");
    fs::write(&path, scene(&description)).with_context(|| format!("cannot write {}", path.display()))?;
    physical::load(&path, &[folder])
}

fn scene(description: &Description) -> String {
    let Camera { origin, target, up, fov_deg } = &description.camera;
    let mut text = format!(
        "format = \"lightcuts-scene\"\nversion = 1\n\n[camera]\nposition = {origin:?}\ntarget = {target:?}\nup = {up:?}\n\
         fov = {fov_deg:?}\n"
    );
    for Mesh { name, ply, albedo, emission } in &description.meshes {
        let _ = write!(text, "\n[[material]]\nname = \"{name}\"\ntype = \"lambert\"\nalbedo = {albedo:?}\n");
        if *emission != [0.0; 3] {
            let _ = writeln!(text, "emission = {emission:?}");
        }
        let _ = write!(
            text,
            "\n[[mesh]]\nname = \"{name}\"\nfile = \"{ply}\"\n\n[[object]]\ntype = \"mesh\"\nmesh = \"{name}\"\n\
             material = \"{name}\"\nsmooth = false\n"
        );
    }
    text
}
