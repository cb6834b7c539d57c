//! The lines of an OBJ file.

use crate::Fault;
use crate::lines::{Lines, ReadError, words};
use crate::model::{self, MaterialRun, Model};
use crate::number::{NUMBER_EXAMPLE, parse_number};
use crate::report::Report;
use crate::resolver::FileError;
use glam::Vec3;
use lightcuts_scene::MeshTriangle;
use std::collections::{HashMap, HashSet};
use std::ops::Range;

/// Keywords of the format that have no meaning for a triangle mesh.
const IGNORED: [&str; 39] = [
    "g",
    "o",
    "s",
    "l",
    "p",
    "vp",
    "vw",
    "t",
    "cstype",
    "deg",
    "bmat",
    "step",
    "curv",
    "curv2",
    "surf",
    "parm",
    "trim",
    "hole",
    "scrv",
    "sp",
    "end",
    "con",
    "mg",
    "bevel",
    "c_interp",
    "d_interp",
    "lod",
    "shadow_obj",
    "trace_obj",
    "ctech",
    "stech",
    "usemap",
    "maplib",
    "call",
    "csh",
    "bzp",
    "bsp",
    "cdc",
    "cdp",
];

/// Unknown keywords that are worth a warning each.
const MAX_UNKNOWN: usize = 16;

/// Indices of vertices yet to come that are remembered for checking.
const MAX_FORWARD: usize = 20;

/// What a corner of a face points at.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Attribute {
    Position,
    TextureCoordinate,
    Normal,
}

impl Attribute {
    const ALL: [Self; 3] = [Self::Position, Self::TextureCoordinate, Self::Normal];

    fn name(self) -> &'static str {
        match self {
            Self::Position => "vertex",
            Self::TextureCoordinate => "texture coordinate",
            Self::Normal => "normal",
        }
    }
}

/// Indices of one corner, from 0: position, texture coordinate, normal.
type Corner = [Option<u32>; 3];

/// A reference to something that the file has not defined so far.
struct Forward {
    attribute: Attribute,
    index: u32,
    fault: Fault,
}

/// Reads a model of at most `max_elements` vertices, normals, coordinates and triangles together.
///
/// Errors go to `report`; the model is `None` if there was one. Fails if the file cannot be read.
pub(crate) fn parse(
    mut lines: Lines<'_>,
    max_elements: usize,
    report: &mut Report,
) -> Result<Option<Model>, FileError> {
    let mut parser = Parser::new(max_elements, report);
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

struct Parser<'a> {
    model: Model,
    report: &'a mut Report,
    max_elements: usize,
    /// Whether there was an error, and whether it makes reading on pointless.
    failed: bool,
    stopped: bool,
    material_ids: HashMap<String, usize>,
    unknown: HashSet<String>,
    forward: Vec<Forward>,
    corners: Vec<Corner>,
}

impl<'a> Parser<'a> {
    fn new(max_elements: usize, report: &'a mut Report) -> Self {
        Self {
            model: Model::default(),
            report,
            max_elements,
            failed: false,
            stopped: false,
            material_ids: HashMap::new(),
            unknown: HashSet::new(),
            forward: Vec::new(),
            corners: Vec::new(),
        }
    }

    fn is_done(&self) -> bool {
        self.stopped || self.report.is_full()
    }

    fn error(&mut self, fault: impl FnOnce() -> Fault) {
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
        match keyword {
            "v" => {
                let position = self.numbers::<3>(lines, rest, 3);
                self.model.mesh.positions.push(Vec3::from_array(position));
            }
            "vn" => {
                let normal = self.numbers::<3>(lines, rest, 3);
                self.model.mesh.normals.push(Vec3::from_array(normal));
            }
            "vt" => {
                let coordinates = self.numbers::<2>(lines, rest, 1);
                self.model.mesh.texture_coordinates.push(coordinates);
            }
            "f" | "fo" => self.face(lines, start..rest.end),
            "usemtl" => self.use_material(lines, start..rest.end, text[rest].trim_ascii()),
            "mtllib" => self
                .model
                .libraries
                .push((text[rest.clone()].trim_ascii().to_owned(), lines.fault(start..rest.end, ""))),
            _ if IGNORED.contains(&keyword) => {}
            _ => self.unknown(lines, start..rest.start, keyword),
        }
        self.check_size(lines, start);
    }

