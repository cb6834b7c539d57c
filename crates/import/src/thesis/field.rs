//! A directive's fields, taken out by name; what is missing or left over is reported.

use crate::report::Report;
use crate::source::Source;
use glam::Vec3;
use std::cell::Cell;
use std::ops::Range;

/// Brackets around numbers. Numbers without any count as round ones.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Bracket {
    Curly,
    Round,
}

/// A number and its place.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Number {
    pub(super) value: f32,
    pub(super) span: Range<usize>,
}

/// What follows a field's name.
#[derive(Debug, Clone, PartialEq)]
pub(super) enum Value<'t> {
    /// Nothing.
    Word,
    /// Numbers; the angle is only there after `ROT{}`.
    Numbers { bracket: Bracket, numbers: Vec<Number>, angle: Option<Number> },
    /// A file name, with a mode after it for textures.
    Text { text: &'t str, mode: Option<&'t str> },
}

/// A name with its value.
#[derive(Debug)]
pub(super) struct Field<'t> {
    pub(super) name: &'t str,
    pub(super) span: Range<usize>,
    pub(super) value: Value<'t>,
    used: Cell<bool>,
}

/// A directive's letter, in upper case, and its fields.
#[derive(Debug)]
pub(super) struct Directive<'t> {
    pub(super) letter: char,
    pub(super) span: Range<usize>,
    pub(super) fields: Vec<Field<'t>>,
}

/// A field as the format defines it: name, form and how it is written.
#[derive(Debug, Clone, Copy)]
pub(super) struct Spec {
    pub(super) name: &'static str,
    pub(super) bracket: Bracket,
    pub(super) count: usize,
    pub(super) example: &'static str,
}

/// A field `NAME{x, y, z}`.
pub(super) const fn vector(name: &'static str, example: &'static str) -> Spec {
    Spec { name, bracket: Bracket::Curly, count: 3, example }
}

/// A field `NAME(v)`.
pub(super) const fn scalar(name: &'static str, example: &'static str) -> Spec {
    Spec { name, bracket: Bracket::Round, count: 1, example }
}

impl<'t> Field<'t> {
    pub(super) fn new(name: &'t str, span: Range<usize>, value: Value<'t>) -> Self {
        Self { name, span, value, used: Cell::new(false) }
    }

    pub(super) fn is(&self, name: &str) -> bool {
        self.name.eq_ignore_ascii_case(name)
    }

    /// Whether the field has the name and brackets of `spec`.
    pub(super) fn matches(&self, spec: Spec) -> bool {
        self.is(spec.name) && matches!(&self.value, Value::Numbers { bracket, .. } if *bracket == spec.bracket)
    }

    /// Whether two fields are written alike, apart from their names.
    fn has_form_of(&self, other: &Field<'_>) -> bool {
        match (&self.value, &other.value) {
            (Value::Numbers { bracket, .. }, Value::Numbers { bracket: other, .. }) => bracket == other,
            (own, other) => std::mem::discriminant(own) == std::mem::discriminant(other),
        }
    }

    /// The field's numbers; none for other values.
    pub(super) fn numbers(&self) -> &[Number] {
        match &self.value {
            Value::Numbers { numbers, .. } => numbers,
            _ => &[],
        }
    }
}

impl<'t> Directive<'t> {
    pub(super) fn new(letter: char, span: Range<usize>, fields: Vec<Field<'t>>) -> Self {
        Self { letter, span, fields }
    }

