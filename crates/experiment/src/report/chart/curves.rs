//! Line charts with two logarithmic axes.

use super::scale::{self, Scale};
use super::{Canvas, Drawn, FRAME, GRID, INK, Letters, PAPER, SOFT_INK, color, svg, text_width};
use plotters::style::text_anchor::HPos;

/// A line chart with two logarithmic axes.
pub struct LogChart {
    /// What x is, with its unit.
    pub x_title: String,
    /// What y is, with its unit.
    pub y_title: String,
    /// The curves, distinguished by colours and markers in their order.
    pub lines: Vec<Line>,
    /// A place that is pointed out.
    pub mark: Option<Mark>,
}

/// A curve.
pub struct Line {
    /// Its name in the legend.
    pub title: String,
    /// In the order of x.
    pub points: Vec<Point>,
}

/// A place of a curve; all above 0.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Point {
    /// Place along the axis.
    pub x: f64,
    /// Height.
    pub y: f64,
    /// Lower end of the bar through it.
    pub least: f64,
    /// Upper end.
    pub greatest: f64,
}

/// A place with a name: a crossover.
pub struct Mark {
    /// Place along the axis.
    pub x: f64,
    /// Height.
    pub y: f64,
    /// What stands beside it.
    pub label: String,
}

impl LogChart {
    /// The chart as an SVG document. The message, if it cannot be drawn, is the library's.
    pub fn to_svg(&self) -> Result<String, String> {
        svg(|canvas| self.draw(canvas))
    }

    fn draw(&self, canvas: &Canvas<'_>) -> Drawn {
        let [left, top, right, bottom] = FRAME;
        let points = || self.lines.iter().flat_map(|line| &line.points);
        let x = Scale::logarithmic(points().map(|point| point.x), (left, right));
        let y = Scale::logarithmic(points().flat_map(|point| [point.least, point.greatest]), (bottom, top));
        canvas.y_axis(&y, &self.y_title)?;
        self.draw_x_axis(canvas, &x)?;
        if let Some(mark) = &self.mark {
            draw_mark(canvas, mark, (x.pixel(mark.x), y.pixel(mark.y)))?;
        }
        for (series, line) in self.lines.iter().enumerate() {
            draw_line(canvas, line, series, &x, &y)?;
        }
        let all = self.lines.iter().enumerate().filter(|(_, line)| !line.points.is_empty());
        let names: Vec<(usize, &str)> = all.map(|(series, line)| (series, line.title.as_str())).collect();
        canvas.legend(&names, |canvas, series, (x, y)| {
            canvas.line(&[(x - 8, y), (x + 8, y)], color(series), 2)?;
            canvas.sign(series, (x, y))
        })
    }

    fn draw_x_axis(&self, canvas: &Canvas<'_>, x: &Scale) -> Drawn {
        let [left, top, right, bottom] = FRAME;
        for tick in x.ticks() {
            let place = x.pixel(tick);
            canvas.line(&[(place, top), (place, bottom)], GRID, 1)?;
            canvas.text(&scale::label(tick), (place, bottom + 16), Letters::new(13.0, SOFT_INK).centered())?;
        }
        canvas.line(&[(left, top), (left, bottom), (right, bottom)], SOFT_INK, 1)?;
        canvas.text(&self.x_title, (i32::midpoint(left, right), bottom + 42), Letters::new(13.0, INK).centered())
    }
}

fn draw_line(canvas: &Canvas<'_>, line: &Line, series: usize, x: &Scale, y: &Scale) -> Drawn {
    let places: Vec<(i32, i32)> = line.points.iter().map(|point| (x.pixel(point.x), y.pixel(point.y))).collect();
    canvas.line(&places, color(series), 2)?;
    for (point, &(place, _)) in line.points.iter().zip(&places) {
        canvas.line(&[(place, y.pixel(point.least)), (place, y.pixel(point.greatest))], color(series), 1)?;
    }
    places.into_iter().try_for_each(|place| canvas.sign(series, place))
}

/// A line across the chart, a ring on it, and its label where there is room for it.
fn draw_mark(canvas: &Canvas<'_>, mark: &Mark, place: (i32, i32)) -> Drawn {
    let [_, top, right, bottom] = FRAME;
    canvas.line(&[(place.0, top), (place.0, bottom)], SOFT_INK, 1)?;
    canvas.ring(place, 9, INK)?;
    let text = format!("crossover: {}", mark.label);
    let width = text_width(&text, 13.0);
    let (x, horizontal, left) = if place.0 + width + 12 < right {
        (place.0 + 8, HPos::Left, place.0 + 5)
    } else {
        (place.0 - 8, HPos::Right, place.0 - width - 11)
    };
    // The end of the line that is farther from the ring.
    let y = if place.1 > i32::midpoint(top, bottom) { top + 14 } else { bottom - 14 };
    canvas.rectangle([(left, y - 10), (left + width + 6, y + 10)], PAPER)?;
    canvas.text(&text, (x, y), Letters { horizontal, ..Letters::new(13.0, INK) })
}
