//! The list of devices as text.

use super::list::{Adapter, Cpu, DeviceList};

/// The processor, every adapter, and the default.
pub(super) fn of(list: &DeviceList) -> String {
    let taken = if list.auto.device == "cpu" { "the CPU" } else { &list.auto.device };
    let adapters: String = list.adapters.iter().map(of_adapter).collect();
    of_cpu(&list.cpu) + &adapters + &line("auto", &format!("uses {taken}: {}", list.auto.why))
}

fn of_cpu(cpu: &Cpu) -> String {
    let simd = cpu.simd.unwrap_or("no supported vector instructions");
    line("CPU", &cpu.name) + &line("", &format!("{} threads, {simd}", cpu.threads))
}

fn of_adapter(adapter: &Adapter) -> String {
    let (name, kind) = match adapter.kind {
        "gpu" => ("GPU", "graphics card"),
        _ => ("software GPU", "driver that runs on the processor"),
    };
    let [least, greatest] = adapter.subgroup_sizes;
    let subgroups = if least == greatest { least.to_string() } else { format!("{least} to {greatest}") };
    let times = if adapter.timestamps { "has timestamps" } else { "has no timestamps" };
    let fit = adapter.unsuited.as_ref().map_or("can be used".to_owned(), |why| format!("cannot be used: {why}"));
    [
        line(name, &adapter.name),
        line("", &format!("{kind}; {}, driver {}", adapter.api, adapter.driver)),
        line(
            "",
            &format!(
                "max buffer {}, max binding {}",
                bytes(adapter.max_buffer_bytes),
                bytes(adapter.max_binding_bytes)
            ),
        ),
        line(
            "",
            &format!(
                "{} buffers per shader, {} invocations per workgroup, subgroups of {subgroups}",
                adapter.max_storage_buffers, adapter.max_invocations
            ),
        ),
        line("", &format!("{times}; {fit}")),
    ]
    .concat()
}

fn line(name: &str, value: &str) -> String {
    format!("{name:<12} {value}\n")
}

/// A number of bytes in the largest unit that is not zero.
fn bytes(number: u64) -> String {
    let units = ["bytes", "KiB", "MiB", "GiB", "TiB"];
    let step = (number.max(1).ilog2() / 10).min(4);
    format!("{} {}", number >> (10 * step), units[step as usize])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::devices::list::tests::adapter;
    use lightcuts::device::DeviceKind;

    #[test]
    fn an_adapter_is_shown_with_everything() {
        let old = adapter("Old Card", DeviceKind::Gpu, Some("it has 4 buffers"));
        let text = of(&DeviceList::new(vec![old, adapter("llvmpipe", DeviceKind::SoftwareGpu, None)]));
        for expected in [
            "GPU          Old Card\n",
            "graphics card; Vulkan, driver driver 1.2",
            "max buffer 2 GiB, max binding 128 MiB",
            "10 buffers per shader, 256 invocations per workgroup, subgroups of 8 to 32",
            "has timestamps; cannot be used: it has 4 buffers",
            "software GPU llvmpipe\n",
            "has timestamps; can be used",
            "auto         uses the CPU: no graphics card is suitable\n",
        ] {
            assert!(text.contains(expected), "{expected} is missing in:\n{text}");
        }
    }

    #[test]
    fn bytes_have_a_fitting_unit() {
        assert_eq!(
            [0, 1023, 1024, (1 << 31) - 1, u64::MAX].map(bytes),
            ["0 bytes", "1023 bytes", "1 KiB", "1 GiB", "16777215 TiB"]
        );
    }
}
