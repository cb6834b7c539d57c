//! Fence 3: stations one by one. Each is made on one device and used on the other.

use crate::support::{has_adapter, on_cpu, on_stations, open, small_scene};
use lightcuts_gpu::{GpuDevice, GpuOptions};
use lightcuts_image::max_abs_difference;
use lightcuts_kernel::light::Vpl;
use lightcuts_render::device::{CpuDevice, Device};
use lightcuts_render::{Rendering, Settings, Simd, Station, Stations};
use lightcuts_world::World;

/// A VPL whose colour is so near to the least one may be chosen on one device only.
const MARGIN: f32 = 1e-4;
/// Greatest relative difference of a VPL's numbers.
const TOLERANCE: f32 = 1e-4;

fn prepared() -> (World, Settings) {
    let (world, mut settings) = small_scene("gallery/caustics.txt");
    settings.caustics.enabled = true;
    settings.bloom.enabled = true;
    (world, settings)
}

/// Every way to put one station alone on the GPU, and all but one.
fn mixtures<'a>(cpu: &'a CpuDevice<'a>, gpu: &'a GpuDevice<'a>) -> Vec<(String, Stations<'a>)> {
    let mut mixtures = Vec::new();
    for (few, many) in [(gpu as &dyn Device, cpu as &dyn Device), (cpu, gpu)] {
        for station in Station::ALL {
            let what = format!("{} on the {:?} alone", station.name(), few.info().kind);
            mixtures.push((what, Stations::all(many).with(station, few)));
        }
    }
    mixtures
}

#[test]
fn any_station_runs_on_any_device() {
    if !has_adapter() {
        return;
    }
    let (world, settings) = prepared();
    let (cpu, gpu) = (CpuDevice::new(&world, Simd::Auto), open(&world, &GpuOptions::default()));
    let expected = on_cpu(&world, &settings);
    for (what, stations) in mixtures(&cpu, &gpu) {
        let mixed = on_stations(&stations, &world, &settings);
        let worst = max_abs_difference(&expected.beauty, &mixed.beauty).expect("equal sizes");
        println!("{what}: greatest difference {worst:.1e}");
        assert!(worst < 1e-3, "{what}: {worst}");
        assert!((expected.stats.light_ratio_percent - mixed.stats.light_ratio_percent).abs() < 0.01, "{what}");
    }
}

/// Element by element: VPLs, what pixels saw, films. Decisions may flip only near their margins; flips are counted.
#[test]
fn what_stations_yield_agrees_element_by_element() {
    if !has_adapter() {
        return;
    }
    for name in ["thesis/simple.txt", "thesis/statue.txt", "gallery/mirrors.txt"] {
        let (world, settings) = small_scene(name);
        let device = open(&world, &GpuOptions::default());
        let cpu = on_cpu(&world, &settings);
        let gpu = on_stations(&Stations::all(&device), &world, &settings);
        let flips = compare_vpls(&cpu.vpls, &gpu.vpls, settings.vpl.min_illumination);
        let flipped_objects = cpu.object_id.pixels().iter().zip(gpu.object_id.pixels()).filter(|(a, b)| a != b).count();
        let flipped_choices = flipped_choices(&cpu, &gpu);
        println!("{name}: flips: {flips} VPLs, {flipped_objects} objects, {flipped_choices} pixels' choices");
        let pixels = cpu.object_id.pixels().len();
        assert!(flipped_objects * 1000 <= pixels && flipped_choices * 1000 <= pixels, "{name}");
        let far = cpu.depth.pixels().iter().zip(gpu.depth.pixels());
        let far = far.filter(|(a, b)| a != b && (*a - *b).abs() > a.abs() * TOLERANCE).count();
        assert!(far * 1000 <= pixels, "{name}: {far} depths differ");
    }
}

/// VPLs in order; returns how many were placed on one device only.
fn compare_vpls(cpu: &[Vpl], gpu: &[Vpl], least: f32) -> usize {
    let is_marginal = |vpl: &Vpl| (vpl.diffuse.element_sum() - least).abs() < MARGIN;
    let is_same = |a: &Vpl, b: &Vpl| {
        let near = |a: glam::Vec3, b: glam::Vec3| (a - b).length() <= TOLERANCE * a.length().max(1.0);
        near(a.position, b.position) && near(a.direction, b.direction) && near(a.diffuse, b.diffuse)
    };
    let (mut a, mut b, mut flips) = (0, 0, 0);
    while a < cpu.len() || b < gpu.len() {
        match (cpu.get(a), gpu.get(b)) {
            (Some(x), Some(y)) if is_same(x, y) => (a, b) = (a + 1, b + 1),
            (Some(x), _) if is_marginal(x) => (a, flips) = (a + 1, flips + 1),
            (_, Some(y)) if is_marginal(y) => (b, flips) = (b + 1, flips + 1),
            (x, y) => panic!("VPLs {a} and {b} differ: {x:?} {y:?}"),
        }
    }
    flips
}

/// Pixels whose hits chose another number of VPLs.
fn flipped_choices(cpu: &Rendering, gpu: &Rendering) -> usize {
    cpu.lights_selected.pixels().iter().zip(gpu.lights_selected.pixels()).filter(|(a, b)| a != b).count()
}
