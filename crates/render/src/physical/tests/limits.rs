//! Renders that end before their samples: by time, by noise, by a person.

use super::scenes::{caustic_room, render, room, settings};
use crate::cpu::Simd;
use crate::monitor::{Monitor, Stage};
use crate::physical::{Aovs, PhysicalRendering, render_physical};
use crate::settings::{Integrator, Settings, Strategy};
use crate::stats::End;
use lightcuts_scene::physical::PhysicalScene;
use lightcuts_world::PhysicalWorld;
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};
use std::time::Instant;

/// Breaks a render off when it has been asked so often, and counts what it is told.
struct Impatient {
    patience: u64,
    asked: AtomicU64,
    steps: AtomicU64,
    done: AtomicU64,
}

impl Impatient {
    fn new(patience: u64) -> Self {
        Self { patience, asked: 0.into(), steps: 0.into(), done: 0.into() }
    }
}

impl Monitor for Impatient {
    fn begin(&self, _: Stage, steps: u64) {
        self.steps.store(steps, Relaxed);
    }

    fn advance(&self) {
        self.done.fetch_add(1, Relaxed);
    }

    fn cancelled(&self) -> bool {
        self.asked.fetch_add(1, Relaxed) >= self.patience
    }
}

fn watched(scene: &PhysicalScene, settings: &Settings, monitor: &dyn Monitor) -> PhysicalRendering {
    let world = PhysicalWorld::new(scene).unwrap();
    render_physical(&world, settings, Simd::Auto, monitor).unwrap()
}

/// Every pixel of the room sees a wall: each layer has a value at each, whether it has a sample or not.
fn assert_whole(rendering: &PhysicalRendering, what: &str) {
    let Aovs { depth, normal, albedo, object_id, material_id, position, samples, .. } = rendering.aovs();
    let stats = &rendering.stats;
    for k in 0..depth.pixels().len() {
        let length = glam::Vec3::from(normal.pixels()[k]).length();
        assert!(depth.pixels()[k].is_finite() && (0.5..1.01).contains(&length), "{what} {k}");
        assert!(albedo.pixels()[k] != [0.0; 3] || material_id.pixels()[k] == 4, "{what} {k}: only the lamp is black");
        assert!(object_id.pixels()[k] > 0 && position.pixels()[k] != [0.0; 3], "{what} {k}");
    }
    let unsampled = samples.pixels().iter().filter(|&&n| n == 0.0).count() as u64;
    assert_eq!(stats.unsampled_pixels, unsampled, "{what}");
    let mean = samples.pixels().iter().map(|&n| f64::from(n)).sum::<f64>() / samples.pixels().len() as f64;
    assert!((stats.samples_per_pixel - mean).abs() < 1e-6, "{what}");
}

/// The camera of the room moved into it, so that no pixel looks past it.
fn closed(mut scene: PhysicalScene) -> PhysicalScene {
    scene.camera.position.z = 0.95;
    scene
}

/// A picture that cannot be finished in time by far is over in time all the same, and whole.
#[test]
fn a_limit_of_time_holds_in_the_first_pass() {
    let scene = closed(caustic_room());
    for (integrator, caustics, vpls) in [
        (Integrator::Path, false, 2000),
        (Integrator::Path, true, 2000),
        (Integrator::Lightcuts, false, 2000),
        (Integrator::Lightcuts, true, 1_000_000),
        (Integrator::Auto, false, 2000),
    ] {
        let mut settings = settings(integrator, 2048, 0);
        settings.physical.time_limit = 0.2;
        settings.physical.vpls = vpls;
        settings.caustics.enabled = caustics;
        let began = Instant::now();
        let rendering = render(&scene, &settings);
        let what = format!("{integrator:?}, caustics {caustics}, {vpls} VPLs");
        println!("{what}: {:?}, {} samples", began.elapsed(), rendering.stats.samples_per_pixel);
        assert_eq!((rendering.stats.end, rendering.stats.complete), (End::Time, true), "{what}");
        assert!(rendering.stats.unsampled_pixels > 0 && rendering.stats.relative_error.is_none(), "{what}");
        assert_whole(&rendering, &what);
    }
}

/// Time for about one pass and a half: the first pass is finished, and no pixel shows another one's sample.
#[test]
fn a_limit_of_time_that_is_enough_leaves_no_pixel_out() {
    let scene = closed(room(true));
    for integrator in [Integrator::Path, Integrator::Lightcuts, Integrator::Auto] {
        let mut settings = settings(integrator, 24, 0);
        settings.physical.time_limit = 0.6;
        settings.physical.vpls = 300;
        let rendering = render(&scene, &settings);
        let stats = &rendering.stats;
        assert_eq!((stats.end, stats.complete, stats.unsampled_pixels), (End::Time, true, 0));
        assert_eq!(stats.samples_wanted, None);
        assert!(stats.samples_per_pixel >= 1.0 && stats.relative_error.is_some(), "{integrator:?}");
        assert_whole(&rendering, &format!("{integrator:?}"));
    }
}

