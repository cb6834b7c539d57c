//! Section 2: the thesis' scenes, without and with lightcuts, on the GPU and on the CPU.

use super::log::{Log, Work};
use super::published::published;
use super::setup::{CPU_THREADS, Render, Setup, stage_s};
use crate::experiment::{Case, Scene};
use crate::format::seconds;
use crate::measure::{Configuration, middle};
use crate::place;
use crate::table::Table;
use anyhow::{Context as _, Result};
use lightcuts::gpu::GpuDevice;
use lightcuts::rendering::Strategy;
use lightcuts::{ImportOptions, Options, SceneDesc, Settings, Stage, Stats, World};
use std::fmt::Write as _;

const HEADER: [&str; 9] =
    ["scene", "configuration", "on", "VPLs", "light ratio", "pass 1, s", "pass 2, s", "total, s", "times the GPU's"];

const REMARKS: &str = "
Wall seconds with `--reproduce`; reading the scene and writing files do not count. Programs are compiled by a render that
does not count, of a small picture on a software driver. The thesis' GPU is an NVIDIA Tesla C1060; its seconds are means of
three runs as published. It had other VPLs than the thesis' CPU, with other attenuations; ours are those of the CPU.
";

pub(super) fn section(setup: &Setup, log: &mut Log) -> Result<String> {
    let csv = std::fs::read_to_string(place::root().join("experiments/thesis_tables.csv"));
    let csv = csv.context("cannot read experiments/thesis_tables.csv")?;
    let (mut table, mut remarks) = (Table::new(&HEADER), String::new());
    for scene in Scene::ALL {
        let case = Case::new(scene, &setup.models);
        if let Some(absent) = case.absent_model {
            let _ = write!(remarks, "\n{absent} is not here: {} takes its place.\n", case.file);
        }
        let scene = load(&case, setup)?;
        let world = World::new(&scene)?;
        let gpu = setup.open(&world)?;
        for configuration in Configuration::ALL {
            eprintln!("{}, {}", case.title, configuration.title());
            let measured = Measured::new(setup, &gpu, &world, &settings(&scene, configuration))?;
            measured.rows(&case, configuration, &csv).into_iter().for_each(|row| table.push(row));
            log.renders.push((format!("{}, {}", case.title, configuration.title()), measured.gpu.stages));
        }
        log.works.push(Work::new(case.title, &gpu));
    }
    Ok(table.markdown() + &remarks + REMARKS)
}

fn load(case: &Case, setup: &Setup) -> Result<SceneDesc> {
    let options = ImportOptions { search_paths: vec![setup.models.clone()], ..ImportOptions::default() };
    let path = place::root().join("scenes/thesis").join(case.file);
    Ok(lightcuts::load(&path, &options)?.scene)
}

fn settings(scene: &SceneDesc, configuration: Configuration) -> Settings {
    let mut settings = Settings::for_scene(scene);
    settings.run.reproduce = true;
    settings.gather.strategy = match configuration {
        Configuration::Plain => Strategy::All,
        Configuration::Lightcuts => Strategy::Lightcuts,
    };
    settings
}

/// What compiles the programs that a render needs: the render itself. A software driver needs minutes for it, besides which
/// the one program that only `--reproduce` takes does not count: for it the picture is small.
fn for_warming_up(setup: &Setup, settings: &Settings) -> Settings {
    let mut settings = settings.clone();
    if setup.is_software() {
        settings.run.reproduce = false;
        (settings.image.width, settings.image.height) = (64, 64);
    }
    settings
}

/// The middle runs on both devices.
struct Measured {
    gpu: Render,
    cpu: Stats,
}

impl Measured {
    fn new(setup: &Setup, gpu: &GpuDevice<'_>, world: &World, settings: &Settings) -> Result<Self> {
        let options = Options::default();
        let before = for_warming_up(setup, settings);
        let gpu = setup.middle_render(gpu, world, [&before, settings], &options, |render| render.stats.total_wall_s)?;
        let on_cpu = (0..setup.runs()).map(|_| setup.render_on_cpu(world, settings, &options));
        let cpu = middle(on_cpu.collect::<Result<_>>()?, |stats| stats.total_wall_s);
        Ok(Self { gpu, cpu })
    }

    /// Rows of the GPU, the CPU and, but for stand-ins, the thesis' GPU.
    fn rows(&self, case: &Case, configuration: Configuration, csv: &str) -> Vec<[String; 9]> {
        let gpu_s = self.gpu.stats.total_wall_s;
        let row = |on: &str, vpls: u64, ratio: Option<f64>, [first, second, total]: [f64; 3]| {
            let ratio = ratio.map_or_else(|| "-".to_owned(), |percent| format!("{percent:.3} %"));
            let (title, configuration) = (case.title.clone(), configuration.title().to_owned());
            let [first_s, second_s, total_s] = [first, second, total].map(seconds);
            let times = format!("{:.2}", total / gpu_s);
            [title, configuration, on.to_owned(), vpls.to_string(), ratio, first_s, second_s, total_s, times]
        };
        let ours = |on: &str, stats: &Stats| {
            let passes = [Stage::FirstPass, Stage::SecondPass].map(|stage| stage_s(stats, stage));
            row(on, stats.vpl_count, Some(stats.light_ratio_percent), [passes[0], passes[1], stats.total_wall_s])
        };
        let suffix = if configuration == Configuration::Lightcuts { "-lightcuts" } else { "" };
        let name = case.file.trim_end_matches(".txt");
        let thesis = published(csv, name, &format!("gpu{suffix}"))
            .map(|it| row("the thesis' GPU", it.vpl_count, it.light_ratio_percent, it.seconds));
        let rows = [ours("this GPU", &self.gpu.stats), ours(&format!("CPU, {CPU_THREADS} threads"), &self.cpu)];
        rows.into_iter().chain(thesis).collect()
    }
}
