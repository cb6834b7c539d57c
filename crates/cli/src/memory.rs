//! Memory: how much a picture needs, how much there is, how much was used. What there is is known on Linux only.

mod free;

use crate::exit::Failure;
use crate::outputs::Kind;
use lightcuts::Settings;
use lightcuts::rendering::{Integrator, Model, Strategy};
use std::path::{Path, PathBuf};

/// Memory for every pixel of a thesis scene, in bytes: films, surfaces seen, layers, the encoded file. Measured: at most 206, written as
/// EXR; the rest is for bloom and tone mapping.
const THESIS: u64 = 250;

/// Of the physical model, in bytes for every pixel: what its samples saw, with the brightness of its surroundings and the sketch of
/// the first pass.
const SUMS: u64 = 125;
/// Two films and the moments of each technique.
const TECHNIQUE: u64 = 56;
/// Colours and variance, which are made while the films are still there.
const COLOURS: u64 = 40;
/// All layers.
const LAYERS: u64 = 100;
/// What writing takes on top of the layers: the blocks of an EXR and the file that they are joined to, at their least compression;
/// the pixels of a PNG before and after tone mapping, as codes and as a file.
const WRITING_EXR: u64 = 175;
const WRITING_PNG: u64 = 60;

/// The program itself, its threads and tables, in bytes.
const PROGRAM: u64 = 32 << 20;

/// Of each VPL of a pass, in bytes, with those that were judged and not kept, and the tree.
const VPL: u64 = 500;

/// What a job needs at once, in bytes, beside the scene.
fn need(settings: &Settings, files: &[(Kind, PathBuf)]) -> u64 {
    let size = settings.image;
    let pixels = u64::from(size.width) * u64::from(size.height);
    if settings.run.model == Model::Thesis {
        return pixels * THESIS;
    }
    let gathered = if settings.gather.strategy == Strategy::Auto { 3 } else { 1 };
    let (techniques, vpls) = match settings.physical.integrator {
        Integrator::Path => (1, 0),
        Integrator::Lightcuts => (gathered, settings.physical.vpls),
        Integrator::Auto => (1 + gathered, settings.physical.vpls),
    };
    let rendering = SUMS + techniques * TECHNIQUE + COLOURS;
    let developing = SUMS + LAYERS;
    let is_written = |kind| files.iter().any(|(of, _)| *of == kind);
    let writing = if is_written(Kind::Exr) { WRITING_EXR } else { WRITING_PNG };
    PROGRAM + pixels * rendering.max(developing).max(LAYERS + writing) + u64::from(vpls) * VPL
}

/// Fails if a job does not fit into free memory and swap: running out of them would end the process in the middle of the render.
/// Where nobody tells how much is free, every size is let through.
pub(crate) fn require_for(settings: &Settings, files: &[(Kind, PathBuf)]) -> Result<(), Failure> {
    let (need, size) = (need(settings, files), settings.image);
    match free::free_bytes(Path::new("/")) {
        Some(free) if free < need => Err(Failure::usage(
            format!("a picture of {} x {} pixels needs about {} of memory", size.width, size.height, mebibytes(need)),
            format!("{} are free, swap included; choose a smaller --size", mebibytes(free)),
        )),
        _ => Ok(()),
    }
}

/// Lets freed memory be used again rather than go back to the system: what tiles yield comes and goes all the time, and a page that
/// is had anew costs about as much as a pixel's rays.
///
/// The GNU allocator gives back what is free above a limit, and moves the limit to twice the size of a large block when that is freed.
/// This one is never touched, so that it takes no memory; other allocators are none the wiser.
pub(crate) fn keep_freed() {
    drop(std::hint::black_box(Vec::<u8>::with_capacity(16 << 20)));
}

/// Most memory that this process had at once so far, in bytes.
pub(crate) fn peak_bytes() -> Option<u64> {
    free::kibibytes_of(Path::new("/proc/self/status"), "VmHWM:")
}

