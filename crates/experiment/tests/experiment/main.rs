//! Plans and runs of experiments: small pictures of real scenes in folders of their own.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod devices;
mod faults;
mod hashes;
mod plans;
mod results;
mod running;
mod stand_ins;
mod support;
