//! The physical model against closed forms, against itself, and cuts against the sum over all lights.

mod agreement;
mod closed_forms;
mod limits;
mod oracle;
mod scenes;