/// Whenever it is broken off, in the sketch, among the VPLs or in any pass, a picture is whole.
#[test]
fn a_render_that_is_broken_off_is_whole() {
    let scene = closed(room(true));
    for (integrator, strategy) in [
        (Integrator::Path, Strategy::Lightcuts),
        (Integrator::Lightcuts, Strategy::Lightcuts),
        (Integrator::Auto, Strategy::Auto),
    ] {
        for patience in [0, 1, 3, 10, 30, 60, 100, 200, 300, 500, 1000, 3000] {
            let mut settings = settings(integrator, 60, 1000);
            settings.gather.strategy = strategy;
            settings.physical.vpls = 200;
            let rendering = watched(&scene, &settings, &Impatient::new(patience));
            let what = format!("{integrator:?} {patience}");
            assert_eq!((rendering.stats.end, rendering.stats.complete), (End::Interrupted, false), "{what}");
            assert_eq!(rendering.stats.samples_wanted, Some(1000));
            assert_whole(&rendering, &what);
        }
    }
}

/// What a finished first pass shows does not depend on the sketch before it: a limit that is never reached changes no
/// bit.
#[test]
fn limits_that_are_not_reached_change_no_bit() {
    for integrator in [Integrator::Path, Integrator::Lightcuts] {
        let plain = render(&room(true), &settings(integrator, 40, 2));
        let mut limited = settings(integrator, 40, 2);
        limited.physical.time_limit = 1000.0;
        let limited = render(&room(true), &limited);
        assert_eq!(limited.beauty.pixels(), plain.beauty.pixels());
        assert_eq!((limited.stats.end, plain.stats.end), (End::Samples, End::Samples));
        assert_eq!(plain.stats.samples_per_pixel, 2.0);
    }
}

/// The estimate of the error that is left is about the error that is left: not below it, and above it as far as
/// low-discrepancy points do better than independent ones, which the estimate takes them for: here two to three times.
#[test]
fn the_error_that_is_told_is_the_error_that_is_left() {
    let scene = closed(room(false));
    let reference = render(&scene, &settings(Integrator::Path, 20, 4096));
    for (integrator, samples) in [(Integrator::Path, 64), (Integrator::Lightcuts, 16)] {
        let rendering = render(&scene, &settings(integrator, 20, samples));
        let brightness = |p: &[f32; 3]| f64::from(p.iter().sum::<f32>()) / 3.0;
        let pairs = rendering.beauty.pixels().iter().zip(reference.beauty.pixels());
        let errors = pairs.map(|(a, b)| ((brightness(a) - brightness(b)) / brightness(b)).powi(2));
        let error = (errors.sum::<f64>() / 400.0).sqrt();
        let told = rendering.stats.relative_error.unwrap();
        println!("{integrator:?}: {told:.4} told, {error:.4} found");
        assert!((0.8..4.0).contains(&(told / error)), "{integrator:?}: {told} {error}");
    }
}

#[test]
fn noise_ends_a_render_that_has_no_limit_of_samples() {
    let mut settings = settings(Integrator::Path, 16, 0);
    settings.physical.noise = 0.2;
    let rendering = render(&closed(room(false)), &settings);
    assert_eq!((rendering.stats.end, rendering.stats.complete), (End::Noise, true));
    assert!(rendering.stats.relative_error.unwrap() <= 0.2 && rendering.stats.samples_per_pixel >= 4.0);
}

/// A render that ends by itself has told all steps that it announced, whatever they are.
#[test]
fn steps_add_up() {
    for (samples, time_limit, noise, steps) in
        [(3, 0.0, 0.0, 12), (0, 0.1, 0.0, 1000), (0, 0.0, 0.5, 1000), (9, 50.0, 0.0, 1000)]
    {
        let mut settings = settings(Integrator::Path, 32, samples);
        (settings.physical.time_limit, settings.physical.noise) = (time_limit, noise);
        let monitor = Impatient::new(u64::MAX);
        watched(&room(false), &settings, &monitor);
        assert_eq!((monitor.steps.into_inner(), monitor.done.into_inner()), (steps, steps));
    }
}

#[test]
fn a_render_without_any_limit_is_refused() {
    let world = PhysicalWorld::new(&room(false)).unwrap();
    let error = render_physical(&world, &settings(Integrator::Path, 8, 0), Simd::Auto, &Impatient::new(0)).unwrap_err();
    assert_eq!(error.name, "sampling.samples");
    assert!(error.expected.contains("or 0, no limit, where there is one of time or noise"), "{error}");
}
