//! Vertices of models that lie far from their own origin, as those of maps and buildings do: kept relative to the first one, so that
//! 32-bit floats hold their form.

use crate::polygon::Cut;
use glam::{DVec3, Vec3};

/// A first vertex within this distance of the origin, in each coordinate, leaves all where they are.
const NEAR: f64 = 1024.0;

/// Where the vertices of a model are kept relative to.
#[derive(Debug)]
pub(crate) struct Anchor {
    /// Found with the first vertex.
    origin: Option<DVec3>,
}

impl Anchor {
    /// Of a model whose polygons are cut in some way. The thesis' models stay where they are, whatever becomes of their form.
    pub(crate) fn new(cut: Cut) -> Self {
        Self { origin: (cut == Cut::Fans).then_some(DVec3::ZERO) }
    }

    /// A vertex relative to the origin.
    pub(crate) fn relative(&mut self, vertex: DVec3) -> Vec3 {
        // Whole numbers, so that what is written with a few digits keeps them.
        let first = || if vertex.abs().max_element() < NEAR { DVec3::ZERO } else { vertex.round() };
        (vertex - *self.origin.get_or_insert_with(first)).as_vec3()
    }

    /// The origin, in the model's coordinates.
    pub(crate) fn origin(&self) -> DVec3 {
        self.origin.unwrap_or_default()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn only_far_vertices_are_moved() {
        let far = DVec3::new(3.5e6, -2.0, 1e5 + 0.125);
        let mut anchor = Anchor::new(Cut::Outlines);
        assert_eq!(anchor.relative(far), Vec3::new(0.0, 0.0, 0.125));
        assert_eq!(anchor.relative(far + DVec3::X / 1024.0), Vec3::new(1.0 / 1024.0, 0.0, 0.125));
        assert_eq!(anchor.origin(), DVec3::new(3.5e6, -2.0, 1e5));
        for (mut anchor, vertex) in [(Anchor::new(Cut::Outlines), DVec3::ONE), (Anchor::new(Cut::Fans), far)] {
            assert_eq!((anchor.relative(vertex), anchor.origin()), (vertex.as_vec3(), DVec3::ZERO));
        }
    }
}
