//! MTL material libraries.

use super::map_file::map_file;
use crate::Fault;
use crate::number::{NUMBER_EXAMPLE, parse_number};
use crate::report::Report;
use crate::source::Source;
use glam::Vec3;
use lightcuts_scene::{MaterialDesc, TextureMode};
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Keywords of the format that the thesis' model of light has no use for.
const IGNORED: [&str; 37] = [
    "Ke",
    "Kt",
    "Tf",
    "illum",
    "d",
    "Tr",
    "Ni",
    "sharpness",
    "map_Ka",
    "map_Ks",
    "map_Ke",
    "map_Ns",
    "map_d",
    "map_aat",
    "map_bump",
    "map_Bump",
    "map_refl",
    "bump",
    "disp",
    "decal",
    "refl",
    "norm",
    "Pr",
    "Pm",
    "Ps",
    "Pc",
    "Pcr",
    "aniso",
    "anisor",
    "map_Pr",
    "map_Pm",
    "map_Ps",
    "map_Pc",
    "map_Pcr",
    "map_Tr",
    "map_opacity",
    "Pmt",
];

/// Unknown keywords that are worth a warning each.
const MAX_UNKNOWN: usize = 16;

/// A library's text and what it defines.
#[derive(Debug)]
pub(crate) struct Library {
    source: Source<'static>,
    materials: HashMap<String, LibraryMaterial>,
}

/// A material as a library defines it. What the library leaves out has the value of [`MaterialDesc::default`].
#[derive(Debug, Clone)]
pub(crate) struct LibraryMaterial {
    /// Name, colours and exponent; the optical ratios are not the library's.
    pub(crate) desc: MaterialDesc,
    /// File, mode and place of `map_Kd`.
    pub(crate) texture: Option<(String, TextureMode, Range<usize>)>,
    /// Where each field of `desc` was given.
    spans: Vec<(&'static str, Range<usize>)>,
    /// The lines with keywords that the thesis' model has no use for, unread.
    others: Vec<(&'static str, Range<usize>)>,
    defined: Range<usize>,
}

impl LibraryMaterial {
    /// Whether the library gives a field of `desc`.
    pub(crate) fn gives(&self, field: &str) -> bool {
        self.spans.iter().any(|(name, _)| *name == field)
    }

    /// The line with a keyword that the thesis' model has no use for.
    pub(crate) fn other(&self, keyword: &str) -> Option<Range<usize>> {
        self.others.iter().find(|(name, _)| *name == keyword).map(|(_, span)| span.clone())
    }

    /// All such keywords, in the order of their last lines.
    pub(crate) fn others(&self) -> impl Iterator<Item = &'static str> {
        self.others.iter().map(|(keyword, _)| *keyword)
    }
}

impl Library {
    /// Name of the library's file.
    pub(crate) fn name(&self) -> &str {
        self.source.name()
    }

    pub(crate) fn get(&self, name: &str) -> Option<&LibraryMaterial> {
        self.materials.get(name)
    }

    /// A fault at a span of the library's text.
    pub(crate) fn fault(&self, span: Range<usize>, message: &str) -> Fault {
        self.source.fault(span, message)
    }

    /// A fault about a field of a material, or another keyword of it.
    pub(crate) fn field_fault(&self, material: &str, field: &str, message: &str) -> Fault {
        let span = self.get(material).map_or(0..0, |material| {
            let mut given = material.spans.iter().chain(&material.others);
            given.find(|(name, _)| *name == field).map_or(material.defined.clone(), |(_, span)| span.clone())
        });
        self.fault(span, message)
    }

    /// The numbers of a line of the library.
    pub(crate) fn numbers(&self, line: Range<usize>, report: &mut Report) -> Option<Vec3> {
        read_numbers(&self.source, report, self.value(&line), line)
    }

    /// The file name of a line of the library that is about a map.
    pub(crate) fn file(&self, line: Range<usize>) -> &str {
        map_file(self.value(&line)).0
    }

