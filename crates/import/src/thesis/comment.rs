//! `# VPL(p/t/a) ... LC(e)`: the run's parameters, which the thesis keeps in a comment.

use crate::number::parse_number;
use lightcuts_scene::{PerDevice, VplDefaults};
use std::ops::Range;

/// What one comment says.
#[derive(Debug, Default, PartialEq)]
pub(super) struct Parameters {
    pub(super) vpl: Option<(VplDefaults, Range<usize>)>,
    pub(super) threshold: Option<(PerDevice, Range<usize>)>,
    /// Places that look like parameters but cannot be read, with what was expected.
    pub(super) malformed: Vec<(Range<usize>, &'static str)>,
}

const VPL_EXAMPLE: &str = "three numbers such as VPL(0.0001/0.7/GPU:0.08-CPU:0.075)";
const LC_EXAMPLE: &str = "a number such as LC(1e-6) or LC(1*10^-6)";

/// Reads a comment; spans are in bytes of it.
pub(super) fn parameters(comment: &str) -> Parameters {
    let mut found = Parameters::default();
    if let Some((span, inner)) = call(comment, "VPL") {
        match vpl(inner) {
            Some(vpl) => found.vpl = Some((vpl, span)),
            None => found.malformed.push((span, VPL_EXAMPLE)),
        }
    }
    if let Some((span, inner)) = call(comment, "LC") {
        match per_device(inner) {
            Some(threshold) => found.threshold = Some((threshold, span)),
            None => found.malformed.push((span, LC_EXAMPLE)),
        }
    }
    found
}

/// The first `NAME(...)` that holds a digit: prose such as "the VPL(s)" is none.
fn call<'t>(comment: &'t str, name: &str) -> Option<(Range<usize>, &'t str)> {
    let bytes = comment.as_bytes();
    for open in comment.match_indices('(').map(|(i, _)| i) {
        let before = comment[..open].trim_end_matches([' ', '\t']);
        let Some(start) = before.len().checked_sub(name.len()) else { continue };
        let named = before.get(start..).is_some_and(|word| word.eq_ignore_ascii_case(name));
        let at_word_start = start == 0 || !bytes[start - 1].is_ascii_alphanumeric();
        if !(named && at_word_start) {
            continue;
        }
        let inner = comment[open + 1..].split_once(')').map_or(&comment[open + 1..], |(inner, _)| inner);
        if inner.bytes().any(|byte| byte.is_ascii_digit()) {
            let closed = usize::from(comment[open + 1..].len() > inner.len());
            return Some((start..open + 1 + inner.len() + closed, inner));
        }
    }
    None
}

fn vpl(text: &str) -> Option<VplDefaults> {
    let mut parts = text.split('/').map(per_device);
    let defaults =
        VplDefaults { probability: parts.next()??, min_illumination: parts.next()??, attenuation: parts.next()?? };
    parts.next().is_none().then_some(defaults)
}

/// A number for all devices, or one per device as in `GPU:0.08-CPU:0.075`.
fn per_device(text: &str) -> Option<PerDevice> {
    let upper = text.to_ascii_uppercase();
    let (cpu, gpu) = (upper.find("CPU"), upper.find("GPU"));
    if cpu.is_none() && gpu.is_none() {
        return number(text).map(PerDevice::from);
    }
    let first = cpu.into_iter().chain(gpu).min()?;
    if !upper[..first].trim().is_empty() {
        return None;
    }
    let value = |start: usize, other: Option<usize>| {
        let end = other.filter(|&other| other > start).unwrap_or(upper.len());
        // The `-` between the devices belongs to neither number.
        let value = upper[start + 3..end].trim().trim_end_matches(['-', ',', ';']);
        number(value.trim_start_matches([' ', '\t']).strip_prefix([':', '='])?)
    };
    match (cpu, gpu) {
        (Some(c), Some(g)) => Some(PerDevice { cpu: value(c, gpu)?, gpu: value(g, cpu)? }),
        (Some(only), None) | (None, Some(only)) => value(only, None).map(PerDevice::from),
        (None, None) => None,
    }
}

/// A number of at least 0: plain, or as `1*10^-6`.
fn number(text: &str) -> Option<f32> {
    let compact: String = text.chars().filter(|c| !c.is_whitespace()).collect();
    let plain = match compact.split_once("*10^") {
        Some((factor, power)) => format!("{factor}e{}", power.trim_start_matches('(').trim_end_matches(')')),
        None => compact,
    };
    parse_number(&plain).ok().filter(|value| *value >= 0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn read(comment: &str) -> (Option<[PerDevice; 3]>, Option<PerDevice>, usize) {
        let found = parameters(comment);
        let vpl = found.vpl.map(|(v, _)| [v.probability, v.min_illumination, v.attenuation]);
        (vpl, found.threshold.map(|(e, _)| e), found.malformed.len())
    }

    #[test]
    fn the_thesis_spellings_are_read() {
        let all = |a: PerDevice| Some([PerDevice::from(0.0001), PerDevice::from(0.7), a]);
        let devices = PerDevice { cpu: 0.075, gpu: 0.08 };
        let threshold = Some(PerDevice::from(1e-6));
        for text in [
            "# VPL(0.0001/0.7/GPU:0.08-CPU:0.075), LC(1*10^-6)",
            "# vpl ( 1e-4 / .7 / CPU:0.075-GPU:0.08 ) lc( 1e-6 )",
            "#VPL(1*10^-4/7*10^-1/GPU : 8e-2 - CPU : 7.5e-2)LC(0.000001)",
            "# the VPL(s): VPL(0.0001/0.7/gpu:0.08,cpu:0.075) | LC(1 * 10^-6",
        ] {
            assert_eq!(read(text), (all(devices), threshold, 0), "{text}");
        }
        assert_eq!(read("# VPL(0.0001/0.7/0.5)"), (all(PerDevice::from(0.5)), None, 0));
        assert_eq!(read("# LC(GPU:1e-6-CPU:2e-6)").1, Some(PerDevice { cpu: 2e-6, gpu: 1e-6 }));
        assert_eq!(read("# LC(CPU:2e-6)").1, Some(PerDevice::from(2e-6)));
    }

    #[test]
    fn malformed_parameters_are_told_from_prose() {
        for text in [
            "# VPL(1/2)",
            "# VPL(1/2/3/4)",
            "# LC(-1)",
            "# LC(1e400)",
            "# LC(1*10)",
            "# VPL(GPU 1/2/3)",
            "# VPL(1/2/x GPU:3)",
        ] {
            assert_eq!(read(text), (None, None, 1), "{text}");
        }
        for text in ["#", "# VPL(s)", "# about LC()", "# VPL 1", "# CALC(1)", "# ä(1)", "# VPL(", "# äLC(ü)"] {
            assert_eq!(read(text), (None, None, 0), "{text}");
        }
    }
}
