//! The two pictures: read, and held against each other before anything is measured.

use crate::args::{CompareArgs, InputArgs};
use crate::console;
use crate::exit::Failure;
use crate::job::require_picture;
use lightcuts::image::{Channels, Picture, PictureFile, read_picture};
use miette::MietteDiagnostic;
use std::path::Path;
use std::time::Instant;

/// Two pictures of one size and with the same channels.
pub(super) struct Inputs {
    pub(super) reference: Picture,
    pub(super) test: Picture,
    pub(super) channels: Channels,
    /// Whether both hold light, and not only what a display shows.
    pub(super) hold_light: bool,
    /// What was told of how the files were read.
    pub(super) warnings: Vec<String>,
    /// Time that reading took.
    pub(super) seconds: f64,
}

impl Inputs {
    /// Reads both pictures, at once. What is to be said of them goes to standard error.
    pub(super) fn read(args: &CompareArgs) -> Result<Self, Failure> {
        let start = Instant::now();
        for path in [&args.reference, &args.test] {
            require_picture(path)?;
        }
        let read = |path: &Path| {
            read_picture(path, args.input.transfer.into(), args.input.layer.as_deref()).map_err(Failure::input)
        };
        let (reference, test) = rayon::join(|| read(&args.reference), || read(&args.test));
        let (reference, test) = (reference?, test?);
        let warnings = warnings(args, &reference, &test);
        for warning in &warnings {
            console::warn(warning);
        }
        check(args, &reference, &test)?;
        Ok(Self {
            hold_light: reference.holds_light && test.holds_light,
            channels: reference.channels,
            reference: reference.picture,
            test: test.picture,
            warnings,
            seconds: start.elapsed().as_secs_f64(),
        })
    }
}

/// What each file's remarks are, with its name.
fn warnings(args: &CompareArgs, reference: &PictureFile, test: &PictureFile) -> Vec<String> {
    let of = |path: &Path, file: &PictureFile| {
        let name = path.display().to_string();
        file.remarks.iter().map(move |remark| format!("{name}: {remark}")).collect::<Vec<_>>()
    };
    let of_reference = of(&args.reference, reference);
    // A picture compared with itself would repeat its remarks.
    let others = of(&args.test, test).into_iter().filter(|warning| !of_reference.contains(warning));
    let others: Vec<String> = others.collect();
    [of_reference, others].concat()
}

/// Fails unless sizes, places and channels match, as far as options do not let them differ.
fn check(args: &CompareArgs, reference: &PictureFile, test: &PictureFile) -> Result<(), Failure> {
    let InputArgs { ignore_alpha, ignore_windows, .. } = args.input;
    let size = |file: &PictureFile| (file.picture.width(), file.picture.height());
    let same_size = size(reference) == size(test);
    let same_place = ignore_windows || reference.frame.matches(&test.frame);
    let same_colours = reference.channels.without_alpha() == test.channels.without_alpha();
    if same_size && same_place && (reference.channels == test.channels || (same_colours && ignore_alpha)) {
        return Ok(());
    }
    let are_whole = reference.frame.is_whole() && test.frame.is_whole();
    let told = |path: &Path, file: &PictureFile| {
        let (width, height) = size(file);
        let size = if are_whole { format!("{width} x {height}") } else { file.frame.to_string() };
        format!("{} is {size} with channels {}", path.display(), file.channels)
    };
    let message = format!("{}; {}", told(&args.reference, reference), told(&args.test, test));
    let help = match () {
        () if !same_size => "only pictures of one size can be compared",
        () if !same_place => {
            "they are not of the same place; with --ignore-windows their pixels are compared all the same"
        }
        () if same_colours => "with --ignore-alpha the colours are compared",
        () => "grey can be compared with grey, and colour with colour",
    };
    Err(Failure::new(crate::exit::Exit::Input, MietteDiagnostic::new(message).with_help(help)))
}
