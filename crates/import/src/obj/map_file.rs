//! The options that may stand before the file name of a map.

use crate::number::parse_number;
use lightcuts_scene::TextureMode;

/// The file name after the options of a map, and how it is laid out: tiled, unless it is clamped.
pub(super) fn map_file(value: &str) -> (&str, TextureMode) {
    let mut rest = value;
    let mut mode = TextureMode::Repeat;
    while let Some((option, after)) = next_word(rest).filter(|(word, _)| word.starts_with('-')) {
        let arguments = match option {
            "-o" | "-s" | "-t" => 1..=3,
            "-mm" => 2..=2,
            "-blendu" | "-blendv" | "-cc" | "-clamp" | "-bm" | "-boost" | "-texres" | "-imfchan" | "-type"
            | "-colorspace" => 1..=1,
            // A file name that starts with a hyphen.
            _ => break,
        };
        rest = after;
        for i in 0..*arguments.end() {
            let Some((word, after)) = next_word(rest) else { break };
            if i >= *arguments.start() && parse_number(word).is_err() {
                break;
            }
            if option == "-clamp" && word == "on" {
                mode = TextureMode::Straight;
            }
            rest = after;
        }
    }
    (rest.trim_ascii(), mode)
}

fn next_word(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_ascii_start();
    let word = text.split_ascii_whitespace().next()?;
    Some((word, &text[word.len()..]))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn map_options_are_skipped() {
        use TextureMode::{Repeat, Straight};
        for (value, file, mode) in [
            ("a.png", "a.png", Repeat),
            ("texture 01.png", "texture 01.png", Repeat),
            ("-o 0.1 diffuse.jpg", "diffuse.jpg", Repeat),
            ("-s 1 1 1 -clamp on my tex.png", "my tex.png", Straight),
            ("-mm 0 1 -blendu on  7.png", "7.png", Repeat),
            ("-type sphere -colorspace sRGB -o 1 2 x.png", "x.png", Repeat),
            ("-odd.png", "-odd.png", Repeat),
            ("-o", "", Repeat),
        ] {
            assert_eq!(map_file(value), (file, mode), "{value}");
        }
    }
}
