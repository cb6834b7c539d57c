//! Pixels that are no numbers.

use rayon::prelude::*;

use crate::{Image, ImageError};

/// How many pixels of two pictures hold a NaN or an infinity in at least one channel.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct NonFinite {
    /// Pixels of the reference.
    pub reference: usize,
    /// Pixels of the test picture.
    pub test: usize,
}

impl NonFinite {
    /// Counts both pictures. Fails with [`ImageError::SizeMismatch`].
    pub fn count(reference: &Image, test: &Image) -> Result<Self, ImageError> {
        reference.expect_size_of(test, "the test picture")?;
        Ok(Self { reference: count(reference), test: count(test) })
    }

    /// Pixels of both pictures; one that fails in both counts twice.
    pub fn total(self) -> usize {
        self.reference + self.test
    }
}

fn count(image: &Image) -> usize {
    image.pixels().par_iter().filter(|pixel| !pixel.iter().all(|value| value.is_finite())).count()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pixels_are_counted_not_channels() {
        let mut test = Image::filled(7, 5, [0.5; 3]);
        test.set(6, 4, [f32::NAN, f32::INFINITY, 1.0]);
        test.set(0, 0, [0.0, 0.0, f32::NEG_INFINITY]);
        let mut reference = Image::new(7, 5);
        reference.set(6, 4, [f32::NAN; 3]);
        let found = NonFinite::count(&reference, &test).unwrap();
        assert_eq!(found, NonFinite { reference: 1, test: 2 });
        assert_eq!(found.total(), 3);
        assert!(NonFinite::count(&reference, &Image::new(5, 7)).is_err());
    }
}
