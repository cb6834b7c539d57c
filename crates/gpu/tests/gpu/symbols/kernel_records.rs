//! The layouts of the kernel's records.

use lightcuts_gpu::records::Layout;
use lightcuts_kernel::camera::Camera;
use lightcuts_kernel::cwbvh::{CompressedNode, LeafItem};
use lightcuts_kernel::filter::PixelFilter;
use lightcuts_kernel::intersect::{Sphere, Square, Triangle};
use lightcuts_kernel::light::{Light, Vpl};
use lightcuts_kernel::material::Material;
use lightcuts_kernel::packed_tree::PackedLightNode;
use lightcuts_kernel::photon::{Photon, PhotonTarget};
use lightcuts_kernel::surface::{Primitive, TriangleCorners};
use lightcuts_kernel::texture::Texture;
use std::mem::offset_of;

/// Layouts of records from lists of all their fields; a pattern makes sure that none is forgotten.
macro_rules! layouts {
    ($($name:ident { $($field:ident),* $(,)? })*) => {
        vec![$({
            let _ = |$name { $($field: _),* }: $name| ();
            Layout {
                name: stringify!($name),
                size: size_of::<$name>(),
                fields: vec![$((stringify!($field), offset_of!($name, $field))),*],
            }
        }),*]
    };
}

/// All of them.
pub(crate) fn layouts() -> Vec<Layout> {
    layouts! {
        Triangle { corner, primitive, edge1, padding0, edge2, padding1 }
        Sphere { center, radius, primitive, padding }
        Square { center, half_height, normal, half_width, along, primitive, across, padding }
        CompressedNode { words }
        LeafItem { a, primitive, b, kind, c, index }
        Primitive { kind, index, object, material }
        TriangleCorners { normals, texture_coordinates, slack }
        Camera { center, pitch, view, eye_distance, right, width, up, height }
        Material {
            specular, exponent, diffuse, reflection, ambient, refraction, glow, refraction_ratio,
            local, texture, texture_mode, padding,
        }
        Light { position, kind, direction, attenuation, specular, padding0, diffuse, padding1, ambient, padding2 }
        Vpl { position, attenuation, direction, padding0, diffuse, padding1 }
        Texture { first, width, height, padding }
        PackedLightNode { lower, intensity, extent_xy, extent_z_spread, axis, intensities }
        PixelFilter { kind, radius, alpha, mitchell_b, mitchell_c, padding }
        Photon { position, cell_x, normal, cell_y, power, cell_z }
        PhotonTarget { center, radius, light, object, side, padding }
    }
}
