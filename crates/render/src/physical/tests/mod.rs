//! The physical model against closed forms, against itself, and cuts against the sum over all lights.

mod agreement;
mod closed_forms;
mod flat_boxes;
mod limits;
mod mapping;
mod one_place;
mod oracle;
mod places;
mod scenes;
mod seams;
