//! Cuts against the sum over all virtual lights, which is exact for a given set of them.

use super::scenes::room;
use crate::cpu::Simd;
use crate::physical::cluster_tree::ClusterTree;
use crate::physical::emission::Origins;
use crate::physical::gather::{CutHeap, Receiver};
use crate::physical::pass::Counts;
use crate::physical::scene::{Cone, Scene};
use crate::physical::vpls::trace_vpls;
use glam::Vec3;
use lightcuts_kernel::bsdf::{MATT, lobes_of};
use lightcuts_kernel::cluster::light_power;
use lightcuts_kernel::lens::lens_ray;
use lightcuts_kernel::virtual_light::VirtualLight;
use lightcuts_world::PhysicalWorld;

/// The oracle: at every pixel the sum over a cut is as near to the sum over all lights as it says, and equal for an error of 0.
#[test]
fn every_cut_is_within_its_bound() {
    for (occluded, vpls) in [(false, 500), (true, 500), (false, 20_000)] {
        let world = PhysicalWorld::new(&room(occluded)).unwrap();
        let scene = Scene::new(&world, Simd::Auto);
        let origins = Origins::new(&scene).unwrap();
        let left = trace_vpls(&scene, &origins, None, vpls, 3);
        let lights: Vec<VirtualLight> = left.items.iter().filter_map(|judged| judged.light).collect();
        let tree = ClusterTree::build(&lights, 4);
        let size = if vpls > 1000 { 12 } else { 24 };
        let lens = world.lens(size, size);
        let (mut heap, mut counts) = (CutHeap::default(), Counts::default());
        let (mut closest, mut pixels, mut sizes) = (0.0_f32, 0, 0);
        for j in 0..size {
            for i in 0..size {
                let ray = lens_ray(&lens, [i as f32 + 0.5, j as f32 + 0.5], [0.0; 2]);
                let Some(hit) = scene.closest(&ray) else { continue };
                let at = scene.interaction(&ray, &hit, Cone::NONE, 0.5);
                if lobes_of(&at.bsdf) & MATT == 0 {
                    continue;
                }
                let receiver = Receiver::new(&scene, &at, Vec3::ONE, Vec3::ONE, 0.0025);
                let all = receiver.all(&tree, &mut counts).light;
                for error in [0.3, 0.02, 0.0] {
                    let cut = receiver.cut(&tree, error, u32::MAX, None, &mut heap, &mut counts);
                    let difference = (light_power(cut.light) - light_power(all)).abs();
                    let rounding = 2e-4 * light_power(all);
                    assert!(difference <= cut.bound + rounding, "({i}, {j}): {difference} > {}", cut.bound);
                    if error == 0.0 {
                        assert!(difference <= rounding, "({i}, {j}): {difference}");
                        assert!(cut.bound == 0.0);
                    } else if cut.bound > 0.0 {
                        closest = closest.max(difference / cut.bound);
                    }
                    if error == 0.02 {
                        sizes += cut.size;
                    }
                }
                pixels += 1;
            }
        }
        println!(
            "occluded {occluded}, {} lights: {pixels} pixels, {:.0} in a cut of 2 %, the closest reaches {closest:.2} of its bound",
            tree.lights.len(),
            f64::from(sizes) / f64::from(pixels),
        );
        assert!(pixels > 100);
    }
}
