//! Faces of an OBJ file.

use super::parse::Parser;
use crate::Fault;
use crate::lines::{Lines, words};
use lightcuts_scene::MeshTriangle;
use std::ops::Range;

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
pub(super) type Corner = [Option<u32>; 3];

/// A reference to something that the file has not defined so far.
pub(super) struct Forward {
    attribute: Attribute,
    index: u32,
    fault: Fault,
}

impl Parser<'_> {
    /// The span starts with the keyword.
    pub(super) fn face(&mut self, lines: &Lines<'_>, span: Range<usize>) {
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
            self.faces.skip(|| lines.fault(span, ""));
        } else if sound {
            let first = self.model.mesh.triangles.len();
            self.fan(&corners);
            let fan = first..self.model.mesh.triangles.len();
            self.faces.add(&mut self.model.mesh, fan, || lines.fault(span, ""));
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

    /// Reports what was pointed at and never came.
    pub(super) fn check_forward(&mut self) {
        for forward in std::mem::take(&mut self.forward) {
            let count = self.count(forward.attribute);
            if forward.index as usize >= count && !self.stopped {
                let number = forward.index + 1;
                let message = format!("{} {number} does not exist: the file has {count}", forward.attribute.name());
                self.error(|| forward.fault.with_message(&message).expected("an index from 1 to the number of them"));
            }
        }
    }
}
