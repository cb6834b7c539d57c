//! A case: arguments are drawn as Rust asks for them and recorded as words for the device.

use crate::functions::tables::Tables;
use crate::functions::word::{Word, Words};
use glam::Vec3;
use lightcuts_kernel::rng::random4;
use std::cell::{Cell, RefCell};

/// One call of a function, on Rust's side.
pub(crate) struct Case<'t> {
    /// What functions read besides their arguments.
    pub(crate) tables: &'t Tables,
    /// Number of the case; its lowest digits choose how values are spread.
    pub(crate) number: u32,
    drawn: Cell<u32>,
    /// Arguments to be used instead of drawn ones, and the first that is left.
    given: Option<(&'t [Word], Cell<usize>)>,
    pub(crate) inputs: RefCell<Vec<Word>>,
    pub(crate) outputs: RefCell<Vec<Word>>,
    /// The last direction and the last point, so that others can coincide with them.
    pub(crate) last: [Cell<Vec3>; 2],
}

impl<'t> Case<'t> {
    pub(crate) fn new(tables: &'t Tables, number: u32) -> Self {
        Self {
            tables,
            number,
            drawn: Cell::new(0),
            given: None,
            inputs: RefCell::default(),
            outputs: RefCell::default(),
            last: [Cell::new(Vec3::X), Cell::new(Vec3::ZERO)],
        }
    }

    /// A case with these arguments.
    pub(crate) fn given(tables: &'t Tables, number: u32, inputs: &'t [Word]) -> Self {
        Self { given: Some((inputs, Cell::new(0))), ..Self::new(tables, number) }
    }

    /// A number in 0..1 that is no argument.
    pub(crate) fn random(&self) -> f32 {
        random4(self.number, self.drawn.replace(self.drawn.get() + 1), 0, SEED)[0]
    }

    /// A whole number below `count` that is no argument.
    pub(crate) fn choice(&self, count: usize) -> usize {
        ((self.random() * count as f32) as usize).min(count - 1)
    }

    /// An argument.
    pub(crate) fn take<T: Words>(&self, draw: impl FnOnce() -> T) -> T {
        let drawn = draw();
        let mut inputs = self.inputs.borrow_mut();
        let Some((given, at)) = &self.given else {
            drawn.write(&mut inputs);
            return drawn;
        };
        T::read(&mut || given[at.replace(at.get() + 1)].bits())
    }

    /// A result.
    pub(crate) fn put(&self, value: impl Words + Copy) {
        value.write(&mut self.outputs.borrow_mut());
    }
}

/// Seed of all cases.
const SEED: u32 = 20_261;
