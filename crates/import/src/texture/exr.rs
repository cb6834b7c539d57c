//! OpenEXR pictures: the first part in colours, else the first in grey; the data window is the picture.

use super::light::{Claim, light, malformed};
use super::{Bounds, Decoded, TextureError};
use ::exr::block::UncompressedBlock;
use ::exr::block::chunk::{Chunk, CompressedBlock};
use ::exr::block::reader::{ChunksReader as _, Reader};
use ::exr::meta::BlockDescription;
use ::exr::meta::header::Header;
use ::exr::prelude::{Compression, SampleType, f16};
use std::collections::HashSet;
use std::io::Cursor;

const SIGNATURE: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// Be lenient with what other programs write; whatever could hurt is checked here.
const PEDANTIC: bool = false;
/// Greatest expansion of deflate, 1032:1 (RFC 1951), with room for PXR24, which drops a quarter of the bytes first.
const MAX_EXPANSION: usize = 2048;
/// DWA compresses run lengths by deflate, so that its bound is a product; this one admits an all-black file.
const MAX_EXPANSION_DWA: usize = 1 << 17;
/// A tile may be larger than its picture (64 x 64 tiles on an 8 x 8 picture), but not without end.
const MAX_TILE_TEXELS: usize = 1 << 20;
/// Bytes of the offset table per block.
const OFFSET_BYTES: usize = 8;
/// A DWA block starts with eleven counters; the first is a version and the last a mode, the others are sizes.
const DWA_COUNTERS: usize = 11;
/// Room for a DWA block beyond its texels: it pads them to 8 x 8, in coefficients of twice a half's size at worst.
const DWA_SLACK: usize = 16;
const DWA_MINIMUM: usize = 1 << 16;

pub(super) fn is_exr(bytes: &[u8]) -> bool {
    bytes.starts_with(&SIGNATURE)
}

/// The colours, or grey as three equal channels; alpha and everything else is left out.
pub(super) fn decode(bytes: &[u8], bounds: Bounds) -> Result<Decoded, TextureError> {
    let reader = Reader::read_from_buffered(Cursor::new(bytes), PEDANTIC).map_err(damaged)?;
    let (part, targets) = find_colours(reader.headers())?;
    let (width, height) = check(reader.headers(), part, bytes.len(), bounds)?;
    let mut expected = 0;
    let chunks = reader.filter_chunks(PEDANTIC, |_, _, block| {
        let is_wanted = block.layer == part && (block.level.0, block.level.1) == (0, 0);
        expected += usize::from(is_wanted);
        is_wanted
    });
    let chunks = chunks.map_err(damaged)?;
    let meta = chunks.meta_data().clone();
    let header = &meta.headers[part];
    let mut texels = vec![[0.0; 3]; header.layer_size.area()];
    let mut seen = HashSet::new();
    for chunk in chunks {
        let chunk = chunk.map_err(damaged)?;
        check_dwa_block(header, &chunk)?;
        let block = UncompressedBlock::decompress_chunk(chunk, &meta, PEDANTIC).map_err(damaged)?;
        let level = block.index.level;
        if block.index.layer != part || (level.0, level.1) != (0, 0) || !seen.insert(block.index.pixel_position) {
            return Err(malformed("the offset table does not match the blocks"));
        }
        copy_block(header, &block, &targets, &mut texels);
    }
    if seen.len() != expected {
        return Err(malformed("blocks are missing"));
    }
    Ok(light(width, height, texels))
}

#[allow(clippy::needless_pass_by_value, reason = "the shape that map_err wants")]
fn damaged(error: ::exr::error::Error) -> TextureError {
    malformed(error.to_string())
}

/// The part to read, and for each of its channels the components that it fills.
fn find_colours(headers: &[Header]) -> Result<(usize, Vec<&'static [usize]>), TextureError> {
    let has = |header: &Header, name: &str| header.channels.list.iter().any(|c| c.name.as_slice() == name.as_bytes());
    let colours = headers.iter().position(|header| ["R", "G", "B"].iter().all(|name| has(header, name)));
    // A `Y` beside others is part of a vector, or the luminance of a picture with chroma.
    let is_grey = |header: &Header| has(header, "Y") && !["X", "RY", "BY"].iter().any(|name| has(header, name));
    let names: &[(&[u8], &[usize])] =
        if colours.is_some() { &[(b"R", &[0]), (b"G", &[1]), (b"B", &[2])] } else { &[(b"Y", &[0, 1, 2])] };
    let part = colours.or_else(|| headers.iter().position(is_grey));
    let part = part.ok_or_else(|| malformed("it has neither the channels R, G and B nor Y alone"))?;
    let target = |name: &[u8]| names.iter().find(|(known, _)| *known == name).map_or(&[][..], |(_, target)| target);
    Ok((part, headers[part].channels.list.iter().map(|channel| target(channel.name.as_slice())).collect()))
}

/// Checks everything that would be allocated for: the picture of part `part`, and the offset tables of all parts.
fn check(headers: &[Header], part: usize, file_bytes: usize, bounds: Bounds) -> Result<(u32, u32), TextureError> {
    let header = &headers[part];
    let (width, height) = (header.layer_size.width(), header.layer_size.height());
    let bytes_per_texel = 4 * header.channels.list.len();
    // Halves double in memory, so the file may hold half of what is decoded.
    let expansion = 2 * if is_dwa(header) { MAX_EXPANSION_DWA } else { MAX_EXPANSION };
    let size = Claim { width, height, bytes_per_texel, expansion, file_bytes }.check(bounds)?;
    let blocks = headers.iter().map(|header| header.chunk_count).fold(0, usize::saturating_add);
    if blocks.saturating_mul(OFFSET_BYTES) > file_bytes {
        return Err(malformed(format!("a file of {file_bytes} bytes cannot hold {blocks} blocks")));
    }
    if let BlockDescription::Tiles(tiles) = header.blocks {
        let tile = tiles.tile_size.width().saturating_mul(tiles.tile_size.height());
        if tile > MAX_TILE_TEXELS.max(width * height) {
            return Err(malformed(format!("tiles of {tile} texels")));
        }
    }
    Ok(size)
}

