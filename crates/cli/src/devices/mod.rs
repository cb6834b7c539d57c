//! Devices: the command that lists them, those of a render, and what a GPU did.

mod fleet;
mod list;
mod text;
mod work;

pub(crate) use fleet::{assigned, open, require_cpu};
pub(crate) use work::{GpuWork, log};

use crate::args::DevicesArgs;
use crate::console;
use crate::exit::{Exit, Failure};
use list::DeviceList;

/// Runs the command.
pub(crate) fn run(args: &DevicesArgs) -> Result<Exit, Failure> {
    let list = DeviceList::new(lightcuts::gpu::adapters());
    let text = if args.json {
        serde_json::to_string_pretty(&list).map_err(|error| Failure::output(error.to_string()))? + "\n"
    } else {
        text::of(&list)
    };
    console::print(text.as_bytes()).map(|()| Exit::Done)
}
