//! EXR files: writing and reading [`Layers`].

use std::collections::BTreeMap;
use std::fs::{self, File};
use std::io::BufReader;
use std::path::Path;

use miniz_oxide::deflate::compress_to_vec_zlib;
use rayon::prelude::*;

use crate::exr_color::ColorSpace;
use crate::exr_decode::{decode, part_with_beauty};
use crate::exr_header::{encode, read_attributes};
use crate::exr_layout::{Channel, channels_of, layers_of};
use crate::limits::check_writable;
use crate::{ImageError, Layers, PictureLimits, write_atomic};

/// Scan lines per block of ZIP compression.
const BLOCK_ROWS: usize = 16;

/// Level of deflate: the next ones make files 3 % smaller in four times the time, and whoever interrupts a render waits.
const LEVEL: u8 = 1;

/// Writes layers to an EXR file, atomically and without loss (ZIP).
///
/// One part; the beauty is `R`, `G`, `B`, so that every viewer shows it, and AOVs have prefixed names (`albedo.R`,
/// `normal.X`, `depth.Z`, `object_id.ID`), which more programs read than separate parts. All are floats, ids too, for some
/// programs refuse mixed types or take integers for shares of 2^32 - 1; a layer with an id above 2^24, which a float may not
/// hold, is stored as 32-bit integers instead. Attributes are UTF-8 texts.
/// The file's bytes depend on the layers alone: no time stamp, blocks in order on any number of threads.
///
/// Fails with [`ImageError::Encode`] on an empty picture or one above [`MAX_PIXELS`](crate::MAX_PIXELS), and as [`write_atomic`].
pub fn write_exr(path: impl AsRef<Path>, layers: &Layers) -> Result<(), ImageError> {
    let path = path.as_ref();
    write_atomic(path, &encoded(path, layers)?)
}

/// Reads an EXR file: its first part with the channels R, G and B, of halves or floats, as the beauty, and the other
/// channels of that part as layers.
///
/// Reads scan lines and tiles in every compression but HTJ2K; of mip maps the full resolution. Channels that form no
/// kind of [`LayerData`](crate::LayerData) keep their full names (`A` for alpha). The picture is the data window, whatever the
/// display window. Colours of other primaries (the attribute `chromaticities`) become Rec. 709.
///
/// Fails with [`ImageError::Io`], or with [`ImageError::Malformed`] on a damaged file, on one above [`MAX_PIXELS`](crate::MAX_PIXELS) or
/// [`MAX_DECODED_BYTES`](crate::MAX_DECODED_BYTES), on deep and on subsampled pixels. Allocates nothing that the file's
/// length does not justify.
pub fn read_exr(path: impl AsRef<Path>) -> Result<Layers, ImageError> {
    let path = path.as_ref();
    let bytes = fs::read(path).map_err(|source| ImageError::io("read", path, source))?;
    decode_layers(path, &bytes, &PictureLimits::default())
}

/// Decodes the layers in the bytes of a file; see [`read_exr`].
fn decode_layers(path: &Path, bytes: &[u8], limits: &PictureLimits) -> Result<Layers, ImageError> {
    let part = part_with_beauty(path, bytes)?;
    let space = ColorSpace::read(path, bytes, part)?;
    let decoded = decode(path, bytes, part, limits, |_| true)?;
    let attributes =
        read_attributes(&mut &bytes[..], part).map_err(|error| ImageError::malformed(path, error.to_string()))?;
    let mut layers = layers_of(path, decoded.width, decoded.height, decoded.channels)?;
    if let Some(matrix) = &space.matrix {
        layers.convert_colors(matrix);
    }
    Ok(layers.with_attributes(attributes))
}

/// Reads the text attributes of an EXR file's first part, without its pixels.
///
/// Fails with [`ImageError::Io`] or [`ImageError::Malformed`].
pub fn read_exr_attributes(path: impl AsRef<Path>) -> Result<BTreeMap<String, String>, ImageError> {
    let path = path.as_ref();
    let file = File::open(path).map_err(|source| ImageError::io("read", path, source))?;
    read_attributes(&mut BufReader::new(file), 0).map_err(|error| match error.kind() {
        std::io::ErrorKind::InvalidData | std::io::ErrorKind::UnexpectedEof => {
            ImageError::malformed(path, error.to_string())
        }
        _ => ImageError::io("read", path, error),
    })
}

