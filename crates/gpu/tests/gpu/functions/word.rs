//! Values as words of a buffer, in the order of the fields of the structures in WGSL.

use glam::{IVec3, UVec2, Vec3};
use lightcuts_kernel::Rules;
use lightcuts_kernel::camera::Camera;
use lightcuts_kernel::cwbvh::{CompressedNode, LeafItem};
use lightcuts_kernel::filter::PixelFilter;
use lightcuts_kernel::intersect::{Sphere, Square, Triangle};
use lightcuts_kernel::light::{Light, Vpl};
use lightcuts_kernel::light_tree::{Decision, LightCluster, RelevanceBounds};
use lightcuts_kernel::material::Material;
use lightcuts_kernel::packed_tree::PackedLightNode;
use lightcuts_kernel::phong::{Incidence, VplIncidence};
use lightcuts_kernel::photon::{PhotonStart, PhotonTarget};
use lightcuts_kernel::ray::{Hit, Ray};
use lightcuts_kernel::surface::Surface;
use lightcuts_kernel::texture::{SurfacePoint, Texture};

/// A word, and how it is compared.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Word {
    Float(f32),
    Whole(u32),
}

impl Word {
    pub(crate) fn bits(self) -> u32 {
        match self {
            Self::Float(value) => value.to_bits(),
            Self::Whole(value) => value,
        }
    }

    /// Neither subnormal, infinite nor NaN.
    pub(crate) fn is_ordinary(self) -> bool {
        match self {
            Self::Float(value) => value == 0.0 || value.is_normal(),
            Self::Whole(_) => true,
        }
    }
}

/// What can be passed to and from a device.
pub(crate) trait Words {
    /// Appends the words.
    fn write(&self, to: &mut Vec<Word>);
    /// Takes the words in the same order.
    fn read(next: &mut dyn FnMut() -> u32) -> Self;
}

impl Words for f32 {
    fn write(&self, to: &mut Vec<Word>) {
        to.push(Word::Float(*self));
    }

    fn read(next: &mut dyn FnMut() -> u32) -> Self {
        Self::from_bits(next())
    }
}

/// Numbers and enums that are one whole word.
macro_rules! whole {
    ($($ty:ty: $to_word:expr, $of_word:expr;)*) => {$(
        impl Words for $ty {
            fn write(&self, to: &mut Vec<Word>) {
                let to_word: fn($ty) -> u32 = $to_word;
                to.push(Word::Whole(to_word(*self)));
            }

            fn read(next: &mut dyn FnMut() -> u32) -> Self {
                let of_word: fn(u32) -> $ty = $of_word;
                of_word(next())
            }
        }
    )*};
}

whole! {
    u32: |value| value, |word| word;
    i32: i32::cast_unsigned, u32::cast_signed;
    bool: u32::from, |word| word != 0;
    Rules: |value| value as u32, |word| [Rules::Original, Rules::Repaired][word as usize];
    Decision: |value| value as u32, |word| [Decision::Reject, Decision::Accept, Decision::Descend][word as usize];
}

impl<T: Words, const N: usize> Words for [T; N] {
    fn write(&self, to: &mut Vec<Word>) {
        for value in self {
            value.write(to);
        }
    }

    fn read(next: &mut dyn FnMut() -> u32) -> Self {
        std::array::from_fn(|_| T::read(next))
    }
}

impl<A: Words, B: Words> Words for (A, B) {
    fn write(&self, to: &mut Vec<Word>) {
        self.0.write(to);
        self.1.write(to);
    }

    fn read(next: &mut dyn FnMut() -> u32) -> Self {
        (A::read(next), B::read(next))
    }
}

/// Records: all fields in the order of the structure in WGSL.
macro_rules! records {
    ($($name:ident { $($field:ident),* $(,)? })*) => {$(
        impl Words for $name {
            fn write(&self, to: &mut Vec<Word>) {
                $(self.$field.write(to);)*
            }

            fn read(next: &mut dyn FnMut() -> u32) -> Self {
                $(let $field = Words::read(next);)*
                Self { $($field),* }
            }
        }
    )*};
}

records! {
    Vec3 { x, y, z }
    UVec2 { x, y }
    IVec3 { x, y, z }
    Ray { origin, t_min, direction, t_max, inside }
    Hit { t, primitive, u, v }
    Triangle { corner, primitive, edge1, padding0, edge2, padding1 }
    Sphere { center, radius, primitive, padding }
    Square { center, half_height, normal, half_width, along, primitive, across, padding }
    CompressedNode { words }
    LeafItem { a, primitive, b, kind, c, index }
    Camera { center, pitch, view, eye_distance, right, width, up, height }
    Material {
        specular, exponent, diffuse, reflection, ambient, refraction, glow, refraction_ratio,
        local, texture, texture_mode, padding,
    }
    Light { position, kind, direction, attenuation, specular, padding0, diffuse, padding1, ambient, padding2 }
    Vpl { position, attenuation, direction, padding0, diffuse, padding1 }
    Texture { first, width, height, padding }
    SurfacePoint { uv, size }
    Surface { point, normal, material, object }
    LightCluster { lower, upper, axis, cos_spread, sin_spread, min_intensity, max_intensity }
    RelevanceBounds { least_flux, greatest_volume, greatest_flux, least_volume }
    PackedLightNode { lower, intensity, extent_xy, extent_z_spread, axis, intensities }
    PixelFilter { kind, radius, alpha, mitchell_b, mitchell_c, padding }
    Incidence { to_light, cos_theta, cos_phi }
    VplIncidence { to_light, cosines, dist_sq }
    PhotonTarget { center, radius, light, object, side, padding }
    PhotonStart { ray, area }
}
