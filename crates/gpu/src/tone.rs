//! Tone mapping on the device, in single precision; `lightcuts-image` says what is meant, in double precision.

use crate::engine::Engine;
use crate::records::ToneParams;
use bytemuck::Zeroable;
use lightcuts_image::{GlobalToneMapping, Image, LocalToneMapping, ToneMapping};
use lightcuts_render::device::DeviceFault;

/// Luminous efficacy of monochromatic light of 540 THz in lumen per watt.
const LUMINOUS_EFFICACY: f32 = 683.0;
/// Added before the logarithm (Reinhard et al. 2002, equation 1).
const LOG_DELTA: f32 = 1e-6;
/// Width of the smallest centre: two standard deviations are one pixel.
const CENTRE_WIDTH: f64 = 0.353_553_390_593_273_8;
/// A Gaussian is cut off at this many widths.
const GAUSSIAN_REACH: f64 = 3.0;

impl Engine {
    /// The picture after an operator; see [`ToneMapping::apply`].
    pub(crate) fn tone_map(&mut self, image: &Image, operator: &ToneMapping) -> Result<Image, DeviceFault> {
        if image.is_empty() {
            return Ok(image.clone());
        }
        match operator {
            ToneMapping::None => Ok(image.clone()),
            ToneMapping::Global(global) => self.tone_global(image, *global),
            ToneMapping::Local(local) => self.tone_local(image, local),
        }
    }

    fn tone_global(&mut self, image: &Image, operator: GlobalToneMapping) -> Result<Image, DeviceFault> {
        self.upload_picture(image)?;
        let white = self.measure(image)?.into_iter().fold(0.0, |white: f32, [y, _]| white.max(y));
        // A black picture stays black whatever its white is.
        let white = if white > 0.0 { white } else { 1.0 };
        let factor = LUMINOUS_EFFICACY / operator.max_display_luminance;
        self.over_pixels("tone_global", &ToneParams { white, factor, ..params(image) }, 1.0)?;
        self.read_picture(image)
    }

    fn tone_local(&mut self, image: &Image, operator: &LocalToneMapping) -> Result<Image, DeviceFault> {
        self.upload_picture(image)?;
        // Black pixels are left out.
        let lit = self.measure(image)?.into_iter().filter(|[y, _]| *y > 0.0);
        let (sum, count) = lit.fold((0.0, 0), |(sum, count), [_, log]| (sum + f64::from(log), count + 1));
        let average = if count == 0 { 1.0 } else { (sum / f64::from(count)).exp2() };
        let exposure = (f64::from(operator.key) / average) as f32;
        let bytes = image.pixels().len() as u64 * 4;
        for name in ["plane_in", "plane_out", "plane_luminance"] {
            self.allocate(name, bytes)?;
        }
        let params = ToneParams { factor: exposure, ..params(image) };
        self.over_pixels("expose", &params, 1.0)?;
        let luminance = self.buffer("plane_in");
        self.rename("plane_luminance", luminance);
        self.blur(image, CENTRE_WIDTH)?;
        self.over_pixels("begin_adaptation", &params, 1.0)?;
        let ratio = f64::from(operator.ratio);
        for scale in 0..operator.scales {
            let size = ratio.powi(scale as i32);
            // The surround of one scale is the centre of the next: both grow by the same ratio.
            let centre = self.buffer("plane_in");
            self.blur(image, CENTRE_WIDTH * size * ratio)?;
            let surround = self.buffer("plane_in");
            self.rename("plane_out", surround.clone());
            self.rename("plane_in", centre);
            let floor_ = (f64::from(operator.phi).exp2() * f64::from(operator.key) / (size * size)) as f32;
            self.over_pixels("adapt", &ToneParams { floor_, epsilon: operator.epsilon, ..params }, 1.0)?;
            self.rename("plane_in", surround);
        }
        self.over_pixels("tone_local", &params, 1.0)?;
        self.read_picture(image)
    }

    /// Luminance and its binary logarithm of every pixel.
    fn measure(&mut self, image: &Image) -> Result<Vec<[f32; 2]>, DeviceFault> {
        self.allocate("tone_pairs", image.pixels().len() as u64 * 8)?;
        self.over_pixels("measure", &ToneParams { epsilon: LOG_DELTA, ..params(image) }, 1.0)?;
        self.read_as("tone_pairs", image.pixels().len())
    }

    /// Blurs the luminance by a Gaussian `exp(-(d / width)^2)` into a new `plane_in`: rows, then columns.
    fn blur(&mut self, image: &Image, width: f64) -> Result<(), DeviceFault> {
        let longest = image.width().max(image.height());
        let reach = ((GAUSSIAN_REACH * width).ceil() as usize).min(longest - 1);
        let weights: Vec<f32> = (0..=reach).map(|distance| (-(distance as f64 / width).powi(2)).exp() as f32).collect();
        self.require_rounds(reach as u64, "tone mapping of such a picture")?;
        self.upload("blur_weights", &weights)?;
        let bytes = image.pixels().len() as u64 * 4;
        let source = self.buffer("plane_luminance");
        self.rename("plane_in", source);
        let rows = ToneParams { reach: reach as u32, ..params(image) };
        let columns = ToneParams { width: rows.height, height: rows.width, ..rows };
        for params in [rows, columns] {
            self.allocate("plane_out", bytes)?;
            self.over_pixels("blur_transposed", &params, reach as f64 / 32.0 + 1.0)?;
            let blurred = self.buffer("plane_out");
            self.rename("plane_in", blurred);
        }
        // No program may be given one buffer twice.
        self.allocate("plane_out", bytes)
    }

    fn over_pixels(&mut self, entry: &'static str, params: &ToneParams, units: f64) -> Result<(), DeviceFault> {
        self.over(entry, params.width * params.height, units, |engine, first, count| {
            let params = ToneParams { first, count, ..*params };
            engine.run(entry, &params, count, f64::from(count) * units)
        })
    }
}

fn params(image: &Image) -> ToneParams {
    ToneParams { width: image.width() as u32, height: image.height() as u32, ..ToneParams::zeroed() }
}
