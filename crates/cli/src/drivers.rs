//! Graphics drivers that talk on our standard error.
//!
//! Mesa's loader layer for choosing a device asks a Wayland display which one that is. On a machine without a desktop the
//! Wayland library then writes `error: XDG_RUNTIME_DIR is invalid or not set in the environment.` to standard error, once
//! per look at the devices, in the middle of progress that programs read. We choose devices ourselves, so the layer is
//! switched off. Its switch is a variable that it reads from the environment of the process, which cannot be changed
//! without `unsafe` once the process runs; so the process executes itself again.

/// Switches the layer off if it would talk. Does not return then, unless that fails: then nothing is lost but silence.
#[cfg(target_os = "linux")]
pub(crate) fn hush() {
    use std::env::{args_os, current_exe, var_os};
    use std::os::unix::process::CommandExt;
    const SWITCH: &str = "NODEVICE_SELECT";

    if var_os("XDG_RUNTIME_DIR").is_some() || var_os(SWITCH).is_some() {
        return;
    }
    let Ok(program) = current_exe() else { return };
    let mut arguments = args_os();
    let mut command = std::process::Command::new(program);
    command.arg0(arguments.next().unwrap_or_default()).args(arguments).env(SWITCH, "1");
    let error = command.exec();
    tracing::debug!("drivers may talk: {error}");
}

/// Elsewhere there is no such layer.
#[cfg(not(target_os = "linux"))]
pub(crate) fn hush() {}
