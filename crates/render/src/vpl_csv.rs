//! VPL sets as text: a header line, then one VPL a line. Floats are written so that reading gives the same bits.

use glam::Vec3;
use lightcuts_kernel::light::Vpl;
use lightcuts_kernel::ray::normalize_or_zero;
use std::fmt::Write;

const HEADER: &str = "x,y,z,normal_x,normal_y,normal_z,red,green,blue,attenuation";
const FIELDS: usize = 10;

/// Largest magnitude of a number in a file.
const MAX_NUMBER: f32 = 1e9;

/// A VPL file that cannot be used.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("line {line}, column {column}: {message}")]
pub struct VplCsvError {
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What is wrong and what was expected.
    pub message: String,
}

/// Writes VPLs as CSV: position, direction, diffuse colour, attenuation; scene units, linear colours.
pub fn vpls_to_csv(vpls: &[Vpl]) -> String {
    let mut text = format!("{HEADER}\n");
    for vpl in vpls {
        let Vpl { position: p, direction: n, diffuse: d, attenuation, .. } = vpl;
        // Rust prints the shortest decimal that reads back as the same float.
        let values = [p.x, p.y, p.z, n.x, n.y, n.z, d.x, d.y, d.z, *attenuation];
        let fields: Vec<String> = values.iter().map(f32::to_string).collect();
        let _ = writeln!(text, "{}", fields.join(","));
    }
    text
}

/// Reads what [`vpls_to_csv`] wrote. Blank lines and lines that start with `#` are skipped.
pub fn vpls_from_csv(text: &str) -> Result<Vec<Vpl>, VplCsvError> {
    let mut lines = text.lines().enumerate().filter(|(_, l)| !l.trim().is_empty() && !l.starts_with('#'));
    let fail = |line: usize, column: usize, message: String| Err(VplCsvError { line: line + 1, column, message });
    match lines.next() {
        Some((_, header)) if header.trim().trim_start_matches('\u{feff}') == HEADER => {}
        other => return fail(other.map_or(0, |(i, _)| i), 1, format!("expected the header {HEADER}")),
    }
    let mut vpls = Vec::new();
    for (index, line) in lines {
        let mut values = [0.0_f32; FIELDS];
        let mut column = 1;
        let count = line.split(',').count();
        if count != FIELDS {
            return fail(index, 1, format!("found {count} fields; expected {FIELDS}"));
        }
        for (value, field) in values.iter_mut().zip(line.split(',')) {
            match field.trim().parse::<f32>() {
                Ok(number) if number.abs() <= MAX_NUMBER => *value = number,
                _ => {
                    let shown: String = field.chars().take(40).collect();
                    return fail(
                        index,
                        column,
                        format!("found '{shown}'; expected a number of at most {MAX_NUMBER:e} in magnitude"),
                    );
                }
            }
            column += field.chars().count() + 1;
        }
        let [x, y, z, nx, ny, nz, r, g, b, attenuation] = values;
        let direction = Vec3::new(nx, ny, nz);
        // Unit vectors are kept as they are, so that a set survives the round trip bit for bit.
        let is_unit = (direction.length_squared() - 1.0).abs() < 1e-5;
        let direction = if is_unit { direction } else { normalize_or_zero(direction) };
        if direction == Vec3::ZERO {
            return fail(index, 1, "the normal has no length; expected a direction".to_owned());
        }
        if [r, g, b, attenuation].iter().any(|&v| v < 0.0) {
            return fail(index, 1, "found a negative colour or attenuation; expected at least 0".to_owned());
        }
        let (position, diffuse) = (Vec3::new(x, y, z), Vec3::new(r, g, b));
        vpls.push(Vpl { position, direction, diffuse, attenuation, ..Vpl::default() });
    }
    Ok(vpls)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::light_tree::tests::scattered;

    #[test]
    fn a_set_survives_the_round_trip_bit_for_bit() {
        let vpls = scattered(200);
        assert_eq!(vpls_from_csv(&vpls_to_csv(&vpls)).unwrap(), vpls);
        assert_eq!(vpls_from_csv(&vpls_to_csv(&[])).unwrap(), []);
    }

    #[test]
    fn faults_are_placed() {
        let with =
            |line: &str| vpls_from_csv(&format!("{HEADER}\n0,0,0,0,1,0,1,1,1,1\n{line}\n")).unwrap_err().to_string();
        assert_eq!(
            with("0,0,0,0,1,0,1,1,x,1"),
            "line 3, column 17: found 'x'; expected a number of at most 1e9 in magnitude"
        );
        assert!(with("1,2").starts_with("line 3, column 1: found 2 fields"));
        assert!(with("0,0,NaN,0,1,0,1,1,1,1").contains("column 5"));
        assert!(with("0,0,0,0,0,0,1,1,1,1").contains("no length"));
        assert!(with("0,0,0,0,1,0,-1,1,1,1").contains("negative"));
        assert!(vpls_from_csv("").unwrap_err().message.contains("header"));
    }
}
