//! Charts as SVG: a canvas with the house's colours and letters, and what bar and line charts share.

pub(super) mod bars;
pub(super) mod curves;
mod scale;

use plotters::backend::SVGBackend;
use plotters::coord::Shift;
use plotters::drawing::{DrawingArea, DrawingAreaErrorKind, IntoDrawingArea};
use plotters::element::{Circle, EmptyElement, PathElement, Polygon, Rectangle, Text};
use plotters::style::text_anchor::{HPos, Pos, VPos};
use plotters::style::{FontTransform, IntoFont, RGBColor, ShapeStyle, TextStyle};
use scale::Scale;

/// Size of a chart in pixels.
const SIZE: (u32, u32) = (880, 440);
/// The chart inside the axes: left, top, right, bottom.
const FRAME: [i32; 4] = [80, 52, 866, 384];
/// Families that every system has one of.
const FONT: &str = "system-ui, -apple-system, 'Segoe UI', Roboto, 'Liberation Sans', Arial, sans-serif";
/// The backend divides sizes by this.
const FONT_SCALE: f64 = 1.24;
/// Width of a letter over its size, on average.
const LETTER_WIDTH: f64 = 0.56;

/// Letters and axes; the page maps these to lighter ones on a dark screen.
const INK: RGBColor = RGBColor(0x26, 0x2b, 0x33);
const SOFT_INK: RGBColor = RGBColor(0x5b, 0x63, 0x70);
const GRID: RGBColor = RGBColor(0xe2, 0xe5, 0xea);
const PAPER: RGBColor = RGBColor(0xff, 0xff, 0xff);
/// Colours that people with any colour vision can distinguish (Okabe & Ito 2008), the darker ones first.
const PALETTE: [RGBColor; 6] = [
    RGBColor(0x00, 0x72, 0xb2),
    RGBColor(0xd5, 0x5e, 0x00),
    RGBColor(0x00, 0x9e, 0x73),
    RGBColor(0xcc, 0x79, 0xa7),
    RGBColor(0xe6, 0x9f, 0x00),
    RGBColor(0x56, 0xb4, 0xe9),
];

/// Drawing to a text does not fail by itself; the library's own errors are passed on.
type Drawn = Result<(), DrawingAreaErrorKind<std::io::Error>>;

/// The colour of a series.
fn color(series: usize) -> RGBColor {
    PALETTE[series % PALETTE.len()]
}

/// A colour mixed with the paper: what a translucent one would look like, in a colour that the page can map.
fn tint(color: RGBColor) -> RGBColor {
    let mix = |value: u8| (255.0 - 0.22 * (255.0 - f64::from(value))).round() as u8;
    RGBColor(mix(color.0), mix(color.1), mix(color.2))
}

/// Draws a chart and returns its SVG. The message is the library's.
fn svg(draw: impl FnOnce(&Canvas<'_>) -> Drawn) -> Result<String, String> {
    let mut text = String::new();
    let canvas = Canvas(SVGBackend::with_string(&mut text, SIZE).into_drawing_area());
    let drawn = canvas.0.fill(&PAPER).and_then(|()| draw(&canvas)).and_then(|()| canvas.0.present());
    drop(canvas);
    drawn.map_err(|error| format!("a chart cannot be drawn: {error}"))?;
    Ok(text)
}

/// An area in pixels, y downwards.
struct Canvas<'a>(DrawingArea<SVGBackend<'a>, Shift>);

