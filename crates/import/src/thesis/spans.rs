//! From the issues of a finished scene back to the fields that caused them.

use super::field::{Bracket, Directive, Value};
use super::scan::{Item, Scanner};
use std::ops::Range;

/// Which field of a directive, and which of its numbers, becomes a field of the scene.
const ORIGINS: [(&str, &str, Bracket, Option<usize>); 36] = [
    ("background", "BK", Bracket::Curly, None),
    ("distance", "PERS", Bracket::Round, None),
    ("view", "V", Bracket::Curly, None),
    ("up", "U", Bracket::Curly, None),
    ("attenuation", "ATTEN", Bracket::Round, None),
    ("specular", "S", Bracket::Curly, None),
    ("diffuse", "D", Bracket::Curly, None),
    ("ambient", "A", Bracket::Curly, None),
    ("exponent", "SH", Bracket::Round, None),
    ("reflection", "FRKE", Bracket::Curly, Some(0)),
    ("refraction", "FRKE", Bracket::Curly, Some(1)),
    ("refraction_ratio", "FRKE", Bracket::Curly, Some(2)),
    ("local", "FRKE", Bracket::Curly, Some(3)),
    ("texture", "TEX", Bracket::Curly, None),
    ("position", "POS", Bracket::Curly, None),
    ("direction", "DIR", Bracket::Curly, None),
    ("center", "C", Bracket::Curly, None),
    ("normal", "N", Bracket::Curly, None),
    ("head", "H", Bracket::Curly, None),
    ("width", "W", Bracket::Round, None),
    ("height", "H", Bracket::Round, None),
    ("spacing", "DS", Bracket::Round, None),
    ("radius", "R", Bracket::Round, None),
    ("length", "L", Bracket::Round, None),
    ("vertical", "V", Bracket::Curly, None),
    ("horizontal", "H", Bracket::Curly, None),
    ("translation", "TRAN", Bracket::Curly, None),
    ("scale", "SCAL", Bracket::Curly, None),
    ("scale", "SCAL", Bracket::Round, None),
    ("axis", "ROT", Bracket::Curly, None),
    ("degrees", "ROT", Bracket::Curly, None),
    ("mesh", "PATH", Bracket::Curly, None),
    ("positions", "PATH", Bracket::Curly, None),
    ("triangles", "PATH", Bracket::Curly, None),
    ("texels", "TEX", Bracket::Curly, None),
    ("material", "FRKE", Bracket::Curly, None),
];

/// The place of the scene's `field` in the directive that starts at byte `start`, and how the text calls the field.
///
/// The directive is read once more: keeping every field's place would double the memory of large scenes.
pub(super) fn find(text: &str, start: usize, field: &str) -> (Range<usize>, Option<&'static str>) {
    match Scanner::new(text, start).next_item() {
        Some(Item::Directive(directive)) => find_in(&directive, field),
        _ => (start..start + 1, None),
    }
}

fn find_in(directive: &Directive<'_>, name: &str) -> (Range<usize>, Option<&'static str>) {
    for (_, text_name, bracket, component) in ORIGINS.iter().filter(|(field, ..)| *field == name) {
        let fits = |value: &Value<'_>| match value {
            Value::Numbers { bracket: found, .. } => found == bracket,
            Value::Text { .. } => true,
            Value::Word => false,
        };
        if let Some(field) = directive.fields.iter().find(|field| field.is(text_name) && fits(&field.value)) {
            let number = component.and_then(|i| field.numbers().get(i));
            return (number.map_or(field.span.clone(), |number| number.span.clone()), Some(text_name));
        }
    }
    (directive.span.clone(), None)
}
