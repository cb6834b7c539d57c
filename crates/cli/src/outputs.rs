//! Files to write: checked before the render, so that no long render is lost, and written one by one after it.

use crate::args::OutputArgs;
use crate::console;
use crate::exit::{Exit, Failure};
use crate::job::{self, has_extension};
use std::fs;
use std::path::{Path, PathBuf};

/// Kinds of file.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Kind {
    Exr,
    Png,
    Stats,
    Vpls,
    Job,
}

/// Files to write, in this order.
#[derive(Debug)]
pub(crate) struct Outputs {
    pub(crate) files: Vec<(Kind, PathBuf)>,
}

impl Outputs {
    /// What the command line asks for. A scene's picture is `<scene>.png` in the current folder unless it asks for more.
    pub(crate) fn new(args: &OutputArgs, scene: &Path) -> Result<Self, Failure> {
        let mut files: Vec<(Kind, PathBuf)> = Vec::new();
        for path in &args.pictures {
            files.push((picture_kind(path)?, path.clone()));
        }
        if files.is_empty() && !args.dry_run {
            let mut name = scene.file_stem().unwrap_or("picture".as_ref()).to_owned();
            name.push(".png");
            files.push((Kind::Png, name.into()));
        }
        files.extend(args.stats.clone().map(|path| (Kind::Stats, path)));
        files.extend(args.write_vpls.clone().map(|path| (Kind::Vpls, path)));
        files.extend(args.write_job.clone().map(|path| (Kind::Job, path)));
        Ok(Self { files })
    }

    /// Fails unless each can be written and none replaces an input or another output.
    pub(crate) fn check(&self, inputs: &[PathBuf]) -> Result<(), Failure> {
        check_files(self.files.iter().map(|(_, path)| path.as_path()), inputs, "render", "-o")
    }

    /// Writes all with `write`, going on after a failure; returns the files written and whether that is all.
    pub(crate) fn write(&self, mut write: impl FnMut(Kind, &Path) -> Result<(), Failure>) -> (Vec<&Path>, Exit) {
        let (mut written, mut exit) = (Vec::new(), Exit::Done);
        for (kind, path) in &self.files {
            match write(*kind, path) {
                Ok(()) => written.push(path.as_path()),
                Err(failure) => {
                    console::show(&failure.report);
                    exit = Exit::NotWritten;
                }
            }
        }
        (written, exit)
    }
}

/// Fails unless each file can be written and none replaces an input or another one. `command` is what has the inputs,
/// `flag` what names the files.
pub(crate) fn check_files<'a>(
    files: impl Iterator<Item = &'a Path>,
    inputs: &[PathBuf],
    command: &str,
    flag: &str,
) -> Result<(), Failure> {
    let mut taken: Vec<PathBuf> = Vec::new();
    let inputs: Vec<PathBuf> = inputs.iter().map(|path| identity(path)).collect();
    for path in files {
        let refuse = |why: &str, help: &str| Failure::usage(format!("cannot write {}: {why}", path.display()), help);
        check_place(path).map_err(|(why, help)| refuse(&why, help))?;
        let identity = identity(path);
        if inputs.contains(&identity) {
            let why = format!("it is an input of this {command}");
            return Err(refuse(&why, &format!("give another name with {flag}")));
        }
        if taken.contains(&identity) {
            return Err(refuse("two outputs have this name", "give each its own"));
        }
        taken.push(identity);
    }
    Ok(())
}

/// Fails unless `output`, a PNG that is made from one input file, can be written. `made` names it in messages.
pub(crate) fn check_png(output: &Path, input: &Path, made: &str) -> Result<(), Failure> {
    if !has_extension(output, "png") {
        let message = format!("{} is no picture that can be written", output.display());
        return Err(Failure::usage(message, "expected a name that ends in .png"));
    }
    check_files(std::iter::once(output), &[input.to_path_buf()], made, "-o")
}

fn picture_kind(path: &Path) -> Result<Kind, Failure> {
    match () {
        () if has_extension(path, "exr") => Ok(Kind::Exr),
        () if has_extension(path, "png") => Ok(Kind::Png),
        () => {
            let message = format!("cannot write a picture named {}", path.display());
            Err(Failure::usage(message, "expected a name that ends in .exr or .png"))
        }
    }
}

/// The folder that a file lies in.
pub(crate) fn folder_of(path: &Path) -> &Path {
    path.parent().filter(|folder| !folder.as_os_str().is_empty()).unwrap_or(Path::new("."))
}

/// Why a file cannot be written, with a way out.
fn check_place(path: &Path) -> Result<(), (String, &'static str)> {
    if path.file_name().is_none() {
        return Err(("it has no file name".to_owned(), "give a file name"));
    }
    let folder = folder_of(path);
    if !folder.is_dir() {
        return Err((format!("there is no folder {}", folder.display()), "make the folder first"));
    }
    if let Ok(metadata) = fs::metadata(path) {
        if !metadata.is_file() {
            return Err(("it is there already and is not a regular file".to_owned(), "give another name"));
        }
        if metadata.permissions().readonly() {
            return Err(("it is there already and is read-only".to_owned(), "give another name, or permit writing"));
        }
    }
    let probe = tempfile::Builder::new().prefix(".lightcuts-").tempfile_in(folder);
    probe.map(drop).map_err(|error| (format!("its folder: {error}"), "give a name in another folder"))
}

/// Equal for two names of one file, there or not.
fn identity(path: &Path) -> PathBuf {
    let of_folder = || Some(folder_of(path).canonicalize().ok()?.join(path.file_name()?));
    path.canonicalize().ok().or_else(of_folder).unwrap_or_else(|| path.to_path_buf())
}

/// The job as a file in the folder of `path` holds it.
pub(crate) fn job_text(job: &job::Job, path: &Path) -> Result<String, Failure> {
    let refuse = |error| Failure::output(format!("cannot write the job to {}: {error}", path.display()));
    job.to_toml(folder_of(path)).map_err(refuse)
}