fn is_dwa(header: &Header) -> bool {
    matches!(header.compression, Compression::DWAA(_) | Compression::DWAB(_))
}

/// Fails where a DWA block's counters exceed what its texels can need: the decoder allocates what they say.
fn check_dwa_block(header: &Header, chunk: &Chunk) -> Result<(), TextureError> {
    if !is_dwa(header) {
        return Ok(());
    }
    let data = match &chunk.compressed_block {
        CompressedBlock::ScanLine(block) => &block.compressed_pixels_le,
        CompressedBlock::Tile(block) => &block.compressed_pixels_le,
        _ => return Err(malformed("deep pixels are not supported")),
    };
    let position = header.get_block_data_indices(&chunk.compressed_block).map_err(damaged)?;
    let texels = header.get_absolute_block_pixel_coordinates(position).map_err(damaged)?.size.area();
    let raw_bytes = texels.saturating_mul(header.channels.bytes_per_pixel);
    let limit = raw_bytes.saturating_mul(DWA_SLACK).max(DWA_MINIMUM) as u64;
    let mut sizes = data.as_chunks::<8>().0.iter().take(DWA_COUNTERS - 1).skip(1);
    // A block as long as its texels holds them as they are, without counters.
    if data.len() != raw_bytes && sizes.any(|size| u64::from_le_bytes(*size) > limit) {
        return Err(malformed("a DWA block claims to be larger than its texels"));
    }
    Ok(())
}

/// Copies the rows of a block, which come channel by channel, to their places.
fn copy_block(header: &Header, block: &UncompressedBlock, targets: &[&[usize]], texels: &mut [[f32; 3]]) {
    for line in block.lines(&header.channels) {
        let first = line.location.position.y() * header.layer_size.width() + line.location.position.x();
        let row = &mut texels[first..first + line.location.sample_count];
        let target = targets[line.location.channel];
        match header.channels.list[line.location.channel].sample_type {
            SampleType::F16 => copy_line(row, target, line.value, |bytes| f16::from_ne_bytes(bytes).to_f32()),
            SampleType::F32 => copy_line(row, target, line.value, f32::from_ne_bytes),
            SampleType::U32 => copy_line(row, target, line.value, |bytes| u32::from_ne_bytes(bytes) as f32),
        }
    }
}

fn copy_line<const N: usize>(row: &mut [[f32; 3]], target: &[usize], bytes: &[u8], convert: impl Fn([u8; N]) -> f32) {
    for (texel, bytes) in row.iter_mut().zip(bytes.as_chunks().0) {
        let value = convert(*bytes);
        for &component in target {
            texel[component] = value;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::super::Texels;
    use super::super::light::{bounds, decode};
    use ::exr::prelude::*;
    use std::io::Cursor;

    fn encoded(compression: Compression, is_grey: bool) -> Vec<u8> {
        let value = |at: Vec2<usize>, channel: usize| (at.0 + 10 * at.1 + channel) as f32 * 0.25;
        let encoding = Encoding { compression, ..Encoding::SMALL_LOSSLESS };
        let attributes = LayerAttributes::named("a");
        let mut bytes = Cursor::new(Vec::new());
        let written = if is_grey {
            let samples = (0..6).map(|i| value(Vec2(i % 3, i / 3), 0)).collect();
            let grey = AnyChannel::new("Y", FlatSamples::F32(samples));
            Image::from_layer(Layer::new((3, 2), attributes, encoding, AnyChannels::sort([grey].into_iter().collect())))
                .write()
                .non_parallel()
                .to_buffered(&mut bytes)
        } else {
            let pixels = SpecificChannels::rgba(|at: Vec2<usize>| {
                (f16::from_f32(value(at, 0)), value(at, 1), f16::from_f32(value(at, 2)), 0.5_f32)
            });
            Image::from_layer(Layer::new((3, 2), attributes, encoding, pixels))
                .write()
                .non_parallel()
                .to_buffered(&mut bytes)
        };
        written.expect("an image in memory can be encoded");
        bytes.into_inner()
    }

    #[test]
    fn colours_and_grey_are_read_in_every_type() {
        for compression in [Compression::Uncompressed, Compression::ZIP16, Compression::PIZ] {
            let decoded = decode(&encoded(compression, false), bounds()).expect("it is EXR").expect("it is sound");
            assert_eq!((decoded.width, decoded.height), (3, 2));
            let Texels::Light(texels) = decoded.texels else { panic!("EXR holds light") };
            assert_eq!((texels[0], texels[4]), ([0.0, 0.25, 0.5], [2.75, 3.0, 3.25]));
        }
        let decoded = decode(&encoded(Compression::RLE, true), bounds()).expect("it is EXR").expect("it is sound");
        let Texels::Light(texels) = decoded.texels else { panic!("EXR holds light") };
        assert_eq!(texels[5], [3.0; 3]);
    }

    #[test]
    fn no_damage_ends_the_program() {
        let bytes = encoded(Compression::ZIP16, false);
        for i in 4..bytes.len() {
            let _ = decode(&bytes[..i], bounds());
            for flip in [0x01, 0x80, 0xff] {
                let mut damaged = bytes.clone();
                damaged[i] ^= flip;
                let _ = decode(&damaged, bounds());
            }
        }
    }
}
