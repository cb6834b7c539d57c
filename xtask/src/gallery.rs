//! `cargo xtask gallery`: a picture of every scene.

use crate::project;
use anyhow::{Context as _, Result, bail, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Render what docs/gallery.md shows, into docs/images/gallery: scenes of the physical model, the same bytes on
    /// each run.
    #[arg(long)]
    docs: bool,
    /// Width and height of the pictures in pixels.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=8192), conflicts_with = "docs")]
    size: u32,
    /// Scene to render, such as room.toml; may be repeated [default: all].
    #[arg(long = "scene", value_name = "NAME")]
    scenes: Vec<String>,
    /// Samples of every pixel of the thesis' model.
    #[arg(long, default_value_t = 4)]
    samples: u32,
    /// Folder with the meshes that are not part of the project [default: ../shared/models].
    #[arg(long, value_name = "DIR")]
    models: Option<PathBuf>,
}

/// Scenes whose meshes are not part of the project, with the mesh that they need.
const FOREIGN: [(&str, &str); 2] = [("venus.txt", "venus.obj"), ("galleon.txt", "galleon.obj")];

/// Options that show what a scene is for.
const OPTIONS: [(&str, &[&str]); 11] = [
    ("caustics.txt", &["--caustics"]),
    ("caustics.toml", &["--integrator", "path", "--caustics", "--samples", "256"]),
    ("corner.toml", &["--samples", "48"]),
    ("fleet.toml", &["--integrator", "path", "--samples", "256"]),
    ("focus.toml", &["--integrator", "path", "--samples", "256"]),
    ("glass.toml", &["--integrator", "path", "--caustics", "--samples", "256"]),
    ("gloss.toml", &["--integrator", "path", "--samples", "256"]),
    ("hall.toml", &["--samples", "48"]),
    ("lamps.toml", &["--integrator", "path", "--samples", "256"]),
    ("room.toml", &["--integrator", "path", "--samples", "384"]),
    ("terrace.toml", &["--integrator", "path", "--samples", "256"]),
];

/// Folder of the pictures that docs/gallery.md shows, and their size.
const DOCS: &str = "docs/images/gallery";
const DOCS_SIZE: &str = "400x300";

/// Renders every scene and says how long each took; fails at the end if one failed.
pub(crate) fn run(args: &Args) -> Result<()> {
    let models = args.models.clone().unwrap_or_else(project::shared_models);
    let cli = project::build_for_speed(&["lightcuts-cli"])?.join("lightcuts");
    let folder = if args.docs { DOCS } else { "out/gallery" };
    let pictures = project::root().join(folder);
    fs::create_dir_all(&pictures).with_context(|| format!("cannot make {}", pictures.display()))?;
    let mut failed = Vec::new();
    for scene in scenes()?.into_iter().filter(|scene| args.takes(scene)) {
        let name = file_name(&scene);
        let missing = FOREIGN.iter().find(|(foreign, mesh)| *foreign == name && !models.join(mesh).is_file());
        if let Some((_, mesh)) = missing {
            println!("{name:<20} skipped: {mesh} is not here");
            continue;
        }
        let picture = pictures.join(&name).with_extension("png");
        let start = Instant::now();
        match render(&cli, &scene, &picture, &models, args) {
            Ok(()) => println!("{name:<20} {:>7.2} s", start.elapsed().as_secs_f64()),
            Err(error) => {
                println!("{name:<20} failed: {error:#}");
                failed.push(name);
            }
        }
    }
    ensure!(failed.is_empty(), "not rendered: {}", failed.join(", "));
    println!("the pictures are in {folder}");
    Ok(())
}

impl Args {
    fn takes(&self, scene: &Path) -> bool {
        let is_wanted = self.scenes.is_empty() || self.scenes.contains(&file_name(scene));
        is_wanted && (is_physical(scene) || !self.docs)
    }

    fn size(&self) -> String {
        if self.docs { DOCS_SIZE.to_owned() } else { format!("{0}x{0}", self.size) }
    }
}

fn is_physical(scene: &Path) -> bool {
    scene.extension().is_some_and(|extension| extension == "toml")
}

/// The scene files of all folders in scenes/, in the order of their names.
fn scenes() -> Result<Vec<PathBuf>> {
    let list = |folder: &Path| -> Result<Vec<PathBuf>> {
        let entries = fs::read_dir(folder).with_context(|| format!("cannot read {}", folder.display()))?;
        let mut paths = entries.map(|entry| Ok(entry?.path())).collect::<Result<Vec<_>>>()?;
        paths.sort();
        Ok(paths)
    };
    let mut scenes = Vec::new();
    for folder in list(&project::root().join("scenes"))?.iter().filter(|path| path.is_dir()) {
        scenes.extend(
            list(folder)?.into_iter().filter(|path| path.extension().is_some_and(|e| e == "txt" || e == "toml")),
        );
    }
    Ok(scenes)
}

fn render(cli: &Path, scene: &Path, picture: &Path, models: &Path, args: &Args) -> Result<()> {
    let name = file_name(scene);
    let extra = OPTIONS.iter().find(|(scene, _)| *scene == name).map_or(&[][..], |(_, options)| options);
    let mut command = Command::new(cli);
    command.arg("render").arg(scene).arg("-o").arg(picture).arg("--search-path").arg(models);
    command.arg("--quiet").arg(format!("--size={}", args.size()));
    // Scenes of the physical model take the samples that they need.
    if !is_physical(scene) {
        command.arg(format!("--samples={}", args.samples));
    }
    command.args(extra);
    let output = command.output().context("cannot run lightcuts")?;
    if !output.status.success() {
        bail!("{}: {}", output.status, String::from_utf8_lossy(&output.stderr).trim());
    }
    Ok(())
}

fn file_name(path: &Path) -> String {
    path.file_name().unwrap_or_default().display().to_string()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_scene_is_found_and_every_special_one_is_there() {
        let names: Vec<String> = scenes().unwrap().iter().map(|path| file_name(path)).collect();
        let special = FOREIGN.iter().map(|(scene, _)| *scene).chain(OPTIONS.iter().map(|(scene, _)| *scene));
        for scene in special {
            assert!(names.iter().any(|name| name == scene), "{scene} is not among {names:?}");
        }
    }

    #[test]
    fn the_page_shows_every_scene_of_the_physical_model() {
        let page = fs::read_to_string(project::root().join("docs/gallery.md")).unwrap();
        for scene in scenes().unwrap().iter().filter(|scene| is_physical(scene)) {
            let picture = Path::new("images/gallery").join(file_name(scene)).with_extension("png");
            assert!(page.contains(&format!("({})", picture.display())), "{} is not shown", picture.display());
        }
    }
}
