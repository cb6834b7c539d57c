//! Faults in job files, said with file, line and column, the line itself, and what was expected.

use crate::exit::{Exit, Failure};
use crate::fault::fault;
use lightcuts::rendering::TomlFault;

/// The keys of a job file beside the tables of settings.
pub(super) const TOP_KEYS: [&str; 4] = ["scene", "search-path", "crease-angle", "read-vpls"];

/// An error of the TOML reader.
pub(super) fn toml_fault(name: &str, text: &str, error: &toml::de::Error) -> Failure {
    let TomlFault { span, message, label } = TomlFault::with_more_keys(error, &TOP_KEYS);
    fault(Exit::Usage, name, text, span, &message, &label)
}
