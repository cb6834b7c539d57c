//! What an EXR file says of its colours: the attributes `chromaticities` and `colorInteropID`.

use std::path::Path;

use crate::ImageError;
use crate::exr_header::{Record, part_records, text};
use crate::primaries::{Matrix, Primaries};

/// Starts of the identifiers of linear light and of numbers that are no colours ("Color Space Encodings for Texture Assets and
/// CG Rendering", Color Interop Forum).
const LINEAR: &str = "lin_";
const DATA: &str = "data";
/// The linear spaces of that list that are not Rec. 709, without their endings `_scene` and `_display`.
const LINEAR_SPACES: [(&str, [f64; 8]); 5] = [
    ("lin_ap0", [0.7347, 0.2653, 0.0, 1.0, 0.0001, -0.077, 0.32168, 0.33767]),
    ("lin_ap1", [0.713, 0.293, 0.165, 0.830, 0.128, 0.044, 0.32168, 0.33767]),
    ("lin_rec2020", [0.708, 0.292, 0.170, 0.797, 0.131, 0.046, 0.3127, 0.3290]),
    ("lin_p3d65", [0.680, 0.320, 0.265, 0.690, 0.150, 0.060, 0.3127, 0.3290]),
    ("lin_adobergb", [0.640, 0.330, 0.210, 0.710, 0.150, 0.060, 0.3127, 0.3290]),
];
const REC_709: &str = "lin_rec709";
/// Longest text that a remark quotes.
const MAX_QUOTED: usize = 60;
/// Pixel aspect ratios nearer to 1 are square.
const ASPECT_TOLERANCE: f32 = 1e-3;

/// What is known of a part's colours.
#[derive(Debug)]
pub(crate) struct ColorSpace {
    /// To linear Rec. 709; `None` where they are that already.
    pub(crate) matrix: Option<Matrix>,
    /// What to say where colours are read.
    of_colors: Vec<String>,
    /// What to say in any case.
    of_all: Vec<String>,
}

impl ColorSpace {
    /// Of a part of a file. Fails with [`ImageError::Malformed`] where the attributes hold what cannot be.
    pub(crate) fn read(path: &Path, bytes: &[u8], part: usize) -> Result<Self, ImageError> {
        let malformed = |reason: String| ImageError::malformed(path, reason);
        let records = |part| part_records(&mut &bytes[..], part).map_err(|error| malformed(error.to_string()));
        let own = records(part)?;
        // All parts of a file share their chromaticities; some writers store them in the first alone.
        let first = if part == 0 { Vec::new() } else { records(0)? };
        let find = |name: &str| own.iter().chain(&first).find(|record| record.name == name.as_bytes());
        let chromaticities = find("chromaticities").map(chromaticities).transpose().map_err(malformed)?;
        let id = find("colorInteropID").filter(|record| record.kind == b"string");
        let id = id.map(|record| text(record.value.clone()).trim_end_matches('\0').to_owned());
        let mut space = Self { matrix: None, of_colors: Vec::new(), of_all: Vec::new() };
        if let Some(id) = &id {
            space.of_colors.extend(id_remark(id));
        }
        let named = || id.as_deref().and_then(linear_space).map(|primaries| ("colorInteropID", primaries));
        let primaries = chromaticities.map(|primaries| ("chromaticities", primaries)).or_else(named);
        if let Some((attribute, primaries)) = primaries {
            space.take(attribute, primaries).map_err(malformed)?;
        }
        space.of_all.extend(find("pixelAspectRatio").and_then(aspect_remark));
        Ok(space)
    }

    /// What a user must know of a picture of colours, or of one of other numbers.
    pub(crate) fn remarks(&self, is_color: bool, is_data: bool) -> Vec<String> {
        let of_colors = self.of_colors.iter().filter(|_| is_color && !is_data);
        of_colors.chain(&self.of_all).cloned().collect()
    }

    fn take(&mut self, attribute: &str, primaries: Primaries) -> Result<(), String> {
        let matrix = primaries.to_rec_709();
        let matrix = matrix.ok_or_else(|| format!("its {attribute} ({primaries}) span no space of colours"))?;
        if !primaries.is_near(&Primaries::REC_709) {
            self.matrix = Some(matrix);
            self.of_colors.push(format!(
                "its colours were converted from its {attribute} ({primaries}) to Rec. 709, white adapted (Bradford)"
            ));
        }
        Ok(())
    }
}

fn chromaticities(record: &Record) -> Result<Primaries, String> {
    let values = record.value.as_chunks::<4>().0;
    match <[[u8; 4]; 8]>::try_from(values) {
        Ok(values) if record.kind == b"chromaticities" && record.value.len() == 32 => {
            Ok(Primaries::new(values.map(|bytes| f64::from(f32::from_le_bytes(bytes)))))
        }
        _ => Err("its attribute chromaticities does not hold eight numbers".to_owned()),
    }
}

/// The primaries of a linear space by its identifier, unless they are Rec. 709.
fn linear_space(id: &str) -> Option<Primaries> {
    let name = id.trim_end_matches("_scene").trim_end_matches("_display");
    LINEAR_SPACES.iter().find(|(known, _)| *known == name).map(|(_, numbers)| Primaries::new(*numbers))
}

/// Programs store pictures that were made for a display as EXR too, with or without undoing their transfer, so the identifier
/// alone does not tell what the numbers are.
fn id_remark(id: &str) -> Option<String> {
    let quoted: String = id.chars().take(MAX_QUOTED).collect();
    let quoted = quoted.escape_debug();
    if id.starts_with(DATA) || id.starts_with(REC_709) || linear_space(id).is_some() {
        return None;
    }
    Some(if id.starts_with(LINEAR) {
        format!(
            "its colorInteropID is \"{quoted}\", which is not known; its numbers are taken as linear, Rec. 709 unless it has chromaticities"
        )
    } else {
        format!(
            "its colorInteropID is \"{quoted}\", not of linear light; its numbers are taken as linear light all the same"
        )
    })
}

fn aspect_remark(record: &Record) -> Option<String> {
    let aspect = f32::from_le_bytes(record.value.as_slice().try_into().ok()?);
    let told =
        || format!("its pixels are {aspect} times as wide as high (pixelAspectRatio); they are taken as squares");
    let is_square = (aspect - 1.0).abs() <= ASPECT_TOLERANCE;
    (!is_square).then(told)
}
