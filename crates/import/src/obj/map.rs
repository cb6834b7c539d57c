//! Statements about maps in MTL files: options, then the name of a file.

use crate::lines::without_comment;
use crate::number::parse_number;
use glam::Vec2;
use lightcuts_scene::TextureMode;

/// A map as a library names it.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct MapStatement<'t> {
    /// Empty if there is none. What follows a ` #` may be a comment or belong to the name; see [`Self::names`].
    file: &'t str,
    /// How it is laid out: tiled, unless it is clamped.
    pub(crate) mode: TextureMode,
    pub(crate) placement: MapPlacement,
    /// `-bm`: how much normals or heights count.
    pub(crate) strength: f32,
    /// Options that would change the picture and are not supported.
    pub(crate) unsupported: Vec<&'static str>,
    pub(crate) color_space: Option<&'t str>,
}

/// `-s` and `-o`: what becomes of texture coordinates, uv * scale + offset.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct MapPlacement {
    scale: Vec2,
    offset: Vec2,
}

impl Default for MapPlacement {
    fn default() -> Self {
        Self { scale: Vec2::ONE, offset: Vec2::ZERO }
    }
}

impl MapPlacement {
    pub(crate) fn apply(&self, coordinates: [f32; 2]) -> [f32; 2] {
        (Vec2::from_array(coordinates) * self.scale + self.offset).to_array()
    }
}

/// Options of numbers: how many at most, and those that change nothing; further ones are as the last.
const NUMBERS: [(&str, usize, &[f32]); 6] = [
    ("-o", 3, &[0.0]),
    ("-s", 3, &[1.0]),
    ("-t", 3, &[0.0]),
    ("-mm", 2, &[0.0, 1.0]),
    ("-bm", 1, &[1.0]),
    ("-boost", 1, &[0.0]),
];

/// Options of one word, and that which changes nothing.
const WORDS: [(&str, &str); 8] = [
    ("-blendu", "on"),
    ("-blendv", "on"),
    ("-cc", "off"),
    ("-clamp", "off"),
    ("-texres", ""),
    ("-imfchan", ""),
    ("-type", ""),
    ("-colorspace", ""),
];

impl<'t> MapStatement<'t> {
    /// Reads what follows the keyword.
    pub(crate) fn parse(value: &'t str) -> Self {
        let mut map = Self {
            file: "",
            mode: TextureMode::Repeat,
            placement: MapPlacement::default(),
            strength: 1.0,
            unsupported: Vec::new(),
            color_space: None,
        };
        let mut rest = value;
        while let Some((option, after)) = next_word(rest).filter(|(word, _)| word.starts_with('-')) {
            let numbers = NUMBERS.iter().find(|(known, ..)| *known == option);
            let words = WORDS.iter().find(|(known, _)| *known == option);
            rest = match (numbers, words) {
                (Some(&(option, most, neutral)), _) => map.numbers(option, most, neutral, after),
                (None, Some(&(option, neutral))) => map.word(option, neutral, after),
                // A file name that starts with a hyphen.
                (None, None) => break,
            };
        }
        map.file = unquoted(rest.trim_ascii());
        map
    }

    /// What the name may be, the likeliest first: as it stands, without a comment.
    pub(crate) fn names(&self) -> impl Iterator<Item = &'t str> + use<'t> {
        let short = unquoted(without_comment(self.file).trim_ascii());
        std::iter::once(self.file).chain((short.len() < self.file.len()).then_some(short))
    }

    pub(crate) fn is_empty(&self) -> bool {
        self.names().last().is_none_or(str::is_empty)
    }

    /// Reads an option of numbers; what follows them comes back.
    fn numbers(&mut self, option: &'static str, most: usize, neutral: &[f32], mut rest: &'t str) -> &'t str {
        let default = |i: usize| neutral[i.min(neutral.len() - 1)];
        let mut values = [0, 1, 2].map(default);
        for value in values.iter_mut().take(most) {
            let Some((word, after)) = next_word(rest) else { break };
            let Ok(number) = parse_number(word) else { break };
            (*value, rest) = (number, after);
        }
        match option {
            "-s" => self.placement.scale = Vec2::new(values[0], values[1]),
            "-o" => self.placement.offset = Vec2::new(values[0], values[1]),
            "-bm" => self.strength = values[0],
            _ if (0..most).any(|i| values[i] != default(i)) => self.unsupported.push(option),
            _ => {}
        }
        rest
    }

    fn word(&mut self, option: &'static str, neutral: &str, rest: &'t str) -> &'t str {
        let Some((word, after)) = next_word(rest) else { return rest };
        match option {
            "-clamp" if word == "on" => self.mode = TextureMode::Straight,
            "-colorspace" => self.color_space = Some(word),
            _ if word != neutral => self.unsupported.push(option),
            _ => {}
        }
        after
    }
}

fn next_word(text: &str) -> Option<(&str, &str)> {
    let text = text.trim_ascii_start();
    let word = text.split_ascii_whitespace().next()?;
    Some((word, &text[word.len()..]))
}

fn unquoted(name: &str) -> &str {
    name.strip_prefix('"').and_then(|name| name.strip_suffix('"')).unwrap_or(name)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_follow_the_options() {
        use TextureMode::{Repeat, Straight};
        for (value, file, mode) in [
            ("a.png", "a.png", Repeat),
            ("texture 01.png", "texture 01.png", Repeat),
            ("-o 0.1 diffuse.jpg", "diffuse.jpg", Repeat),
            ("-s 1 1 1 -clamp on my tex.png", "my tex.png", Straight),
            ("-mm 0 1 -blendu on  7.png", "7.png", Repeat),
            ("-type sphere -colorspace sRGB -o 1 2 x.png", "x.png", Repeat),
            ("-odd.png", "-odd.png", Repeat),
            ("-bm 0.5\tn.png", "n.png", Repeat),
            ("-bm n.png", "n.png", Repeat),
            ("\"a b.png\"", "a b.png", Repeat),
            ("-o", "", Repeat),
        ] {
            let map = MapStatement::parse(value);
            assert_eq!((map.file, map.mode, map.is_empty()), (file, mode, file.is_empty()), "{value}");
        }
        let names = |value| MapStatement::parse(value).names().collect::<Vec<_>>();
        assert_eq!(names("a #1.png # wood"), ["a #1.png # wood", "a"]);
        assert_eq!(names("a#1.png"), ["a#1.png"]);
    }

    #[test]
    fn options_that_change_the_picture_are_kept_or_named() {
        let map = MapStatement::parse("-s 2 3 1 -o .5 -bm 0.25 a.png");
        assert_eq!((map.placement.apply([1.0, 1.0]), map.strength), ([2.5, 3.0], 0.25));
        assert_eq!(MapStatement::parse("-s 2 a.png").placement.apply([1.0, 1.0]), [2.0, 1.0]);
        let unsupported = |value| MapStatement::parse(value).unsupported;
        assert_eq!(
            unsupported("-t 1 -mm 0 2 -boost 3 -blendu off -blendv off -cc on -texres 512 -imfchan r -type sphere a"),
            ["-t", "-mm", "-boost", "-blendu", "-blendv", "-cc", "-texres", "-imfchan", "-type"]
        );
        assert_eq!(unsupported("-t 0 0 0 -mm 0 1 -boost 0 -blendu on -blendv on -cc off -clamp off a"), [""; 0]);
    }
}