/// A number of bytes for people, rounded down to whole MiB.
fn mebibytes(bytes: u64) -> String {
    format!("{} MiB", bytes >> 20)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts::scene::Location;
    use lightcuts::scene::physical::{
        EnvironmentDesc, PhysicalObject, PhysicalScene, PhysicalShape, SurfaceDesc, SurfaceId,
    };
    use lightcuts::{PhysicalRendering, PhysicalWorld, Simd, Unwatched};

    /// A large ball, half in the dark.
    fn scene() -> PhysicalScene {
        let shape = PhysicalShape::Sphere { center: [0.0, 0.0, -3.0].into(), radius: 2.0 };
        let (material, location) = (SurfaceId(0), Location::default());
        PhysicalScene {
            objects: vec![PhysicalObject { name: String::new(), shape, material, location }],
            materials: vec![SurfaceDesc::default()],
            environment: Some(EnvironmentDesc {
                radiance: [1.0; 3].into(),
                image: None,
                degrees: 0.0,
                location: Location::default(),
            }),
            ..PhysicalScene::default()
        }
    }

    fn resident(key: &str) -> u64 {
        free::kibibytes_of(Path::new("/proc/self/status"), key).unwrap()
    }

    /// What a render and writing its EXR take is not more than what is asked for, and not so much less that it would refuse what
    /// fits.
    #[test]
    fn as_much_is_asked_for_as_is_used() {
        // 5: what was most so far is forgotten.
        if std::fs::write("/proc/self/clear_refs", "5").is_err() {
            println!("skipped: this system does not tell how much memory is used");
            return;
        }
        let world = PhysicalWorld::new(&scene()).unwrap();
        let folder = tempfile::tempdir().unwrap();
        let mut settings = Settings::for_physical();
        (settings.image.width, settings.image.height) = (600, 600);
        for (integrator, samples) in [(Integrator::Path, 2), (Integrator::Lightcuts, 1), (Integrator::Auto, 6)] {
            settings.physical.integrator = integrator;
            settings.sampling.samples = samples;
            settings.physical.vpls = 300;
            std::fs::write("/proc/self/clear_refs", "5").unwrap();
            let before = resident("VmRSS:");
            let rendering: PhysicalRendering =
                lightcuts::render_physical(&world, &settings, Simd::Auto, &Unwatched).unwrap();
            let path = folder.path().join("a.exr");
            lightcuts::image::write_exr(&path, &rendering.into_layers()).unwrap();
            let (used, need) = (resident("VmHWM:") - before, need(&settings, &[(Kind::Exr, path)]));
            let per_pixel = |bytes: u64| bytes as f64 / (600.0 * 600.0);
            println!("{integrator:?}: {:.0} bytes a pixel used, {:.0} asked for", per_pixel(used), per_pixel(need));
            assert!(used <= need && used > need / 3, "{integrator:?}: {used} {need}");
        }
    }

    #[test]
    fn more_techniques_and_more_vpls_need_more() {
        let of = |integrator, strategy, vpls, kind| {
            let mut settings = Settings::for_physical();
            (settings.image.width, settings.image.height) = (1000, 1000);
            (settings.physical.integrator, settings.gather.strategy) = (integrator, strategy);
            settings.physical.vpls = vpls;
            need(&settings, &[(kind, PathBuf::new())])
        };
        let path = of(Integrator::Path, Strategy::Lightcuts, 2000, Kind::Png);
        let auto = of(Integrator::Auto, Strategy::Auto, 2000, Kind::Png);
        assert!(auto > path && of(Integrator::Auto, Strategy::Lightcuts, 2000, Kind::Png) < auto);
        assert!(of(Integrator::Path, Strategy::Lightcuts, 2000, Kind::Exr) > path);
        let many = of(Integrator::Lightcuts, Strategy::Lightcuts, 1_000_000, Kind::Png);
        assert!(many >= of(Integrator::Lightcuts, Strategy::Lightcuts, 2000, Kind::Png) + 400_000_000);
    }
}
