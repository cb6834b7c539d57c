//! Programs: lists of WGSL sources with the buffers that they use, joined into one text whose lines can be found again.

use crate::buffers::{Split, accessor, element};
use lightcuts_kernel::wgsl::Source;
use std::fmt::Write as _;

/// A storage buffer of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Binding {
    /// Name of the variable.
    pub name: &'static str,
    /// Whether the program writes to it.
    pub is_written: bool,
}

/// A compute program: entry points that take the same parameters and buffers.
#[derive(Debug, Clone, Copy)]
pub struct Program {
    /// Names of the entry points.
    pub entries: &'static [&'static str],
    /// Type of `params`, which every program has.
    pub params: &'static str,
    /// Invocations of a workgroup.
    pub workgroup: u32,
    /// What is joined, in any order.
    pub sources: &'static [&'static [Source]],
    /// Names of the storage buffers that are read only.
    pub reads: &'static [&'static [&'static str]],
    /// Names of those that are written to.
    pub writes: &'static [&'static str],
}

/// A program's text, and where its lines come from.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Text {
    /// What a driver is given.
    pub wgsl: String,
    /// For each source its path and the number of its first line in `wgsl`, from 1, in ascending order.
    starts: Vec<(&'static str, usize)>,
}

impl Text {
    /// The file and line of a line of [`Text::wgsl`], both from 1.
    pub fn origin(&self, line: usize) -> (&'static str, usize) {
        let before = self.starts.iter().rev().find(|(_, first)| *first <= line);
        before.map_or(("generated bindings", line), |&(path, first)| (path, line - first + 1))
    }
}

impl Program {
    /// Its storage buffers in the order of their bindings, from 1 on.
    pub fn bindings(&self) -> impl Iterator<Item = Binding> {
        let reads = self.reads.iter().copied().flatten().map(|&name| Binding { name, is_written: false });
        reads.chain(self.writes.iter().map(|&name| Binding { name, is_written: true }))
    }

    /// Joins the sources under declarations of the buffers. `split` says how a buffer is split.
    pub fn text(&self, split: impl Fn(&str) -> Split) -> Text {
        let mut wgsl = format!("@group(0) @binding(0) var<uniform> params: {};\n", self.params);
        let mut number = 0;
        for Binding { name, is_written } in self.bindings() {
            let split = split(name);
            let access = if is_written { "read_write" } else { "read" };
            let element = element(name);
            for part in 0..split.parts {
                number += 1;
                let name = part_name(name, split, part);
                let _ = writeln!(wgsl, "@group(0) @binding({number}) var<storage, {access}> {name}: array<{element}>;");
            }
            if let Some(function) = accessor(name) {
                wgsl += &accessor_text(name, function, split);
            }
        }
        let mut starts = Vec::new();
        for source in self.sources.iter().copied().flatten() {
            starts.push((source.path, wgsl.lines().count() + 1));
            wgsl += source.text;
        }
        Text { wgsl, starts }
    }
}

fn part_name(name: &str, split: Split, part: u32) -> String {
    if split.parts == 1 { name.to_owned() } else { format!("{name}_{part}") }
}

/// A function from an element's number to the element, wherever it is.
fn accessor_text(name: &str, function: &str, split: Split) -> String {
    let element = element(name);
    if split.parts == 1 {
        return format!("fn {function}(index: u32) -> {element} {{ return {name}[index]; }}\n");
    }
    let mut text = format!("fn {function}(index: u32) -> {element} {{\n    switch (index >> {}u) {{\n", split.shift);
    let mask = (1_u32 << split.shift) - 1;
    for part in 0..split.parts {
        let case = if part + 1 == split.parts { "default".to_owned() } else { format!("case {part}u") };
        let _ = writeln!(text, "        {case}: {{ return {name}_{part}[index & {mask}u]; }}");
    }
    text + "    }\n}\n"
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::programs::{PROGRAMS, program};

    /// Every program is valid WGSL, whole and split, and stays within the portable number of storage buffers.
    #[test]
    fn every_program_is_valid() {
        use naga::valid::{Capabilities, ValidationFlags, Validator};
        for program in PROGRAMS {
            for parts in [1, 3] {
                let split = |name: &str| match accessor(name) {
                    Some(_) => Split { parts, shift: 20 },
                    None => Split::WHOLE,
                };
                let text = program.text(split);
                let module = naga::front::wgsl::parse_str(&text.wgsl).unwrap_or_else(|error| {
                    let line = error.location(&text.wgsl).map_or(0, |place| place.line_number as usize);
                    panic!("{:?}: {:?}: {}", program.entries, text.origin(line), error.emit_to_string(&text.wgsl))
                });
                let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
                let checked = validator.validate(&module);
                checked.unwrap_or_else(|error| panic!("{:?}: {}", program.entries, error.emit_to_string(&text.wgsl)));
                let found: Vec<_> =
                    module.entry_points.iter().map(|entry| (&*entry.name, entry.workgroup_size)).collect();
                let listed: Vec<_> = program.entries.iter().map(|&name| (name, [program.workgroup, 1, 1])).collect();
                assert_eq!(found, listed);
                assert!(program.workgroup <= 256);
            }
            let buffers = program.bindings().count();
            assert!(buffers <= 10, "{:?}: {buffers} buffers", program.entries);
        }
    }

    #[test]
    fn lines_are_found_again() {
        let program = program("trace");
        let text = program.text(|_| Split::WHOLE);
        for source in program.sources.iter().copied().flatten() {
            let wanted = source.text.lines().next().unwrap();
            let found = text
                .wgsl
                .lines()
                .enumerate()
                .any(|(number, line)| line == wanted && text.origin(number + 1) == (source.path, 1));
            assert!(found, "{}", source.path);
        }
        assert_eq!(text.origin(1).0, "generated bindings");
    }
}