    fn value(&self, line: &Range<usize>) -> &str {
        let line = &self.source.text()[line.clone()];
        line.split_once(|c: char| c.is_ascii_whitespace()).map_or("", |(_, value)| value.trim_ascii())
    }

    /// Reads a library. Numbers that are none are errors; all else that is odd is a warning.
    pub(crate) fn parse(name: &str, text: String, report: &mut Report) -> Self {
        let source = Source::new(name, text);
        let mut parser = Parser {
            source: &source,
            report,
            materials: HashMap::new(),
            current: None,
            unknown: HashSet::new(),
            orphans: false,
        };
        let mut start = 0;
        for line in source.text().split_inclusive('\n') {
            if parser.report.is_full() {
                break;
            }
            parser.line(start, line);
            start += line.len();
        }
        parser.store();
        let materials = parser.materials;
        Self { source, materials }
    }
}

struct Parser<'a> {
    source: &'a Source<'static>,
    report: &'a mut Report,
    materials: HashMap<String, LibraryMaterial>,
    current: Option<LibraryMaterial>,
    unknown: HashSet<String>,
    /// Whether values before the first `newmtl` were warned about.
    orphans: bool,
}

impl Parser<'_> {
    fn warn(&mut self, span: Range<usize>, message: &str) {
        self.report.warn(|| self.source.fault(span, message));
    }

    /// Ends the current material.
    fn store(&mut self) {
        let Some(material) = self.current.take() else { return };
        let span = material.defined.clone();
        if self.materials.insert(material.desc.name.clone(), material).is_some() {
            self.warn(span, "the material is defined twice; the last definition counts");
        }
    }

    fn line(&mut self, line_start: usize, line: &str) {
        let content = line.trim_ascii();
        if content.is_empty() || content.starts_with('#') {
            return;
        }
        let start = line_start + line.len() - line.trim_ascii_start().len();
        let span = start..start + content.len();
        let (keyword, value) = content.split_once(|c: char| c.is_ascii_whitespace()).unwrap_or((content, ""));
        let value = value.trim_ascii();
        match keyword {
            "newmtl" => {
                self.store();
                let desc = MaterialDesc { name: value.to_owned(), ..MaterialDesc::default() };
                self.current =
                    Some(LibraryMaterial { desc, texture: None, spans: vec![], others: vec![], defined: span });
            }
            "Ka" | "Kd" | "Ks" | "Ns" | "map_Kd" => self.value(keyword, value, span),
            _ => match IGNORED.iter().find(|ignored| **ignored == keyword) {
                Some(ignored) => self.other(ignored, span),
                None => self.unknown_keyword(keyword, start..start + keyword.len()),
            },
        }
    }

    /// Remembers the last line with a keyword.
    fn other(&mut self, keyword: &'static str, span: Range<usize>) {
        if let Some(material) = &mut self.current {
            material.others.retain(|(known, _)| *known != keyword);
            material.others.push((keyword, span));
        }
    }

    fn unknown_keyword(&mut self, keyword: &str, span: Range<usize>) {
        if self.unknown.len() < MAX_UNKNOWN && self.unknown.insert(keyword.to_owned()) {
            let message = format!("unknown keyword `{keyword}`: lines that start with it are ignored");
            self.warn(span, &message);
        }
    }

    fn value(&mut self, keyword: &str, value: &str, span: Range<usize>) {
        let Some(mut material) = self.current.take() else {
            if !std::mem::replace(&mut self.orphans, true) {
                self.warn(span, "a value before the first `newmtl` belongs to no material");
            }
            return;
        };
        if keyword == "map_Kd" {
            let (file, mode) = map_file(value);
            material.texture = (!file.is_empty()).then(|| (file.to_owned(), mode, span.clone()));
            if file.is_empty() {
                self.warn(span, "map_Kd names no file");
            }
        } else if let Some(numbers) = read_numbers(self.source, self.report, value, span.clone()) {
            let field = match keyword {
                "Ka" => "ambient",
                "Kd" => "diffuse",
                "Ks" => "specular",
                _ => "exponent",
            };
            match field {
                "ambient" => material.desc.ambient = numbers,
                "diffuse" => material.desc.diffuse = numbers,
                "specular" => material.desc.specular = numbers,
                _ => material.desc.exponent = numbers.x,
            }
            material.spans.retain(|(name, _)| *name != field);
            material.spans.push((field, span));
        }
        self.current = Some(material);
    }
}

