//! Faces on their way from a file to a mesh, whatever the format.

use super::{Cut, Cutter, Outcome};
use crate::Fault;
use crate::report::{Report, Tally, counted};
use lightcuts_scene::MeshDesc;
use std::ops::Range;

/// Cuts the polygons of a model, and counts the faces of which something is to be said.
pub(crate) struct Faces {
    cutter: Cutter,
    /// Fans of polygons some of whose vertices came later than they did.
    late: Vec<Range<usize>>,
    /// Where the first of those is.
    late_place: Option<Box<Fault>>,
    small: Tally,
    broken: Tally,
}

impl Faces {
    pub(crate) fn new(cut: Cut) -> Self {
        Self {
            cutter: Cutter::new(cut),
            late: Vec::new(),
            late_place: None,
            small: Tally::default(),
            broken: Tally::default(),
        }
    }

    /// A face of fewer than 3 corners is none.
    pub(crate) fn skip(&mut self, place: impl FnOnce() -> Fault) {
        self.small.note(place);
    }

    /// A polygon stands in the mesh as a fan of triangles.
    pub(crate) fn add(&mut self, mesh: &mut MeshDesc, fan: Range<usize>, place: impl FnOnce() -> Fault) {
        if fan.len() < 2 || self.cutter.cut == Cut::Fans {
            return;
        }
        let count = mesh.positions.len();
        if mesh.triangles[fan.clone()].iter().any(|t| t.positions.iter().any(|&i| i as usize >= count)) {
            self.late.push(fan);
            self.late_place.get_or_insert_with(|| Box::new(place()));
        } else if self.cutter.recut(mesh, fan) == Outcome::Broken {
            self.broken.note(place);
        }
    }

    /// Cuts what had to wait for its vertices; all indices must point at vertices of the mesh.
    pub(crate) fn cut_late(&mut self, mesh: &mut MeshDesc) {
        for fan in std::mem::take(&mut self.late) {
            if self.cutter.recut(mesh, fan) == Outcome::Broken
                && let Some(place) = &self.late_place
            {
                self.broken.note(|| (**place).clone());
            }
        }
    }

    pub(crate) fn warn(self, report: &mut Report) {
        self.small.warn(report, |count| {
            let verb = if count == 1 { "is" } else { "are" };
            format!("{} of fewer than 3 corners {verb} ignored", counted(count, "face"))
        });
        self.broken.warn(report, |count| {
            let (verb, becomes) =
                if count == 1 { ("crosses itself or has", "becomes") } else { ("cross themselves or have", "become") };
            format!("{} {verb} no area, and {becomes} triangles around the first corner", counted(count, "polygon"))
        });
    }
}
