//! From the bytes of an EXR file to the samples of its channels.

use std::collections::HashSet;
use std::io::Cursor;
use std::path::Path;

use exr::block::chunk::{Chunk, CompressedBlock};
use exr::block::reader::{ChunksReader as _, Reader};
use exr::block::{BlockIndex, UncompressedBlock};
use exr::meta::header::Header;
use exr::meta::{BlockDescription, MetaData};
use exr::prelude::{Compression, SampleType, f16};
use rayon::prelude::*;

use crate::ImageError;
use crate::exr_header::text;
use crate::exr_layout::{Samples, no_beauty};
use crate::light::guarded;
use crate::limits::{Claim, MAX_EXPANSION, MAX_EXPANSION_DWA};
use crate::{Frame, PictureLimits, Window};

/// Be lenient with what other programs write; sizes are checked here.
const PEDANTIC: bool = false;
/// A tile may be larger than its picture (64 x 64 tiles on an 8 x 8 picture), but not without end.
const MAX_TILE_PIXELS: usize = 1 << 20;
/// Bytes of the offset table per block of pixels.
const OFFSET_BYTES: usize = 8;
/// Numbers at the front of a DWA block: a version, sizes, a mode.
const DWA_COUNTERS: usize = 11;
/// Most that the sizes of a DWA block may be, over those of its pixels: it pads them to 8 x 8, so that a row of one pixel's
/// height takes 8 times its size, in coefficients of twice a half's size at worst.
const DWA_SLACK: usize = 16;
const DWA_MINIMUM: usize = 1 << 16;
/// Blocks that are decompressed in parallel before they are copied: bounds the memory beside the result.
const BLOCKS_AT_ONCE: usize = 64;

/// One part of a file, decoded.
pub(crate) struct Decoded {
    /// Width of the data window in pixels.
    pub(crate) width: usize,
    /// Height of the data window in pixels.
    pub(crate) height: usize,
    /// Both windows.
    pub(crate) frame: Frame,
    /// Full name and samples of each channel that was wanted, in the order of the file.
    pub(crate) channels: Vec<(String, Samples)>,
}

/// The headers of all parts, in the order of the file. Fails with [`ImageError::Malformed`].
pub(crate) fn headers(path: &Path, bytes: &[u8]) -> Result<Vec<Header>, ImageError> {
    guarded(path, || Ok(reader(path, bytes)?.headers().to_vec()))
}

/// The first part that has the channels R, G and B, of halves or floats. Fails with [`ImageError::Malformed`].
pub(crate) fn part_with_beauty(path: &Path, bytes: &[u8]) -> Result<usize, ImageError> {
    headers(path, bytes)?.iter().position(has_beauty).ok_or_else(|| no_beauty(path))
}

/// Decodes the channels with `wanted` names of a part of a file at full resolution; the data window is the picture.
///
/// Allocates nothing that the length of the file does not justify. Fails with [`ImageError::Malformed`].
pub(crate) fn decode(
    path: &Path,
    bytes: &[u8],
    part: usize,
    limits: &PictureLimits,
    wanted: impl Fn(&str) -> bool,
) -> Result<Decoded, ImageError> {
    guarded(path, || {
        let reader = reader(path, bytes)?;
        check_parts(path, reader.headers(), part, bytes.len(), limits)?;
        decode_part(path, reader, part, wanted)
    })
}

fn reader<'a>(path: &Path, bytes: &'a [u8]) -> Result<Reader<Cursor<&'a [u8]>>, ImageError> {
    let malformed = |error: exr::error::Error| ImageError::malformed(path, error.to_string());
    Reader::read_from_buffered(Cursor::new(bytes), PEDANTIC).map_err(malformed)
}

