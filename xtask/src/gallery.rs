//! `cargo xtask gallery`: a picture of every scene.

use crate::project;
use anyhow::{Context as _, Result, bail, ensure};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Width and height of the pictures in pixels.
    #[arg(long, default_value_t = 256, value_parser = clap::value_parser!(u32).range(1..=8192))]
    size: u32,
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
const OPTIONS: [(&str, &[&str]); 1] = [("caustics.txt", &["--caustics"])];

/// Renders every scene and says how long each took; fails at the end if one failed.
pub(crate) fn run(args: &Args) -> Result<()> {
    let models = args.models.clone().unwrap_or_else(project::shared_models);
    let cli = project::release_cli()?;
    let folder = project::root().join("out/gallery");
    fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
    let mut failed = Vec::new();
    for scene in scenes()? {
        let name = file_name(&scene);
        let missing = FOREIGN.iter().find(|(foreign, mesh)| *foreign == name && !models.join(mesh).is_file());
        if let Some((_, mesh)) = missing {
            println!("{name:<20} skipped: {mesh} is not here");
            continue;
        }
        let picture = folder.join(&name).with_extension("png");
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
    println!("the pictures are in out/gallery");
    Ok(())
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
    command.arg("--quiet").arg(format!("--size={0}x{0}", args.size));
    // Scenes of the physical model take the samples that they need.
    if scene.extension().is_some_and(|extension| extension == "txt") {
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
}
