//! The GPU device: adapters, buffers, pipelines, a governor of dispatches, and recovery, on wgpu.
//!
//! No mathematics is here: what is computed stands in `lightcuts-kernel`, once in Rust and once in WGSL.

mod adapter;
mod bloom;
pub mod buffers;
mod context;
mod counters;
mod device;
mod dispatcher;
mod engine;
mod fleet;
mod governor;
mod lighting;
mod original_order;
mod photons;
mod probe;
pub mod program;
pub mod programs;
pub mod records;
mod rows;
mod sabotage;
mod scan;
mod tone;
mod tree;
mod wave;
mod wave_input;
mod wave_output;
mod world_buffers;

pub use adapter::{AdapterSummary, DeviceChoice, adapters, choose};
pub use device::{GpuDevice, GpuOptions};
pub use fleet::{Assignment, Fleet, NoDevice, adapters_for};
pub use governor::{GovernorReport, StageReport};
pub use sabotage::Sabotage;
