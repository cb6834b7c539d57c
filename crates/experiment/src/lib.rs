//! Experiments: from a plan of renders to results, one line each, and from those to a report.
//!
//! A plan is read from an experiment file and says every render ([`Plan`]); running it appends a line per finished
//! render to `results.jsonl` ([`Runner`]), which is read again as [`Results`]. What the lines hold is in [`record`],
//! what a report shows in [`layout`].

mod hash;
pub mod layout;
pub mod plan;
pub mod published;
pub mod record;
pub mod report;
pub mod results;
pub mod run;

pub use plan::{ExperimentFile, Plan, PlanError};
pub use report::{Report, ReportError};
pub use results::{Results, ResultsError};
pub use run::{Outcome, RunError, Runner, Watch};
