//! Fence 4: whole pictures.

use crate::support::{has_adapter, on_cpu, on_gpu, open, scene, small_scene};
use lightcuts_gpu::GpuOptions;
use lightcuts_image::{fraction_within, max_abs_difference};
use lightcuts_render::{FilterKind, Rendering, Strategy, ToneMappingKind};
use lightcuts_testkit::shared;

/// Share of pixels that may differ by more than [`TOLERANCE`].
const OUTLIERS: f64 = 0.001;
/// Two code values of an eight-bit picture.
const TOLERANCE: f32 = 2.0 / 255.0;

/// Pictures, AOVs, VPLs and counts of both devices agree.
fn compare(name: &str, cpu: &Rendering, gpu: &Rendering) {
    let mut worst = 0.0_f32;
    for (what, a, b) in [
        ("beauty", &cpu.beauty, &gpu.beauty),
        ("first pass", &cpu.first_pass, &gpu.first_pass),
        ("second pass", &cpu.second_pass, &gpu.second_pass),
        ("albedo", &cpu.albedo, &gpu.albedo),
        ("normal", &cpu.normal, &gpu.normal),
    ] {
        worst = worst.max(max_abs_difference(a, b).expect("equal sizes"));
        let share = fraction_within(a, b, TOLERANCE).expect("equal sizes");
        assert!(share >= 1.0 - OUTLIERS, "{name}, {what}: {share}");
    }
    println!(
        "{name}: greatest difference {worst:.1e}; VPLs {} {}, light ratio {:.4} {:.4} %, shadow rays {} {}",
        cpu.vpls.len(),
        gpu.vpls.len(),
        cpu.stats.light_ratio_percent,
        gpu.stats.light_ratio_percent,
        cpu.stats.rays.shadow,
        gpu.stats.rays.shadow
    );
    assert_eq!(cpu.vpls.len(), gpu.vpls.len(), "{name}");
    assert!((cpu.stats.light_ratio_percent - gpu.stats.light_ratio_percent).abs() < 0.01, "{name}");
    let near = |a: u64, b: u64| a.abs_diff(b) <= 10 + a / 1000;
    let (a, b) = (cpu.stats.rays, gpu.stats.rays);
    assert!(
        a.primary == b.primary
            && near(a.secondary, b.secondary)
            && near(a.shadow, b.shadow)
            && near(a.occlusion, b.occlusion)
            && near(a.photon, b.photon),
        "{name}: {a:?} {b:?}"
    );
}

#[test]
fn every_scene_looks_the_same_on_both_devices() {
    if !has_adapter() {
        return;
    }
    let thesis = ["thesis/simple.txt", "thesis/statue.txt", "thesis/ship.txt"];
    let gallery = ["cubes", "mirrors", "textures", "sunlight", "orthographic", "materials", "area-light", "caustics"]
        .map(|name| format!("gallery/{name}.txt"));
    for name in thesis.into_iter().map(str::to_owned).chain(gallery) {
        let (world, settings) = small_scene(&name);
        let device = open(&world, &GpuOptions::default());
        compare(&name, &on_cpu(&world, &settings), &on_gpu(&device, &world, &settings));
    }
}

#[test]
fn every_effect_looks_the_same_on_both_devices() {
    if !has_adapter() {
        return;
    }
    let (world, plain) = small_scene("gallery/caustics.txt");
    let device = open(&world, &GpuOptions::default());
    let mut effects = plain.clone();
    effects.ambient_occlusion.enabled = true;
    effects.ambient_occlusion.step = 20.0;
    effects.caustics.enabled = true;
    effects.bloom.enabled = true;
    effects.run.max_depth = 7;
    let mut edges = plain.clone();
    edges.sampling.samples = 2;
    edges.sampling.adaptive_samples = 5;
    for (name, kind, settings) in [
        ("effects", FilterKind::Box, &effects),
        ("triangle", FilterKind::Triangle, &edges),
        ("Gaussian", FilterKind::Gaussian, &edges),
        ("Mitchell", FilterKind::Mitchell, &edges),
    ] {
        let mut settings = settings.clone();
        settings.filter.kind = kind;
        compare(name, &on_cpu(&world, &settings), &on_gpu(&device, &world, &settings));
    }
}

