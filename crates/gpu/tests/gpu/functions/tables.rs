//! What functions read besides their arguments: a world, texels, photons.

use crate::support::scene;
use crate::twins::BUFFERS;
use bytemuck::cast_slice;
use glam::Vec3;
use lightcuts_kernel::photon::Photon;
use lightcuts_kernel::photon_gather::photon_cell;
use lightcuts_kernel::rng::random4;
use lightcuts_kernel::texture::Texture;
use lightcuts_world::{CompressedHierarchy, World};

/// Texels of all images together.
const TEXELS: u32 = 4096;
/// Photons in a cube of [`PHOTON_EXTENT`].
const PHOTONS: u32 = 2000;
/// Edge of the cube that photons lie in, in scene units.
pub(crate) const PHOTON_EXTENT: f32 = 4.0;
/// Radius of the photons' cells, in scene units.
pub(crate) const PHOTON_RADIUS: f32 = 0.5;

/// The buffers.
pub(crate) struct Tables {
    pub(crate) world: World,
    pub(crate) hierarchy: CompressedHierarchy,
    pub(crate) texels: Vec<[u8; 4]>,
    pub(crate) photons: Vec<Photon>,
}

impl Tables {
    /// With a scene of the project.
    pub(crate) fn new(name: &str) -> Self {
        let (world, _) = scene(name, Vec::new());
        let texel = |k| random4(k, 0, 0, 1).map(|channel| (channel * 256.0) as u8);
        let mut photons: Vec<_> = (0..PHOTONS).map(photon).collect();
        photons.sort_by_key(|photon| (photon.cell_x, photon.cell_y, photon.cell_z));
        Self { hierarchy: CompressedHierarchy::new(&world), world, texels: (0..TEXELS).map(texel).collect(), photons }
    }

    /// Their contents in the order of [`BUFFERS`].
    pub(crate) fn contents(&self) -> [&[u8]; BUFFERS.len()] {
        let world = &self.world;
        let spheres: &[u8] = cast_slice(&world.shapes.spheres);
        let squares: &[u8] = cast_slice(&world.shapes.squares);
        let corners: &[u8] = cast_slice(&world.shapes.corners);
        // A scene without spheres, say, still binds a buffer.
        let bound = |content, size| if <[u8]>::is_empty(content) { &[0; 64][..size] } else { content };
        [
            cast_slice(&self.hierarchy.nodes),
            cast_slice(&self.hierarchy.items),
            bound(squares, 64),
            bound(spheres, 32),
            cast_slice(&world.shapes.primitives),
            bound(corners, 64),
            cast_slice(&self.texels),
            cast_slice(&self.photons),
        ]
    }
}

/// An image somewhere among the texels.
pub(crate) fn image(k: u32) -> Texture {
    let [a, b, c, _] = random4(k, 0, 0, 2);
    let [width, height] = [a, b].map(|x| 1 + (x * 60.0) as u32);
    Texture { first: (c * (TEXELS - width * height) as f32) as u32, width, height, padding: 0 }
}

fn photon(k: u32) -> Photon {
    let [a, b, c, _] = random4(k, 0, 0, 3);
    let [d, e, f, g] = random4(k, 1, 0, 3);
    let position = (Vec3::new(a, b, c) - 0.5) * PHOTON_EXTENT;
    let cell = photon_cell(position, PHOTON_RADIUS);
    let normal = [Vec3::Z, Vec3::new(d, e, f).normalize()][usize::from(g < 0.5)];
    let (cell_x, cell_y, cell_z) = (cell.x, cell.y, cell.z);
    Photon { position, cell_x, normal, cell_y, power: Vec3::new(d, f, g), cell_z }
}