/// The part of a file whose headers were checked.
fn decode_part(
    path: &Path,
    reader: Reader<Cursor<&[u8]>>,
    part: usize,
    wanted: impl Fn(&str) -> bool,
) -> Result<Decoded, ImageError> {
    let malformed = |error: exr::error::Error| ImageError::malformed(path, error.to_string());
    let is_wanted = |block: &BlockIndex| block.layer == part && block.level.0 == 0 && block.level.1 == 0;
    let mut expected = 0;
    let chunks = reader.filter_chunks(PEDANTIC, |_, _, block| {
        expected += usize::from(is_wanted(&block));
        is_wanted(&block)
    });
    let chunks = chunks.map_err(malformed)?;
    let meta = chunks.meta_data().clone();
    let chunks: Vec<Chunk> = chunks.collect::<Result<_, _>>().map_err(malformed)?;
    if is_dwa(&meta.headers[part]) {
        chunks.iter().try_for_each(|chunk| check_dwa_block(path, &meta.headers[chunk.layer_index], chunk))?;
    }
    let header = &meta.headers[part];
    let names = header.channels.list.iter().map(|channel| text(channel.name.as_slice().to_vec()));
    let names: Vec<String> = names.collect();
    let mut samples = blank_samples(header, names.iter().map(|name| wanted(name)));
    decompress(path, &meta, part, chunks, expected, &mut samples)?;

    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let channels = names.into_iter().zip(samples).filter_map(|(name, samples)| Some((name, samples?)));
    Ok(Decoded { width, height, frame: frame(header), channels: channels.collect() })
}

/// Both windows of a part.
fn frame(header: &Header) -> Frame {
    let window = |position: exr::prelude::Vec2<i32>, size: exr::prelude::Vec2<usize>| Window {
        x: position.x(),
        y: position.y(),
        width: size.width(),
        height: size.height(),
    };
    let display = header.shared_attributes.display_window;
    Frame {
        data: window(header.own_attributes.layer_position, header.layer_size),
        display: window(display.position, display.size),
    }
}

fn has_beauty(header: &Header) -> bool {
    let has = |name: &str| {
        header.channels.list.iter().any(|c| c.name.as_slice() == name.as_bytes() && c.sample_type != SampleType::U32)
    };
    ["R", "G", "B"].into_iter().all(has)
}

/// Checks everything that would be allocated for: the picture of part `part`, and the offset tables of all parts.
fn check_parts(
    path: &Path,
    headers: &[Header],
    part: usize,
    file_bytes: usize,
    limits: &PictureLimits,
) -> Result<(), ImageError> {
    let header = &headers[part];
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let bytes_per_pixel = 4 * header.channels.list.len(); // in memory, where halves are floats
    let expansion = if is_dwa(header) { MAX_EXPANSION_DWA } else { MAX_EXPANSION };
    // Halves double in memory, so the file may hold half of what is decoded.
    Claim { width, height, bytes_per_pixel, expansion: 2 * expansion, file_bytes }.check(path, limits)?;

    let blocks = headers.iter().map(|header| header.chunk_count).fold(0, usize::saturating_add);
    if blocks.saturating_mul(OFFSET_BYTES) > file_bytes {
        return Err(ImageError::malformed(path, format!("a file of {file_bytes} bytes cannot hold {blocks} blocks")));
    }
    if let BlockDescription::Tiles(tiles) = header.blocks {
        let tile_pixels = tiles.tile_size.width().saturating_mul(tiles.tile_size.height());
        if tile_pixels > MAX_TILE_PIXELS.max(width * height) {
            return Err(ImageError::malformed(path, format!("tiles of {tile_pixels} pixels")));
        }
    }
    Ok(())
}

fn is_dwa(header: &Header) -> bool {
    matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_))
}

