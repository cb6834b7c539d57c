use glam::Vec3;

/// Index into [`super::PhysicalScene::materials`].
pub use crate::MaterialId as SurfaceId;

/// Index into [`super::PhysicalScene::images`].
pub use crate::ImageId;

/// How a surface scatters and emits light.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct SurfaceDesc {
    /// Name shown to people; may be empty.
    pub name: String,
    /// What it does with light that arrives.
    pub scattering: Scattering,
    /// Light that it sends out by itself.
    pub emission: Option<EmissionDesc>,
    /// Normals in tangent space, red along u, green along v, blue outwards; 0..1 stands for -1..1. Linear.
    pub normal_map: Option<ImageId>,
    /// Where it is there at all.
    pub alpha: Option<AlphaMask>,
}

/// Where a surface is there at all.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct AlphaMask {
    /// The image; its alpha channel where it has one, else its red one.
    pub image: ImageId,
    /// The surface is there where the value is at least this.
    pub threshold: f32,
}

/// Light that a surface sends out.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct EmissionDesc {
    /// Radiance in W per square unit and steradian; a factor on the image's where there is one.
    pub radiance: Vec3,
    /// Texture of the radiance.
    pub image: Option<ImageId>,
    /// Whether the back shines too; else only the side that the normal points to.
    pub two_sided: bool,
}

/// A colour, times that of an image where there is one. Linear RGB.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Tint {
    /// The colour, 0..1 each.
    pub color: Vec3,
    /// The image.
    pub image: Option<ImageId>,
}

impl From<Vec3> for Tint {
    fn from(color: Vec3) -> Self {
        Self { color, image: None }
    }
}

/// The closed set of materials. All but dielectrics show the same on both sides. `roughness` is perceptual, 0..1: the
/// microfacet distribution's width alpha is its square, and 0 is smooth.
#[derive(Debug, Clone, PartialEq)]
pub enum Scattering {
    /// Diffuse.
    Lambert {
        /// Share of the light that is reflected.
        albedo: Tint,
    },
    /// The Phong model made to keep energy (Lafortune & Willems 1994).
    Phong {
        /// Share that is reflected diffusely.
        diffuse: Tint,
        /// Share that is reflected about the mirror direction; both together at most 1.
        specular: Tint,
        /// Exponent of the lobe, at least 1.
        exponent: f32,
    },
    /// A metal.
    Conductor {
        /// Refractive index per channel.
        eta: Vec3,
        /// Absorption index per channel.
        k: Vec3,
        /// Roughness, 0..1.
        roughness: f32,
    },
    /// Glass or a liquid; the surface's normal points outwards.
    Dielectric {
        /// Refractive index inside, relative to outside; above 1/3 and below 3, but not 1.
        ior: f32,
        /// Roughness, 0..1.
        roughness: f32,
        /// Factor on light that passes, per crossing.
        transmittance: Vec3,
    },
    /// Diffuse under a clear coat.
    Plastic {
        /// Share of the light which entered the coat that leaves it again. A base of reflectance a under a coat that
        /// reflects the share Fi of diffuse light back inside has a (1 - Fi) / (1 - a Fi); Fi is 0.596 for an index of
        /// 1.5.
        albedo: Tint,
        /// Refractive index of the coat, above 1 and below 3.
        ior: f32,
        /// Roughness of the coat, 0..1.
        roughness: f32,
    },
    /// A perfect mirror.
    Mirror {
        /// Share of the light that is reflected.
        reflectance: Tint,
    },
    /// One material here and another there.
    Mix {
        /// Where the weight is 0.
        first: SurfaceId,
        /// Where the weight is 1.
        second: SurfaceId,
        /// Share of the second, 0..1.
        weight: f32,
        /// Factor on the weight: the image's red channel.
        image: Option<ImageId>,
    },
}

impl Default for Scattering {
    /// Half-grey and diffuse.
    fn default() -> Self {
        Self::Lambert { albedo: Vec3::splat(0.5).into() }
    }
}

/// A decoded image.
#[derive(Debug, Clone, PartialEq)]
pub struct PixelImage {
    /// Name shown to people, usually the path as the scene gives it.
    pub name: String,
    /// Width in pixels, at least 1.
    pub width: u32,
    /// Height in pixels, at least 1.
    pub height: u32,
    /// The pixels, top row first.
    pub pixels: Pixels,
}

/// Pixels of an image, `width * height` of them.
#[derive(Debug, Clone, PartialEq)]
pub enum Pixels {
    /// 8 bits per channel; red, green and blue in the transfer curve of sRGB.
    Srgb(Vec<[u8; 4]>),
    /// 8 bits per channel, linear: normals, weights and masks.
    Linear(Vec<[u8; 4]>),
    /// Linear light, at least 0.
    Float(Vec<[f32; 3]>),
}

impl Pixels {
    /// Number of pixels.
    pub fn len(&self) -> usize {
        match self {
            Self::Srgb(pixels) | Self::Linear(pixels) => pixels.len(),
            Self::Float(pixels) => pixels.len(),
        }
    }

    /// Whether there are none.
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}
