//! Bar charts: groups of bars, ours filled and published ones outlined.

use super::scale::Scale;
use super::{Canvas, Drawn, FRAME, INK, Letters, SOFT_INK, color, svg};
use crate::report::number::fixed;
use plotters::style::text_anchor::VPos;

/// Share of a group's width that its bars take.
const FILLED_SHARE: f64 = 0.84;
/// Gap between two series, in bars.
const SERIES_GAP: f64 = 0.35;
/// Narrowest bar, in pixels, with its number above.
const LABELLED_WIDTH: f64 = 30.0;

/// A bar chart.
pub(crate) struct BarChart {
    pub(crate) y_title: String,
    pub(crate) series: Vec<String>,
    pub(crate) groups: Vec<Group>,
}

/// Bars over one name.
pub(crate) struct Group {
    pub(crate) label: String,
    /// Those of one series are neighbours.
    pub(crate) bars: Vec<Bar>,
}

/// A bar, or the word in its place.
pub(crate) struct Bar {
    pub(crate) series: usize,
    pub(crate) published: bool,
    pub(crate) value: Option<f64>,
    pub(crate) word: &'static str,
}

impl BarChart {
    /// Draws it. The message is the library's.
    pub(crate) fn to_svg(&self) -> Result<String, String> {
        svg(|canvas| self.draw(canvas))
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let [left, top, right, bottom] = FRAME;
        let values = self.groups.iter().flat_map(|group| &group.bars).filter_map(|bar| bar.value);
        let scale = Scale::linear(values, (bottom, top + 16));
        canvas.y_axis(&scale, &self.y_title)?;
        let width = f64::from(right - left) / self.groups.len().max(1) as f64;
        for (i, group) in self.groups.iter().enumerate() {
            let start = f64::from(left) + i as f64 * width;
            draw_group(canvas, group, &scale, (start, width))?;
            let center = (start + width / 2.0) as i32;
            canvas.text(&group.label, (center, bottom + 22), Letters::new(15.0, INK).centered())?;
        }
        let zero = scale.pixel(0.0);
        canvas.line(&[(left, zero), (right, zero)], SOFT_INK, 1)?;
        self.draw_legend(canvas)
    }

    /// The series, and after them what filled and outlined bars are.
    fn draw_legend(&self, canvas: &Canvas<'_>) -> Drawn {
        let mut names: Vec<(usize, &str)> = self.series.iter().map(String::as_str).enumerate().collect();
        let series = names.len();
        if self.groups.iter().flat_map(|group| &group.bars).any(|bar| bar.published) {
            names.extend([(series, "ours"), (series + 1, "published")]);
        }
        canvas.legend(&names, |canvas, i, (x, y)| {
            let square = [(x - 6, y - 6), (x + 6, y + 6)];
            match i.checked_sub(series) {
                None => canvas.rectangle(square, color(i)),
                Some(0) => canvas.rectangle(square, SOFT_INK),
                Some(_) => canvas.outlined(square, SOFT_INK),
            }
        })
    }
}

fn draw_group(canvas: &Canvas<'_>, group: &Group, scale: &Scale, (start, width): (f64, f64)) -> Drawn {
    let changes = group.bars.windows(2).filter(|pair| pair[0].series != pair[1].series).count();
    let bar_width = width * FILLED_SHARE / (group.bars.len() as f64 + changes as f64 * SERIES_GAP).max(1.0);
    let mut x = start + width * (1.0 - FILLED_SHARE) / 2.0;
    for (i, bar) in group.bars.iter().enumerate() {
        if i > 0 && group.bars[i - 1].series != bar.series {
            x += SERIES_GAP * bar_width;
        }
        draw_bar(canvas, bar, scale, (x, bar_width))?;
        x += bar_width;
    }
    Ok(())
}

fn draw_bar(canvas: &Canvas<'_>, bar: &Bar, scale: &Scale, (x, width): (f64, f64)) -> Drawn {
    let (left, right) = ((x + 1.0).round() as i32, (x + width - 1.0).round() as i32);
    let zero = scale.pixel(0.0);
    let middle = i32::midpoint(left, right);
    let Some(value) = bar.value else {
        let style = Letters { upright: true, ..Letters::new(12.0, SOFT_INK) };
        return canvas.text(bar.word, (middle, zero - 8), style);
    };
    let end = scale.pixel(value);
    let corners = [(left, end.min(zero)), (right, end.max(zero))];
    if bar.published {
        canvas.outlined(corners, color(bar.series))?;
    } else {
        canvas.rectangle(corners, color(bar.series))?;
    }
    if width < LABELLED_WIDTH {
        return Ok(());
    }
    let (y, vertical) = if value < 0.0 { (end + 4, VPos::Top) } else { (end - 2, VPos::Bottom) };
    let style = Letters { vertical, ..Letters::new(11.5, SOFT_INK).centered() };
    let digits = usize::from(value.abs() < 1000.0);
    canvas.text(&fixed(value, digits).replace('-', "\u{2212}"), (middle, y), style)
}
