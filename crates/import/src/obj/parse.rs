//! The lines of an OBJ file.

use super::face::{Corner, Forward};
use super::ignored::Ignored;
use crate::Fault;
use crate::anchor::Anchor;
use crate::lines::{Lines, ReadError, length_without_comment, words};
use crate::model::{self, MaterialRun, Model, SmoothingRun};
use crate::number::{NUMBER_EXAMPLE, NumberError, parse_exact, parse_number};
use crate::polygon::{Cut, Faces};
use crate::report::{Report, Tally};
use crate::resolver::FileError;
use glam::{DVec3, Vec3};
use std::collections::HashMap;
use std::ops::Range;

/// Numbers of a `v` line from which on it has a colour: x, y, z and red, green, blue, with or without a weight.
const WITH_COLOR: usize = 6;

/// Reads a model of at most `max_elements` vertices, normals, coordinates and triangles together.
///
/// Errors go to `report`; the model is `None` if there was one. Fails if the file cannot be read.
pub(crate) fn parse(
    mut lines: Lines<'_>,
    max_elements: usize,
    cut: Cut,
    report: &mut Report,
) -> Result<Option<Model>, FileError> {
    let mut parser = Parser::new(max_elements, cut, report);
    loop {
        match lines.advance() {
            Ok(true) if !parser.is_done() => parser.line(&lines),
            Ok(_) => break,
            Err(ReadError::Content(fault)) => {
                parser.error(|| *fault);
                break;
            }
            Err(ReadError::File(error)) => return Err(error),
        }
    }
    Ok(parser.finish())
}

pub(super) struct Parser<'a> {
    pub(super) model: Model,
    pub(super) report: &'a mut Report,
    pub(super) max_elements: usize,
    /// Whether there was an error, and whether it makes reading on pointless.
    failed: bool,
    pub(super) stopped: bool,
    material_ids: HashMap<String, usize>,
    pub(super) forward: Vec<Forward>,
    /// Of the current face.
    pub(super) corners: Vec<Corner>,
    pub(super) faces: Faces,
    ignored: Ignored,
    colors: Tally,
    cut: Cut,
    anchor: Anchor,
}

impl<'a> Parser<'a> {
    fn new(max_elements: usize, cut: Cut, report: &'a mut Report) -> Self {
        Self {
            model: Model::default(),
            report,
            max_elements,
            failed: false,
            stopped: false,
            material_ids: HashMap::new(),
            forward: Vec::new(),
            corners: Vec::new(),
            faces: Faces::new(cut),
            ignored: Ignored::default(),
            colors: Tally::default(),
            cut,
            anchor: Anchor::new(cut),
        }
    }

    fn is_done(&self) -> bool {
        self.stopped || self.report.is_full()
    }

    pub(super) fn error(&mut self, fault: impl FnOnce() -> Fault) {
        self.failed = true;
        self.report.error(fault);
    }

    fn line(&mut self, lines: &Lines<'_>) {
        let text = lines.text();
        let content = text.trim_ascii();
        if content.is_empty() || content.starts_with('#') {
            return;
        }
        let start = text.len() - text.trim_ascii_start().len();
        let keyword = content.split_ascii_whitespace().next().unwrap_or_default();
        let rest = start + keyword.len()..start + content.len();
        // Names may hold a `#`, numbers do not.
        let numbers = rest.start..rest.start + length_without_comment(&text[rest.clone()]);
        match keyword {
            "v" => self.vertex(lines, numbers),
            "vn" => {
                let normal = self.numbers(lines, numbers, 3, parse_number);
                self.model.mesh.normals.push(Vec3::from_array(normal));
            }
            "vt" => {
                let coordinates = self.numbers(lines, numbers, 1, parse_number);
                self.model.mesh.texture_coordinates.push(coordinates);
            }
            "f" | "fo" => self.face(lines, start..numbers.end),
            "s" => self.smoothing_group(text[numbers].trim_ascii()),
            "usemtl" => self.use_material(lines, start..rest.end, text[rest].trim_ascii()),
            "mtllib" => self
                .model
                .libraries
                .push((text[rest.clone()].trim_ascii().to_owned(), lines.fault(start..rest.end, ""))),
            _ => self.ignored.note(lines, start..rest.start, keyword, self.report),
        }
        self.check_size(lines, start);
    }

