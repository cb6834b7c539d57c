//! Integrators and strategies against each other, and one picture whatever computes it.

use super::scenes::{caustic_room, mean, render, room, scaled, settings, variants};
use crate::cpu::Simd;
use crate::monitor::Unwatched;
use crate::physical::{PhysicalRendering, render_physical};
use crate::settings::{Integrator, Strategy};
use lightcuts_world::PhysicalWorld;

/// Every strategy shows what path tracing shows, at every pixel, as far as the noise of both tells: the greatest of all normal
/// deviates is not above what chance gives in a thousand (Sidak's correction).
#[test]
fn every_pixel_agrees_with_path_tracing() {
    for (name, scene) in variants() {
        let reference = render(&scene, &settings(Integrator::Path, 16, 1024));
        for (integrator, strategy) in [
            (Integrator::Lightcuts, Strategy::All),
            (Integrator::Lightcuts, Strategy::Lightcuts),
            (Integrator::Lightcuts, Strategy::Stochastic),
            (Integrator::Lightcuts, Strategy::Auto),
            (Integrator::Auto, Strategy::Lightcuts),
        ] {
            // Rare bright samples make means and variances small together where they are missing; `auto` divides its samples
            // among techniques and so needs more.
            let is_mixed = integrator == Integrator::Auto || strategy == Strategy::Auto;
            let mut settings = settings(integrator, 16, if is_mixed { 320 } else { 96 });
            settings.gather.strategy = strategy;
            settings.physical.vpls = 300;
            settings.physical.cut_error = 0.1;
            let rendering = render(&scene, &settings);
            let brightness =
                |r: &PhysicalRendering, k: usize| f64::from(r.beauty.pixels()[k].iter().sum::<f32>()) / 3.0;
            let mut deviates: Vec<f64> = Vec::new();
            for k in 0..256 {
                let variance = f64::from(reference.aovs().variance.pixels()[k] + rendering.aovs().variance.pixels()[k]);
                if variance > 0.0 {
                    deviates.push((brightness(&rendering, k) - brightness(&reference, k)) / variance.sqrt());
                }
            }
            let greatest = deviates.iter().map(|z| z.abs()).fold(0.0, f64::max);
            let mean_sq = deviates.iter().map(|z| z * z).sum::<f64>() / deviates.len() as f64;
            println!(
                "{name}, {integrator:?}, {strategy:?}: greatest |z| {greatest:.2}, mean z^2 {mean_sq:.2} of {}",
                deviates.len()
            );
            // 1 - (1 - 0.001)^(1 / 256) on both sides is 4.6 deviations.
            assert!(greatest < 4.6 && mean_sq < 1.5, "{name}, {integrator:?}, {strategy:?}: {greatest} {mean_sq}");
        }
    }
}

/// What photons bring and paths leave out is what paths alone would find: a glass ball, a mirror and a coated floor under a lamp.
#[test]
fn caustics_are_counted_once() {
    let scene = caustic_room();
    let plain = render(&scene, &settings(Integrator::Path, 16, 1024));
    for integrator in [Integrator::Path, Integrator::Lightcuts] {
        let mut settings = settings(integrator, 16, 128);
        settings.physical.vpls = 300;
        settings.caustics.enabled = true;
        let rendering = render(&scene, &settings);
        let ratio = mean(&rendering) / mean(&plain);
        println!("{integrator:?}: {ratio:.4}, {} photons", rendering.stats.photons_stored);
        assert!(rendering.stats.photons_stored > 10_000);
        assert!((ratio - 1.0).abs().max_element() < 0.02, "{integrator:?}: {ratio}");
    }
}

/// Light per area and angle knows no unit of length: a power of two changes no bit, and a factor of 1,000 only what rounding
/// does to single paths.
#[test]
fn a_thousand_times_as_large() {
    let scene = room(false);
    for integrator in [Integrator::Path, Integrator::Lightcuts] {
        let settings = settings(integrator, 24, 8);
        let small = render(&scene, &settings);
        assert_eq!(render(&scaled(&scene, 1024.0), &settings).beauty.pixels(), small.beauty.pixels());
        let ratio = mean(&render(&scaled(&scene, 1000.0), &settings)) / mean(&small);
        println!("{integrator:?}: {ratio:.5}");
        assert!((ratio - 1.0).abs().max_element() < 0.01, "{integrator:?}: {ratio}");
    }
}

/// The same numbers on any number of threads, with and without vector instructions.
#[test]
fn the_same_picture_bit_for_bit() {
    let world = PhysicalWorld::new(&room(true)).unwrap();
    let settings = settings(Integrator::Lightcuts, 20, 3);
    let on = |threads, simd| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
        pool.install(|| render_physical(&world, &settings, simd, &Unwatched).unwrap().beauty)
    };
    let expected = on(1, Simd::Off);
    assert_eq!(on(3, Simd::Auto).pixels(), expected.pixels());
}

/// What a pass costs goes by the number of its virtual lights, so it is the one that was asked for, whatever the pilot had.
#[test]
fn a_pass_has_about_as_many_virtual_lights_as_are_wanted() {
    for wanted in [200, 2_000, 40_000] {
        let mut settings = settings(Integrator::Lightcuts, 8, 1);
        settings.physical.vpls = wanted;
        let found = render(&room(true), &settings).stats.vpl_count;
        println!("{wanted} wanted, {found} found");
        assert!((f64::from(wanted) * 0.8..f64::from(wanted) * 1.25).contains(&(found as f64)), "{wanted}: {found}");
    }
}
