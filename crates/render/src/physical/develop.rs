//! Station 6: the picture that a render's sums make, and how far it may be from the truth.

use super::mixture::{Canvas, MOST_TECHNIQUES, Mixture};
use super::rendering::Aovs;
use super::sketch::{Glimpse, Sketch, Source};
use super::sums::PixelSums;
use crate::film::Film;
use bytemuck::Zeroable;
use glam::{DVec3, Vec3};
use lightcuts_image::{Image, Plane};
use rayon::prelude::*;
use rayon::slice::ChunksMut;

/// Pixels of which an error is estimated, about, where nothing hangs on it but a figure.
const JUDGED_PIXELS: usize = 1 << 20;

/// Dark pixels' errors are relative to this, as a share of the picture's mean.
const DARKEST: f64 = 0.01;

/// How techniques count in a tile; `None` without samples.
type Weights = Option<[f64; MOST_TECHNIQUES]>;

/// Sums that are about to become a picture.
struct Darkroom<'a> {
    mixture: &'a Mixture,
    /// Of each tile.
    weights: Vec<Weights>,
    dark: f64,
    /// What pixels without samples show, and where it is, bottom row first.
    sketch: Option<&'a Sketch>,
    sources: Option<Sources>,
}

/// What is nearest to the pixels without samples: the same throughout a block.
struct Sources {
    /// Edge of a block in pixels, and blocks in a row.
    block: usize,
    columns: usize,
    /// Bottom row first.
    nearest: Vec<Option<Source>>,
}

impl Sources {
    fn new(sketch: &Sketch, width: usize, height: usize) -> Self {
        let block = sketch.block();
        let columns = width.div_ceil(block);
        let mut nearest: Vec<Option<Source>> = vec![None; columns * height.div_ceil(block)];
        nearest.par_chunks_mut(columns).enumerate().for_each(|(row, sources)| {
            let of = |column: usize| sketch.nearest(column * block, row * block);
            sources.iter_mut().enumerate().for_each(|(column, source)| *source = of(column));
        });
        Self { block, columns, nearest }
    }

    fn of(&self, i: usize, j: usize) -> Option<Source> {
        *self.nearest.get(j / self.block * self.columns + i / self.block)?
    }
}

/// What the films of a picture tell, beside its beauty.
struct Light {
    direct: Image,
    indirect: Image,
    variance: Plane<f32>,
}

/// Sums over pixels: squares of their errors, as far as they are known.
#[derive(Clone, Copy, Default)]
struct Errors {
    /// Of the pixels that tell, with their number, and as if each had a single sample.
    known: f64,
    count: u64,
    of_sample: f64,
    /// One over the number of samples, of the pixels that do not.
    unknown: f64,
    all: u64,
}

impl Errors {
    fn with(self, other: Self) -> Self {
        Self {
            known: self.known + other.known,
            count: self.count + other.count,
            of_sample: self.of_sample + other.of_sample,
            unknown: self.unknown + other.unknown,
            all: self.all + other.all,
        }
    }
}

impl Mixture {
    /// Root mean square of the pixels' relative standard errors; of dark pixels relative to a hundredth of the mean. A pixel of a
    /// single sample is taken to vary as the others do. `None` if no pixel tells.
    pub(crate) fn noise(&self) -> Option<f64> {
        Darkroom::new(self, None).noise(1)
    }

    /// About the same, from a part of the rows of a large picture.
    pub(crate) fn about_noise(&self) -> Option<f64> {
        Darkroom::new(self, None).noise((self.width * self.height).div_ceil(JUDGED_PIXELS))
    }
}

/// What a render leaves: all that its picture is made of.
pub(super) struct Undeveloped {
    pub(super) mixture: Mixture,
    /// What pixels without samples show.
    pub(super) sketch: Option<Sketch>,
    /// Where the world lies in the scene.
    pub(super) origin: DVec3,
}

