//! The place that a scene is moved to the origin from: 32-bit floats are finest there.

use glam::DVec3;
use lightcuts_scene::physical::{PhysicalScene, PhysicalShape};

/// A middle that is not this many steps away from the origin costs three bits of precision at most: nothing is moved.
const NEAR: f64 = 8.0;

/// The middle of a scene, in its coordinates; what is near the origin stays where it is.
///
/// Rounding matters relative to an object's size, so that is what distances are divided by: the middle is the place
/// with the least sum of them, a weighted median along each axis. A huge ground does not draw it away from what stands
/// there. It is rounded to a power of two of about the distances between objects: so a scene keeps its numbers but for
/// the first digits, and what lies in one plane goes on to do so.
pub(super) fn middle(scene: &PhysicalScene) -> DVec3 {
    let objects: Vec<(DVec3, f64)> = scene.objects.iter().filter_map(|object| ball(scene, &object.shape)).collect();
    if objects.is_empty() {
        return DVec3::ZERO;
    }
    let weights: f64 = objects.iter().map(|(_, size)| size.recip()).sum();
    let median = DVec3::from_array([0, 1, 2].map(|axis| median(&objects, axis, weights)));
    let spread = objects.iter().map(|(center, size)| (*center - median).length() / size).sum::<f64>() / weights;
    let size = objects.len() as f64 / weights;
    let step = (spread + size).log2().ceil().exp2();
    let is_near = median.abs().max_element() < NEAR * step;
    if is_near { DVec3::ZERO } else { (median / step).round() * step }
}

/// Middle and diagonal of an object.
fn ball(scene: &PhysicalScene, shape: &PhysicalShape) -> Option<(DVec3, f64)> {
    let (lower, upper) = shape.bounds(&scene.meshes)?;
    let size = (upper - lower).length();
    (size > 0.0).then_some(((lower + upper) / 2.0, size))
}

/// The coordinate with half of the weights, one over the size each, on either side.
fn median(objects: &[(DVec3, f64)], axis: usize, weights: f64) -> f64 {
    let mut sorted: Vec<(f64, f64)> = objects.iter().map(|(center, size)| (center[axis], size.recip())).collect();
    sorted.sort_by(|a, b| a.0.total_cmp(&b.0));
    let mut sum = 0.0;
    let middle = sorted.iter().find(|(_, weight)| {
        sum += weight;
        sum >= weights / 2.0
    });
    middle.or(sorted.last()).map_or(0.0, |(coordinate, _)| *coordinate)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;
    use lightcuts_scene::physical::{PhysicalObject, SurfaceId};

    fn spheres(all: &[(DVec3, f32)]) -> PhysicalScene {
        let object = |&(center, radius): &(DVec3, f32)| PhysicalObject {
            name: String::new(),
            shape: PhysicalShape::Sphere { center, radius },
            material: SurfaceId(0),
            location: lightcuts_scene::Location::default(),
        };
        PhysicalScene { objects: all.iter().map(object).collect(), ..PhysicalScene::default() }
    }

    #[test]
    fn what_is_near_the_origin_stays() {
        assert_eq!(middle(&PhysicalScene::default()), DVec3::ZERO);
        let near = [(DVec3::Y, 1.0), (DVec3::new(2.0, 0.5, -1.0), 0.5), (DVec3::NEG_X, 2.0)];
        assert_eq!(middle(&spheres(&near)), DVec3::ZERO);
        // However large the ground: the ball on it decides.
        let ground = [(DVec3::Y, 1.0), (DVec3::NEG_Y * 1e5, 1e5)];
        assert_eq!(middle(&spheres(&ground)), DVec3::ZERO);
    }

    #[test]
    fn a_moved_scene_is_moved_back() {
        let near = [(DVec3::Y, 1.0), (DVec3::new(2.0, 0.5, -1.0), 0.5), (DVec3::NEG_X, 2.0)];
        for distance in [1e3, 1e4, 1e5, 1e6] {
            let shift = DVec3::new(distance, -2.0 * distance, 0.5 * distance);
            let moved = near.map(|(center, radius)| (center + shift, radius));
            let found = middle(&spheres(&moved));
            assert!((found - shift).length() < 8.0, "{found} of {shift}");
            let [a, b] = [(moved[1].0 - found).as_vec3(), (moved[0].0 - found).as_vec3()];
            assert!((a - b - Vec3::new(2.0, -0.5, -1.0)).length() < 1e-6);
        }
    }
}
