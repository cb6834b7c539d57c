use glam::Vec3;

/// Index into [`crate::SceneDesc::materials`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct MaterialId(pub u32);

/// Index into [`crate::SceneDesc::images`].
#[derive(Debug, Clone, Copy, PartialEq, Eq, Hash)]
pub struct ImageId(pub u32);

/// A Phong material with the thesis' optical ratios (`FRKE`).
#[derive(Debug, Clone, PartialEq)]
pub struct MaterialDesc {
    /// Name shown to people; may be empty.
    pub name: String,
    /// Factor on the light's specular colour.
    pub specular: Vec3,
    /// Factor on the light's diffuse colour.
    pub diffuse: Vec3,
    /// Factor on the light's ambient colour.
    pub ambient: Vec3,
    /// Phong exponent.
    pub exponent: f32,
    /// F: factor on the colour of the mirrored ray.
    pub reflection: f32,
    /// R: factor on the colour of the refracted ray.
    pub refraction: f32,
    /// K: the ratio n1/n2 of refractive indices in Snell's law, for a ray that enters.
    pub refraction_ratio: f32,
    /// E: factor on the locally evaluated (Phong) illumination. Not light emission.
    pub local: f32,
    /// Texture whose texels are added to the local colour.
    pub texture: Option<TextureDesc>,
}

impl Default for MaterialDesc {
    /// Half-grey, diffuse, opaque.
    fn default() -> Self {
        Self {
            name: String::new(),
            specular: Vec3::ZERO,
            diffuse: Vec3::splat(0.5),
            ambient: Vec3::ZERO,
            exponent: 1.0,
            reflection: 0.0,
            refraction: 0.0,
            refraction_ratio: 1.0,
            local: 1.0,
            texture: None,
        }
    }
}

/// How a material uses an image.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct TextureDesc {
    /// The image.
    pub image: ImageId,
    /// How it is laid over the surface.
    pub mode: TextureMode,
}

/// How an image is laid over a surface.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum TextureMode {
    /// The image covers the surface once.
    #[default]
    Stretch,
    /// One texel per scene unit, tiled without end. On meshes, texture coordinates wrap.
    Repeat,
    /// One texel per scene unit, once, from the surface's corner; nothing outside. On meshes, nothing outside 0..1.
    Straight,
}

/// A decoded image.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ImageDesc {
    /// Name shown to people, usually the path as the scene gives it.
    pub name: String,
    /// Width in texels, at least 1.
    pub width: u32,
    /// Height in texels, at least 1.
    pub height: u32,
    /// Texels, top row first, `width * height` of them; 255 is 1.0, without a transfer curve, as the thesis reads them.
    pub texels: Vec<[u8; 3]>,
}
