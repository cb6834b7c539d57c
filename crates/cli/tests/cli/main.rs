//! The real binary: what it writes, what it says, how it ends.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod compare;
mod develop;
mod devices;
mod experiment;
mod inputs;
mod interrupt;
mod jobs;
#[path = "../../../import/tests/malformed/mod.rs"]
mod malformed;
mod other_commands;
mod outputs;
mod physical;
mod pictures;
mod rendering;
mod report;
mod support;
