//! What is rendered, and with what the pictures are compared.

use super::reference::{self, Reference};
use super::{Scene, cornell, lamps};
use crate::physical::load;
use crate::place;
use anyhow::Result;
use lightcuts::PhysicalWorld;
use lightcuts::rendering::Integrator;
use std::path::Path;

/// Width and height of the pictures of our own scenes.
const SIZE: u32 = 128;

/// A scene that is ready.
pub(super) struct Case {
    pub(super) scene: Scene,
    pub(super) title: &'static str,
    pub(super) world: PhysicalWorld,
    pub(super) size: u32,
    pub(super) reference: Reference,
}

impl Case {
    /// `None`, with a printed line, where the scene is not here. `folder` is for scenes that are made.
    pub(super) fn new(scene: Scene, folder: &Path, args: &reference::Args) -> Result<Option<Self>> {
        let ours = |title, world: PhysicalWorld, name: &str, integrator| -> Result<Option<Self>> {
            let reference = Reference::rendered(&world, SIZE, name, integrator, args)?;
            Ok(Some(Self { scene, title, world, size: SIZE, reference }))
        };
        let file = |name: &str| load(&place::root().join("scenes/physical").join(name), &[]);
        match scene {
            Scene::Open => ours("open box", file("room.toml")?, "open", Integrator::Path),
            // Paths would need hours where no surface sees the lamp.
            Scene::Occluded => ours("occluded box", file("corner.toml")?, "occluded", Integrator::Lightcuts),
            Scene::Lamps => {
                let path = lamps::write(folder)?;
                ours("1,000 lamps in 100,000 triangles", load(&path, &[])?, "lamps", Integrator::Path)
            }
            Scene::Cornell => {
                let Some(box_) = cornell::find() else { return Ok(None) };
                let (world, reference) = (cornell::load(&box_, folder)?, Reference::read(&box_)?);
                let size = reference.picture.width() as u32;
                Ok(Some(Self { scene, title: "Cornell box", world, size, reference }))
            }
        }
    }
}
