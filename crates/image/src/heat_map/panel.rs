//! The scale below a heat map: a gradient, ticks with numbers, and a label.

use super::font::{self, CELL};
use super::ticks::Ticks;
use crate::{ColorMap, Image};

/// Colours of the panel, code values.
pub(super) const PAPER: [f32; 3] = [1.0; 3];
const INK: [f32; 3] = [0.13; 3];

/// Lengths in pixels of the font.
const MARGIN: usize = 6;
const BAR: usize = 10;
const TICK: usize = 3;
const GAP: usize = 4;
const BETWEEN_NUMBERS: usize = 8;

/// One pixel of the font is one of the picture for each started stretch of so many pixels of its width.
const PIXELS_PER_SCALE: usize = 600;

/// A line of the label is allowed that many characters, even if that widens the panel.
const LEAST_CHARACTERS: usize = 16;

/// A laid-out scale.
pub(super) struct Panel {
    map: ColorMap,
    range: (f64, f64),
    label: Vec<String>,
    ticks: Ticks,
    width: usize,
    scale: usize,
}

impl Panel {
    /// A scale from `low` to `high` for a picture of that width, or wider where numbers or label need it.
    pub(super) fn new(map: ColorMap, low: f64, high: f64, label: &str, picture_width: usize) -> Self {
        let scale = picture_width.div_ceil(PIXELS_PER_SCALE).max(1);
        let margins = 2 * MARGIN * scale;
        let characters = picture_width.saturating_sub(margins) / (CELL * scale);
        let label = wrapped(label, characters.max(LEAST_CHARACTERS));
        let longest = label.iter().map(|line| font::width(line, scale)).fold(scale, usize::max);
        let width = picture_width.max(longest + margins);
        let mut panel = Self { map, range: (low, high), label, ticks: Ticks::coarsest(low, high), width, scale };
        while !panel.has_room_for(&panel.ticks) {
            panel.width += CELL * scale;
        }
        panel.ticks = Ticks::new(low, high, |ticks| panel.has_room_for(ticks));
        panel
    }

    /// Width in pixels.
    pub(super) fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub(super) fn height(&self) -> usize {
        let lines = self.label.len() * (CELL + GAP);
        self.scale * (MARGIN + BAR + TICK + GAP + CELL + lines + MARGIN)
    }

    /// Whether no two numbers come too near.
    fn has_room_for(&self, ticks: &Ticks) -> bool {
        let places: Vec<(usize, usize)> = ticks.marks.iter().map(|mark| self.number_place(mark)).collect();
        places.windows(2).all(|pair| pair[0].0 + pair[0].1 + BETWEEN_NUMBERS * self.scale <= pair[1].0)
    }

    /// Left end and width of a number: in the middle below its tick, or moved so far that the panel holds it.
    fn number_place(&self, (value, text): &(f64, String)) -> (usize, usize) {
        let (width, edge) = (font::width(text, self.scale), MARGIN * self.scale / 2);
        let centred = self.column_of(*value).saturating_sub(width / 2);
        (centred.min(self.width.saturating_sub(width + edge)).max(edge), width)
    }

    /// First column and number of columns of the gradient.
    fn bar(&self) -> (usize, usize) {
        let inset = MARGIN * self.scale;
        (inset, self.width - 2 * inset)
    }

    /// The column of the gradient that has a value's colour.
    fn column_of(&self, value: f64) -> usize {
        let (left, width) = self.bar();
        let share = (value - self.range.0) / (self.range.1 - self.range.0);
        left + (share.clamp(0.0, 1.0) * (width - 1) as f64).round() as usize
    }

    /// Draws the panel over the full width of the picture from row `top` down.
    pub(super) fn draw(&self, picture: &mut Image, top: usize) {
        let scale = self.scale;
        let bar_top = top + MARGIN * scale;
        self.draw_bar(picture, bar_top);
        let tick_top = bar_top + BAR * scale;
        let number_top = tick_top + (TICK + GAP) * scale;
        let line = self.line_width();
        for mark in &self.ticks.marks {
            let column = self.column_of(mark.0) - line / 2;
            font::fill(picture, (column, tick_top), (line, TICK * scale), INK);
            font::draw(picture, (self.number_place(mark).0, number_top), &mark.1, scale, INK);
        }
        for (i, line) in self.label.iter().enumerate() {
            let y = number_top + (i + 1) * (CELL + GAP) * scale;
            font::draw(picture, ((self.width - font::width(line, scale)) / 2, y), line, scale, INK);
        }
    }

    /// The gradient in a frame, which keeps white ends apart from the paper.
    fn draw_bar(&self, picture: &mut Image, top: usize) {
        let ((left, width), height, line) = (self.bar(), BAR * self.scale, self.line_width());
        font::fill(picture, (left - line, top - line), (width + 2 * line, height + 2 * line), INK);
        for column in 0..width {
            let value = column as f32 / (width - 1) as f32;
            font::fill(picture, (left + column, top), (1, height), self.map.at(value));
        }
    }

    /// Width of frames and ticks in pixels.
    fn line_width(&self) -> usize {
        self.scale.div_ceil(2)
    }
}

/// The words of a text in lines of at most so many characters; a longer word has a line of its own.
fn wrapped(text: &str, characters: usize) -> Vec<String> {
    let mut lines: Vec<String> = Vec::new();
    for paragraph in text.lines() {
        let mut line = String::new();
        for word in paragraph.split_whitespace() {
            if !line.is_empty() && line.chars().count() + 1 + word.chars().count() > characters {
                lines.push(std::mem::take(&mut line));
            }
            if !line.is_empty() {
                line.push(' ');
            }
            line.push_str(word);
        }
        lines.push(line);
    }
    lines
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_stand_apart_and_inside_the_panel() {
        for width in [0, 1, 8, 64, 160, 601, 1920, 3840] {
            for (low, high) in [(0.0, 1.0), (-0.05, 0.05), (-2e-7, 2e-7), (0.31, 0.9), (0.0, 99_999.0), (-1.0, 3.9e38)]
            {
                let panel = Panel::new(ColorMap::Viridis, low, high, "", width);
                let places: Vec<(usize, usize)> =
                    panel.ticks.marks.iter().map(|mark| panel.number_place(mark)).collect();
                assert!(panel.width() >= width && places.len() >= 2);
                assert!(places.windows(2).all(|pair| pair[0].0 + pair[0].1 < pair[1].0), "{width} {low} {high}");
                assert!(places.iter().all(|(left, number)| left + number < panel.width()), "{width} {low} {high}");
            }
        }
    }

    #[test]
    fn wider_panels_have_more_ticks() {
        let count = |width| Panel::new(ColorMap::Magma, 0.0, 1.0, "", width).ticks.marks.len();
        assert_eq!((count(64), count(1280)), (3, 11));
    }

    #[test]
    fn labels_are_broken_between_words() {
        assert_eq!(wrapped("luminance, test - reference", 18), ["luminance, test -", "reference"]);
        assert_eq!(wrapped("a  b\nc", 18), ["a b", "c"]);
        assert_eq!(wrapped("incomprehensible no", 4), ["incomprehensible", "no"]);
        assert!(wrapped("", 4).is_empty());
        let panel = Panel::new(ColorMap::Magma, 0.0, 1.0, "incomprehensibilities, test - reference", 64);
        assert_eq!(panel.width(), 22 * CELL + 2 * MARGIN, "as wide as the longest word with its comma");
    }
}
