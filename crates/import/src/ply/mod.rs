//! PLY models (Greg Turk, "The PLY Polygon File Format", 1994): text, and binary of both byte orders.
//!
//! Written here and not taken from a crate, because errors are to name the place, and because a header may claim anything:
//! memory is taken as values arrive, never on its word.

mod header;
mod mesh;
mod values;

use crate::lines::ReadError;
use crate::model::Model;
use crate::polygon::Cut;
use crate::report::Report;
use crate::resolver::FileError;
use header::Header;
use lightcuts_scene::MeshDesc;
use std::io::{BufReader, Read};
use std::path::Path;
use values::Values;

/// A file to be read.
pub(crate) struct PlyFile<'a> {
    pub(crate) reader: Box<dyn Read>,
    pub(crate) path: &'a Path,
    /// For messages.
    pub(crate) name: &'a str,
    /// Largest length in bytes.
    pub(crate) limit: u64,
}

/// Reads a model of at most `room` vertices, normals, texture coordinates and triangles together.
///
/// The first error ends the search and goes to `report`; the model is `None` then. Fails if the file cannot be read.
pub(crate) fn parse(file: PlyFile<'_>, room: usize, cut: Cut, report: &mut Report) -> Result<Option<Model>, FileError> {
    match read(file, room, cut, report) {
        Ok((mesh, origin)) => Ok(Some(Model { mesh, origin, ..Model::default() })),
        Err(ReadError::Content(fault)) => {
            report.error(|| *fault);
            Ok(None)
        }
        Err(ReadError::File(error)) => Err(error),
    }
}

