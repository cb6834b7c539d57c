//! Text of pixels, in the public-domain font of 8 x 8 pixels.

use font8x8::{BASIC_FONTS, GREEK_FONTS, LATIN_FONTS, UnicodeFonts as _};

use crate::Image;

/// Pixels of a character's cell, both ways, before scaling.
pub(super) const CELL: usize = 8;

/// Width of the text in pixels, at `scale` pixels per pixel of the font.
pub(super) fn width(text: &str, scale: usize) -> usize {
    CELL * scale * text.chars().count()
}

/// Draws the text with its upper left corner at (x, y); what lies outside the picture is left out.
pub(super) fn draw(picture: &mut Image, (x, y): (usize, usize), text: &str, scale: usize, ink: [f32; 3]) {
    for (i, character) in text.chars().enumerate() {
        for (v, bits) in glyph(character).into_iter().enumerate() {
            for u in (0..CELL).filter(|u| bits >> u & 1 == 1) {
                fill(picture, (x + (CELL * i + u) * scale, y + v * scale), (scale, scale), ink);
            }
        }
    }
}

/// Fills a rectangle with its upper left corner at (x, y); what lies outside the picture is left out.
pub(super) fn fill(picture: &mut Image, (x, y): (usize, usize), (width, height): (usize, usize), ink: [f32; 3]) {
    let columns = x.min(picture.width())..(x + width).min(picture.width());
    for y in y..(y + height).min(picture.height()) {
        picture.row_mut(y)[columns.clone()].fill(ink);
    }
}

/// Eight rows from the top; the lowest bit is the leftmost pixel. A question mark for characters that the font lacks.
fn glyph(character: char) -> [u8; CELL] {
    let found =
        BASIC_FONTS.get(character).or_else(|| LATIN_FONTS.get(character)).or_else(|| GREEK_FONTS.get(character));
    found.or_else(|| BASIC_FONTS.get('?')).unwrap_or([0xff; CELL])
}
