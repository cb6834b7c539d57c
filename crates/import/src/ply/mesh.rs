//! From elements to triangles.

use super::header::{Element, Header, Property};
use super::values::{Row, Values};
use crate::anchor::Anchor;
use crate::lines::ReadError;
use crate::model;
use crate::polygon::{Cut, Faces};
use crate::report::Report;
use glam::{DVec3, Vec3};
use lightcuts_scene::{MeshDesc, MeshTriangle};

/// Numbers of a vertex that a mesh has a use for, in this order: position, normal, texture coordinates.
const SLOTS: usize = 8;

/// Names of texture coordinates that occur: of the format's papers, of Blender, of VCG and of pbrt.
const TEXTURE_COORDINATES: [(&str, &str); 4] =
    [("u", "v"), ("s", "t"), ("texture_u", "texture_v"), ("texture_s", "texture_t")];

/// Names of the red channel of colours that occur.
const REDS: [&str; 4] = ["red", "r", "diffuse_red", "diffuse_r"];

/// Reads the body of a file as a mesh, with what its positions are relative to, of at most `room` vertices, normals, texture coordinates and triangles together.
pub(super) fn read(
    header: &Header,
    values: &mut Values<'_>,
    room: usize,
    cut: Cut,
    report: &mut Report,
) -> Result<(MeshDesc, DVec3), ReadError> {
    let Some(vertices) = header.element("vertex") else {
        let fault = header.fault(values.file(), "the model has no vertices");
        return Err(ReadError::Content(Box::new(fault.expected("an element `vertex`"))));
    };
    let layout = Layout::new(vertices, values.file())?;
    let (mesh, faces) = (MeshDesc::default(), Faces::new(cut));
    let anchor = Anchor::new(cut);
    let mut reader = Reader { mesh, anchor, layout, vertices, room, corners: Vec::new(), faces };
    reader.check_counts(header, values)?;
    warn_unused(header, &reader.layout, values.file(), report);
    for element in &header.elements {
        match element.name.as_str() {
            "vertex" => reader.vertices(values)?,
            "face" => reader.faces(element, values)?,
            _ => skip(element, values)?,
        }
    }
    reader.faces.cut_late(&mut reader.mesh);
    reader.faces.warn(report);
    Ok((reader.mesh, reader.anchor.origin()))
}

/// Warns about colours, texture coordinates of faces, and elements that are not used.
fn warn_unused(header: &Header, layout: &Layout, file: &str, report: &mut Report) {
    let has = |element: &Element, names: &[&str]| element.properties.iter().any(|p| names.contains(&p.name.as_str()));
    let is_read = |element: &&Element| matches!(element.name.as_str(), "vertex" | "face");
    let elements = || header.elements.iter().filter(|element| element.count > 0);
    if let Some(colored) = elements().filter(is_read).find(|element| has(element, &REDS)) {
        report.warn(|| colored.fault(file, model::VERTEX_COLORS_UNUSED));
    }
    let faces = elements().find(|element| element.name == "face" && has(element, &["texcoord"]));
    if let Some(faces) = faces.filter(|_| !layout.has_texture_coordinates) {
        let message = "the texture coordinates of faces (`texcoord`) are not supported; those of vertices are";
        report.warn(|| faces.fault(file, message));
    }
    // Scanners leave a `camera` that says nothing about the surface.
    let unused = elements().filter(|e| !is_read(e) && !e.properties.is_empty() && e.name != "camera");
    for element in unused {
        report.warn(|| element.fault(file, &format!("the element `{}` is ignored; only faces are read", element.name)));
    }
}

/// Where the numbers of a vertex go.
struct Layout {
    /// Per property.
    slots: Vec<Option<usize>>,
    has_normals: bool,
    has_texture_coordinates: bool,
}

impl Layout {
    fn new(vertices: &Element, file: &str) -> Result<Self, ReadError> {
        let has = |name: &str| vertices.properties.iter().any(|p| p.name == name && p.count.is_none());
        if let Some(missing) = ["x", "y", "z"].into_iter().find(|name| !has(name)) {
            let fault = vertices.fault(file, &format!("the vertices have no `{missing}`"));
            return Err(ReadError::Content(Box::new(fault.expected("the properties x, y and z"))));
        }
        let mut names = vec!["x", "y", "z"];
        let has_normals = ["nx", "ny", "nz"].into_iter().all(has);
        names.extend(if has_normals { ["nx", "ny", "nz"] } else { [""; 3] });
        let coordinates = TEXTURE_COORDINATES.into_iter().find(|(u, v)| has(u) && has(v));
        names.extend(coordinates.map_or([""; 2], |(u, v)| [u, v]));
        let slot = |property: &Property| {
            let found = names.iter().position(|name| *name == property.name && !name.is_empty());
            found.filter(|_| property.count.is_none())
        };
        let slots = vertices.properties.iter().map(slot).collect();
        Ok(Self { slots, has_normals, has_texture_coordinates: coordinates.is_some() })
    }

    /// What one vertex costs.
    fn elements(&self) -> u64 {
        1 + u64::from(self.has_normals) + u64::from(self.has_texture_coordinates)
    }
}

