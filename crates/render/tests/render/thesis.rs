//! The thesis' own numbers and pictures.

use crate::scene;
use lightcuts_image::{fraction_within, read_exr};
use lightcuts_render::{Options, Rendering, Settings, Strategy, Unwatched, render};
use lightcuts_testkit::shared;
use lightcuts_world::World;
use std::path::PathBuf;

/// A thesis scene prepared for reproduction, or `None` where its model is absent.
fn prepare(name: &str, model: Option<&str>) -> Option<(World, Settings)> {
    let search_paths: Vec<PathBuf> = match model {
        Some(model) => vec![shared(model)?.parent()?.to_owned()],
        None => Vec::new(),
    };
    let (world, mut settings) = scene(&format!("thesis/{name}"), search_paths);
    settings.run.reproduce = true;
    Some((world, settings))
}

fn reproduce(world: &World, settings: &Settings, strategy: Strategy) -> Rendering {
    let mut settings = settings.clone();
    settings.gather.strategy = strategy;
    render(world, &settings, &Options::default(), &Unwatched).expect("the settings are valid")
}

/// Appendix C: VPL count and light ratio in percent.
fn appendix_c(name: &str, model: Option<&str>, vpls: u64, ratio: f64) {
    let Some((world, settings)) = prepare(name, model) else { return };
    let stats = reproduce(&world, &settings, Strategy::Lightcuts).stats;
    println!(
        "{name}: {} VPLs, light ratio {:.4} %, {:.1} visits per hit",
        stats.vpl_count, stats.light_ratio_percent, stats.tree.visits_per_hit
    );
    assert_eq!(stats.vpl_count, vpls);
    assert!((stats.light_ratio_percent - ratio).abs() <= 0.01, "{}", stats.light_ratio_percent);
}

#[test]
fn appendix_c_simple() {
    appendix_c("simple.txt", None, 290, 68.313);
}

#[test]
fn appendix_c_venus() {
    appendix_c("venus.txt", Some("models/venus.obj"), 136, 60.020);
}

#[test]
fn appendix_c_galleon() {
    appendix_c("galleon.txt", Some("models/galleon.obj"), 131, 48.247);
}

#[test]
fn the_originals_pictures_of_simple() {
    let Some(folder) = shared("data/original") else { return };
    let (world, settings) = prepare("simple.txt", None).expect("the scene is the project's own");
    let plain = reproduce(&world, &settings, Strategy::All);
    let lightcuts = reproduce(&world, &settings, Strategy::Lightcuts);
    let pictures = [
        ("simple-pass1.exr", &plain.first_pass),
        ("simple.exr", &plain.beauty),
        ("simple-lightcuts.exr", &lightcuts.beauty),
    ];
    for (file, picture) in pictures {
        let original = read_exr(folder.join(file)).expect("the original's picture is readable").into_beauty();
        let share = fraction_within(picture, &original, 2.0 / 255.0).expect("both are 512 x 512");
        println!("{file}: {:.3} % of pixels within 2/255", share * 100.0);
        assert!(share >= 0.999, "{file}: {share}");
    }
}