impl Undeveloped {
    fn room(&self) -> Darkroom<'_> {
        Darkroom::new(&self.mixture, self.sketch.as_ref())
    }

    pub(super) fn beauty(&self) -> Image {
        let room = self.room();
        room.plane(|i, j| room.color(i, j, |canvas| &canvas.all, |glimpse| glimpse.all).to_array())
    }

    /// The rest of the picture, beside its beauty.
    pub(super) fn aovs(&self, beauty: &Image) -> Aovs {
        let room = self.room();
        room.seen(room.light(beauty), self.origin)
    }

    /// The same; what is not needed any more makes room on the way.
    pub(super) fn into_aovs(mut self, beauty: &Image) -> Aovs {
        let room = self.room();
        let light = room.light(beauty);
        let Darkroom { weights, dark, sources, .. } = room;
        self.mixture.canvases.clear();
        let room = Darkroom { mixture: &self.mixture, weights, dark, sketch: self.sketch.as_ref(), sources };
        room.seen(light, self.origin)
    }

    /// Mean number of samples of a pixel, and pixels without any.
    pub(super) fn samples(&self) -> (f64, u64) {
        let mixture = &self.mixture;
        let shown =
            |tile: usize| (0..mixture.canvases.len()).map(|technique| mixture.shown(technique, tile)).sum::<u32>();
        let is_unsampled = |&(i, j): &(usize, usize)| shown(mixture.tile_of(i, j)) == 0;
        let sketched = self.sketch.iter().flat_map(Sketch::pixels).filter(is_unsampled).count() as u64;
        let (mut samples, mut unsampled) = (sketched, 0);
        for (number, tile) in mixture.tiles().iter().enumerate() {
            let (of_each, pixels) = (u64::from(shown(number)), u64::from(tile.width * tile.height));
            samples += of_each * pixels;
            unsampled += if of_each == 0 { pixels } else { 0 };
        }
        (samples as f64 / (mixture.width * mixture.height) as f64, unsampled - sketched)
    }
}

/// Where a pixel's samples hit something, in the scene; `origin` is where the world lies in it.
fn in_scene(sums: &PixelSums, origin: DVec3) -> [f32; 3] {
    let PixelSums { position, hits, .. } = *sums;
    if hits == 0 { [0.0; 3] } else { (position.as_dvec3() / f64::from(hits) + origin).as_vec3().to_array() }
}

impl<'a> Darkroom<'a> {
    fn new(mixture: &'a Mixture, sketch: Option<&'a Sketch>) -> Self {
        let weights_of =
            |tile| Some(mixture.weights(tile)).filter(|weights| weights.iter().any(|&weight| weight > 0.0));
        let weights = (0..mixture.tiles().len()).map(weights_of).collect();
        let sources = sketch.map(|sketch| Sources::new(sketch, mixture.width, mixture.height));
        Self { mixture, weights, dark: mixture.dark(), sketch, sources }
    }

    fn weights(&self, i: usize, j: usize) -> Option<&[f64; MOST_TECHNIQUES]> {
        self.weights[self.mixture.tile_of(i, j)].as_ref()
    }

    /// A pixel's colour on the films of all canvases together, or of the sketch.
    fn color(&self, i: usize, j: usize, film: impl Fn(&Canvas) -> &Film, sketched: impl Fn(&Glimpse) -> Vec3) -> Vec3 {
        let Some(weights) = self.weights(i, j) else {
            return self.glimpse(i, j).map_or(Vec3::ZERO, sketched);
        };
        let of = |(canvas, &weight): (&Option<Canvas>, &f64)| {
            canvas.as_ref().filter(|_| weight > 0.0).map(|canvas| film(canvas).mean(i, j) * weight as f32)
        };
        self.mixture.canvases.iter().zip(weights).filter_map(of).sum()
    }

    fn source(&self, i: usize, j: usize) -> Option<Source> {
        self.sources.as_ref()?.of(i, j)
    }

    fn glimpse(&self, i: usize, j: usize) -> Option<&Glimpse> {
        Some(self.sketch?.glimpse(self.source(i, j)?))
    }

