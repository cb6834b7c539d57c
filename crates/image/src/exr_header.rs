//! The attributes at the front of an EXR file, as records of name, type and bytes.
//!
//! Written here and not by the `exr` crate: that crate keeps custom attributes in a `HashMap` whose order changes with
//! every run, and the same render must give the same bytes. The layout is in "OpenEXR File Layout", openexr.com.

use std::collections::BTreeMap;
use std::io::{self, BufRead, Read};

/// Magic number of the format.
const MAGIC: [u8; 4] = [0x76, 0x2f, 0x31, 0x01];
/// Version 2 of the format, without flags: one part, scan lines.
const VERSION: u32 = 2;
/// Flag in the version field: some name has more than 31 bytes.
const LONG_NAMES: u32 = 1 << 10;
/// Flag in the version field: the file has several parts.
const MULTI_PART: u32 = 1 << 12;
/// Longest name without the flag, and with it.
const SHORT_NAME_BYTES: usize = 31;
const LONG_NAME_BYTES: usize = 255;

/// Names that mean something to a reader of the format, so that a text attribute must not take them.
pub(crate) const RESERVED_ATTRIBUTES: [&str; 15] = [
    "channels",
    "chromaticities",
    "chunkCount",
    "compression",
    "dataWindow",
    "displayWindow",
    "lineOrder",
    "maxSamplesPerPixel",
    "name",
    "pixelAspectRatio",
    "screenWindowCenter",
    "screenWindowWidth",
    "tiles",
    "type",
    "version",
];

/// The type of a channel's samples, with its code in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum SampleKind {
    /// 32-bit unsigned integers.
    U32 = 0,
    /// 32-bit floats.
    F32 = 2,
}

/// One attribute: name, type name, value.
pub(crate) struct Record {
    pub(crate) name: Vec<u8>,
    pub(crate) kind: Vec<u8>,
    pub(crate) value: Vec<u8>,
}

/// The bytes of a file from its start to its offset table: one part, scan lines from the top, ZIP in blocks of 16.
///
/// `channels` must be sorted by name. Attributes are sorted by name, so that the bytes depend on nothing else.
pub(crate) fn encode(
    width: i32,
    height: i32,
    channels: &[(String, SampleKind)],
    attributes: &BTreeMap<String, String>,
) -> Vec<u8> {
    let mut records = format_records(width, height, channels);
    records.extend(attributes.iter().map(|(name, value)| record(name, "string", value.as_bytes())));
    records.sort_by(|a, b| a.name.cmp(&b.name));

    let names = records.iter().map(|record| record.name.len()).chain(channels.iter().map(|(name, _)| name.len()));
    let flags = if names.max() > Some(SHORT_NAME_BYTES) { LONG_NAMES } else { 0 };

    let mut bytes = MAGIC.to_vec();
    bytes.extend((VERSION | flags).to_le_bytes());
    for record in &records {
        bytes.extend([&record.name[..], &[0], &record.kind, &[0]].concat());
        bytes.extend((record.value.len() as u32).to_le_bytes());
        bytes.extend(&record.value);
    }
    bytes.push(0);
    bytes
}

/// The attributes that every file must have.
fn format_records(width: i32, height: i32, channels: &[(String, SampleKind)]) -> Vec<Record> {
    let window = [0, 0, width - 1, height - 1].map(i32::to_le_bytes).concat();
    vec![
        record("channels", "chlist", &channel_list(channels)),
        record("compression", "compression", &[3]), // ZIP, 16 scan lines per block
        record("dataWindow", "box2i", &window),
        record("displayWindow", "box2i", &window),
        record("lineOrder", "lineOrder", &[0]), // increasing y
        record("pixelAspectRatio", "float", &1_f32.to_le_bytes()),
        record("screenWindowCenter", "v2f", &[0; 8]),
        record("screenWindowWidth", "float", &1_f32.to_le_bytes()),
    ]
}

fn record(name: &str, kind: &str, value: &[u8]) -> Record {
    Record { name: name.into(), kind: kind.into(), value: value.into() }
}

/// Per channel: name, sample type, "perceptually linear" with 3 reserved bytes, sampling in x and in y.
fn channel_list(channels: &[(String, SampleKind)]) -> Vec<u8> {
    let mut bytes = Vec::new();
    for (name, kind) in channels {
        bytes.extend(name.as_bytes());
        bytes.push(0);
        bytes.extend([*kind as i32, 0, 1, 1].map(i32::to_le_bytes).concat());
    }
    bytes.push(0);
    bytes
}