    fn vertex(&mut self, lines: &Lines<'_>, numbers: Range<usize>) {
        let position = if self.cut == Cut::Fans {
            Vec3::from_array(self.numbers(lines, numbers.clone(), 3, parse_number))
        } else {
            let exact = self.numbers(lines, numbers.clone(), 3, parse_exact);
            self.anchor.relative(DVec3::from_array(exact))
        };
        self.model.mesh.positions.push(position);
        if words(lines.text(), numbers.clone()).nth(WITH_COLOR - 1).is_some() {
            self.colors.note(|| lines.fault(numbers, ""));
        }
    }

    /// At least `least` numbers, at most N; what follows them (weights, vertex colours) is ignored. Zeros after an
    /// error, so that later indices still point at what was meant.
    fn numbers<T: Copy + Default, const N: usize>(
        &mut self,
        lines: &Lines<'_>,
        rest: Range<usize>,
        least: usize,
        parse: fn(&str) -> Result<T, NumberError>,
    ) -> [T; N] {
        let text = lines.text();
        let mut values = [T::default(); N];
        let mut words = words(text, rest.clone());
        for (i, value) in values.iter_mut().enumerate() {
            let Some(span) = words.next() else {
                if i < least {
                    self.error(|| {
                        let message = format!("{i} numbers instead of {least}");
                        lines.fault(rest.end..rest.end, &message).expected(NUMBER_EXAMPLE)
                    });
                }
                break;
            };
            match parse(&text[span.clone()]) {
                Ok(number) => *value = number,
                Err(error) => {
                    let message = error.message(&text[span.clone()]);
                    self.error(|| lines.fault(span, &message).expected(NUMBER_EXAMPLE));
                    return [T::default(); N];
                }
            }
        }
        values
    }

    fn use_material(&mut self, lines: &Lines<'_>, span: Range<usize>, name: &str) {
        let next = self.material_ids.len();
        let material = *self.material_ids.entry(name.to_owned()).or_insert(next);
        if material == next {
            self.model.materials.push((name.to_owned(), lines.fault(span, "")));
        }
        let first_triangle = self.model.mesh.triangles.len();
        // A run without triangles is replaced.
        self.model.runs.pop_if(|run| run.first_triangle == first_triangle);
        self.model.runs.push(MaterialRun { first_triangle, material });
    }

    /// `s 1`; `s off` and `s 0` end smoothing, and so does what is no number.
    fn smoothing_group(&mut self, group: &str) {
        let group = group.parse().unwrap_or(0);
        let first_triangle = self.model.mesh.triangles.len();
        let runs = &mut self.model.smoothing;
        runs.pop_if(|run| run.first_triangle == first_triangle);
        if runs.last().is_none_or(|last| last.group != group) {
            runs.push(SmoothingRun { first_triangle, group });
        }
    }

    pub(super) fn elements(&self) -> usize {
        model::elements(&self.model.mesh)
    }

    fn check_size(&mut self, lines: &Lines<'_>, start: usize) {
        if self.elements() > self.max_elements {
            let message = model::too_large(self.max_elements);
            self.error(|| lines.fault(start..start + 1, &message).expected("a smaller model"));
            self.stopped = true;
        }
    }

    fn finish(mut self) -> Option<Model> {
        self.check_forward();
        if self.failed {
            return None;
        }
        self.faces.cut_late(&mut self.model.mesh);
        self.faces.warn(self.report);
        self.ignored.warn(self.report);
        self.colors.warn(self.report, |_| model::VERTEX_COLORS_UNUSED.to_owned());
        self.model.origin = self.anchor.origin();
        Some(self.model)
    }
}