impl Canvas<'_> {
    fn line(&self, places: &[(i32, i32)], color: RGBColor, width: u32) -> Drawn {
        let style = ShapeStyle { color: color.into(), filled: false, stroke_width: width };
        self.0.draw(&PathElement::new(places.to_vec(), style))
    }

    fn rectangle(&self, corners: [(i32, i32); 2], color: RGBColor) -> Drawn {
        self.0.draw(&Rectangle::new(corners, filled(color)))
    }

    /// A rectangle in a tint with a border: a published figure.
    fn outlined(&self, corners: [(i32, i32); 2], color: RGBColor) -> Drawn {
        self.rectangle(corners, tint(color))?;
        let [(left, top), (right, bottom)] = corners;
        let (left, right) = (left + 1, right - 1);
        let border = [(left, top), (right, top), (right, bottom), (left, bottom), (left, top)];
        self.line(&border, color, 2)
    }

    fn text(&self, text: &str, place: (i32, i32), style: Letters) -> Drawn {
        let font = (FONT, style.size * FONT_SCALE).into_font();
        let font = if style.upright { font.transform(FontTransform::Rotate270) } else { font };
        let style = TextStyle::from(font).color(&style.color).pos(Pos::new(style.horizontal, style.vertical));
        self.0.draw(&Text::new(printable(text), place, style))
    }

    /// A marker of the series at a point of a curve: shapes distinguish curves where colours do not.
    fn sign(&self, series: usize, (x, y): (i32, i32)) -> Drawn {
        let style = filled(color(series));
        match series % 4 {
            0 => self.0.draw(&Circle::new((x, y), 4, style)),
            1 => self.rectangle([(x - 4, y - 4), (x + 4, y + 4)], color(series)),
            2 => self.0.draw(&Polygon::new(vec![(x, y - 5), (x + 5, y + 4), (x - 5, y + 4)], style)),
            _ => self.0.draw(&Polygon::new(vec![(x, y - 6), (x + 6, y), (x, y + 6), (x - 6, y)], style)),
        }
    }

    /// A circle with a hole.
    fn ring(&self, place: (i32, i32), radius: i32, color: RGBColor) -> Drawn {
        let style = ShapeStyle { color: color.into(), filled: false, stroke_width: 2 };
        self.0.draw(&(EmptyElement::at(place) + Circle::new((0, 0), radius, style)))
    }

    /// Lines across the chart with their numbers at the left.
    fn y_axis(&self, scale: &Scale, title: &str) -> Drawn {
        let [left, top, right, bottom] = FRAME;
        for tick in scale.ticks() {
            let y = scale.pixel(tick);
            self.line(&[(left, y), (right, y)], GRID, 1)?;
            let style = Letters { horizontal: HPos::Right, ..Letters::new(13.0, SOFT_INK) };
            self.text(&scale::label(tick), (left - 10, y), style)?;
        }
        let style = Letters { upright: true, ..Letters::new(13.0, INK).centered() };
        self.text(title, (18, i32::midpoint(top, bottom)), style)
    }

    /// Names with their signs in a row above the chart, or in several.
    fn legend(&self, names: &[(usize, &str)], sign: impl Fn(&Self, usize, (i32, i32)) -> Drawn) -> Drawn {
        let (mut x, mut y) = (FRAME[0], 16);
        for (series, name) in names {
            let width = text_width(name, 14.0);
            if x + width + 20 > FRAME[2] && x > FRAME[0] {
                (x, y) = (FRAME[0], y + 20);
            }
            sign(self, *series, (x + 6, y))?;
            self.text(name, (x + 20, y), Letters::new(14.0, INK))?;
            x += width + 48;
        }
        Ok(())
    }
}

/// How a text looks and where it lies from its place.
#[derive(Clone, Copy)]
struct Letters {
    size: f64,
    color: RGBColor,
    horizontal: HPos,
    vertical: VPos,
    /// Read from below.
    upright: bool,
}

impl Letters {
    /// To the right of their place.
    fn new(size: f64, color: RGBColor) -> Self {
        Self { size, color, horizontal: HPos::Left, vertical: VPos::Center, upright: false }
    }

    fn centered(self) -> Self {
        Self { horizontal: HPos::Center, ..self }
    }
}

fn filled(color: RGBColor) -> ShapeStyle {
    ShapeStyle { color: color.into(), filled: true, stroke_width: 0 }
}

/// In pixels, roughly: there are no fonts to ask.
fn text_width(text: &str, size: f64) -> i32 {
    (text.chars().count() as f64 * size * LETTER_WIDTH).ceil() as i32
}

/// XML has no place for control characters.
fn printable(text: &str) -> String {
    text.chars().filter(|c| !c.is_control() && !matches!(c, '\u{fffe}' | '\u{ffff}')).collect()
}
