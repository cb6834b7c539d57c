//! A model: named, shaded parts in materials, written as OBJ and MTL text.

use std::collections::BTreeMap;
use std::fmt::Write as _;

use anyhow::{Context as _, Result};

use super::part::Part;
use super::vector::{Vec3, vec3};

/// An MTL material; colours are red, green, blue.
#[derive(Clone, Copy, Debug)]
pub(super) struct Material {
    pub(super) name: &'static str,
    pub(super) diffuse: [f64; 3],
    pub(super) specular: [f64; 3],
    pub(super) exponent: f64,
}

/// Where a part's vertex normals come from.
#[derive(Clone, Copy, Debug)]
pub(super) enum Shading<'a> {
    /// Faces that meet at less than the angle of this cosine are smoothed into each other.
    Crease(f64),
    /// One normal per position.
    Given(&'a [Vec3]),
}

/// A corner of a polygon: indices of its position and its normal.
type Corner = (usize, usize);

/// What becomes one OBJ file.
#[derive(Debug, Default)]
pub(super) struct Model {
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    normal_index: BTreeMap<[i64; 3], usize>,
    groups: BTreeMap<&'static str, Vec<Vec<Corner>>>,
}

impl Model {
    /// Adds a body in one material.
    pub(super) fn add(&mut self, material: &'static str, part: &Part, shading: Shading) -> Result<()> {
        self.add_by(|_| material, part, shading)
    }

    /// Adds a body whose faces choose their material by their index.
    pub(super) fn add_by(
        &mut self,
        material: impl Fn(usize) -> &'static str,
        part: &Part,
        shading: Shading,
    ) -> Result<()> {
        /// Square units; the thesis' intersection loses triangles of less than about this.
        const LEAST_AREA: f64 = 0.004;
        part.check(LEAST_AREA).with_context(|| format!("a part in {}", material(0)))?;
        let first = self.positions.len();
        self.positions.extend(part.positions.iter().map(|point| point.rounded()));
        let creased = match shading {
            Shading::Crease(cosine) => creased_normals(part, cosine),
            Shading::Given(normals) => {
                part.faces.iter().map(|face| face.iter().map(|&corner| normals[corner]).collect()).collect()
            }
        };
        for (index, (face, normals)) in part.faces.iter().zip(&creased).enumerate() {
            let corners = face.iter().zip(normals).map(|(&at, &normal)| (first + at, self.normal(normal))).collect();
            self.groups.entry(material(index)).or_default().push(corners);
        }
        Ok(())
    }

    /// The index of a normal, shared with those equal to it to four decimals.
    fn normal(&mut self, normal: Vec3) -> usize {
        let key = [normal.x, normal.y, normal.z].map(|value| (value * 1.0e4).round() as i64);
        let normals = &mut self.normals;
        *self.normal_index.entry(key).or_insert_with(|| {
            let [x, y, z] = key.map(|value| value as f64 / 1.0e4);
            normals.push(vec3(x, y, z));
            normals.len() - 1
        })
    }

    /// Triangles after each polygon is cut into a fan.
    pub(super) fn triangle_count(&self) -> usize {
        self.groups.values().flatten().map(|face| face.len() - 2).sum()
    }

    /// The lowest and highest coordinates.
    pub(super) fn bounds(&self) -> (Vec3, Vec3) {
        self.positions.iter().fold((self.positions[0], self.positions[0]), |(low, high), point| {
            (
                vec3(low.x.min(point.x), low.y.min(point.y), low.z.min(point.z)),
                vec3(high.x.max(point.x), high.y.max(point.y), high.z.max(point.z)),
            )
        })
    }

    /// The OBJ text; `title` says what the model is.
    pub(super) fn obj(&self, name: &str, title: &str) -> String {
        let (low, high) = self.bounds();
        let mut text = header(title);
        let mut line = |content: std::fmt::Arguments| writeln!(text, "{content}").expect("a String takes every write");
        line(format_args!("# {} vertices, {} triangles", self.positions.len(), self.triangle_count()));
        line(format_args!("# x {} to {}, y {} to {}, z {} to {}", low.x, high.x, low.y, high.y, low.z, high.z));
        line(format_args!("mtllib {name}.mtl\no {name}"));
        for Vec3 { x, y, z } in &self.positions {
            line(format_args!("v {x:.3} {y:.3} {z:.3}"));
        }
        for Vec3 { x, y, z } in &self.normals {
            line(format_args!("vn {x:.4} {y:.4} {z:.4}"));
        }
        for (material, faces) in &self.groups {
            line(format_args!("g {material}\nusemtl {material}"));
            for face in faces {
                let corners: Vec<_> = face.iter().map(|(at, normal)| format!("{}//{}", at + 1, normal + 1)).collect();
                line(format_args!("f {}", corners.join(" ")));
            }
        }
        text
    }
}

/// The MTL text.
pub(super) fn mtl(title: &str, materials: &[Material]) -> String {
    let colour = |[red, green, blue]: [f64; 3]| format!("{red:.3} {green:.3} {blue:.3}");
    materials.iter().fold(header(title), |text, material| {
        let Material { name, diffuse, specular, exponent } = *material;
        let (diffuse, specular) = (colour(diffuse), colour(specular));
        text + &format!("\nnewmtl {name}\nKa 0.000 0.000 0.000\nKd {diffuse}\nKs {specular}\nNs {exponent}\nillum 2\n")
    })
}

fn header(title: &str) -> String {
    format!("# {title}\n# Generated by `cargo xtask models`; do not edit. Licence: MIT OR Apache-2.0\n")
}

/// For each corner the mean of the face normals, weighted by area, of those faces around it that meet its own face at
/// less than the crease angle.
fn creased_normals(part: &Part, cosine: f64) -> Vec<Vec<Vec3>> {
    let areas: Vec<Vec3> = part.faces.iter().map(|face| area_vector(part, face)).collect();
    let mut around = vec![Vec::new(); part.positions.len()];
    for (index, face) in part.faces.iter().enumerate() {
        for &corner in face {
            around[corner].push(index);
        }
    }
    let smooth = |own: usize, corner: usize| {
        let direction = areas[own].normalised();
        around[corner]
            .iter()
            .filter(|&&other| areas[other].normalised().dot(direction) >= cosine)
            .fold(Vec3::default(), |sum, &other| sum + areas[other])
            .normalised()
    };
    let of_face = |(own, face): (usize, &Vec<usize>)| face.iter().map(|&corner| smooth(own, corner)).collect();
    part.faces.iter().enumerate().map(of_face).collect()
}

/// The normal of a polygon, as long as its area.
fn area_vector(part: &Part, face: &[usize]) -> Vec3 {
    let corner = |index: usize| part.positions[face[index % face.len()]];
    (0..face.len()).fold(Vec3::default(), |sum, index| sum + corner(index).cross(corner(index + 1)) * 0.5)
}