/// Up to three numbers; one alone stands for all three, as the format has it. `value` stands at the end of `span`.
fn read_numbers(source: &Source<'_>, report: &mut Report, value: &str, span: Range<usize>) -> Option<Vec3> {
    let value_start = span.end - value.len();
    let mut numbers = [0.0; 3];
    let mut count = 0;
    for word in value.split_ascii_whitespace().take(3) {
        if count == 0 && matches!(word, "spectral" | "xyz") {
            let message = format!("`{word}` colours are not known; the value is ignored");
            report.warn(|| source.fault(span, &message));
            return None;
        }
        match parse_number(word) {
            Ok(number) => numbers[count] = number,
            Err(error) => {
                let start = value_start + (word.as_ptr() as usize - value.as_ptr() as usize);
                let message = error.message(word);
                report.error(|| source.fault(start..start + word.len(), &message).expected(NUMBER_EXAMPLE));
                return None;
            }
        }
        count += 1;
    }
    match count {
        0 => {
            report.error(|| source.fault(span, "the value is missing").expected(NUMBER_EXAMPLE));
            None
        }
        3 => Some(Vec3::from_array(numbers)),
        _ => Some(Vec3::new(numbers[0], if count == 2 { numbers[1] } else { numbers[0] }, numbers[0])),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn library(text: &str) -> (Library, Vec<String>, Vec<String>) {
        let mut report = Report::default();
        let library = Library::parse("m.mtl", text.to_owned(), &mut report);
        match report.finish() {
            Ok(warnings) => (library, Vec::new(), warnings.iter().map(ToString::to_string).collect()),
            Err(faults) => (library, vec![faults.to_string()], Vec::new()),
        }
    }

    #[test]
    fn values_are_read() {
        let (library, errors, warnings) = library(
            "\tnewmtl  a b \r\n Ka .1 .2 .3\n  Kd 0.5\nKs 1 1 1\nNs 30\nillum 2\nnewmtl c\nmap_Kd -clamp on t u.png",
        );
        assert_eq!((errors.len(), warnings.len()), (0, 0));
        let material = &library.get("a b").expect("it is defined").desc;
        assert_eq!((material.ambient, material.diffuse), (Vec3::new(0.1, 0.2, 0.3), Vec3::splat(0.5)));
        assert_eq!((material.specular, material.exponent), (Vec3::ONE, 30.0));
        let texture = library.get("c").and_then(|c| c.texture.clone()).expect("it has one");
        assert_eq!((texture.0.as_str(), texture.1), ("t u.png", TextureMode::Straight));
    }

    #[test]
    fn oddities_are_told() {
        let warned = |text: &str, fragment: &str| {
            let (_, _, warnings) = library(text);
            assert!(warnings.len() == 1 && warnings[0].contains(fragment), "{text}: {warnings:?}");
        };
        warned("Kd 1 1 1\nKa 1 1 1\n", "m.mtl:1:1: a value before the first `newmtl`");
        warned("newmtl a\nfoo 1\nfoo 2\n", "m.mtl:2:1: unknown keyword `foo`");
        warned("newmtl a\nnewmtl a\n", "m.mtl:2:1: the material is defined twice");
        warned("newmtl a\nKd spectral x.rfl\n", "m.mtl:2:1: `spectral` colours");
        warned("newmtl a\nmap_Kd -clamp on\n", "m.mtl:2:1: map_Kd names no file");
        let failed =
            |text: &str, message: &str| assert!(library(text).1[0].contains(message), "{text}: {:?}", library(text).1);
        failed("newmtl a\nKd 1 nan 1\n", "m.mtl:2:6: `nan` is not a number");
        failed("newmtl a\n Ns\n", "m.mtl:2:2: the value is missing");
    }
}
