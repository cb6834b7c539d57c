//! Faults at any moment: the picture is complete and the same, and the user is told.

use crate::support::{has_adapter, on_gpu, open, small_scene};
use lightcuts_gpu::{GpuOptions, Sabotage};
use lightcuts_image::{fraction_within, max_abs_difference};
use lightcuts_kernel::rng::random4;
use lightcuts_render::{Monitor, Options, Rendering, Settings, Stations, render_on};
use lightcuts_world::World;
use std::sync::{Arc, Mutex};

/// Greatest difference of a picture whose rest the CPU rendered, with VPLs in another order of summation.
const TOLERANCE: f32 = 1e-4;

/// Keeps what the user is told.
#[derive(Default)]
struct Listener(Mutex<Vec<String>>);

impl Monitor for Listener {
    fn note(&self, text: &str) {
        self.0.lock().expect("nobody panics").push(text.to_owned());
    }
}

fn sabotaged(world: &World, settings: &Settings, sabotage: Sabotage) -> (Rendering, Vec<String>) {
    let options = GpuOptions { sabotage: Arc::new(sabotage), ..GpuOptions::default() };
    let device = open(world, &options);
    let listener = Listener::default();
    let stations = Stations::all(&device);
    let rendering = render_on(world, settings, &Options::default(), &stations, &listener).expect("valid settings");
    (rendering, listener.0.into_inner().expect("nobody panics"))
}

fn settings_with_everything() -> (World, Settings) {
    let (world, mut settings) = small_scene("gallery/caustics.txt");
    settings.caustics.enabled = true;
    settings.bloom.enabled = true;
    (world, settings)
}

fn assert_whole(expected: &Rendering, rendering: &Rendering, what: &str) {
    assert!(rendering.stats.complete, "{what}");
    assert_eq!(expected.vpls.len(), rendering.vpls.len(), "{what}");
    let worst = max_abs_difference(&expected.beauty, &rendering.beauty).expect("equal sizes");
    let share = fraction_within(&expected.beauty, &rendering.beauty, TOLERANCE).expect("equal sizes");
    assert!(share >= 0.999, "{what}: {share}, greatest difference {worst}");
}

/// How many submissions and allocations an undisturbed render takes.
fn undisturbed(world: &World, settings: &Settings) -> (Rendering, u64, u64) {
    let sabotage = Arc::new(Sabotage::default());
    let device = open(world, &GpuOptions { sabotage: Arc::clone(&sabotage), ..GpuOptions::default() });
    let rendering = on_gpu(&device, world, settings);
    (rendering, sabotage.submissions(), sabotage.allocations())
}

#[test]
fn a_device_lost_at_twenty_moments_costs_no_pixel() {
    if !has_adapter() {
        return;
    }
    let (world, settings) = settings_with_everything();
    let (expected, submissions, _) = undisturbed(&world, &settings);
    let mut faults = 0;
    for k in 0..20 {
        let moment = (random4(k, 0, 0, 4)[0] * submissions as f32) as u64;
        let (rendering, notes) = sabotaged(&world, &settings, Sabotage::new(&[moment], &[]));
        assert_whole(&expected, &rendering, &format!("lost before submission {moment} of {submissions}"));
        faults += rendering.stats.device_faults;
        assert_eq!(rendering.stats.device_faults > 0, !notes.is_empty(), "the user is told: {notes:?}");
    }
    // How many submissions a render takes varies with the device's speed: the last ones may not come.
    println!("{faults} of 20 renders lost their device, among {submissions} submissions");
    assert!(faults >= 8, "{faults}");
}

#[test]
fn a_device_lost_again_and_again_leaves_the_rest_to_the_cpu() {
    if !has_adapter() {
        return;
    }
    let (world, settings) = settings_with_everything();
    let (expected, submissions, _) = undisturbed(&world, &settings);
    let every: Vec<u64> = (submissions / 4..submissions * 10).collect();
    let (rendering, notes) = sabotaged(&world, &settings, Sabotage::new(&every, &[]));
    assert_whole(&expected, &rendering, "lost for good");
    println!("{notes:#?}");
    assert!(rendering.stats.device_faults >= 2 && notes.len() >= 2);
    assert_eq!(rendering.stats.devices.last().map(|device| device.kind.as_str()), Some("cpu"));
}

#[test]
fn memory_that_runs_out_costs_no_pixel() {
    if !has_adapter() {
        return;
    }
    let (world, settings) = settings_with_everything();
    let (expected, _, allocations) = undisturbed(&world, &settings);
    let at_start = {
        let sabotage = Arc::new(Sabotage::default());
        drop(open(&world, &GpuOptions { sabotage: Arc::clone(&sabotage), ..GpuOptions::default() }));
        sabotage.allocations()
    };
    assert!(allocations > at_start + 3, "{at_start} {allocations}");
    for refused in [vec![at_start], vec![at_start + 2], (at_start..at_start + 1000).collect()] {
        let (rendering, notes) = sabotaged(&world, &settings, Sabotage::new(&[], &refused));
        assert_whole(&expected, &rendering, &format!("{} allocations refused", refused.len()));
        assert!(rendering.stats.device_faults > 0 && notes.iter().any(|note| note.contains("memory")), "{notes:?}");
    }
}
