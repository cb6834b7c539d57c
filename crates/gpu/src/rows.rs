//! The original's first pass needs its rows one after the other: where a row's draws begin depends on the hits before
//! it.

use crate::engine::Engine;
use crate::records::RowParams;
use lightcuts_render::device::{DeviceFault, View, original_shift};

/// Initial state of the original's generator.
const SEED: u32 = 1;

impl Engine {
    /// The shifts of all pixels, bottom row first. Rows are dispatches that follow one another without waiting.
    pub(crate) fn original_shifts(&mut self, view: &View<'_>) -> Result<Vec<[f32; 2]>, DeviceFault> {
        let (width, height) = (view.camera.width, view.camera.height);
        self.require_rounds_of_trees(view.max_depth, "rows of such deep ray trees")?;
        self.allocate("row_starts", u64::from(height + 1) * 4)?;
        self.allocate("shifts", u64::from(width) * u64::from(height) * 8)?;
        let params = RowParams {
            camera: view.camera,
            row: 0,
            max_depth: view.max_depth,
            seed: SEED,
            padding: 0,
            shifts: std::array::from_fn(|draw| original_shift(draw as u32)),
        };
        for row in 0..height {
            let params = RowParams { row, ..params };
            self.run("draw_row", &params, width, f64::from(width))?;
        }
        self.read_as("shifts", (width * height) as usize)
    }
}