    /// What a pixel's samples saw, or the nearest sample of the sketch.
    fn sums(&self, i: usize, j: usize) -> &PixelSums {
        let own = &self.mixture.pixels[j * self.mixture.width + i];
        if self.weights(i, j).is_some() { own } else { self.glimpse(i, j).map_or(own, |glimpse| &glimpse.sums) }
    }

    /// Number of the pixel's own samples.
    fn samples(&self, i: usize, j: usize) -> u32 {
        if self.weights(i, j).is_some() {
            return self.mixture.pixels[j * self.mixture.width + i].samples;
        }
        let is_own = |(sketch, source): (&Sketch, Source)| sketch.is_at(source, i, j);
        u32::from(self.sketch.zip(self.source(i, j)).is_some_and(is_own))
    }

    /// Variance of a pixel's brightness; `None` if its samples do not tell.
    fn variance(&self, i: usize, j: usize) -> Option<f64> {
        let (weights, mixture) = (self.weights(i, j)?, self.mixture);
        let (pixel, tile) = (j * mixture.width + i, mixture.tile_of(i, j));
        let (mut sum, mut is_known) = (0.0, false);
        for (technique, (canvas, &weight)) in mixture.canvases.iter().zip(weights).enumerate() {
            let Some(canvas) = canvas.as_ref().filter(|_| weight > 0.0) else { continue };
            let moments = canvas.moments[pixel];
            let of_sample = match moments.samples {
                // A single sample says nothing: its tile does.
                0 | 1 => mixture.variances[technique][tile].map(|v| v * mixture.scale_sq(pixel, self.dark)),
                n => Some(moments.variance_of_mean() * f64::from(n)),
            };
            is_known |= of_sample.is_some();
            sum += weight * weight * of_sample.unwrap_or(0.0) / f64::from(canvas.shown[tile].max(1));
        }
        is_known.then_some(sum)
    }

    /// See [`Mixture::noise`]; of every so manieth row.
    fn noise(&self, step: usize) -> Option<f64> {
        let Mixture { width, height, .. } = *self.mixture;
        let is_telling = |tile: usize| {
            let of = |k: usize| self.mixture.shown(k, tile) > 1 || self.mixture.variance_in(k, tile).is_some();
            (0..self.mixture.canvases.len()).any(of)
        };
        if !(0..self.weights.len()).any(is_telling) {
            return None;
        }
        let rows: Vec<usize> = (0..height).step_by(step).collect();
        let brightness = |i, j| f64::from(self.color(i, j, |canvas| &canvas.all, |_| Vec3::ZERO).element_sum()) / 3.0;
        let of_rows: Vec<f64> = rows.par_iter().map(|&j| (0..width).map(|i| brightness(i, j)).sum::<f64>()).collect();
        let floor = of_rows.iter().sum::<f64>() / (rows.len() * width) as f64 * DARKEST;
        let of_pixel = |i, j| {
            let samples = f64::from(self.samples(i, j).max(1));
            let Some(variance) = self.variance(i, j) else {
                return Errors { unknown: 1.0 / samples, all: 1, ..Errors::default() };
            };
            let error = variance / brightness(i, j).max(floor).powi(2).max(f64::MIN_POSITIVE);
            Errors { known: error, count: 1, of_sample: error * samples, unknown: 0.0, all: 1 }
        };
        let of_row = |&j: &usize| (0..width).map(|i| of_pixel(i, j)).fold(Errors::default(), Errors::with);
        let of_rows: Vec<Errors> = rows.par_iter().map(of_row).collect();
        let Errors { known, count, of_sample, unknown, all } =
            of_rows.into_iter().fold(Errors::default(), Errors::with);
        (count > 0).then(|| ((known + unknown * of_sample / count as f64) / all as f64).sqrt())
    }

    fn light(&self, beauty: &Image) -> Light {
        let indirect =
            self.plane(|i, j| self.color(i, j, |canvas| &canvas.indirect, |glimpse| glimpse.indirect).to_array());
        let top = self.mixture.height - 1;
        let direct = self.plane(|i, j| {
            let (all, indirect) = (beauty.get(i, top - j), indirect.get(i, top - j));
            std::array::from_fn(|c| all[c] - indirect[c])
        });
        let variance = self.plane(|i, j| self.variance(i, j).unwrap_or(0.0) as f32);
        Light { direct, indirect, variance }
    }