/// The bytes of a file: header, offset table, blocks.
fn encoded(path: &Path, layers: &Layers) -> Result<Vec<u8>, ImageError> {
    let (width, height) = (layers.width(), layers.height());
    check_writable(path, width, height)?;
    let channels = channels_of(layers);
    let blocks = compressed_blocks(width, height, &channels);
    let kinds: Vec<_> = channels.iter().map(|channel| (channel.name.clone(), channel.kind())).collect();
    // The casts hold: `check_writable` bounds both sides.
    let mut bytes = encode(width as i32, height as i32, &kinds, layers.attributes());
    append_blocks(&mut bytes, &blocks);
    Ok(bytes)
}

/// Appends the offset table and the blocks: first row, length, data.
fn append_blocks(bytes: &mut Vec<u8>, blocks: &[(i32, Vec<u8>)]) {
    let mut offset = bytes.len() + 8 * blocks.len();
    for (_, data) in blocks {
        bytes.extend((offset as u64).to_le_bytes());
        offset += 8 + data.len();
    }
    bytes.reserve(offset - bytes.len());
    for (first_row, data) in blocks {
        bytes.extend(first_row.to_le_bytes());
        bytes.extend((data.len() as u32).to_le_bytes());
        bytes.extend(data);
    }
}

/// The blocks from the top: first row and compressed bytes. Compressed in parallel, collected in order.
fn compressed_blocks(width: usize, height: usize, channels: &[Channel<'_>]) -> Vec<(i32, Vec<u8>)> {
    let compress = |first_row: usize| {
        let rows = BLOCK_ROWS.min(height - first_row);
        let mut data = Vec::with_capacity(4 * width * rows * channels.len());
        for y in first_row..first_row + rows {
            for channel in channels {
                channel.append_row(y, &mut data);
            }
        }
        (first_row as i32, zip(&data))
    };
    (0..height.div_ceil(BLOCK_ROWS)).into_par_iter().map(|block| compress(block * BLOCK_ROWS)).collect()
}

/// The bytes of a block as OpenEXR's ZIP has them: every other byte first, then the rest, each as the difference to the one
/// before; as they are where that is no longer.
fn zip(bytes: &[u8]) -> Vec<u8> {
    let mut ordered: Vec<u8> = Vec::with_capacity(bytes.len());
    ordered.extend(bytes.iter().step_by(2));
    ordered.extend(bytes.iter().skip(1).step_by(2));
    for k in (1..ordered.len()).rev() {
        ordered[k] = ordered[k].wrapping_sub(ordered[k - 1]).wrapping_add(128);
    }
    let compressed = compress_to_vec_zlib(&ordered, LEVEL);
    if compressed.len() < bytes.len() { compressed } else { bytes.to_vec() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::Image;

    #[test]
    fn a_file_beyond_the_limits_is_refused_before_it_is_decoded() {
        let bytes = encoded(Path::new("a.exr"), &Layers::new(Image::filled(20, 10, [0.5; 3]))).unwrap();
        let read = |limits| decode_layers(Path::new("a.exr"), &bytes, &limits);
        let any = PictureLimits::default();
        assert!(read(PictureLimits { side: 20, pixels: 200, bytes: 2400 }).is_ok());
        let cases = [
            (PictureLimits { side: 19, ..any }, "at most 19 x 19"),
            (PictureLimits { pixels: 199, ..any }, "more than the limit of 199"),
            (PictureLimits { bytes: 2399, ..any }, "there is room for 2399 only"),
        ];
        for (limits, expected) in cases {
            let error = read(limits).unwrap_err().to_string();
            assert!(error.starts_with("cannot read a.exr: 20 x 10 pixels") && error.contains(expected), "{error}");
        }
    }
}
