//! Bloom on the device.

use crate::engine::Engine;
use crate::records::BloomParams;
use lightcuts_image::Image;
use lightcuts_render::device::DeviceFault;

impl Engine {
    /// The picture with bloom; see [`lightcuts_image::bloom`].
    pub(crate) fn bloom(&mut self, image: &Image, radius: f32, weight: f32) -> Result<Image, DeviceFault> {
        if !(radius > 0.0 && weight > 0.0) || image.is_empty() {
            return Ok(image.clone());
        }
        let (width, height) = (image.width() as u32, image.height() as u32);
        let reach = (radius.ceil() as u32).saturating_sub(1).min(width.max(height));
        self.require_rounds(u64::from(2 * reach + 1).pow(2), "bloom of this radius")?;
        self.upload_picture(image)?;
        let taps = f64::from(2 * reach + 1).powi(2) / 64.0;
        self.over("bloom", width * height, taps, |engine, first, count| {
            let params = BloomParams { first, count, width, height, radius, weight, reach, padding: 0 };
            engine.run("bloom", &params, count, f64::from(count) * taps)
        })?;
        let bloomed = self.read_picture(image)?;
        // A pixel that is no number keeps what it is; only its neighbours take it as black.
        Ok(Image::from_fn(image.width(), image.height(), |x, y| {
            let own = image.get(x, y);
            if own.iter().all(|value| value.is_finite()) { bloomed.get(x, y) } else { own }
        }))
    }

    /// Brings a picture to the device, values that are no numbers as 0, and makes room for another.
    pub(crate) fn upload_picture(&mut self, image: &Image) -> Result<(), DeviceFault> {
        let finite = |value: f32| if value.is_finite() { value } else { 0.0 };
        let pixels: Vec<[f32; 4]> =
            image.pixels().iter().map(|[r, g, b]| [finite(*r), finite(*g), finite(*b), 0.0]).collect();
        self.upload("picture", &pixels)?;
        self.allocate("bloomed", pixels.len() as u64 * 16)
    }

    /// The picture that was made, of the size of `image`.
    pub(crate) fn read_picture(&mut self, image: &Image) -> Result<Image, DeviceFault> {
        let pixels: Vec<[f32; 4]> = self.read_as("bloomed", image.pixels().len())?;
        Ok(Image::from_fn(image.width(), image.height(), |x, y| {
            let [r, g, b, _] = pixels[y * image.width() + x];
            [r, g, b]
        }))
    }
}
