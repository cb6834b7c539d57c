//! Stations on other devices than the CPU: layouts, faults and what becomes of the picture.

use crate::{scene, small_scene};
use lightcuts_image::{Image, ToneMapping, max_abs_difference};
use lightcuts_kernel::light::Vpl;
use lightcuts_render::device::{
    CpuDevice, Device, DeviceFault, DeviceInfo, DeviceKind, LightTree, Pass, PhotonMap, Tile, TileResult, TreeLayout,
    View,
};
use lightcuts_render::{Caustics, Monitor, Options, Rendering, Settings, Simd, Stage, Station, Stations, render_on};
use lightcuts_world::World;
use std::collections::BTreeSet;
use std::sync::Mutex;
use std::sync::atomic::{AtomicU64, Ordering};

/// A device made of the CPU that fails where it is told to, after it has done the work.
struct Fake<'a> {
    cpu: CpuDevice<'a>,
    layout: TreeLayout,
    tiles_at_once: usize,
    /// Calls that fault, by their numbers.
    faults: BTreeSet<usize>,
    can_be_revived: bool,
    /// Whether a tile is missing in each batch.
    forgetful: bool,
    /// The stations' functions that were called.
    calls: Mutex<Vec<&'static str>>,
    revivals: AtomicU64,
}

impl<'a> Fake<'a> {
    fn new(world: &'a World) -> Self {
        Self {
            cpu: CpuDevice::new(world, Simd::Auto),
            layout: TreeLayout::Wide,
            tiles_at_once: 2,
            faults: BTreeSet::new(),
            can_be_revived: true,
            forgetful: false,
            calls: Mutex::default(),
            revivals: AtomicU64::new(0),
        }
    }

    fn faulting(world: &'a World, faults: impl IntoIterator<Item = usize>) -> Self {
        Self { faults: faults.into_iter().collect(), ..Self::new(world) }
    }

    fn calls(&self) -> Vec<&'static str> {
        self.calls.lock().expect("no panic").clone()
    }

    fn after<T>(&self, what: &'static str, result: Result<T, DeviceFault>) -> Result<T, DeviceFault> {
        let mut calls = self.calls.lock().expect("no panic");
        calls.push(what);
        if self.faults.contains(&(calls.len() - 1)) { Err(DeviceFault::Lost(what.to_owned())) } else { result }
    }
}

impl Device for Fake<'_> {
    fn info(&self) -> DeviceInfo {
        DeviceInfo { kind: DeviceKind::SoftwareGpu, name: "fake".to_owned() }
    }
    fn batch(&self) -> usize {
        self.tiles_at_once
    }
    fn render_tiles(
        &self,
        pass: &Pass<'_>,
        tiles: &[Tile],
        monitor: &dyn Monitor,
    ) -> Result<Vec<Option<TileResult>>, DeviceFault> {
        let mut results = self.cpu.render_tiles(pass, tiles, monitor)?;
        results.truncate(tiles.len() - usize::from(self.forgetful));
        self.after("tiles", Ok(results))
    }
    fn original_shifts(&self, view: &View<'_>) -> Result<Vec<[f32; 2]>, DeviceFault> {
        self.after("shifts", self.cpu.original_shifts(view))
    }
    fn shoot_photons(
        &self,
        view: &View<'_>,
        settings: &Caustics,
        monitor: &dyn Monitor,
    ) -> Result<(PhotonMap, u64), DeviceFault> {
        self.after("photons", self.cpu.shoot_photons(view, settings, monitor))
    }
    fn preferred_layout(&self) -> TreeLayout {
        self.layout
    }
    fn build_tree(&self, vpls: &[Vpl], wanted: TreeLayout) -> Result<LightTree, DeviceFault> {
        self.after("tree", self.cpu.build_tree(vpls, wanted))
    }
    fn bloom(&self, image: &Image, radius: f32, weight: f32) -> Result<Image, DeviceFault> {
        self.after("bloom", self.cpu.bloom(image, radius, weight))
    }
    fn tone_map(&self, image: &Image, operator: &ToneMapping) -> Result<Image, DeviceFault> {
        self.cpu.tone_map(image, operator)
    }
    fn revive(&self) -> Result<(), DeviceFault> {
        self.revivals.fetch_add(1, Ordering::Relaxed);
        if self.can_be_revived { Ok(()) } else { Err(DeviceFault::Lost("for good".to_owned())) }
    }
}

/// Counts steps and keeps notes.
#[derive(Default)]
struct Ledger {
    announced: AtomicU64,
    done: AtomicU64,
    notes: Mutex<Vec<String>>,
}

