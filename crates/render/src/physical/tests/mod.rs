//! The physical model against closed forms, against itself, and cuts against the sum over all lights.

mod agreement;
mod closed_forms;
mod geometry;
mod limits;
mod mapping;
mod oracle;
mod scenes;
