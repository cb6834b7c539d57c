//! What counts as equal.
//!
//! A software driver computes each operation as the processor does: results are compared bit by bit, signs of zeros
//! included. Cards may fuse multiplications with additions and round divisions and roots otherwise. There a result is also
//! taken if it is within a row's units in the last place, or if Rust gives it, or results on either side of it, for
//! arguments moved by [`MOVE`]: a decision near its threshold, or a difference of almost equal numbers. Corners lie on
//! thresholds that moving them does not cross; one case in [`CARD_FLIPS`] may therefore differ by more.
//!
//! Excluded everywhere: cases with a subnormal, infinite or NaN float among arguments or Rust's results. Devices may take
//! subnormals as zeros and need not know the others.

use crate::functions::case::Case;
use crate::functions::table::Row;
use crate::functions::tables::Tables;
use crate::functions::word::Word;
use std::fmt::Write as _;

/// Relative move of arguments that cards may answer for: eight units in the last place.
const MOVE: f32 = 1e-6;

/// Moved arguments that are tried.
const MOVES: u32 = 64;

/// Of how many cases one may differ by more on cards.
pub(crate) const CARD_FLIPS: usize = 256;

/// Arguments and results of a case in Rust.
pub(crate) struct Called {
    pub(crate) inputs: Vec<Word>,
    pub(crate) outputs: Vec<Word>,
}

impl Called {
    pub(crate) fn new(case: &Case<'_>, row: &Row) -> Self {
        (row.run)(case);
        Self { inputs: case.inputs.take(), outputs: case.outputs.take() }
    }

    pub(crate) fn result(&self) -> Vec<u32> {
        self.outputs.iter().map(|word| word.bits()).collect()
    }

    /// A word of the result. A function that gives fewer words than it could leaves zeros on the device.
    fn output(&self, place: usize) -> Word {
        self.outputs.get(place).copied().unwrap_or(Word::Whole(0))
    }
}

/// A case with the results of both sides.
pub(crate) struct Trial<'t> {
    pub(crate) row: &'t Row,
    pub(crate) tables: &'t Tables,
    pub(crate) is_software: bool,
    pub(crate) number: u32,
    pub(crate) called: &'t Called,
    pub(crate) found: &'t [u32],
}

/// What came of a case.
pub(crate) enum Verdict {
    Excluded,
    /// Units in the last place.
    Within(u32),
    /// Rust gives it for moved arguments.
    Marginal,
    Wrong(String),
}

impl Trial<'_> {
    pub(crate) fn verdict(&self) -> Verdict {
        let Called { inputs, outputs } = self.called;
        if !inputs.iter().chain(outputs).all(|word| word.is_ordinary()) {
            return Verdict::Excluded;
        }
        let worst = (0..self.found.len()).map(|place| self.ulps(place)).max().unwrap_or_default();
        match worst {
            0 => Verdict::Within(0),
            _ if self.is_software => Verdict::Wrong(self.complaint()),
            _ if worst <= self.row.ulps => Verdict::Within(worst),
            _ if self.is_near() => Verdict::Marginal,
            _ => Verdict::Wrong(self.complaint()),
        }
    }

    fn ulps(&self, place: usize) -> u32 {
        ulps(self.called.output(place), self.found[place])
    }

    /// Whether each word lies among Rust's results for moved arguments.
    fn is_near(&self) -> bool {
        let near: Vec<Called> = (0..MOVES).map(|k| self.call_moved(k)).collect();
        (0..self.found.len()).all(|place| {
            let words = || near.iter().chain([self.called]).map(|called| called.output(place));
            let found = self.found[place];
            words().any(|word| ulps(word, found) <= self.row.ulps) || is_among(words(), f32::from_bits(found))
        })
    }

    fn call_moved(&self, k: u32) -> Called {
        let chance = Case::new(self.tables, self.number * MOVES + k);
        let moved = |word: &Word| match word {
            Word::Float(value) => Word::Float(value * (1.0 + MOVE * (2.0 * chance.random() - 1.0))),
            Word::Whole(_) => *word,
        };
        let inputs: Vec<_> = self.called.inputs.iter().map(moved).collect();
        Called::new(&Case::given(self.tables, self.number, &inputs), self.row)
    }

    fn complaint(&self) -> String {
        let mut text = format!("{}, case {}:\n  of {:?}\n", self.row.name, self.number, self.called.inputs);
        for place in (0..self.found.len()).filter(|&place| self.ulps(place) > 0) {
            let (expected, bits, ulps) = (self.called.output(place), self.found[place], self.ulps(place));
            let as_float = f32::from_bits(bits);
            let _ = writeln!(text, "  word {place}: {expected:?} but {as_float:e} ({bits:#x}), {ulps} ULP");
        }
        text
    }
}

/// Units in the last place between floats; for whole numbers 0 or [`u32::MAX`].
fn ulps(expected: Word, found: u32) -> u32 {
    let place = |bits: u32| if bits >> 31 == 0 { i64::from(bits) } else { -i64::from(bits & 0x7fff_ffff) - 1 };
    match expected {
        Word::Float(value) => (place(value.to_bits()) - place(found)).unsigned_abs() as u32,
        Word::Whole(value) if value == found => 0,
        Word::Whole(_) => u32::MAX,
    }
}

/// Whether a number lies within the range of floats, widened by as much on either side.
fn is_among(words: impl Iterator<Item = Word>, value: f32) -> bool {
    let floats = words.filter_map(|word| if let Word::Float(float) = word { Some(float) } else { None });
    let (least, greatest) = floats.fold((f32::MAX, f32::MIN), |(a, b), x| (a.min(x), b.max(x)));
    let width = greatest - least;
    value >= least - width && value <= greatest + width
}
