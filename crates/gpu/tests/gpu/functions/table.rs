//! The table's rows.

use crate::functions::case::Case;

/// A function on both sides.
pub(crate) struct Row {
    /// Its name in WGSL.
    pub(crate) name: &'static str,
    /// WGSL that reads the arguments and writes the result; `None` for a plain call.
    pub(crate) statements: Option<&'static str>,
    /// The same in Rust.
    pub(crate) run: fn(&Case<'_>),
    /// Units in the last place by which a card may be off. Software drivers may not be.
    pub(crate) ulps: u32,
}

/// Cards: some operations of half a unit each, divisions and roots of up to 2.5.
const CARD_ULPS: u32 = 16;

/// A function that is called in the same way on both sides.
pub(crate) const fn twin(name: &'static str, run: fn(&Case<'_>)) -> Row {
    Row { name, statements: None, run, ulps: CARD_ULPS }
}

/// A function whose result has another form in Rust.
pub(crate) const fn unlike(name: &'static str, statements: &'static str, run: fn(&Case<'_>)) -> Row {
    Row { name, statements: Some(statements), run, ulps: CARD_ULPS }
}