/// Strategies differ in which VPLs they choose, never in how they add them up.
#[test]
fn on_the_gpu_too_threshold_zero_is_plain_and_bounds_change_nothing() {
    if !has_adapter() {
        return;
    }
    for name in ["thesis/simple.txt", "gallery/cubes.txt"] {
        let (world, mut settings) = small_scene(name);
        let device = open(&world, &GpuOptions::default());
        let mut with = |strategy, threshold| {
            settings.gather.strategy = strategy;
            settings.gather.threshold = threshold;
            on_gpu(&device, &world, &settings)
        };
        let all = with(Strategy::All, 0.0);
        let zero = with(Strategy::Lightcuts, 0.0);
        assert_eq!(all.second_pass, zero.second_pass, "{name}");
        let (cut, tested) = (with(Strategy::Lightcuts, 1e-5), with(Strategy::LightcutsExhaustive, 1e-5));
        assert_eq!(cut.second_pass, tested.second_pass, "{name}");
        assert_eq!(cut.lights_selected, tested.lights_selected, "{name}");
        assert!(cut.stats.tree.visits_per_hit < tested.stats.tree.visits_per_hit, "{name}");
        assert_ne!(all.second_pass, cut.second_pass, "{name}");
    }
}

/// However the work is split, in time or in memory, the picture is the same bit for bit.
#[test]
fn budget_capacity_and_split_buffers_change_no_bit() {
    if !has_adapter() {
        return;
    }
    let (world, mut settings) = small_scene("thesis/ship.txt");
    settings.sampling.samples = 3;
    settings.filter.kind = FilterKind::Gaussian;
    let usual = on_gpu(&open(&world, &GpuOptions::default()), &world, &settings);
    let short = std::time::Duration::from_millis(1);
    for (what, options) in [
        ("budget", GpuOptions { budget: short, ..GpuOptions::default() }),
        ("no timestamps", GpuOptions { has_clock: false, ..GpuOptions::default() }),
        ("capacity", GpuOptions { capacity: Some(1), ..GpuOptions::default() }),
        ("split buffers", GpuOptions { max_binding: Some(100_000), ..GpuOptions::default() }),
    ] {
        let device = open(&world, &options);
        let other = on_gpu(&device, &world, &settings);
        assert_eq!(usual.beauty, other.beauty, "{what}");
        assert_eq!(usual.vpls, other.vpls, "{what}");
        let submissions: u64 = device.reports().iter().map(|report| report.submissions).sum();
        println!("{what}: {submissions} submissions");
    }
}

/// The thesis' numbers, and the pictures of the CPU, with the original's random numbers. Appendix C.
#[test]
fn reproduction_gives_the_thesis_numbers() {
    if !has_adapter() {
        return;
    }
    let cases = [("simple", 290, 68.313), ("venus", 136, 60.020), ("galleon", 131, 48.247)];
    for (name, vpls, ratio) in cases {
        let search_paths = match shared("models") {
            Some(models) => vec![models],
            None if name == "simple" => Vec::new(),
            None => continue,
        };
        let (world, mut settings) = scene(&format!("thesis/{name}.txt"), search_paths);
        settings.run.reproduce = true;
        let device = open(&world, &GpuOptions::default());
        let (cpu, gpu) = (on_cpu(&world, &settings), on_gpu(&device, &world, &settings));
        compare(name, &cpu, &gpu);
        assert_eq!(gpu.stats.vpl_count, vpls, "{name}");
        assert!((gpu.stats.light_ratio_percent - ratio).abs() <= 0.01, "{name}: {}", gpu.stats.light_ratio_percent);
    }
}

/// Tone mapping in single precision, beside the CPU's in double precision.
#[test]
fn tone_mapping_is_the_same_on_both_devices() {
    if !has_adapter() {
        return;
    }
    let (world, mut settings) = small_scene("gallery/mirrors.txt");
    settings.bloom.enabled = true;
    let device = open(&world, &GpuOptions::default());
    let rendering = on_cpu(&world, &settings);
    for (kind, tolerance) in
        [(ToneMappingKind::None, 0.0), (ToneMappingKind::Global, 1e-5), (ToneMappingKind::Local, 1e-3)]
    {
        settings.display.tone_mapping = kind;
        let cpu = rendering.displayed(&settings.display);
        let gpu = rendering.displayed_on(&settings.display, &device);
        let worst = max_abs_difference(&cpu, &gpu).expect("equal sizes");
        let share = fraction_within(&cpu, &gpu, 1e-5).expect("equal sizes");
        println!("{kind:?}: greatest difference {worst:.1e}, {:.2} % within 1e-5", share * 100.0);
        // A pixel's neighbourhood may be just even on one device and not on the other.
        assert!(worst <= tolerance && share >= 0.99, "{kind:?}: {worst} {share}");
        assert!(kind == ToneMappingKind::None || cpu != rendering.beauty, "{kind:?}");
    }
}