fn read(file: PlyFile<'_>, room: usize, cut: Cut, report: &mut Report) -> Result<(MeshDesc, glam::DVec3), ReadError> {
    let mut reader = BufReader::with_capacity(1 << 16, file.reader);
    let header = Header::read(&mut reader, file.path, file.name, report)?;
    let mut values = Values::new(&header, Box::new(reader), file.path, file.name, file.limit);
    mesh::read(&header, &mut values, room, cut, report)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use std::io::Cursor;

    fn parsed(bytes: &[u8], room: usize) -> Result<MeshDesc, String> {
        let mut report = Report::default();
        let reader = Box::new(Cursor::new(bytes.to_vec()));
        let file = PlyFile { reader, path: Path::new("m.ply"), name: "m.ply", limit: 1 << 20 };
        let model = parse(file, room, Cut::Outlines, &mut report).map_err(|error| error.to_string())?;
        report.finish().map_err(|faults| faults.to_string())?;
        Ok(model.expect("without an error there is a model").mesh)
    }

    const TEXT: &str = "ply\nformat ascii 1.0\ncomment a square\nelement vertex 4\nproperty float x\nproperty float y\n\
                        property double z\nproperty uchar red\nproperty float nx\nproperty float ny\nproperty float nz\n\
                        property float s\nproperty float t\nelement face 1\nproperty list uchar uint vertex_indices\n\
                        end_header\n0 0 0 255 0 0 1 0 0\n1 0 0 255 0 0 1 1 0\n1 1 0 0 0 0 1 1 1\n0 1 0 0 0 0 1 0 1\n\
                        4 0 1 2 3\n";

    /// The same square in binary.
    fn binary(is_big: bool, line_end: &str) -> Vec<u8> {
        let order = if is_big { "big" } else { "little" };
        let (head, body) = TEXT.split_once("end_header\n").expect("it has one");
        let head = format!("{head}end_header\n").replace("ascii", &format!("binary_{order}_endian"));
        let mut bytes = head.replace('\n', line_end).into_bytes();
        for line in body.lines() {
            let numbers: Vec<f64> = line.split(' ').map(|word| word.parse().expect("a number")).collect();
            for (i, &number) in numbers.iter().enumerate() {
                let single = |value: f32| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
                let whole = |value: u32| if is_big { value.to_be_bytes() } else { value.to_le_bytes() };
                let double = if is_big { number.to_be_bytes() } else { number.to_le_bytes() };
                match (numbers.len(), i) {
                    (9, 2) => bytes.extend(double),
                    (9, 3) | (5, 0) => bytes.push(number as u8),
                    (9, _) => bytes.extend(single(number as f32)),
                    _ => bytes.extend(whole(number as u32)),
                }
            }
        }
        bytes
    }

    #[test]
    fn every_encoding_means_the_same_mesh() {
        let mesh = parsed(TEXT.as_bytes(), 100).expect("it is sound");
        assert_eq!(mesh.positions, [Vec3::ZERO, Vec3::X, Vec3::new(1.0, 1.0, 0.0), Vec3::Y]);
        assert_eq!((mesh.normals[3], mesh.texture_coordinates[2]), (Vec3::Z, [1.0, 1.0]));
        let corners: Vec<[u32; 3]> = mesh.triangles.iter().map(|triangle| triangle.positions).collect();
        assert_eq!(corners, [[0, 1, 2], [0, 2, 3]]);
        assert_eq!(mesh.triangles[1].normals, Some([0, 2, 3]));
        assert_eq!(mesh.triangles[1].texture_coordinates, Some([0, 2, 3]));
        for is_big in [false, true] {
            for line_end in ["\n", "\r\n"] {
                assert_eq!(parsed(&binary(is_big, line_end), 100).as_ref(), Ok(&mesh), "{is_big} {line_end:?}");
            }
        }
        assert_eq!(parsed(TEXT.replace('\n', "\r\n").as_bytes(), 100), Ok(mesh));
    }

    #[test]
    fn what_is_not_needed_is_skipped() {
        let text = "ply\nformat ascii 1.0\nobj_info x\nCreated by hand\nelement empty 4000000000\nelement camera 1\nproperty list int float k\n\
                    element face 1\nproperty uchar flag\nproperty list int short vertex_index\nelement vertex 3\n\
                    property int x\nproperty int y\nproperty int z\nend_header\n2 nan inf\n7 3 0 1 2\n0 0 0 1 0 0\n0 1 0\n";
        let mesh = parsed(text.as_bytes(), 100).expect("it is sound");
        assert_eq!((mesh.positions.len(), mesh.triangles.len(), mesh.normals.len()), (3, 1, 0));
        assert_eq!(mesh.triangles[0].normals, None);
    }

    #[test]
    fn broken_headers_are_explained() {
        let cases = [
            ("", "1:1: the first line is not `ply`"),
            ("solid\n", "1:1: the first line is not `ply`"),
            ("ply\n", "2:1: the header has no end; expected `end_header`"),
            ("ply\nend_header\n", "2:1: the format is missing; expected `format ascii 1.0`"),
            ("ply\nformat ascii 2.0\n", "2:1: the format is unknown; expected `format ascii 1.0`"),
            ("ply\nformat xml 1.0\n", "2:1: the format is unknown"),
            (
                "ply\nelement vertex -1\n",
                "2:1: `-1` is not a number of elements; expected a line such as `element vertex 8`",
            ),
            ("ply\nelement vertex\n", "2:1: the number of elements is missing"),
            ("ply\nproperty float x\n", "2:1: a property before the first element"),
            ("ply\nelement a 1\nproperty half x\n", "3:1: `half` is not a type; expected one of char,"),
            (
                "ply\nelement a 1\nproperty list float int x\n",
                "3:1: a list cannot have `float` items in number; expected",
            ),
            ("ply\nelement a 1\nproperty float\n", "3:1: the property has no name"),
            ("ply\nelement a 1\nelement a 2\n", "3:1: the element `a` is given twice"),
            ("ply\nformat ascii 1.0\nend_header\n", "3:1: the model has no vertices; expected an element `vertex`"),
            (
                "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nend_header\n1\n",
                "3:1: the vertices have no `y`",
            ),
            (
                "ply\nformat ascii 1.0\nelement vertex 99999999999\nproperty float x\nproperty float y\nproperty float z\n\
                 end_header\n",
                "3:1: the meshes have more than 100 vertices",
            ),
        ];
        for (text, message) in cases {
            let error = parsed(text.as_bytes(), 100).expect_err(text);
            assert!(error.starts_with(&format!("m.ply:{message}")), "{text:?}: {error}");
        }
        let error = parsed(&[b"ply\ncomment ".to_vec(), vec![b'x'; 5000]].concat(), 100).expect_err("it is long");
        assert!(error.contains("2:1: the line is longer than 4096 bytes"), "{error}");
        let error = parsed(format!("ply\n{}", "comment\n".repeat(20_000)).as_bytes(), 100).expect_err("it is long");
        assert!(error.contains("the header has more than 10000 lines"), "{error}");
    }

    #[test]
    fn broken_values_are_placed() {
        let with = |body: &str| {
            let head = TEXT.split_once("0 0 0 255").expect("it has one").0;
            parsed(format!("{head}{body}").as_bytes(), 100).expect_err(body)
        };
        let vertices = "0 0 0 255 0 0 1 0 0\n1 0 0 255 0 0 1 1 0\n1 1 0 0 0 0 1 1 1\n0 1 0 0 0 0 1 0 1\n";
        let cases = [
            ("", "17:1: the file ends in vertex 1 of 4"),
            ("0 0 0 255 0 0 1 0 0\n1 nan", "18:3: vertex 2 of 4: `nan` is not a number; expected a number such as"),
            ("0 0 1e39 255", "17:5: vertex 1 of 4: `1e39` is too large"),
            ("0 0 x 255", "17:5: vertex 1 of 4: `x` is not a number"),
        ];
        for (body, message) in cases {
            let error = with(body);
            assert!(error.starts_with(&format!("m.ply:{message}")), "{body:?}: {error}");
        }
        let cases = [
            ("4 0 1 2 4", "21:9: face 1 of 1: vertex 4 does not exist; expected an index from 0 to 3"),
            ("4 0 1 2 -1", "21:9: face 1 of 1: vertex -1 does not exist"),
            ("4 0 1.5 2 3", "21:5: face 1 of 1: `1.5` is not a whole number"),
            ("-3 0 1", "21:1: face 1 of 1: a face of -3 corners"),
            ("200 0 1", "21:1: face 1 of 1: the meshes have more than"),
            ("4 0 1", "22:1: the file ends in face 1 of 1"),
        ];
        for (body, message) in cases {
            let error = with(&format!("{vertices}{body}\n"));
            assert!(error.starts_with(&format!("m.ply:{message}")), "{body:?}: {error}");
        }
    }

    #[test]
    fn broken_bytes_are_placed_too() {
        let bytes = binary(false, "\n");
        let start = bytes.len() - 17 - 4 * 37;
        let error = parsed(&bytes[..bytes.len() - 1], 100).expect_err("it is cut");
        assert!(error.contains(&format!("14:1: the file ends in face 1 of 1, at byte {}", bytes.len() - 4)), "{error}");
        let mut nan = bytes.clone();
        nan[start + 37..start + 41].copy_from_slice(&f32::NAN.to_le_bytes());
        let error = parsed(&nan, 100).expect_err("it has a NaN");
        assert!(error.contains(&format!("4:1: vertex 2 of 4, at byte {}: x is NaN", start + 37)), "{error}");
        let mut far = bytes;
        let last = far.len() - 4;
        far[last..].copy_from_slice(&u32::MAX.to_le_bytes());
        let error = parsed(&far, 100).expect_err("there is no such vertex");
        assert!(error.contains(&format!("at byte {last}: vertex 4294967295 does not exist")), "{error}");
    }

    #[test]
    fn no_damage_ends_the_program() {
        for bytes in [TEXT.as_bytes().to_vec(), binary(false, "\n"), binary(true, "\n")] {
            for i in 0..bytes.len() {
                let _ = parsed(&bytes[..i], 100);
                for flip in [0x01, 0x10, 0x80, 0xff] {
                    let mut damaged = bytes.clone();
                    damaged[i] ^= flip;
                    let _ = parsed(&damaged, 100);
                }
            }
        }
    }
}
