//! Texts inside a PNG: `iTXt` chunks, which the `image` crate neither writes nor reads (PNG 1.2, 4.2.3.3).

use crate::ImageError;

/// Bytes of the signature and of the `IHDR` chunk, which must come first.
const SIGNATURE_BYTES: usize = 8;
const HEADER_END: usize = SIGNATURE_BYTES + 12 + 13;
/// Longest keyword, in bytes.
const MAX_KEYWORD_BYTES: usize = 79;

/// Inserts one chunk per text after the header of a PNG.
pub(super) fn insert(png: &mut Vec<u8>, texts: &[(&str, &str)]) -> Result<(), ImageError> {
    let mut chunks = Vec::new();
    for (keyword, text) in texts {
        check_keyword(keyword)?;
        // keyword, NUL, not compressed, method 0, no language, no translated keyword, text
        let data = [keyword.as_bytes(), &[0, 0, 0, 0, 0], text.as_bytes()].concat();
        chunks.extend((data.len() as u32).to_be_bytes());
        let body = [b"iTXt", &data[..]].concat();
        chunks.extend(&body);
        chunks.extend(crc32(&body).to_be_bytes());
    }
    png.splice(HEADER_END..HEADER_END, chunks);
    Ok(())
}

fn check_keyword(keyword: &str) -> Result<(), ImageError> {
    // ASCII is the part of Latin-1 that is the same in UTF-8.
    let is_printable = keyword.bytes().all(|byte| (b' '..=b'~').contains(&byte));
    if (1..=MAX_KEYWORD_BYTES).contains(&keyword.len()) && is_printable && keyword.trim() == keyword {
        return Ok(());
    }
    let reason = "does not have 1 to 79 printable ASCII characters without spaces at its ends";
    Err(ImageError::Name { what: "attribute", name: keyword.to_owned(), reason })
}

/// The text of a keyword, or `None`.
pub(super) fn find(png: &[u8], keyword: &str) -> Option<String> {
    let mut rest = png.get(SIGNATURE_BYTES..)?;
    let start = [keyword.as_bytes(), &[0, 0, 0, 0, 0]].concat();
    loop {
        let length = u32::from_be_bytes(*rest.first_chunk()?) as usize;
        let kind = rest.get(4..8)?;
        let data = rest.get(8..)?.get(..length)?;
        if kind == b"iTXt" && data.starts_with(&start) {
            return String::from_utf8(data[start.len()..].to_vec()).ok();
        }
        rest = rest.get(12 + length..)?;
    }
}

/// CRC-32 with the polynomial of ISO 3309, as PNG asks for (PNG 1.2, annex D).
fn crc32(bytes: &[u8]) -> u32 {
    const TABLE: [u32; 256] = crc_table();
    !bytes.iter().fold(u32::MAX, |crc, byte| TABLE[((crc ^ u32::from(*byte)) & 0xff) as usize] ^ (crc >> 8))
}

const fn crc_table() -> [u32; 256] {
    let mut table = [0; 256];
    let mut index = 0;
    while index < 256 {
        let mut crc = index as u32;
        let mut bit = 0;
        while bit < 8 {
            crc = if crc & 1 == 1 { 0xedb8_8320 ^ (crc >> 1) } else { crc >> 1 };
            bit += 1;
        }
        table[index] = crc;
        index += 1;
    }
    table
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crc_of_the_check_string() {
        assert_eq!(crc32(b"123456789"), 0xcbf4_3926); // the published check value of CRC-32
        assert_eq!(crc32(b"IEND"), 0xae42_6082); // as at the end of every PNG
    }

    #[test]
    fn keywords_are_checked() {
        for keyword in ["", " a", "a ", "a\nb", "ü", &"a".repeat(80)] {
            assert!(insert(&mut vec![0; 64], &[(keyword, "")]).is_err(), "{keyword:?}");
        }
    }

    #[test]
    fn a_damaged_file_has_no_text() {
        assert_eq!(find(b"", "a"), None);
        assert_eq!(find(&[0xff; 100], "a"), None);
    }
}
