//! Why there is no plan.

use lightcuts::ImportError;
use lightcuts::rendering::{TomlFault, value_at};
use std::ops::Range;
use std::path::PathBuf;

/// Why an experiment file makes no plan.
#[derive(Debug, thiserror::Error)]
pub enum PlanError {
    /// The file cannot be read.
    #[error("cannot read the experiment {}: {reason}", path.display())]
    Unreadable {
        /// The file.
        path: PathBuf,
        /// Why not.
        reason: String,
    },
    /// Something in its text is wrong.
    #[error(transparent)]
    Text(Box<TextFault>),
    /// A scene cannot be imported.
    #[error(transparent)]
    Scene(Box<ImportError>),
    /// A file of a scene cannot be read again.
    #[error("cannot read {}: {source}", path.display())]
    File {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        source: std::io::Error,
    },
}

/// Something wrong at a place in a text.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("{message}")]
pub struct TextFault {
    /// Name of the file.
    pub file: String,
    /// Its text.
    pub text: String,
    /// Where, in bytes.
    pub span: Range<usize>,
    /// What is wrong.
    pub message: String,
    /// A few words to stand beside the place.
    pub label: String,
}

/// A named TOML text in which places are given as paths: `scene.0.file`.
#[derive(Debug, Clone)]
pub(super) struct Source {
    pub(super) file: String,
    pub(super) text: String,
}

impl Source {
    /// A fault of the TOML reader, or one found like it.
    pub(super) fn toml(&self, fault: TomlFault) -> PlanError {
        let TomlFault { span, message, label } = fault;
        PlanError::Text(Box::new(TextFault { file: self.file.clone(), text: self.text.clone(), span, message, label }))
    }

    /// A fault at `path`; `expected` completes the sentence after that word.
    pub(super) fn fault(&self, path: &str, message: impl Into<String>, expected: &str) -> PlanError {
        let message = format!("{}; expected {expected}", message.into());
        self.toml(TomlFault { span: self.span(path), message, label: format!("expected {expected}") })
    }

    /// A `what` at `path` that is none of the `known` ones.
    pub(super) fn unknown<'k>(
        &self,
        path: &str,
        what: &str,
        word: &str,
        known: impl IntoIterator<Item = &'k str>,
    ) -> PlanError {
        let known: Vec<&str> = known.into_iter().collect();
        self.toml(TomlFault::unknown(self.span(path), what, word, &known))
    }

    /// The value at `path`, or the nearest one above it.
    pub(super) fn span(&self, path: &str) -> Range<usize> {
        let up = path.rsplit_once('.').map(|(above, _)| above);
        match (value_at(&self.text, path), up) {
            (Some(value), _) => value.span(),
            (None, Some(above)) => self.span(above),
            (None, None) => 0..0,
        }
    }

    /// Whether there is a value at `path`.
    pub(super) fn has(&self, path: &str) -> bool {
        value_at(&self.text, path).is_some()
    }
}
