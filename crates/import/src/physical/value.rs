//! Values of a document, and what they may be.

use super::document::Table;
use glam::{DVec3, Vec3};
use std::num::ParseFloatError;
use std::ops::Range;
use std::str::FromStr as _;
use toml::Spanned;
use toml::de::DeValue;

/// The value of a key, or an item of a list that is one.
#[derive(Debug, Clone, Copy)]
pub(super) struct Value<'d> {
    pub(super) key: &'d str,
    pub(super) content: &'d DeValue<'d>,
    start: usize,
    end: usize,
}

/// A kind of value.
pub(super) struct Kind<T> {
    /// To follow the word "expected".
    pub(super) expected: &'static str,
    pub(super) read: fn(Value<'_>) -> Read<T>,
}

// Not derived: a kind can be copied whether or not what it reads can be.
impl<T> Clone for Kind<T> {
    fn clone(&self) -> Self {
        *self
    }
}

impl<T> Copy for Kind<T> {}

/// What comes of a value.
pub(super) enum Read<T> {
    Good(T),
    /// It is of another kind.
    Other,
    /// It is almost good, but for what the message says, at this place.
    Bad(Range<usize>, String),
}

pub(super) const NUMBER: Kind<f32> = Kind { expected: "a number such as 1.5", read: number };
pub(super) const WHOLE: Kind<i64> = Kind { expected: "a whole number such as 1", read: whole };
pub(super) const VECTOR: Kind<Vec3> = Kind { expected: "three numbers such as [0, 1, 0]", read: vector };
/// Places are read with 64 bits, so that a scene far from the origin keeps its form.
pub(super) const POSITION: Kind<DVec3> = Kind { expected: VECTOR.expected, read: position };
pub(super) const COLOR: Kind<Vec3> = Kind { expected: "a number or three such as [0.8, 0.5, 0.2]", read: color };
pub(super) const FACTORS: Kind<DVec3> = Kind { expected: "a number or three such as [1, 2, 1]", read: factors };
pub(super) const TEXT: Kind<String> = Kind { expected: "a string such as \"name\"", read: text };
pub(super) const FILE: Kind<String> = Kind { expected: "the name of a file such as \"model.obj\"", read: text };
pub(super) const MATERIAL: Kind<String> = Kind { expected: "the name of a [[material]]", read: text };
pub(super) const MESH: Kind<String> = Kind { expected: "the name of a [[mesh]]", read: text };
pub(super) const FLAG: Kind<bool> = Kind { expected: "true or false", read: flag };
pub(super) const MATRIX: Kind<[[f64; 4]; 4]> =
    Kind { expected: "four rows of four numbers, the last one [0, 0, 0, 1]", read: matrix };

impl<'d> Value<'d> {
    pub(super) fn new(key: &'d str, value: &'d Spanned<DeValue<'d>>) -> Self {
        let Range { start, end } = value.span();
        Self { key, content: value.get_ref(), start, end }
    }

    pub(super) fn span(self) -> Range<usize> {
        self.start..self.end
    }

    pub(super) fn table(self) -> Option<Table<'d>> {
        Table::of_value(self.content, self.span())
    }

    /// The items of a list.
    pub(super) fn items(self) -> Option<impl ExactSizeIterator<Item = Self>> {
        Some(self.content.as_array()?.iter().map(move |item| Self::new(self.key, item)))
    }

    /// What it is, for messages.
    pub(super) fn kind(self) -> &'static str {
        match self.content {
            DeValue::String(_) => "a string",
            DeValue::Integer(_) | DeValue::Float(_) => "a number",
            DeValue::Boolean(_) => "true or false",
            DeValue::Datetime(_) => "a date",
            DeValue::Array(_) => "a list",
            DeValue::Table(_) => "a table",
        }
    }
}

fn number(value: Value<'_>) -> Read<f32> {
    // Parsed with 32 bits at once: by way of 64 it would be rounded twice.
    number_of(value, f32::from_str, |whole| whole as f32, |number| number)
}

/// A number that a 32-bit one can come near to, with the precision of 64.
fn exact_number(value: Value<'_>) -> Read<f64> {
    number_of(value, f64::from_str, |whole| whole as f64, |number| number as f32)
}

fn number_of<T: Copy>(
    value: Value<'_>,
    parse: fn(&str) -> Result<T, ParseFloatError>,
    of_whole: fn(i64) -> T,
    rounded: fn(T) -> f32,
) -> Read<T> {
    let parsed = match value.content {
        DeValue::Float(float) => parse(float.as_str()).ok(),
        DeValue::Integer(whole) if whole.radix() == 10 => parse(whole.as_str()).ok(),
        DeValue::Integer(whole) => i64::from_str_radix(whole.as_str(), whole.radix()).ok().map(of_whole),
        _ => return Read::Other,
    };
    match parsed {
        Some(number) if rounded(number).is_finite() => Read::Good(number),
        Some(number) if rounded(number).is_nan() => Read::Bad(value.span(), "is not a number".to_owned()),
        _ => Read::Bad(value.span(), "is too large for a 32-bit number".to_owned()),
    }
}

fn whole(value: Value<'_>) -> Read<i64> {
    match value.content {
        DeValue::Integer(whole) => i64::from_str_radix(whole.as_str(), whole.radix())
            .map_or_else(|_| Read::Bad(value.span(), "is too large".to_owned()), Read::Good),
        _ => Read::Other,
    }
}

fn vector(value: Value<'_>) -> Read<Vec3> {
    list(value, number).map(Vec3::from_array)
}

fn position(value: Value<'_>) -> Read<DVec3> {
    list(value, exact_number).map(DVec3::from_array)
}

fn factors(value: Value<'_>) -> Read<DVec3> {
    match value.content {
        DeValue::Array(_) => position(value),
        _ => exact_number(value).map(DVec3::splat),
    }
}

fn color(value: Value<'_>) -> Read<Vec3> {
    match value.content {
        DeValue::Array(_) => vector(value),
        _ => number(value).map(Vec3::splat),
    }
}

fn text(value: Value<'_>) -> Read<String> {
    value.content.as_str().map_or(Read::Other, |text| Read::Good(text.to_owned()))
}

fn flag(value: Value<'_>) -> Read<bool> {
    value.content.as_bool().map_or(Read::Other, Read::Good)
}

fn matrix(value: Value<'_>) -> Read<[[f64; 4]; 4]> {
    list(value, |row| list(row, exact_number))
}

/// Exactly N items.
fn list<T: Copy + Default, const N: usize>(value: Value<'_>, read: fn(Value<'_>) -> Read<T>) -> Read<[T; N]> {
    let Some(items) = value.items() else { return Read::Other };
    if items.len() != N {
        return Read::Bad(value.span(), format!("has {} items instead of {N}", items.len()));
    }
    let mut all = [T::default(); N];
    for (place, item) in all.iter_mut().zip(items) {
        match read(item) {
            Read::Good(good) => *place = good,
            Read::Other => return Read::Bad(item.span(), format!("holds {}", item.kind())),
            Read::Bad(span, message) => return Read::Bad(span, message),
        }
    }
    Read::Good(all)
}

impl<T> Read<T> {
    fn map<U>(self, change: impl FnOnce(T) -> U) -> Read<U> {
        match self {
            Self::Good(good) => Read::Good(change(good)),
            Self::Other => Read::Other,
            Self::Bad(span, message) => Read::Bad(span, message),
        }
    }
}