    /// The first unused field that `wanted` likes; it counts as used from now on.
    pub(super) fn take(&self, wanted: impl Fn(&Field<'t>) -> bool) -> Option<&Field<'t>> {
        let field = self.fields.iter().find(|field| !field.used.get() && wanted(field))?;
        field.used.set(true);
        Some(field)
    }

    /// The first of `words` that stands alone as a field.
    pub(super) fn take_word<T: Copy>(&self, words: &[(&str, T)]) -> Option<T> {
        let meaning = |field: &Field<'_>| words.iter().find(|(word, _)| field.is(word)).map(|(_, meaning)| *meaning);
        let field = self.take(|field| field.value == Value::Word && meaning(field).is_some())?;
        meaning(field)
    }
}

/// Reads the fields of one directive and reports to the import's report.
pub(super) struct Reader<'a, 't> {
    pub(super) directive: &'a Directive<'t>,
    pub(super) source: &'a Source<'t>,
    pub(super) report: &'a mut Report,
}

impl<'a, 't> Reader<'a, 't> {
    /// Adds an error at `span`.
    pub(super) fn error(&mut self, span: Range<usize>, message: &str, expected: &str) {
        self.report.error(|| self.source.fault(span, message).expected(expected));
    }

    /// Adds a warning at `span`.
    pub(super) fn warn(&mut self, span: Range<usize>, message: &str) {
        self.report.warn(|| self.source.fault(span, message));
    }

    /// The numbers of a field; `None` if it is absent, or (reported) if it has another count of numbers.
    fn numbers(&mut self, spec: Spec) -> Option<&'a Field<'t>> {
        let field = self.directive.take(|field| field.matches(spec))?;
        if field.numbers().len() == spec.count {
            return Some(field);
        }
        let message = format!("{} has {} numbers instead of {}", spec.name, field.numbers().len(), spec.count);
        self.error(field.span.clone(), &message, spec.example);
        None
    }

    /// A field that must be there; `None` after an error was reported.
    pub(super) fn required(&mut self, spec: Spec) -> Option<&'a Field<'t>> {
        if self.directive.fields.iter().any(|field| field.matches(spec) && !field.used.get()) {
            return self.numbers(spec);
        }
        let other = self.directive.take(|field| field.is(spec.name) && field.numbers().len() == spec.count);
        match other {
            Some(field) => {
                self.error(field.span.clone(), &format!("{} has the wrong brackets", spec.name), spec.example);
            }
            None => self.missing(spec.name, spec.example),
        }
        None
    }

    /// Reports that a field is missing.
    pub(super) fn missing(&mut self, name: &str, example: &str) {
        self.error(self.directive.span.clone(), &format!("{name} is missing"), example);
    }

    /// Three numbers that must be there.
    pub(super) fn vector(&mut self, spec: Spec) -> Option<Vec3> {
        self.required(spec).map(|field| to_vec3(field.numbers()))
    }

    /// One number that must be there.
    pub(super) fn scalar(&mut self, spec: Spec) -> Option<f32> {
        self.required(spec).and_then(|field| field.numbers().first()).map(|number| number.value)
    }

    /// The value of an optional field, or `default`; `None` if it is there but wrong.
    pub(super) fn optional<T>(&mut self, spec: Spec, default: T, read: impl Fn(&[Number]) -> T) -> Option<T> {
        if !self.directive.fields.iter().any(|field| field.is(spec.name) && !field.used.get()) {
            return Some(default);
        }
        self.required(spec).map(|field| read(field.numbers()))
    }

    /// A switch `NAME(0)` or `NAME(1)`; on if absent.
    pub(super) fn switch(&mut self, spec: Spec) -> Option<bool> {
        let value = self.optional(spec, 1.0, |numbers| numbers[0].value)?;
        if value == 0.0 || value == 1.0 {
            return Some(value == 1.0);
        }
        let field = self.directive.fields.iter().find(|field| field.matches(spec))?;
        self.error(field.span.clone(), &format!("{} is {value}", spec.name), &format!("{}(0) or {0}(1)", spec.name));
        None
    }

    /// Warns about every field that nobody took.
    pub(super) fn warn_unused(&mut self) {
        for field in self.directive.fields.iter().filter(|field| !field.used.get()) {
            self.report.warn(|| {
                let twin = |other: &Field<'_>| other.used.get() && other.is(field.name) && other.has_form_of(field);
                let again = self.directive.fields.iter().any(twin);
                let reason = if again { "is given twice, the first counts" } else { "is not known here" };
                self.source.fault(field.span.clone(), &format!("unused field: {} {reason}", field.name))
            });
        }
    }
}

/// A vector from three numbers.
pub(super) fn to_vec3(numbers: &[Number]) -> Vec3 {
    Vec3::new(numbers[0].value, numbers[1].value, numbers[2].value)
}
