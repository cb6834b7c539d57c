//! MTL material libraries.

use super::map::MapStatement;
use super::statement::{numbers, statements};
use crate::Fault;
use crate::lines::without_comment;
use crate::report::Report;
use crate::source::Source;
use glam::Vec3;
use lightcuts_scene::MaterialDesc;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Keywords of the format that the thesis' model of light has no use for; the physical one has for some.
const OTHERS: [&str; 38] = [
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
    "map_norm",
    "Pmt",
];

/// The field of [`MaterialDesc`] that a keyword gives, if it gives one.
fn field_of(keyword: &str) -> Option<&'static str> {
    let fields = [("Ka", "ambient"), ("Kd", "diffuse"), ("Ks", "specular"), ("Ns", "exponent")];
    fields.into_iter().find(|(known, _)| *known == keyword).map(|(_, field)| field)
}

/// Unknown keywords that are worth a warning each.
const MAX_UNKNOWN: usize = 16;

/// The program that wrote a library, as far as it matters: some give numbers a meaning of their own.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Writer {
    /// Blender from 2.80 on; roughness 0 becomes this exponent `Ns`.
    Blender { greatest_exponent: f32 },
    /// Any other, or nobody knows.
    Other,
}

impl Writer {
    /// By the comment in the first line of a library.
    fn of(text: &str) -> Self {
        match text.lines().next().and_then(|line| line.strip_prefix("# Blender ")) {
            // The exporter in Python, up to 3.0, names no version here.
            Some(rest) if rest.starts_with("MTL File") => Self::Blender { greatest_exponent: 900.0 },
            Some(_) => Self::Blender { greatest_exponent: 1000.0 },
            None => Self::Other,
        }
    }
}

/// A library's text and what it defines.
#[derive(Debug)]
pub(crate) struct Library {
    source: Source<'static>,
    writer: Writer,
    materials: HashMap<String, LibraryMaterial>,
    /// Names that end in what may be a comment, by what they are without it.
    commented: HashMap<String, String>,
}

/// A material as a library defines it. What the library leaves out has the value of [`MaterialDesc::default`].
#[derive(Debug, Clone)]
pub(crate) struct LibraryMaterial {
    /// Name, colours and exponent; the optical ratios are not the library's.
    pub(crate) desc: MaterialDesc,
    /// Where `map_Kd` is given.
    pub(crate) texture: Option<Range<usize>>,
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

    pub(crate) fn writer(&self) -> Writer {
        self.writer
    }

    /// The material of this name; of one that differs by a comment only, if there is none.
    pub(crate) fn get(&self, name: &str) -> Option<&LibraryMaterial> {
        let short = without_comment(name).trim_ascii();
        let commented = || self.materials.get(self.commented.get(short)?);
        self.materials.get(name).or_else(|| self.materials.get(short)).or_else(commented)
    }

    /// A fault at a span of the library's text.
    pub(crate) fn fault(&self, span: Range<usize>, message: &str) -> Fault {
        self.source.fault(span, message)
    }

    /// A fault about a field of a material, or a keyword of it.
    pub(crate) fn field_fault(&self, material: &str, field: &str, message: &str) -> Fault {
        let field = field_of(field).unwrap_or(field);
        let span = self.get(material).map_or(0..0, |material| {
            let mut given = material.spans.iter().chain(&material.others);
            given.find(|(name, _)| *name == field).map_or(material.defined.clone(), |(_, span)| span.clone())
        });
        self.fault(span, message)
    }

    /// The numbers of a line of the library.
    pub(crate) fn numbers(&self, line: Range<usize>, report: &mut Report) -> Option<Vec3> {
        numbers(&self.source, report, self.value(&line), line)
    }