    /// Adds the planes of what samples saw, all in one go: to look a pixel up takes longer than to make something of it.
    fn seen(&self, light: Light, origin: DVec3) -> Aovs {
        let Mixture { width, height, .. } = *self.mixture;
        let [mut albedo, mut normal, mut position] = std::array::from_fn(|_| zeros::<[f32; 3]>(width * height));
        let [mut depth, mut samples, mut cut_size, mut error_bound] =
            std::array::from_fn(|_| zeros::<f32>(width * height));
        let [mut object_id, mut material_id] = std::array::from_fn(|_| zeros::<u32>(width * height));
        let vectors = (rows(&mut albedo, width), rows(&mut normal, width), rows(&mut position, width)).into_par_iter();
        let means =
            (rows(&mut depth, width), rows(&mut cut_size, width), rows(&mut error_bound, width)).into_par_iter();
        let counts =
            (rows(&mut samples, width), rows(&mut object_id, width), rows(&mut material_id, width)).into_par_iter();
        let over = |sum: Vec3, count: u32| if count == 0 { [0.0; 3] } else { (sum / count as f32).to_array() };
        let mean = |sum: f32, count: u32| if count == 0 { 0.0 } else { sum / count as f32 };
        vectors.zip(means).zip(counts).enumerate().for_each(|(y, ((vectors, means), counts))| {
            let ((albedo, normal, position), (depth, cut_size, error_bound)) = (vectors, means);
            let (samples, object, material) = counts;
            let j = height - 1 - y;
            for i in 0..width {
                let sums = self.sums(i, j);
                albedo[i] = over(sums.albedo, sums.samples);
                normal[i] = over(sums.normal, sums.hits);
                position[i] = in_scene(sums, origin);
                depth[i] = if sums.hits == 0 { f32::INFINITY } else { sums.depth / sums.hits as f32 };
                samples[i] = self.samples(i, j) as f32;
                cut_size[i] = mean(sums.cut, sums.cuts);
                error_bound[i] = mean(sums.bound, sums.cuts);
                (object[i], material[i]) = (sums.object, sums.material);
            }
        });
        Aovs {
            albedo: self.whole(albedo),
            normal: self.whole(normal),
            position: self.whole(position),
            depth: self.whole(depth),
            samples: self.whole(samples),
            cut_size: self.whole(cut_size),
            error_bound: self.whole(error_bound),
            object_id: self.whole(object_id),
            material_id: self.whole(material_id),
            direct: light.direct,
            indirect: light.indirect,
            variance: light.variance,
        }
    }

    fn whole<T: Copy>(&self, pixels: Vec<T>) -> Plane<T> {
        Plane::from_pixels(self.mixture.width, self.mixture.height, pixels).expect("a value for each pixel")
    }

    /// A picture from a function of (i, j), j from the bottom. All threads write it: most of the time goes into memory that is
    /// touched for the first time.
    fn plane<T: Copy + Send + Zeroable>(&self, value: impl Fn(usize, usize) -> T + Sync) -> Plane<T> {
        let Mixture { width, height, .. } = *self.mixture;
        let mut pixels: Vec<T> = zeros(width * height);
        rows(&mut pixels, width).enumerate().for_each(|(y, row)| {
            row.iter_mut().enumerate().for_each(|(i, pixel)| *pixel = value(i, height - 1 - y));
        });
        self.whole(pixels)
    }
}

/// Zeros of the system, which are touched by whoever writes them first.
fn zeros<T: Zeroable>(count: usize) -> Vec<T> {
    bytemuck::zeroed_vec(count)
}

fn rows<T: Send>(pixels: &mut [T], width: usize) -> ChunksMut<'_, T> {
    pixels.par_chunks_mut(width)
}
