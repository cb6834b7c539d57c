//! References: pictures with little noise, whose noise is known.

use crate::physical::{render, settings};
use crate::place;
use anyhow::{Context as _, Result};
use lightcuts::PhysicalWorld;
use lightcuts::image::metrics::deviation::relmse;
use lightcuts::image::{Image, ImageError, Layers, Transfer, read_picture, write_exr};
use lightcuts::rendering::Integrator;
use serde::{Deserialize, Serialize};
use std::fs;
use std::path::{Path, PathBuf};

#[derive(Debug, clap::Args)]
pub(crate) struct Args {
    /// Minutes that a reference is rendered for where there is none yet; they are kept in target/bench.
    #[arg(long, default_value_t = 10.0)]
    reference_minutes: f32,
}

/// A picture to compare with.
pub(super) struct Reference {
    pub(super) picture: Image,
    /// relMSE of its own.
    pub(super) noise: f64,
}

/// What a reference says of itself, in a file beside it.
#[derive(Debug, Serialize, Deserialize)]
struct About {
    relmse_noise: f64,
}

impl Reference {
    /// The mean of two pictures with seeds of their own, for half the time each, whose difference tells the noise.
    pub(super) fn rendered(
        world: &PhysicalWorld,
        size: u32,
        name: &str,
        integrator: Integrator,
        args: &Args,
    ) -> Result<Self> {
        let folder = place::root().join("target/bench");
        let [picture, about] = ["exr", "json"].map(|ending| folder.join(format!("{name}-{size}.{ending}")));
        if !about.is_file() {
            eprintln!("rendering a reference, {:.1} minutes: {}", args.reference_minutes, picture.display());
            let half = |seed| -> Result<Image> {
                let mut settings = settings(size, 1 << 22);
                settings.physical.integrator = integrator;
                settings.physical.time_limit = args.reference_minutes * 30.0;
                settings.run.seed = seed;
                Ok(render(world, &settings)?.beauty)
            };
            let (first, second) = (half(1001)?, half(1002)?);
            fs::create_dir_all(&folder).with_context(|| format!("cannot make {}", folder.display()))?;
            let mean = mean(&first, &second);
            // A half is as far from the mean of both as that mean is from the truth.
            let noise = f64::midpoint(relmse(&mean, &first)?, relmse(&mean, &second)?);
            write_exr(&picture, &Layers::new(mean))?;
            fs::write(&about, serde_json::to_string(&About { relmse_noise: noise })?)
                .with_context(|| format!("cannot write {}", about.display()))?;
        }
        Self::of_files(&picture, &about)
    }

    /// The reference that lies with a scene.
    pub(super) fn read(folder: &Path) -> Result<Self> {
        Self::of_files(&folder.join("reference.exr"), &folder.join("reference.json"))
    }

    fn of_files(picture: &PathBuf, about: &PathBuf) -> Result<Self> {
        let text = fs::read_to_string(about).with_context(|| format!("cannot read {}", about.display()))?;
        let about: About =
            serde_json::from_str(&text).with_context(|| format!("{} lacks something", about.display()))?;
        let picture = read_picture(picture, Transfer::Linear, None)?.picture;
        Ok(Self { picture: picture.linear().clone(), noise: about.relmse_noise })
    }

    /// relMSE of a picture: what is measured less what the reference has itself.
    pub(super) fn error_of(&self, picture: &Image) -> Result<f64, ImageError> {
        Ok((relmse(&self.picture, picture)? - self.noise).max(0.0))
    }
}

fn mean(a: &Image, b: &Image) -> Image {
    Image::from_fn(a.width(), a.height(), |x, y| {
        let (a, b) = (a.get(x, y), b.get(x, y));
        [0, 1, 2].map(|channel| f32::midpoint(a[channel], b[channel]))
    })
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts_kernel::rng::random4;

    #[test]
    fn the_noise_of_a_mean_is_found_from_its_halves() {
        let noisy =
            |stream| Image::from_fn(64, 64, |x, y| [1.0 + 0.2 * (random4(x as u32, y as u32, 0, stream)[0] - 0.5); 3]);
        let (first, second) = (noisy(1), noisy(2));
        let mean = mean(&first, &second);
        let found = relmse(&mean, &first).unwrap();
        let exact = relmse(&Image::filled(64, 64, [1.0; 3]), &mean).unwrap();
        assert!((found / exact - 1.0).abs() < 0.1, "{found} {exact}");
    }
}
