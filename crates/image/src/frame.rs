//! Where the pixels of a picture lie in the frame that they were made for.

use std::fmt;

/// A rectangle of pixels on the plane that both windows of an EXR file lie in.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Window {
    /// First column.
    pub x: i32,
    /// First row, counted downwards.
    pub y: i32,
    /// Columns.
    pub width: usize,
    /// Rows.
    pub height: usize,
}

/// The two windows of an EXR file: the pixels are those of the data window, the frame is the display window. In the other
/// formats both are the whole picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Frame {
    /// Where the pixels are.
    pub data: Window,
    /// What was to be shown.
    pub display: Window,
}

impl Frame {
    /// Of a picture that fills its frame.
    pub fn whole(width: usize, height: usize) -> Self {
        let window = Window { x: 0, y: 0, width, height };
        Self { data: window, display: window }
    }

    /// Whether the pixels fill the frame.
    pub fn is_whole(&self) -> bool {
        self.data == self.display
    }

    /// Whether the pixels of both lie in the same places of frames of one size.
    pub fn matches(&self, other: &Self) -> bool {
        let size = |window: Window| (window.width, window.height);
        self.offset() == other.offset()
            && size(self.data) == size(other.data)
            && size(self.display) == size(other.display)
    }

    /// Column and row of the frame where the pixels begin.
    fn offset(&self) -> (i64, i64) {
        let Self { data, display } = self;
        (i64::from(data.x) - i64::from(display.x), i64::from(data.y) - i64::from(display.y))
    }
}

impl fmt::Display for Frame {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        let (column, row) = self.offset();
        let Self { data, display } = self;
        write!(
            formatter,
            "{} x {} at column {column}, row {row} of a display window of {} x {}",
            data.width, data.height, display.width, display.height
        )
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn frame(data: [i32; 2], display: [i32; 2], side: usize) -> Frame {
        let window = |[x, y]: [i32; 2], side| Window { x, y, width: side, height: side };
        Frame { data: window(data, 8), display: window(display, side) }
    }

    #[test]
    fn places_are_those_in_the_frame() {
        let crop = frame([5, 6], [0, 0], 40);
        assert!(crop.matches(&frame([-5, 16], [-10, 10], 40)), "the frame itself may lie anywhere");
        assert!(!crop.matches(&frame([6, 6], [0, 0], 40)));
        assert!(!crop.matches(&frame([5, 6], [0, 0], 41)));
        assert!(!crop.matches(&Frame::whole(8, 8)));
        assert!(frame([3, 4], [3, 4], 8).matches(&Frame::whole(8, 8)));
        assert!(
            frame([i32::MIN, 0], [i32::MAX, 0], 8).to_string().starts_with("8 x 8 at column -4294967295, row 0 of")
        );
    }
}