struct Reader<'h> {
    mesh: MeshDesc,
    anchor: Anchor,
    layout: Layout,
    vertices: &'h Element,
    room: usize,
    /// Of the current face.
    corners: Vec<u32>,
    faces: Faces,
}

impl Reader<'_> {
    /// Refuses what cannot fit before any of it is read.
    fn check_counts(&self, header: &Header, values: &Values<'_>) -> Result<(), ReadError> {
        let vertices = self.vertices.count.saturating_mul(self.layout.elements());
        let faces = header.element("face").map_or(0, |faces| faces.count);
        if vertices.saturating_add(faces) > self.room as u64 || self.vertices.count > u64::from(u32::MAX) {
            let fault = self.vertices.fault(values.file(), &model::too_large(self.room));
            return Err(ReadError::Content(Box::new(fault.expected("a smaller model"))));
        }
        Ok(())
    }

    fn vertices(&mut self, values: &mut Values<'_>) -> Result<(), ReadError> {
        for index in 0..self.vertices.count {
            let row = Row { element: self.vertices, index };
            let mut slots = [0.0; SLOTS];
            for (property, slot) in self.vertices.properties.iter().zip(&self.layout.slots) {
                match slot {
                    Some(slot) => slots[*slot] = values.finite(property.number, &property.name, row)?,
                    None => skip_property(property, values, row)?,
                }
            }
            self.mesh.positions.push(self.anchor.relative(DVec3::new(slots[0], slots[1], slots[2])));
            let [_, _, _, normal_x, normal_y, normal_z, u, v] = slots.map(|value| value as f32);
            if self.layout.has_normals {
                self.mesh.normals.push(Vec3::new(normal_x, normal_y, normal_z));
            }
            if self.layout.has_texture_coordinates {
                self.mesh.texture_coordinates.push([u, v]);
            }
        }
        Ok(())
    }

    fn faces(&mut self, element: &Element, values: &mut Values<'_>) -> Result<(), ReadError> {
        let is_corners = |p: &Property| matches!(p.name.as_str(), "vertex_indices" | "vertex_index");
        if !element.properties.iter().any(|p| is_corners(p) && p.count.is_some()) {
            let fault = element.fault(values.file(), "the faces have no vertices");
            return Err(ReadError::Content(Box::new(fault.expected("a list `vertex_indices`"))));
        }
        for index in 0..element.count {
            let row = Row { element, index };
            for property in &element.properties {
                if is_corners(property) && property.count.is_some() {
                    self.face(property, values, row)?;
                } else {
                    skip_property(property, values, row)?;
                }
            }
        }
        Ok(())
    }

    /// One polygon.
    fn face(&mut self, property: &Property, values: &mut Values<'_>, row: Row<'_>) -> Result<(), ReadError> {
        let count = values.whole(property.count.unwrap_or(property.number), row)?;
        if count < 0 {
            return Err(values.error(row, &format!("a face of {count} corners"), "at least 3"));
        }
        if count < 3 {
            self.faces.skip(|| values.fault(row, ""));
            return (0..count).try_for_each(|_| values.skip(property.number, row));
        }
        let triangles = (count - 2) as usize;
        // All vertices count, even if they come behind the faces.
        let vertices = self.vertices.count.saturating_mul(self.layout.elements()) as usize;
        if vertices.saturating_add(self.mesh.triangles.len()).saturating_add(triangles) > self.room {
            return Err(values.error(row, &model::too_large(self.room), "a smaller model"));
        }
        self.corners.clear();
        for _ in 0..count {
            let corner = values.whole(property.number, row)?;
            let known = u32::try_from(corner).ok().filter(|&corner| u64::from(corner) < self.vertices.count);
            let Some(known) = known else {
                let last = self.vertices.count.saturating_sub(1);
                let message = format!("vertex {corner} does not exist");
                return Err(values.error(row, &message, &format!("an index from 0 to {last}")));
            };
            self.corners.push(known);
        }
        let first = self.mesh.triangles.len();
        for pair in self.corners[1..].windows(2) {
            let positions = [self.corners[0], pair[0], pair[1]];
            self.mesh.triangles.push(MeshTriangle {
                positions,
                normals: self.layout.has_normals.then_some(positions),
                texture_coordinates: self.layout.has_texture_coordinates.then_some(positions),
                material: None,
            });
        }
        let fan = first..self.mesh.triangles.len();
        self.faces.add(&mut self.mesh, fan, || values.fault(row, ""));
        Ok(())
    }
}

/// Skips an element. One without properties has no bytes, however many there are of it.
fn skip(element: &Element, values: &mut Values<'_>) -> Result<(), ReadError> {
    if element.properties.is_empty() {
        return Ok(());
    }
    for index in 0..element.count {
        for property in &element.properties {
            skip_property(property, values, Row { element, index })?;
        }
    }
    Ok(())
}

fn skip_property(property: &Property, values: &mut Values<'_>, row: Row<'_>) -> Result<(), ReadError> {
    let count = match property.count {
        Some(count) => values.whole(count, row)?,
        None => 1,
    };
    for _ in 0..count {
        values.skip(property.number, row)?;
    }
    Ok(())
}
