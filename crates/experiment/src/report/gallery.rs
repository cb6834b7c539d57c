//! Picture files as data URIs, each read once.

use super::document::Picture;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

/// Largest file in bytes.
const MAX_BYTES: u64 = 64 << 20;
/// What every PNG begins with, the name of its first chunk included (ISO 15948).
const SIGNATURE: &[u8] = b"\x89PNG\r\n\x1a\n\0\0\0\rIHDR";

/// A picture that the page holds.
#[derive(Debug, Clone, PartialEq, Eq)]
pub(super) struct Held {
    /// `picture-1`, ...
    pub(super) anchor: String,
    pub(super) width: u32,
    pub(super) height: u32,
    /// For its first place on the page; later ones copy it from there.
    pub(super) uri: Option<String>,
}

/// The pictures of a page.
#[derive(Debug)]
pub(super) struct Gallery<'a> {
    /// Paths start here.
    folder: &'a Path,
    known: BTreeMap<PathBuf, Result<Held, String>>,
}

impl<'a> Gallery<'a> {
    pub(super) fn new(folder: &'a Path) -> Self {
        Self { folder, known: BTreeMap::new() }
    }

    /// A picture for its next place on the page, or why there is none.
    pub(super) fn hold(&mut self, picture: &Picture) -> Result<Held, String> {
        if let Some(known) = self.known.get(&picture.path) {
            return known.clone();
        }
        let anchor = format!("picture-{}", self.known.len() + 1);
        let read = read(&self.folder.join(&picture.path)).map(|bytes| held(anchor, &bytes));
        let first = read.map_err(|reason| format!("{} cannot be shown: {reason}", picture.path.display()));
        let later = first.clone().map(|held| Held { uri: None, ..held });
        self.known.insert(picture.path.clone(), later);
        first
    }

    /// Pictures that cannot be shown, with the reasons.
    pub(super) fn missing(&self) -> Vec<String> {
        self.known.values().filter_map(|known| known.as_ref().err().cloned()).collect()
    }
}

fn held(anchor: String, png: &[u8]) -> Held {
    // The checked signature is followed by width and height.
    let side = |at: usize| u32::from_be_bytes([png[at], png[at + 1], png[at + 2], png[at + 3]]);
    let uri = Some(format!("data:image/png;base64,{}", STANDARD.encode(png)));
    Held { anchor, width: side(SIGNATURE.len()), height: side(SIGNATURE.len() + 4), uri }
}

fn read(path: &Path) -> Result<Vec<u8>, String> {
    let refused = |error: io::Error| match error.kind() {
        io::ErrorKind::NotFound => "there is no such file".to_owned(),
        _ => error.to_string(),
    };
    if !path.metadata().map_err(refused)?.is_file() {
        return Err("it is not a regular file".to_owned());
    }
    let mut bytes = Vec::new();
    File::open(path).and_then(|file| file.take(MAX_BYTES + 1).read_to_end(&mut bytes)).map_err(refused)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err("it is larger than 64 MiB".to_owned());
    }
    if !bytes.starts_with(SIGNATURE) || bytes.len() < SIGNATURE.len() + 8 {
        return Err("it is not a PNG".to_owned());
    }
    Ok(bytes)
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts::image::{Image, Transfer, write_png};

    fn picture(name: &str) -> Picture {
        Picture { path: PathBuf::from(name), title: String::new(), alternative: String::new() }
    }

    #[test]
    fn a_picture_is_embedded_once_with_its_size() {
        let folder = tempfile::tempdir().unwrap();
        write_png(folder.path().join("a.png"), &Image::new(7, 5), Transfer::Linear).unwrap();
        let mut gallery = Gallery::new(folder.path());
        let first = gallery.hold(&picture("a.png")).unwrap();
        assert_eq!((first.width, first.height), (7, 5));
        let uri = first.uri.unwrap();
        let bytes = STANDARD.decode(uri.strip_prefix("data:image/png;base64,").unwrap()).unwrap();
        assert_eq!(bytes, std::fs::read(folder.path().join("a.png")).unwrap());
        let second = gallery.hold(&picture("a.png")).unwrap();
        assert_eq!((second.anchor, second.uri), (first.anchor, None));
        assert!(gallery.missing().is_empty());
    }

    #[test]
    fn what_is_no_picture_is_told() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("text.png"), "secret").unwrap();
        std::fs::create_dir(folder.path().join("folder.png")).unwrap();
        std::fs::write(folder.path().join("cut.png"), SIGNATURE).unwrap();
        let mut gallery = Gallery::new(folder.path());
        let cases =
            [("text.png", "not a PNG"), ("folder.png", "regular"), ("none.png", "no such"), ("cut.png", "not a PNG")];
        for (name, expected) in cases {
            let reason = gallery.hold(&picture(name)).unwrap_err();
            assert!(reason.contains(expected) && reason.contains(name), "{reason}");
        }
        assert_eq!(gallery.missing().len(), cases.len());
    }
}
