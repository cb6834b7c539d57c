//! The two pictures: read, and held against each other before anything is measured.

use crate::args::{CompareArgs, InputArgs};
use crate::exit::Failure;
use crate::job::require_regular;
use lightcuts::image::{Channels, Picture, read_picture};
use miette::MietteDiagnostic;
use std::path::Path;
use std::time::Instant;

/// Two pictures of one size and with the same channels.
pub(super) struct Inputs {
    pub(super) reference: Picture,
    pub(super) test: Picture,
    pub(super) channels: Channels,
    /// Time that reading took.
    pub(super) seconds: f64,
}

impl Inputs {
    /// Reads both pictures, at once.
    pub(super) fn read(args: &CompareArgs) -> Result<Self, Failure> {
        let start = Instant::now();
        for path in [&args.reference, &args.test] {
            require_regular(path)
                .map_err(|why| Failure::input(format!("cannot read the picture {}: {why}", path.display())))?;
        }
        let read = |path: &Path| {
            read_picture(path, args.input.transfer.into(), args.input.layer.as_deref()).map_err(Failure::input)
        };
        let (reference, test) = rayon::join(|| read(&args.reference), || read(&args.test));
        let ((reference, channels), (test, test_channels)) = (reference?, test?);
        check(args, (&reference, channels), (&test, test_channels))?;
        Ok(Self { reference, test, channels, seconds: start.elapsed().as_secs_f64() })
    }
}

/// Fails unless sizes and channels match, as far as `--ignore-alpha` does not let them differ.
fn check(args: &CompareArgs, reference: (&Picture, Channels), test: (&Picture, Channels)) -> Result<(), Failure> {
    let InputArgs { ignore_alpha, .. } = args.input;
    let same_size = (reference.0.width(), reference.0.height()) == (test.0.width(), test.0.height());
    let same_colours = reference.1.without_alpha() == test.1.without_alpha();
    if same_size && (reference.1 == test.1 || (same_colours && ignore_alpha)) {
        return Ok(());
    }
    let told = |path: &Path, (picture, channels): (&Picture, Channels)| {
        format!("{} is {} x {} with channels {channels}", path.display(), picture.width(), picture.height())
    };
    let message = format!("{}; {}", told(&args.reference, reference), told(&args.test, test));
    let help = match () {
        () if !same_size => "only pictures of one size can be compared",
        () if same_colours => "with --ignore-alpha the colours are compared",
        () => "grey can be compared with grey, and colour with colour",
    };
    Err(Failure::new(crate::exit::Exit::Input, MietteDiagnostic::new(message).with_help(help)))
}