    /// A line of the library that is about a map.
    pub(crate) fn map(&self, line: &Range<usize>) -> MapStatement<'_> {
        MapStatement::parse(self.value(line))
    }

    fn value(&self, line: &Range<usize>) -> &str {
        let line = &self.source.text()[line.clone()];
        line.split_once(|c: char| c.is_ascii_whitespace()).map_or("", |(_, value)| value.trim_ascii())
    }

    /// Reads a library. What is not a number where one is expected is an error; everything else that is odd is a warning.
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
        for span in statements(source.text()) {
            if parser.report.is_full() {
                break;
            }
            parser.line(span.start, &source.text()[span]);
        }
        parser.store();
        let (materials, writer) = (parser.materials, Writer::of(source.text()));
        let mut commented = HashMap::new();
        for material in materials.values() {
            let name = &material.desc.name;
            let short = without_comment(name).trim_ascii();
            if short.len() < name.len() {
                // Of several the least: the order of a hash table is none.
                let kept: &mut String = commented.entry(short.to_owned()).or_insert_with(|| name.clone());
                if name < kept {
                    kept.clone_from(name);
                }
            }
        }
        Self { source, writer, materials, commented }
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
            _ => match OTHERS.iter().find(|other| **other == keyword) {
                Some(other) => self.other(other, span),
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
            let is_empty = MapStatement::parse(value).is_empty();
            material.texture = (!is_empty).then(|| span.clone());
            if is_empty {
                self.warn(span, "map_Kd names no file");
            }
        } else if let Some(numbers) = numbers(self.source, self.report, value, span.clone()) {
            match keyword {
                "Ka" => material.desc.ambient = numbers,
                "Kd" => material.desc.diffuse = numbers,
                "Ks" => material.desc.specular = numbers,
                _ => material.desc.exponent = numbers.x,
            }
            if let Some(field) = field_of(keyword) {
                material.spans.retain(|(name, _)| *name != field);
                material.spans.push((field, span));
            }
        }
        self.current = Some(material);
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_scene::TextureMode;

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
        assert_eq!(library.map(&texture).mode, TextureMode::Straight);
        assert_eq!(library.map(&texture).names().collect::<Vec<_>>(), ["t u.png"]);
    }

    #[test]
    fn comments_and_long_lines_are_read_as_the_format_has_them() {
        let (library, errors, warnings) = library(
            "# c:\\path\\\nnewmtl a # red\r\nKd .1 .2 \\\r\n .3 # first\nKs 1# white\nNs \\\n 30\nnewmtl Material #25\nKd 1\n\
             newmtl x\nKd xyz 0.9505 1 1.089",
        );
        assert_eq!((errors.len(), warnings.len()), (0, 0), "{errors:?} {warnings:?}");
        let a = &library.get("a").expect("a comment is no name").desc;
        assert_eq!((a.diffuse, a.specular, a.exponent), (Vec3::new(0.1, 0.2, 0.3), Vec3::ONE, 30.0));
        assert!(library.get("a # other").is_some() && library.get("b").is_none());
        assert_eq!(library.get("Material #25").expect("it is").desc.name, "Material #25");
        let white = library.get("x").expect("it is").desc.diffuse;
        assert!((white - Vec3::ONE).abs().max_element() < 1e-3, "{white}");
    }

    #[test]
    fn writers_are_told_by_the_first_line() {
        let writer = |line: &str| library(&format!("{line}\nnewmtl a\n")).0.writer();
        assert_eq!(writer("# Blender 5.2.3 LTS MTL File: 'None'"), Writer::Blender { greatest_exponent: 1000.0 });
        assert_eq!(writer("# Blender MTL File: 'a.blend'"), Writer::Blender { greatest_exponent: 900.0 });
        assert_eq!((writer("# Wavefront material file"), writer("")), (Writer::Other, Writer::Other));
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
        warned("newmtl a\nKd .3 .2\nNs 3 4\n", "m.mtl:2:1: `Kd` has 2 numbers instead of 1 or 3: 0.3 is used for blue");
        warned(
            "newmtl a\nKs 0 -1e99 0\n",
            "m.mtl:2:6: `-1e99` is too large for a 32-bit number: -3.4028235e38 is used",
        );
        failed("newmtl a\nKd 1 nan 1\n", "m.mtl:2:6: `nan` is not a number");
        failed("newmtl a\n Ns\n", "m.mtl:2:2: the value is missing");
    }
}
