//! Pictures in memory: a rectangle of pixels in one flat list.

use crate::ImageError;

/// A picture in linear RGB. No colour management: the values are the renderer's own, without a display transfer.
pub type Image = Plane<[f32; 3]>;

/// A rectangle of `width * height` pixels; row 0 is the TOP row, x runs to the right.
///
/// `Plane<[f32; 3]>` is an [`Image`]; one-channel AOVs are `Plane<f32>` (depth, counts) and `Plane<u32>` (ids).
#[derive(Clone, Debug, PartialEq)]
pub struct Plane<T> {
    width: usize,
    height: usize,
    pixels: Vec<T>,
}

impl<T: Copy> Plane<T> {
    /// A picture of `width * height` pixels that all have one value.
    pub fn filled(width: usize, height: usize, value: T) -> Self {
        Self { width, height, pixels: vec![value; width * height] }
    }

    /// A picture whose pixel (x, y) is `pixel(x, y)`, evaluated row by row from the top.
    pub fn from_fn(width: usize, height: usize, mut pixel: impl FnMut(usize, usize) -> T) -> Self {
        let mut pixels = Vec::with_capacity(width * height);
        for y in 0..height {
            pixels.extend((0..width).map(|x| pixel(x, y)));
        }
        Self { width, height, pixels }
    }

    /// A picture from its pixels, row by row from the top.
    ///
    /// Fails with [`ImageError::PixelCount`] unless there are exactly `width * height` of them.
    pub fn from_pixels(width: usize, height: usize, pixels: Vec<T>) -> Result<Self, ImageError> {
        if width.checked_mul(height) != Some(pixels.len()) {
            return Err(ImageError::PixelCount { width, height, length: pixels.len() });
        }
        Ok(Self { width, height, pixels })
    }

    /// Width in pixels.
    pub fn width(&self) -> usize {
        self.width
    }

    /// Height in pixels.
    pub fn height(&self) -> usize {
        self.height
    }

    /// Whether the picture has no pixel.
    pub fn is_empty(&self) -> bool {
        self.pixels.is_empty()
    }

    /// The pixel in column `x` of row `y`. Panics outside the picture, as indexing a slice does.
    pub fn get(&self, x: usize, y: usize) -> T {
        self.row(y)[x]
    }

    /// Replaces the pixel in column `x` of row `y`. Panics outside the picture, as indexing a slice does.
    pub fn set(&mut self, x: usize, y: usize, value: T) {
        self.row_mut(y)[x] = value;
    }

    /// Row `y`, counted from the top, `width` pixels.
    pub fn row(&self, y: usize) -> &[T] {
        &self.pixels[y * self.width..][..self.width]
    }

    /// Row `y`, counted from the top, to be changed.
    pub fn row_mut(&mut self, y: usize) -> &mut [T] {
        &mut self.pixels[y * self.width..][..self.width]
    }

    /// All rows from the top.
    pub fn rows(&self) -> impl ExactSizeIterator<Item = &[T]> {
        self.pixels.chunks_exact(self.width.max(1))
    }

    /// All pixels, row by row from the top.
    pub fn pixels(&self) -> &[T] {
        &self.pixels
    }

    /// All pixels, row by row from the top, to be changed.
    pub fn pixels_mut(&mut self) -> &mut [T] {
        &mut self.pixels
    }

    /// The list of pixels, row by row from the top.
    pub fn into_pixels(self) -> Vec<T> {
        self.pixels
    }

    /// A picture of the same size whose pixels are `change(pixel)`.
    pub fn map<U: Copy>(&self, change: impl FnMut(T) -> U) -> Plane<U> {
        let pixels = self.pixels.iter().copied().map(change).collect();
        Plane { width: self.width, height: self.height, pixels }
    }

    /// Fails with [`ImageError::SizeMismatch`] unless `other` has the size of `self`; `what` names `other`.
    pub(crate) fn expect_size_of<U: Copy>(&self, other: &Plane<U>, what: &str) -> Result<(), ImageError> {
        if (self.width, self.height) == (other.width, other.height) {
            return Ok(());
        }
        Err(ImageError::SizeMismatch {
            what: what.to_owned(),
            expected_width: self.width,
            expected_height: self.height,
            width: other.width,
            height: other.height,
        })
    }
}

impl<T: Copy + Default> Plane<T> {
    /// A picture of `width * height` zeros: a black image.
    pub fn new(width: usize, height: usize) -> Self {
        Self::filled(width, height, T::default())
    }
}

/// Relative luminance of linear RGB with the Rec. 709 primaries (thesis section 7; weights of PBRT 1st edition).
pub fn luminance(rgb: [f32; 3]) -> f32 {
    luminance_f64(rgb) as f32
}

/// [`luminance`] before its rounding to f32; the sum of three greatest floats does not overflow here.
pub(crate) fn luminance_f64([r, g, b]: [f32; 3]) -> f64 {
    0.212_671 * f64::from(r) + 0.715_160 * f64::from(g) + 0.072_169 * f64::from(b)
}

/// The pixel with every NaN and infinity replaced by 0, so that no operator spreads them.
pub(crate) fn finite_or_zero(rgb: [f32; 3]) -> [f32; 3] {
    rgb.map(|value| if value.is_finite() { value } else { 0.0 })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rows_run_from_the_top_and_pixels_to_the_right() {
        let mut plane = Plane::from_fn(3, 2, |x, y| (10 * y + x) as u32);
        assert_eq!(plane.row(1), [10, 11, 12]);
        assert_eq!(plane.rows().len(), 2);
        plane.set(2, 0, 99);
        assert_eq!(plane.get(2, 0), 99);
        assert_eq!(plane.into_pixels(), [0, 1, 99, 10, 11, 12]);
    }

    #[test]
    fn a_pixel_list_of_the_wrong_length_is_refused() {
        let error = Image::from_pixels(2, 2, vec![[0.0; 3]; 3]).unwrap_err();
        assert_eq!(error.to_string(), "a picture of 2 x 2 pixels cannot hold a list of 3 pixels");
        assert!(Plane::<u32>::from_pixels(usize::MAX, 2, vec![]).is_err());
    }

    #[test]
    fn an_empty_plane_has_no_rows() {
        assert_eq!(Image::new(0, 0).rows().len(), 0);
        assert!(Image::new(0, 5).is_empty());
    }

    #[test]
    fn luminance_of_white_is_one() {
        assert!((luminance([1.0; 3]) - 1.0).abs() < 1e-6);
    }
}
