//! Section 1: what the device is, and the CPU beside it.

use super::log::Log;
use super::setup::{CPU_THREADS, Setup};
use crate::format::mebibytes;
use crate::record::machine;
use crate::table::Table;
use anyhow::Result;
use lightcuts::gpu::{AdapterSummary, GpuOptions};

#[expect(clippy::unnecessary_wraps, reason = "all sections have one type")]
pub(super) fn section(setup: &Setup, _: &mut Log) -> Result<String> {
    let mut table = Table::new(&["what", "value"]);
    for (what, value) in of_adapter(&setup.adapter) {
        table.push([what.to_owned(), value]);
    }
    table.push(["governor's budget".to_owned(), format!("{} ms", GpuOptions::default().budget.as_millis())]);
    table.push(["CPU beside it".to_owned(), processor()]);
    Ok(table.markdown())
}

fn of_adapter(adapter: &AdapterSummary) -> [(&'static str, String); 10] {
    let [least, most] = adapter.subgroup_sizes;
    let timestamps = if adapter.has_timestamps { "yes" } else { "no: seconds of programs are shares of wall time" };
    [
        ("name", adapter.name.clone()),
        ("kind", adapter.kind.name().to_owned()),
        ("interface", adapter.api.clone()),
        ("driver", adapter.driver.clone()),
        ("largest buffer of a program", mebibytes(adapter.max_binding_bytes)),
        ("largest buffer", mebibytes(adapter.max_buffer_bytes)),
        ("buffers of a program", adapter.max_storage_buffers.to_string()),
        ("invocations of a workgroup", adapter.max_invocations.to_string()),
        ("invocations in step", format!("{least} to {most}")),
        ("timestamps", timestamps.to_owned()),
    ]
}

fn processor() -> String {
    format!("{}, {CPU_THREADS} of which render", machine())
}