/// Fails where a DWA block says that it is larger than its pixels can need.
fn check_dwa_block(path: &Path, header: &Header, chunk: &Chunk) -> Result<(), ImageError> {
    let malformed = |error: exr::error::Error| ImageError::malformed(path, error.to_string());
    let data = match &chunk.compressed_block {
        CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
        CompressedBlock::Tile(block) => &block.compressed_pixels_le,
        _ => return Err(ImageError::malformed(path, "deep pixels are not supported")),
    };
    let position = header.get_block_data_indices(&chunk.compressed_block).map_err(malformed)?;
    let pixels = header.get_absolute_block_pixel_coordinates(position).map_err(malformed)?.size.area();
    let raw_bytes = pixels.saturating_mul(header.channels.bytes_per_pixel);
    let limit = raw_bytes.saturating_mul(DWA_SLACK).max(DWA_MINIMUM) as u64;
    let mut sizes = data.as_chunks::<8>().0.iter().take(DWA_COUNTERS - 1).skip(1);
    // A block as long as its pixels holds them as they are, without counters.
    if data.len() != raw_bytes && sizes.any(|size| u64::from_le_bytes(*size) > limit) {
        return Err(ImageError::malformed(path, "a DWA block claims to be larger than its pixels"));
    }
    Ok(())
}

/// Fills in the samples of part `part`, channel by channel; `None` is skipped. Each block must come exactly once.
fn decompress(
    path: &Path,
    meta: &MetaData,
    part: usize,
    chunks: Vec<Chunk>,
    expected: usize,
    samples: &mut [Option<Samples>],
) -> Result<(), ImageError> {
    let header = &meta.headers[part];
    let mut seen = HashSet::with_capacity(expected);
    let mut chunks = chunks.into_iter();
    while chunks.len() > 0 {
        let batch: Vec<Chunk> = chunks.by_ref().take(BLOCKS_AT_ONCE).collect();
        let blocks: Vec<_> =
            batch.into_par_iter().map(|chunk| UncompressedBlock::decompress_chunk(chunk, meta, PEDANTIC)).collect();
        for block in blocks {
            let block = block.map_err(|error| ImageError::malformed(path, error.to_string()))?;
            let level = block.index.level;
            if block.index.layer != part || (level.0, level.1) != (0, 0) || !seen.insert(block.index.pixel_position) {
                return Err(ImageError::malformed(path, "the offset table does not match the blocks of pixels"));
            }
            copy_block(header, &block, samples);
        }
    }
    if seen.len() != expected {
        return Err(ImageError::malformed(path, "blocks of pixels are missing"));
    }
    Ok(())
}

/// Per channel of the file, room for its samples if it is wanted.
fn blank_samples(header: &Header, wanted: impl Iterator<Item = bool>) -> Vec<Option<Samples>> {
    let pixels = header.layer_size.area();
    let blank = |kind| match kind {
        SampleType::U32 => Samples::U32(vec![0; pixels]),
        SampleType::F16 | SampleType::F32 => Samples::F32(vec![0.0; pixels]),
    };
    let channels = header.channels.list.iter().zip(wanted);
    channels.map(|(channel, wanted)| wanted.then(|| blank(channel.sample_type))).collect()
}

/// Copies the rows of a block, which come channel by channel, to their places.
fn copy_block(header: &Header, block: &UncompressedBlock, samples: &mut [Option<Samples>]) {
    for line in block.lines(&header.channels) {
        let first = line.location.position.y() * header.layer_size.width() + line.location.position.x();
        let range = first..first + line.location.sample_count;
        let kind = header.channels.list[line.location.channel].sample_type;
        match (&mut samples[line.location.channel], kind) {
            (None, _) => {}
            (Some(Samples::U32(values)), _) => copy_line(&mut values[range], line.value, u32::from_ne_bytes),
            (Some(Samples::F32(values)), SampleType::F16) => {
                copy_line(&mut values[range], line.value, |bytes| f16::from_ne_bytes(bytes).to_f32());
            }
            (Some(Samples::F32(values)), _) => copy_line(&mut values[range], line.value, f32::from_ne_bytes),
        }
    }
}

fn copy_line<T, const BYTES: usize>(values: &mut [T], bytes: &[u8], convert: impl Fn([u8; BYTES]) -> T) {
    for (value, bytes) in values.iter_mut().zip(bytes.as_chunks::<BYTES>().0) {
        *value = convert(*bytes);
    }
}
