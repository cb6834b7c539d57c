//! What must not change the picture, and what must.

use crate::{run, scene, small_scene};
use lightcuts_image::{Image, max_abs_difference};
use lightcuts_render::{
    FilterKind, Monitor, Options, Rendering, Settings, Simd, Stage, Strategy, Unwatched, render, vpls_from_csv,
    vpls_to_csv,
};
use lightcuts_testkit::shared;
use lightcuts_world::World;
use std::sync::atomic::{AtomicU64, Ordering};

/// Everything that a render yields, apart from times.
fn assert_same(a: &Rendering, b: &Rendering, what: &str) {
    let bits = |image: &Image| image.pixels().iter().flatten().map(|c| c.to_bits()).collect::<Vec<_>>();
    for (x, y) in [(&a.beauty, &b.beauty), (&a.first_pass, &b.first_pass), (&a.second_pass, &b.second_pass)] {
        assert!(bits(x) == bits(y), "{what}: pictures differ");
    }
    assert!(bits(&a.albedo) == bits(&b.albedo) && bits(&a.normal) == bits(&b.normal), "{what}: AOVs differ");
    assert_eq!(a.object_id, b.object_id, "{what}");
    assert_eq!(a.lights_selected, b.lights_selected, "{what}");
    assert_eq!(a.vpls, b.vpls, "{what}");
    assert_eq!((a.stats.rays, a.stats.vpl_count), (b.stats.rays, b.stats.vpl_count), "{what}");
}

fn on_threads(threads: usize, world: &World, settings: &Settings) -> Rendering {
    let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("a pool");
    pool.install(|| run(world, settings))
}

#[test]
fn any_number_of_threads_gives_the_same_bits() {
    for (name, reproduce) in [("gallery/cubes.txt", false), ("thesis/statue.txt", false), ("thesis/simple.txt", true)] {
        let (world, mut settings) = if reproduce { scene(name, Vec::new()) } else { small_scene(name) };
        settings.run.reproduce = reproduce;
        if !reproduce {
            settings.sampling.samples = 2;
            settings.sampling.adaptive_samples = 5;
            settings.filter.kind = FilterKind::Mitchell;
            settings.caustics.enabled = true;
            settings.bloom.enabled = true;
        }
        let one = on_threads(1, &world, &settings);
        assert!(one.stats.vpl_count > 20, "{name}");
        for threads in [2, 7] {
            assert_same(&one, &on_threads(threads, &world, &settings), &format!("{name} on {threads} threads"));
        }
    }
}

#[test]
fn simd_gives_the_same_bits() {
    for name in ["thesis/simple.txt", "thesis/ship.txt", "gallery/mirrors.txt"] {
        let (world, settings) = small_scene(name);
        let plain = Options { simd: Simd::Off, ..Options::default() };
        let plain = render(&world, &settings, &plain, &Unwatched).expect("the settings are valid");
        assert_same(&plain, &run(&world, &settings), name);
    }
}

/// Plain and lightcuts with threshold 0 are identical, on all three sizes of scene.
#[test]
fn threshold_zero_is_plain() {
    let mut scenes = vec![scene("thesis/simple.txt", Vec::new()), scene("thesis/statue.txt", Vec::new())];
    match shared("models") {
        Some(models) => {
            scenes.push(scene("thesis/venus.txt", vec![models.clone()]));
            scenes.push(scene("thesis/galleon.txt", vec![models]));
        }
        None => scenes.push(scene("thesis/ship.txt", Vec::new())),
    }
    for (world, mut settings) in scenes {
        (settings.image.width, settings.image.height) = (192, 192);
        settings.gather.threshold = 0.0;
        let mut with = |strategy| {
            settings.gather.strategy = strategy;
            run(&world, &settings)
        };
        let (plain, cut) = (with(Strategy::All), with(Strategy::Lightcuts));
        assert_same(&plain, &cut, "threshold 0");
        assert!((cut.stats.light_ratio_percent - 100.0).abs() < 1e-9);
    }
}

#[test]
fn the_bounded_tree_makes_the_picture_of_testing_every_light_with_fewer_visits() {
    for name in ["thesis/simple.txt", "thesis/statue.txt", "thesis/ship.txt", "gallery/cubes.txt"] {
        let (world, mut settings) = small_scene(name);
        settings.gather.threshold = 1e-5;
        settings.vpl.probability *= 4.0;
        settings.gather.strategy = Strategy::Lightcuts;
        let tree = run(&world, &settings);
        settings.gather.strategy = Strategy::LightcutsExhaustive;
        let exhaustive = run(&world, &settings);
        assert_same(&tree, &exhaustive, name);
        let (visits, lights) = (tree.stats.tree.visits_per_hit, exhaustive.stats.tree.visits_per_hit);
        println!(
            "{name}: {visits:.1} visits per hit for {lights} lights, ratio {:.1} %",
            tree.stats.light_ratio_percent
        );
        assert!(visits < lights, "{name}: {visits} of {lights}");
    }
}

#[test]
fn written_vpls_give_the_same_picture_again() {
    let (world, settings) = small_scene("thesis/simple.txt");
    let placed = run(&world, &settings);
    let vpls = vpls_from_csv(&vpls_to_csv(&placed.vpls)).expect("our own file");
    let options = Options { vpls: Some(vpls), ..Options::default() };
    let again = render(&world, &settings, &options, &Unwatched).expect("the settings are valid");
    assert_same(&placed, &again, "given VPLs");
}

