//! Programs: lists of WGSL sources with the buffers that they use, joined into one text whose lines can be found again.

use std::fmt::Write as _;

use lightcuts_kernel::wgsl::Source;

/// A storage buffer of a program.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Binding {
    /// Name of the variable; buffers of one name have one layout in all programs.
    pub name: &'static str,
    /// WGSL type of an element.
    pub element: &'static str,
    /// Whether the program writes to it.
    pub is_written: bool,
}

/// A compute program.
#[derive(Debug, Clone, Copy)]
pub struct Program {
    /// Name of the entry point, and of the program.
    pub entry: &'static str,
    /// Type of `params`, which every program has.
    pub params: &'static str,
    /// Invocations of a workgroup.
    pub workgroup: u32,
    /// What is joined, in any order.
    pub sources: &'static [Source],
    /// Storage buffers in the order of their bindings, from 1 on.
    pub bindings: &'static [Binding],
}

/// Functions through which programs read the world's large buffers, which may be split over several bindings.
const ACCESSORS: [(&str, &str); 4] = [
    ("nodes", "compressed_node"),
    ("items", "leaf_item"),
    ("corners", "triangle_corners"),
    ("primitives", "primitive_record"),
];

/// Whether buffers of this name may be split.
pub(crate) fn is_splittable(name: &str) -> bool {
    ACCESSORS.iter().any(|(large, _)| *large == name)
}

/// How the buffers of a name are split: into how many parts of 2^shift elements.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Split {
    /// Number of buffers.
    pub parts: u32,
    /// Elements of all but the last, as a power of two.
    pub shift: u32,
}

impl Split {
    /// One buffer.
    pub const WHOLE: Self = Self { parts: 1, shift: 31 };
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
    /// Joins the sources under declarations of the buffers. `split` says how a buffer is split.
    pub fn text(&self, split: impl Fn(&str) -> Split) -> Text {
        let mut wgsl = format!("@group(0) @binding(0) var<uniform> params: {};\n", self.params);
        let mut number = 0;
        for binding in self.bindings {
            let split = split(binding.name);
            let access = if binding.is_written { "read_write" } else { "read" };
            for part in 0..split.parts {
                number += 1;
                let name = part_name(binding.name, split, part);
                let element = binding.element;
                let _ = writeln!(wgsl, "@group(0) @binding({number}) var<storage, {access}> {name}: array<{element}>;");
            }
            if let Some((_, function)) = ACCESSORS.iter().find(|(name, _)| *name == binding.name) {
                wgsl += &accessor(binding, function, split);
            }
        }
        let mut starts = Vec::new();
        for source in self.sources {
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
fn accessor(binding: &Binding, function: &str, split: Split) -> String {
    let Binding { name, element, .. } = binding;
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
    use crate::programs::PROGRAMS;

    /// Every program is valid WGSL, whole and split, and stays within the portable number of storage buffers.
    #[test]
    fn every_program_is_valid() {
        use naga::valid::{Capabilities, ValidationFlags, Validator};
        for program in PROGRAMS {
            for parts in [1, 3] {
                let split = |name: &str| if is_splittable(name) { Split { parts, shift: 20 } } else { Split::WHOLE };
                let text = program.text(split);
                let module = naga::front::wgsl::parse_str(&text.wgsl).unwrap_or_else(|error| {
                    let line = error.location(&text.wgsl).map_or(0, |place| place.line_number as usize);
                    panic!("{}: {:?}: {}", program.entry, text.origin(line), error.emit_to_string(&text.wgsl))
                });
                let mut validator = Validator::new(ValidationFlags::all(), Capabilities::default());
                let checked = validator.validate(&module);
                checked.unwrap_or_else(|error| panic!("{}: {}", program.entry, error.emit_to_string(&text.wgsl)));
                let entry = module.entry_points.iter().find(|entry| entry.name == program.entry).unwrap();
                assert_eq!(entry.workgroup_size, [program.workgroup, 1, 1], "{}", program.entry);
                assert!(program.workgroup <= 256);
            }
            assert!(program.bindings.len() <= 10, "{}: {} buffers", program.entry, program.bindings.len());
        }
    }

    #[test]
    fn lines_are_found_again() {
        let program = PROGRAMS.iter().find(|program| program.entry == "trace").unwrap();
        let text = program.text(|_| Split::WHOLE);
        for source in program.sources {
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