impl Monitor for Ledger {
    fn begin(&self, stage: Stage, steps: u64) {
        // The last stage has one step that nobody counts.
        self.announced.fetch_add(if stage == Stage::Develop { 0 } else { steps }, Ordering::Relaxed);
    }
    fn advance(&self) {
        self.done.fetch_add(1, Ordering::Relaxed);
    }
    fn note(&self, text: &str) {
        self.notes.lock().expect("no panic").push(text.to_owned());
    }
}

/// Renders, checks that every step was told once, and returns what was noted.
fn render_noting(world: &World, settings: &Settings, stations: &Stations<'_>) -> (Rendering, Vec<String>) {
    let ledger = Ledger::default();
    let rendering = render_on(world, settings, &Options::default(), stations, &ledger).expect("the settings are valid");
    assert_eq!(ledger.announced.into_inner(), ledger.done.into_inner());
    assert!(rendering.stats.complete);
    (rendering, ledger.notes.into_inner().expect("no panic"))
}

fn assert_same_picture(a: &Rendering, b: &Rendering, what: &str) {
    let bits = |image: &Image| image.pixels().iter().flatten().map(|c| c.to_bits()).collect::<Vec<_>>();
    for (x, y) in [(&a.beauty, &b.beauty), (&a.first_pass, &b.first_pass), (&a.second_pass, &b.second_pass)] {
        assert!(bits(x) == bits(y), "{what}: pictures differ");
    }
    assert_eq!(a.lights_selected, b.lights_selected, "{what}");
    assert_eq!(a.vpls, b.vpls, "{what}");
    assert_eq!((a.stats.rays, a.stats.tree), (b.stats.rays, b.stats.tree), "{what}");
    assert_eq!(a.stats.light_ratio_percent, b.stats.light_ratio_percent, "{what}");
}

/// A small picture that every station has something to do for.
fn busy_scene() -> (World, Settings) {
    let (world, mut settings) = scene("gallery/mirrors.txt", Vec::new());
    (settings.image.width, settings.image.height) = (48, 40);
    settings.sampling.adaptive_samples = 3;
    settings.caustics.enabled = true;
    settings.caustics.step *= 4.0;
    settings.bloom.enabled = true;
    (world, settings)
}

/// The kinds of device that finished the stations.
fn kinds(rendering: &Rendering) -> Vec<(&str, &str)> {
    rendering.stats.devices.iter().map(|d| (d.station.as_str(), d.kind.as_str())).collect()
}

const FAKE: &str = "software gpu";

#[test]
fn after_a_fault_at_any_moment_the_revived_device_makes_the_same_picture() {
    let (world, settings) = busy_scene();
    let cpu = CpuDevice::new(&world, Simd::Auto);
    let (expected, notes) = render_noting(&world, &settings, &Stations::all(&cpu));
    assert!(notes.is_empty() && expected.stats.device_faults == 0);
    assert_eq!(kinds(&expected), ["place", "photons", "tree", "gather", "develop"].map(|station| (station, "cpu")));
    let undisturbed = Fake::new(&world);
    render_noting(&world, &settings, &Stations::all(&undisturbed));
    let calls = undisturbed.calls();
    assert!(calls.len() >= 20 && ["tiles", "photons", "tree", "bloom"].iter().all(|what| calls.contains(what)));
    for (moment, what) in calls.iter().enumerate() {
        let fake = Fake::faulting(&world, [moment]);
        let (rendering, notes) = render_noting(&world, &settings, &Stations::all(&fake));
        assert_same_picture(&expected, &rendering, &format!("fault at {moment}, {what}"));
        assert_eq!((notes.len(), rendering.stats.device_faults), (1, 1), "{notes:?}");
        assert!(notes[0].contains(what) && notes[0].contains("fake") && notes[0].contains("reopened"), "{notes:?}");
        assert!(kinds(&rendering).iter().all(|(_, kind)| *kind == FAKE));
        assert_eq!((fake.calls().len(), fake.revivals.into_inner()), (calls.len() + 1, 1));
    }
    println!("{} moments", calls.len());
}

