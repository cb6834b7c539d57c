//! SHA-256 over named fields.

use lightcuts::image::Image;
use sha2::{Digest, Sha256};
use std::fmt::Write;
use std::io;
use std::path::Path;

/// A hash on its way. Names and lengths are part of it, so that no two lists of fields are the same bytes.
pub(crate) struct Fields(Sha256);

impl Fields {
    /// For one purpose.
    pub(crate) fn of(purpose: &str) -> Self {
        Self(Sha256::new()).with("purpose", purpose)
    }

    /// With one more field.
    #[must_use]
    pub(crate) fn with(mut self, name: &str, value: impl AsRef<[u8]>) -> Self {
        for bytes in [name.as_bytes(), value.as_ref()] {
            self.0.update((bytes.len() as u64).to_le_bytes());
            self.0.update(bytes);
        }
        self
    }

    /// 64 hexadecimal digits.
    pub(crate) fn finish(self) -> String {
        digits(self.0)
    }
}

/// Of a file's content.
pub(crate) fn of_file(path: &Path) -> io::Result<String> {
    let mut hash = Sha256::new();
    io::copy(&mut std::fs::File::open(path)?, &mut HashWriter(&mut hash))?;
    Ok(digits(hash))
}

/// Of a picture: width, height, and every value from the top left as little-endian f32.
pub(crate) fn of_picture(image: &Image) -> String {
    let mut hash = Sha256::new();
    for side in [image.width(), image.height()] {
        hash.update((side as u64).to_le_bytes());
    }
    for row in image.rows() {
        let bytes: Vec<u8> = row.iter().flatten().flat_map(|value| value.to_le_bytes()).collect();
        hash.update(bytes);
    }
    digits(hash)
}

struct HashWriter<'h>(&'h mut Sha256);

impl io::Write for HashWriter<'_> {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        self.0.update(bytes);
        Ok(bytes.len())
    }

    fn flush(&mut self) -> io::Result<()> {
        Ok(())
    }
}

fn digits(hash: Sha256) -> String {
    hash.finalize().iter().fold(String::with_capacity(64), |mut text, byte| {
        let _ = write!(text, "{byte:02x}"); // writing to a String cannot fail
        text
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn hashes_are_those_of_the_standard() {
        // FIPS 180-4's example: SHA-256 of "abc".
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("abc");
        std::fs::write(&path, "abc").unwrap();
        let expected = "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad";
        assert_eq!(of_file(&path).unwrap(), expected);
    }

    #[test]
    fn neither_names_nor_lengths_run_into_each_other() {
        let hashes = [
            Fields::of("a").with("b", "c").finish(),
            Fields::of("a").with("bc", "").finish(),
            Fields::of("a").with("", "bc").finish(),
            Fields::of("a").finish(),
            Fields::of("ab").with("", "c").finish(),
        ];
        for (i, hash) in hashes.iter().enumerate() {
            assert!(!hashes[..i].contains(hash), "{i}");
        }
    }

    #[test]
    fn a_picture_is_its_size_and_its_bits() {
        let image = Image::filled(3, 2, [0.0; 3]);
        let mut negative = image.clone();
        negative.set(2, 1, [0.0, 0.0, -0.0]);
        assert_eq!(of_picture(&image), of_picture(&image.clone()));
        assert_ne!(of_picture(&image), of_picture(&negative));
        assert_ne!(of_picture(&image), of_picture(&Image::filled(2, 3, [0.0; 3])));
    }
}