    /// At least `least` numbers, at most N; what follows them (weights, vertex colours) is ignored. Zeros after an
    /// error, so that later indices still point at what was meant.
    fn numbers<const N: usize>(&mut self, lines: &Lines<'_>, rest: Range<usize>, least: usize) -> [f32; N] {
        let text = lines.text();
        let mut values = [0.0; N];
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
            match parse_number(&text[span.clone()]) {
                Ok(number) => *value = number,
                Err(error) => {
                    let message = error.message(&text[span.clone()]);
                    self.error(|| lines.fault(span, &message).expected(NUMBER_EXAMPLE));
                    return [0.0; N];
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

    fn unknown(&mut self, lines: &Lines<'_>, span: Range<usize>, keyword: &str) {
        if self.unknown.len() < MAX_UNKNOWN && self.unknown.insert(keyword.to_owned()) {
            let message = format!("unknown keyword `{keyword}`: lines that start with it are ignored");
            self.report.warn(|| lines.fault(span, &message));
        }
    }

    fn face(&mut self, lines: &Lines<'_>, span: Range<usize>) {
        let text = lines.text();
        let mut corners = std::mem::take(&mut self.corners);
        corners.clear();
        let sound = words(text, span.clone()).skip(1).all(|word| match self.corner(lines, word) {
            Some(corner) => {
                corners.push(corner);
                true
            }
            None => false,
        });
        if sound && corners.len() < 3 {
            let message = format!("the face has {} corners", corners.len());
            self.error(|| lines.fault(span, &message).expected("at least 3, such as `f 1 2 3`"));
        } else if sound {
            self.fan(&corners);
        }
        self.corners = corners;
    }

    /// `v`, `v/t`, `v//n` or `v/t/n`.
    fn corner(&mut self, lines: &Lines<'_>, span: Range<usize>) -> Option<Corner> {
        let mut corner = [None; 3];
        let mut start = span.start;
        for (i, part) in lines.text()[span.clone()].split('/').enumerate() {
            let part_span = start..start + part.len();
            start = part_span.end + 1;
            let Some(attribute) = Attribute::ALL.get(i) else {
                self.error(|| lines.fault(part_span, "the corner has too many parts").expected("v/t/n at most"));
                return None;
            };
            if !part.is_empty() || i == 0 {
                corner[i] = Some(self.index(lines, part_span, *attribute)?);
            }
        }
        Some(corner)
    }

    /// An index from 0, from one that counts from 1 or, if negative, back from the latest.
    fn index(&mut self, lines: &Lines<'_>, span: Range<usize>, attribute: Attribute) -> Option<u32> {
        let token = &lines.text()[span.clone()];
        let count = self.count(attribute);
        let index = match token.parse::<i64>() {
            Ok(number) if number > 0 => number - 1,
            Ok(number) if number < 0 && number >= -(count as i64) => number + count as i64,
            Ok(0) => return self.bad_index(lines, span, "index 0: indices count from 1"),
            Ok(_) => {
                let message = format!("{} {token} does not exist: there are {count} so far", attribute.name());
                return self.bad_index(lines, span, &message);
            }
            Err(_) => return self.bad_index(lines, span, &format!("`{token}` is not an index")),
        };
        let Ok(index) = u32::try_from(index) else {
            return self.bad_index(lines, span, &format!("{} {token} does not exist", attribute.name()));
        };
        if index as usize >= count {
            self.remember_forward(lines, span, attribute, index);
        }
        Some(index)
    }

    fn bad_index(&mut self, lines: &Lines<'_>, span: Range<usize>, message: &str) -> Option<u32> {
        self.error(|| lines.fault(span, message).expected("an index such as 1, or -1 for the latest"));
        None
    }

    /// Keeps the first of these and, in the last place, the one that points farthest: if that one is met, all are.
    fn remember_forward(&mut self, lines: &Lines<'_>, span: Range<usize>, attribute: Attribute, index: u32) {
        let mut same = self.forward.iter_mut().filter(|forward| forward.attribute == attribute);
        let count = same.by_ref().count();
        let forward = || Forward { attribute, index, fault: lines.fault(span.clone(), "") };
        if count < MAX_FORWARD {
            self.forward.push(forward());
        } else if let Some(last) = self.forward.iter_mut().rfind(|forward| forward.attribute == attribute)
            && index > last.index
        {
            *last = forward();
        }
    }

    fn count(&self, attribute: Attribute) -> usize {
        let mesh = &self.model.mesh;
        match attribute {
            Attribute::Position => mesh.positions.len(),
            Attribute::TextureCoordinate => mesh.texture_coordinates.len(),
            Attribute::Normal => mesh.normals.len(),
        }
    }

    /// Triangles (0, 1, 2), (0, 2, 3), ...: the order of the thesis' reader, which its results depend on.
    fn fan(&mut self, corners: &[Corner]) {
        let complete = |attribute: usize| corners.iter().all(|corner| corner[attribute].is_some());
        let (textured, smooth) = (complete(1), complete(2));
        let room = self.max_elements.saturating_add(1).saturating_sub(self.elements());
        for pair in corners[1..].windows(2).take(room) {
            let triangle = [corners[0], pair[0], pair[1]];
            let indices = |attribute: usize| triangle.map(|corner| corner[attribute].unwrap_or_default());
            self.model.mesh.triangles.push(MeshTriangle {
                positions: indices(0),
                normals: smooth.then(|| indices(2)),
                texture_coordinates: textured.then(|| indices(1)),
                material: None,
            });
        }
    }

    fn elements(&self) -> usize {
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
        for forward in std::mem::take(&mut self.forward) {
            let count = self.count(forward.attribute);
            if forward.index as usize >= count && !self.stopped {
                let number = forward.index + 1;
                let message = format!("{} {number} does not exist: the file has {count}", forward.attribute.name());
                self.error(|| forward.fault.with_message(&message).expected("an index from 1 to the number of them"));
            }
        }
        (!self.failed).then_some(self.model)
    }
}