#[test]
fn the_cpu_takes_over_from_a_device_that_faults_again_or_cannot_be_revived() {
    let (world, settings) = busy_scene();
    let cpu = CpuDevice::new(&world, Simd::Auto);
    let (expected, _) = render_noting(&world, &settings, &Stations::all(&cpu));
    let undisturbed = Fake::new(&world);
    render_noting(&world, &settings, &Stations::all(&undisturbed));
    let moments = undisturbed.calls().len();
    for moment in 0..moments {
        for (again, can_be_revived) in [(1, true), (3, true), (0, false)] {
            let faults = [moment, moment + again];
            let fake = Fake { can_be_revived, ..Fake::faulting(&world, faults) };
            let (rendering, notes) = render_noting(&world, &settings, &Stations::all(&fake));
            let what = format!("faults at {faults:?}");
            assert_same_picture(&expected, &rendering, &what);
            assert_eq!(fake.revivals.into_inner(), 1, "{what}");
            assert_eq!(notes.len(), rendering.stats.device_faults as usize, "{what} {notes:?}");
            // A second fault that would come after the last call never comes.
            if again == 1 || !can_be_revived || moment + again < moments {
                assert!(notes.last().unwrap().contains("the CPU does the rest"), "{what} {notes:?}");
                assert_eq!(rendering.stats.devices.last().unwrap().kind, "cpu", "{what}");
            }
        }
    }
}

#[test]
fn stations_on_other_devices_go_on_there_when_one_device_is_gone() {
    let (world, settings) = busy_scene();
    let cpu = CpuDevice::new(&world, Simd::Auto);
    let (expected, _) = render_noting(&world, &settings, &Stations::all(&cpu));
    let sound = Fake::new(&world);
    let gone = Fake { can_be_revived: false, ..Fake::faulting(&world, [0]) };
    let stations = Stations::all(&sound).with(Station::Tree, &gone).with(Station::Develop, &gone);
    let (rendering, notes) = render_noting(&world, &settings, &stations);
    assert_same_picture(&expected, &rendering, "two devices");
    assert_eq!((notes.len(), gone.calls()), (1, vec!["tree"]));
    let expected = [("place", FAKE), ("photons", FAKE), ("tree", "cpu"), ("gather", FAKE), ("develop", "cpu")];
    assert_eq!(kinds(&rendering), expected);
}

#[test]
fn a_device_that_forgets_tiles_does_not_make_the_picture() {
    let (world, settings) = busy_scene();
    let cpu = CpuDevice::new(&world, Simd::Auto);
    let (expected, _) = render_noting(&world, &settings, &Stations::all(&cpu));
    let forgetful = Fake { forgetful: true, ..Fake::new(&world) };
    let (rendering, notes) = render_noting(&world, &settings, &Stations::all(&forgetful));
    assert_same_picture(&expected, &rendering, "forgotten tiles");
    assert_eq!((notes.len(), rendering.stats.device_faults), (2, 2));
    assert!(notes[0].contains("1 results for 2 tiles"), "{notes:?}");
    assert_eq!(kinds(&rendering), kinds(&expected));
}

/// The original's VPLs and picture come out, no matter whether the device goes away while the shifts are found or
/// later.
#[test]
fn faults_leave_the_original_reproduced() {
    let (world, mut settings) = scene("thesis/simple.txt", Vec::new());
    settings.run.reproduce = true;
    let cpu = CpuDevice::new(&world, Simd::Auto);
    let (expected, _) = render_noting(&world, &settings, &Stations::all(&cpu));
    assert_eq!(expected.vpls.len(), 290);
    for fault in [0, 4] {
        let gone = Fake { tiles_at_once: 64, can_be_revived: false, ..Fake::faulting(&world, [fault]) };
        let (rendering, notes) = render_noting(&world, &settings, &Stations::all(&gone));
        assert_same_picture(&expected, &rendering, &format!("fault {fault}"));
        assert_eq!((notes.len(), gone.calls().len(), gone.calls()[0]), (1, fault + 1, "shifts"));
        assert_eq!(kinds(&rendering)[0], ("place", "cpu"));
    }
}

#[test]
fn the_packed_layout_makes_the_picture_of_the_wide_one() {
    for name in ["thesis/simple.txt", "thesis/statue.txt", "gallery/cubes.txt"] {
        let (world, mut settings) = small_scene(name);
        settings.gather.threshold = 1e-5;
        settings.vpl.probability *= 8.0;
        let [wide, packed] = [TreeLayout::Wide, TreeLayout::Packed].map(|layout| {
            let fake = Fake { layout, ..Fake::new(&world) };
            render_noting(&world, &settings, &Stations::all(&fake)).0
        });
        assert_eq!(wide.vpls, packed.vpls, "{name}");
        assert_eq!(wide.stats.light_ratio_percent, packed.stats.light_ratio_percent, "{name}");
        assert_eq!(wide.lights_selected, packed.lights_selected, "{name}");
        let difference = max_abs_difference(&wide.beauty, &packed.beauty).unwrap();
        assert!(difference <= 1e-5, "{name}: {difference}");
        let [a, b] = [&wide, &packed].map(|rendering| rendering.stats.tree.visits_per_hit);
        println!("{name}: {} VPLs, visits per hit: wide {a:.1}, packed {b:.1}", wide.vpls.len());
    }
}
