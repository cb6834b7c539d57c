//! Rendering with very many lights: global illumination from virtual point lights and lightcuts.
//!
//! This crate re-exports what programs that embed the renderer need, under one name.
//!
//! Scenes have one of two models of light. The thesis' model (Phong shading without falloff, after Tong Zhang 2011):
//!
//! ```no_run
//! use lightcuts::{ImportOptions, Options, Settings, Unwatched, World, image};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let scene = lightcuts::load("scene.txt".as_ref(), &ImportOptions::default())?.scene;
//!     let world = World::new(&scene)?;
//!
//!     // What the scene's author recommends, at another size.
//!     let mut settings = Settings::for_scene(&scene);
//!     (settings.image.width, settings.image.height) = (640, 480);
//!
//!     let rendering = lightcuts::render(&world, &settings, &Options::default(), &Unwatched)?;
//!     image::write_exr("scene.exr", &rendering.layers())?;
//!     println!("{} VPLs", rendering.vpls.len());
//!     Ok(())
//! }
//! ```
//!
//! The stations of a picture, one way only: [`load`] makes a [`SceneDesc`] of files, [`World::new`] makes a flat
//! [`World`] of it, [`render()`] makes a [`Rendering`] of the world and the [`Settings`], and [`image`] makes files of
//! that. A [`Monitor`] receives the progress and may cancel the render.
//!
//! The physical model has radiometric units and converges to the solution of the rendering equation. [`load_any`] reads
//! scenes of either model:
//!
//! ```no_run
//! use lightcuts::{AnyScene, ImportOptions, PhysicalWorld, Settings, Simd, Unwatched, image};
//!
//! fn main() -> Result<(), Box<dyn std::error::Error>> {
//!     let scene = lightcuts::load_any("scene.toml".as_ref(), &ImportOptions::default())?.scene;
//!     let AnyScene::Physical(scene) = scene else { return Err("not a scene of the physical model".into()) };
//!     let world = PhysicalWorld::new(&scene)?;
//!
//!     let mut settings = Settings::for_physical();
//!     settings.sampling.samples = 256;
//!
//!     let rendering = lightcuts::render_physical(&world, &settings, Simd::Auto, &Unwatched)?;
//!     image::write_exr("scene.exr", &rendering.layers())?;
//!     Ok(())
//! }
//! ```
//!
//! In the thesis' model, [`render_on`] runs each station on a [`device`]; a [`gpu::Fleet`] opens those that are
//! requested:
//!
//! ```no_run
//! use lightcuts::gpu::{self, Assignment, DeviceChoice, Fleet, GpuOptions};
//! use lightcuts::{Options, PerStation, Rendering, Settings, Simd, Unwatched, World};
//!
//! fn on_a_gpu(world: &World, settings: &Settings) -> Result<Rendering, Box<dyn std::error::Error>> {
//!     // A graphics card if there is one, else the CPU; `DeviceChoice::Gpu` fails without any.
//!     let wanted = PerStation::all(DeviceChoice::Auto);
//!     let assignment = Assignment::new(&wanted, &gpu::adapters())?;
//!     let note = |text: &str| eprintln!("{text}");
//!     let fleet = Fleet::open(&assignment, world, Simd::Auto, &GpuOptions::default(), &note)?;
//!     Ok(lightcuts::render_on(world, settings, &Options::default(), &fleet.stations(), &Unwatched)?)
//! }
//! ```

pub use lightcuts_import::{AnyScene, ImportError, ImportOptions, Imported, load, load_any};
pub use lightcuts_render::{
    Monitor, Options, PerStation, PhysicalRendering, Rendering, Settings, SettingsError, Simd, Stage, Station,
    Stations, Stats, Unwatched, VplCsvError, device, render, render_on, render_physical, vpls_from_csv, vpls_to_csv,
};
pub use lightcuts_scene::SceneDesc;
pub use lightcuts_world::{PhysicalWorld, World, WorldError};

/// GPUs: adapters, devices, and who runs which station.
pub mod gpu {
    pub use lightcuts_gpu::*;
}

/// Pictures: layers, tone mapping, bloom, EXR and PNG files.
pub mod image {
    pub use lightcuts_image::*;
}

/// Importers: scene and model files to scene descriptions.
pub mod import {
    pub use lightcuts_import::*;
}

/// Scene descriptions: for scenes made in code, and to look into those that were read.
pub mod scene {
    pub use lightcuts_scene::*;
}

/// The tables of [`Settings`] and what a render reports.
pub mod rendering {
    pub use lightcuts_render::*;
}

/// Flat, immutable worlds: what rendering reads.
pub mod world {
    pub use lightcuts_world::*;
}