#[test]
fn another_seed_is_another_picture_of_the_same_scene() {
    let (world, mut settings) = small_scene("thesis/simple.txt");
    let one = run(&world, &settings);
    settings.run.seed = 2;
    let two = run(&world, &settings);
    assert_ne!(one.vpls, two.vpls);
    let (a, b) = (mean(&one.first_pass), mean(&two.first_pass));
    assert!((a - b).abs() < 0.01 * a, "{a} {b}");
}

#[test]
fn adaptive_samples_go_to_the_edges() {
    let (world, mut settings) = small_scene("thesis/simple.txt");
    settings.vpl.enabled = false;
    let coarse = run(&world, &settings);
    settings.sampling.adaptive_samples = 64;
    let adaptive = run(&world, &settings);
    settings.sampling.adaptive_samples = 0;
    settings.sampling.samples = 64;
    let fine = run(&world, &settings);
    let error = |r: &Rendering| {
        let pairs = r.beauty.pixels().iter().zip(fine.beauty.pixels());
        pairs.map(|(a, b)| (0..3).map(|c| f64::from(a[c] - b[c]).powi(2)).sum::<f64>()).sum::<f64>()
    };
    let (before, after) = (error(&coarse), error(&adaptive));
    let rays = adaptive.stats.rays.primary as f64 / fine.stats.rays.primary as f64;
    println!("squared error {before:.3} -> {after:.3} with {:.0} % of the rays of 64 samples", rays * 100.0);
    assert!(after < before * 0.2 && rays < 0.5, "{before} {after} {rays}");
    assert!(adaptive.stats.adaptive_pixels > 100);
}

/// Cancels after some steps.
struct Impatient {
    steps: AtomicU64,
    limit: u64,
}

impl Monitor for Impatient {
    fn begin(&self, _: Stage, _: u64) {}
    fn advance(&self) {
        self.steps.fetch_add(1, Ordering::Relaxed);
    }
    fn cancelled(&self) -> bool {
        self.steps.load(Ordering::Relaxed) >= self.limit
    }
}

#[test]
fn a_cancelled_render_keeps_what_there_is() {
    let (world, mut settings) = scene("thesis/simple.txt", Vec::new());
    for reproduce in [false, true] {
        settings.run.reproduce = reproduce;
        let whole = run(&world, &settings);
        let monitor = Impatient { steps: AtomicU64::new(0), limit: 300 };
        let partial = render(&world, &settings, &Options::default(), &monitor).expect("the settings are valid");
        assert!(whole.stats.complete && !partial.stats.complete);
        let black = |image: &Image| image.pixels().iter().filter(|p| **p == [0.0; 3]).count();
        let (rows, missing) = (partial.first_pass.height(), black(&partial.first_pass));
        assert!(missing > black(&whole.first_pass) && missing < rows * rows, "{missing}");
        // The bottom row was rendered first.
        let bottom = |image: &Image| image.row(rows - 1).to_vec();
        assert_eq!(bottom(&partial.first_pass), bottom(&whole.first_pass));
    }
}

fn mean(image: &Image) -> f64 {
    image.pixels().iter().flatten().map(|&c| f64::from(c)).sum::<f64>() / (image.pixels().len() * 3) as f64
}

#[test]
fn a_wider_picture_shows_the_same_in_its_middle() {
    let (world, mut settings) = scene("thesis/simple.txt", Vec::new());
    settings.vpl.enabled = false;
    (settings.image.width, settings.image.height) = (64, 64);
    settings.sampling.samples = 64;
    let small = run(&world, &settings).beauty;
    (settings.image.width, settings.image.height) = (128, 64);
    let wide = run(&world, &settings).beauty;
    let middle = Image::from_fn(64, 64, |x, y| wide.get(x + 32, y));
    assert!(max_abs_difference(&small, &middle).expect("equal sizes") < 0.2);
    assert!((mean(&small) / mean(&middle) - 1.0).abs() < 0.01);
}

#[test]
fn size_and_samples_change_neither_the_number_of_vpls_nor_the_brightness() {
    let (world, mut settings) = scene("thesis/simple.txt", Vec::new());
    let mut with = |size: u32, samples: u32| {
        (settings.image.width, settings.image.height) = (size, size);
        settings.sampling.samples = samples;
        let rendering = run(&world, &settings);
        (rendering.stats.vpl_count as f64, mean(&rendering.second_pass))
    };
    let (count, brightness) = with(512, 1);
    for (size, samples) in [(128, 1), (128, 9), (600, 1)] {
        let (other_count, other_brightness) = with(size, samples);
        // About 290 of them: a standard deviation of 17 each.
        assert!((other_count - count).abs() < 90.0, "{size} {samples}: {other_count} {count}");
        assert!(
            (other_brightness / brightness - 1.0).abs() < 0.25,
            "{size} {samples}: {other_brightness} {brightness}"
        );
    }
}

#[test]
fn without_a_second_pass_vpls_are_placed_all_the_same_and_no_photon_is_shot() {
    let (world, mut settings) = scene("thesis/simple.txt", Vec::new());
    settings.caustics.enabled = true;
    for reproduce in [false, true] {
        settings.run.reproduce = reproduce;
        settings.vpl.enabled = true;
        let both = run(&world, &settings);
        settings.vpl.enabled = false;
        let first = run(&world, &settings);
        assert!(both.stats.rays.photon > 0 && first.stats.rays.photon == 0);
        assert_eq!(both.vpls, first.vpls);
        assert_eq!(both.first_pass, first.first_pass);
        assert!(first.second_pass.pixels().iter().all(|p| *p == [0.0; 3]));
    }
}
