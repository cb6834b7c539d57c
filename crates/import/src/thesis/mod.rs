//! The thesis' scene text (Tong Zhang, "GPU-Based Global Illumination Using Lightcuts", 2011, Appendix A).
//!
//! ```text
//! # VPL(0.0001/0.7/GPU:0.08-CPU:0.075) LC(1e-6)
//! S | BK{0, 0, 0} |
//! C | STRAT | PERS(10) | C{0, 0, 960} | V{0, 0, -1} | U{0, 1, 0} |
//! L | OMNI | POS{0, 100, 0} | ATTEN(1) | S{1, 1, 1} | D{1, 1, 1} | A{1, 1, 1} |
//! P | SPH | FRKE{0, 0, 0.7, 1} | C{0, 0, 0}R(60) | S{0.2, 0.2, 0.2} | D{0.2, 0.2, 0.2} | A{0, 0, 0} | SH(20) |
//! ```
//!
//! # Where a directive starts and ends
//!
//! Directives run over as many lines as they like, so lines alone do not separate them. A line starts a new directive if
//! its first non-blank character is `S`, `C`, `L`, `P` or `O` (either case) **and** that letter stands alone: it is
//! followed by a `|` or `:`, by blanks and another letter (`L OMNI`), or by the line's end (unless the next line opens a
//! bracket). Fields that begin with one of these letters never look so: `S{`, `C {`, `L(`, `L60` have a bracket or a
//! number after the letter, `SH(`, `PATH:`, `ORTHO` another letter at once. So a wrapped `S{0.1, ...}` continues the
//! directive before it, whatever that one still lacks. A line that starts with `#` is a comment, even between the lines
//! of a directive. A line that starts with another lone letter, a foreign word without a bracket or a foreign sign is an
//! unknown directive: it is skipped with a warning, up to the next line that starts a directive.
//!
//! # Fields
//!
//! Fields may be separated by `|`, `:` or blanks, or not at all; they may come in any order. The brackets are part of a
//! field's name (`H{}` is a direction, `H()` a length); plain numbers may do without `()`: `W400`, `W:400`. Of fields
//! given twice the first counts; they and unknown ones cause a warning. A file name ends at a `|`, at the line's end, or
//! after its extension where a field follows, so it may contain blanks.

mod assets;
mod build;
mod camera;
mod comment;
mod draft;
mod field;
mod light;
mod material;
mod mesh;
mod primitive;
mod scan;
mod spans;
mod text_field;

use crate::resolver::Resolver;
use crate::source::Source;
use crate::{ImportError, Imported, Limits};

/// Reads a scene from `text`; `name` stands for the file in messages, and its stem becomes the scene's name.
///
/// `resolver` finds the models and textures that the scene names. Fails with all errors found, at most 20.
pub fn parse_thesis(text: &str, name: &str, resolver: &dyn Resolver, limits: &Limits) -> Result<Imported, ImportError> {
    let source = Source::new(name, text.strip_prefix('\u{feff}').unwrap_or(text));
    build::Builder::new(&source, name, resolver, limits).run()
}
