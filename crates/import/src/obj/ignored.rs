//! Statements of OBJ files that a triangle mesh has no use for.

use crate::lines::Lines;
use crate::report::{Report, Tally, counted};
use std::collections::HashSet;
use std::ops::Range;

/// Statements that say nothing about the surface, or belong to those of [`MISSED`].
const SILENT: [&str; 26] = [
    "g",
    "o",
    "vp",
    "vw",
    "t",
    "cstype",
    "deg",
    "bmat",
    "step",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "mg",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "maplib",
];

/// Statements that may be missed, by what they are.
const MISSED: [(&str, &[&str]); 5] = [
    ("line element", &["l"]),
    ("point element", &["p"]),
    ("free-form curve or surface", &["curv", "curv2", "surf", "bzp", "bsp", "cdc", "cdp"]),
    ("call of another file or command", &["call", "csh"]),
    ("use of a texture map by the model itself", &["usemap"]),
];

/// Unknown keywords that are worth a warning each.
const MAX_UNKNOWN: usize = 16;

/// What was ignored so far.
#[derive(Debug, Default)]
pub(super) struct Ignored {
    missed: [Tally; MISSED.len()],
    unknown: HashSet<String>,
}

impl Ignored {
    /// A statement that is none of the others; `span` is that of its keyword. Unknown ones are warned about at once.
    pub(super) fn note(&mut self, lines: &Lines<'_>, span: Range<usize>, keyword: &str, report: &mut Report) {
        if let Some(kind) = MISSED.iter().position(|(_, keywords)| keywords.contains(&keyword)) {
            self.missed[kind].note(|| lines.fault(span, ""));
        } else if !SILENT.contains(&keyword)
            && self.unknown.len() < MAX_UNKNOWN
            && self.unknown.insert(keyword.to_owned())
        {
            let message = format!("unknown keyword `{keyword}`: lines that start with it are ignored");
            report.warn(|| lines.fault(span, &message));
        }
    }

    pub(super) fn warn(self, report: &mut Report) {
        for ((thing, keywords), tally) in MISSED.iter().zip(self.missed) {
            let listed: Vec<String> = keywords.iter().map(|keyword| format!("`{keyword}`")).collect();
            tally.warn(report, |count| {
                format!("ignored: {} ({}); only faces are read", counted(count, thing), listed.join(", "))
            });
        }
    }
}
