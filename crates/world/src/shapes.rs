//! Shapes made into primitives, in file order, and these into what rays can hit.

use crate::bvh::{BvhNode, Geometry, TriangleBlock, TriangleForm};
use crate::collapse;
use crate::lights::Square as SquareFrame;
use crate::mesh::{Place, place_triangle};
use crate::pages::Pages;
use glam::Vec3;
use lightcuts_kernel::intersect::{SPHERE, SQUARE, Sphere, Square, TRIANGLE};
use lightcuts_kernel::ray::NONE;
use lightcuts_kernel::surface::{Primitive, Surfaces, TriangleCorners};
use lightcuts_scene::{MaterialId, MeshDesc};

/// All that rays can hit, as flat slices.
#[derive(Debug, Clone, Default)]
pub struct Shapes {
    /// Nodes of the hierarchy; the first is the root.
    pub nodes: Pages<BvhNode>,
    /// Triangles for intersection, in blocks, in hierarchy order.
    pub triangles: Pages<TriangleBlock>,
    /// What the blocks hold.
    pub form: TriangleForm,
    /// Spheres in file order.
    pub spheres: Vec<Sphere>,
    /// Squares in file order; a cube is six of them.
    pub squares: Vec<Square>,
    /// All primitives in file order.
    pub primitives: Pages<Primitive>,
    /// What triangles carry at their corners, in file order.
    pub corners: Pages<TriangleCorners>,
}

impl Shapes {
    /// What rays can hit.
    pub fn geometry(&self) -> Geometry<'_> {
        Geometry {
            nodes: &self.nodes,
            triangles: &self.triangles,
            form: self.form,
            spheres: &self.spheres,
            squares: &self.squares,
        }
    }

    /// What hits lie on.
    pub fn surfaces(&self) -> Surfaces<'_> {
        Surfaces {
            primitives: &self.primitives,
            corners: &self.corners,
            spheres: &self.spheres,
            squares: &self.squares,
        }
    }
}

/// Collects primitives. `boxes` holds the bounds of each.
#[derive(Debug, Default)]
pub(crate) struct Builder {
    pub(crate) primitives: Vec<Primitive>,
    pub(crate) boxes: Vec<(Vec3, Vec3)>,
    pub(crate) corners: Vec<TriangleCorners>,
    /// Corner points of the triangles, in file order.
    pub(crate) points: Vec<[Vec3; 3]>,
    pub(crate) spheres: Vec<Sphere>,
    pub(crate) squares: Vec<Square>,
    /// First triangle of each mesh, and the greatest coordinate that corners from there on were given with, in scene
    /// units: what they are rounded relative to. Empty if nobody asks for it.
    pub(crate) given: Vec<(usize, f64)>,
    pub(crate) objects: u32,
}

impl Builder {
    /// What follows belongs to the next object.
    pub(crate) fn begin_object(&mut self) {
        self.objects += 1;
    }

    pub(crate) fn add_sphere(&mut self, center: Vec3, radius: f32, material: u32) {
        let primitive = self.push(SPHERE, self.spheres.len(), material, (center - radius, center + radius));
        self.spheres.push(Sphere { center, radius, primitive, padding: [0; 3] });
    }

    /// A placed mesh; `material` says which material a face has, by the one that the mesh gives it.
    pub(crate) fn add_mesh(
        &mut self,
        mesh: &MeshDesc,
        placement: &impl Place,
        smooth: bool,
        material: impl Fn(Option<MaterialId>) -> u32,
    ) {
        for triangle in &mesh.triangles {
            let (points, corners) = place_triangle(mesh, triangle, placement, smooth);
            self.push(TRIANGLE, self.corners.len(), material(triangle.material), triangle_box(&points));
            self.corners.push(corners);
            self.points.push(points);
        }
    }

    pub(crate) fn add_square(&mut self, frame: &SquareFrame, material: u32) {
        let mut square = Square {
            center: frame.center,
            half_height: frame.height / 2.0,
            normal: frame.normal,
            half_width: frame.width / 2.0,
            along: frame.along,
            primitive: NONE,
            across: frame.across,
            padding: 0,
        };
        square.primitive = self.push(SQUARE, self.squares.len(), material, square_box(&square));
        self.squares.push(square);
    }

    /// Recomputes the boxes of triangles and squares that were changed.
    pub(crate) fn fit_boxes(&mut self) {
        for (primitive, bounds) in self.primitives.iter().zip(&mut self.boxes) {
            let index = primitive.index as usize;
            match primitive.kind {
                TRIANGLE => *bounds = triangle_box(&self.points[index]),
                SQUARE => *bounds = square_box(&self.squares[index]),
                _ => {}
            }
        }
    }

    fn push(&mut self, kind: u32, index: usize, material: u32, bounds: (Vec3, Vec3)) -> u32 {
        self.primitives.push(Primitive { kind, index: index as u32, object: self.objects, material });
        self.boxes.push(bounds);
        self.primitives.len() as u32 - 1
    }

    /// Builds the hierarchy. `reach` is the camera's largest coordinate.
    pub(crate) fn finish(self, reach: f32, form: TriangleForm) -> Shapes {
        let (nodes, triangles) = collapse::build(&self, reach, form);
        Shapes {
            nodes: nodes.into(),
            triangles: triangles.into(),
            form,
            spheres: self.spheres,
            squares: self.squares,
            primitives: self.primitives.into(),
            corners: self.corners.into(),
        }
    }
}

fn triangle_box(&[a, b, c]: &[Vec3; 3]) -> (Vec3, Vec3) {
    (a.min(b).min(c), a.max(b).max(c))
}

fn square_box(square: &Square) -> (Vec3, Vec3) {
    let reach = (square.across * square.half_width).abs() + (square.along * square.half_height).abs();
    (square.center - reach, square.center + reach)
}