/// The text attributes of part `part` of a file, by name; text that is not UTF-8 is taken as Latin-1.
///
/// Reads no further than that part's header and allocates no more than the bytes that are there. Fails with
/// `InvalidData` or `UnexpectedEof` on a malformed header.
pub(crate) fn read_attributes(read: &mut impl BufRead, part: usize) -> io::Result<BTreeMap<String, String>> {
    let records = part_records(read, part)?.into_iter();
    let is_text = |record: &Record| record.kind == b"string" && record.name != b"name" && record.name != b"type";
    Ok(records.filter(is_text).map(|record| (text(record.name), text(record.value))).collect())
}

/// All attributes of part `part` of a file; see [`read_attributes`].
pub(crate) fn part_records(read: &mut impl BufRead, part: usize) -> io::Result<Vec<Record>> {
    let mut start = [0; 8];
    read.read_exact(&mut start)?;
    if start[..4] != MAGIC {
        return Err(invalid("not an EXR file"));
    }
    let is_multi_part = start[5] & (MULTI_PART >> 8) as u8 != 0;
    if part > 0 && !is_multi_part {
        return Err(invalid("no such part"));
    }
    for _ in 0..part {
        read_records(read)?;
    }
    read_records(read)
}

/// The records of one part, up to and with the zero byte that ends them.
fn read_records(read: &mut impl BufRead) -> io::Result<Vec<Record>> {
    let mut records = Vec::new();
    loop {
        let name = read_name(read)?;
        if name.is_empty() {
            return Ok(records);
        }
        let kind = read_name(read)?;
        let mut length = [0; 4];
        read.read_exact(&mut length)?;
        let length = u64::try_from(i32::from_le_bytes(length)).map_err(|_| invalid("an attribute of negative size"))?;
        // `take` and not a buffer of `length` bytes: the length is only a claim until the bytes are there.
        let mut value = Vec::new();
        if read.by_ref().take(length).read_to_end(&mut value)? as u64 != length {
            return Err(io::ErrorKind::UnexpectedEof.into());
        }
        records.push(Record { name, kind, value });
    }
}

/// Text up to a zero byte, without that byte.
fn read_name(read: &mut impl BufRead) -> io::Result<Vec<u8>> {
    let mut name = Vec::new();
    read.by_ref().take(LONG_NAME_BYTES as u64 + 1).read_until(0, &mut name)?;
    match name.pop() {
        Some(0) => Ok(name),
        Some(_) if name.len() == LONG_NAME_BYTES => Err(invalid("an attribute name of more than 255 bytes")),
        _ => Err(io::ErrorKind::UnexpectedEof.into()),
    }
}

/// Text of a file: UTF-8, or else Latin-1, which is what older programs wrote.
pub(crate) fn text(bytes: Vec<u8>) -> String {
    String::from_utf8(bytes).unwrap_or_else(|error| error.into_bytes().into_iter().map(char::from).collect())
}

fn invalid(reason: &str) -> io::Error {
    io::Error::new(io::ErrorKind::InvalidData, reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn header(attributes: &[(&str, &str)]) -> Vec<u8> {
        let attributes = attributes.iter().map(|(name, value)| (name.to_string(), value.to_string())).collect();
        encode(4, 3, &[("R".to_owned(), SampleKind::F32)], &attributes)
    }

    #[test]
    fn attributes_come_back() {
        let bytes = header(&[("zebra", "Grüße\nan alle\n"), ("comments", "")]);
        let attributes = read_attributes(&mut &bytes[..], 0).unwrap();
        assert_eq!(attributes.len(), 2);
        assert_eq!(attributes["zebra"], "Grüße\nan alle\n");
        assert_eq!(attributes["comments"], "");
    }

    #[test]
    fn every_truncation_is_an_error() {
        let bytes = header(&[("a", "b")]);
        for length in 0..bytes.len() {
            assert!(read_attributes(&mut &bytes[..length], 0).is_err(), "{length}");
        }
        assert!(read_attributes(&mut &bytes[..], 1).is_err());
    }

    #[test]
    fn only_long_names_set_the_flag() {
        assert_eq!(header(&[("short", "")])[4..8], [2, 0, 0, 0]);
        assert_eq!(header(&[(&"long".repeat(8), "")])[4..8], [2, 4, 0, 0]);
    }

    #[test]
    fn text_that_is_not_utf8_is_latin_1() {
        assert_eq!(text(vec![b'G', 0xfc]), "Gü");
    }
}
