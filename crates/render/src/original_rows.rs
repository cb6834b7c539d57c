//! The original's first pass needs its rows one after the other: where a row's draws begin depends on the hits before
//! it. Twin of the GPU's `rows`.

use crate::cpu::{HalfSpaces, Tracer};
use crate::device::View;
use crate::original::OriginalDraws;
use crate::ray_tree::RayTree;
use crate::shade::Shader;
use lightcuts_kernel::camera::camera_ray;
use lightcuts_kernel::ray::{Hit, Ray};
use lightcuts_world::World;
use lightcuts_world::bvh::LANES;

/// The shifts of all pixels, bottom row first.
pub(crate) fn original_shifts(view: &View<'_>, tracer: Tracer<'_>) -> Vec<[f32; 2]> {
    let (width, height) = (view.camera.width, view.camera.height);
    let half_spaces = HalfSpaces::default();
    let mut shader = Shader::new(view.world, tracer, None, &half_spaces);
    let mut tree = RayTree::new(view.max_depth);
    let mut draws = OriginalDraws::new();
    let mut all = Vec::with_capacity((width * height) as usize);
    for j in 0..height {
        let shifts = draws.row(width);
        let camera_ray = |(i, &shift): (u32, &[f32; 2])| camera_ray(&view.camera, i, j, shift, view.rules);
        let rays: Vec<Ray> = (0..width).zip(&shifts).map(camera_ray).collect();
        for rays in rays.chunks(LANES) {
            let hits = tracer.closest8(&std::array::from_fn(|lane| rays[lane.min(rays.len() - 1)]));
            for (&ray, hit) in rays.iter().zip(hits).filter(|(_, hit)| hit.is_some()) {
                draws.skip(if goes_on(view.world, &hit) { tree.hit_count(&mut shader, ray) } else { 1 });
            }
        }
        all.extend(shifts);
    }
    all
}

/// Whether other rays may follow from a hit.
fn goes_on(world: &World, hit: &Hit) -> bool {
    let primitive = world.shapes.surfaces().primitives[hit.primitive as usize];
    let material = &world.materials[primitive.material as usize];
    material.reflection > 0.0 || material.refraction > 0.0
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::{CpuDevice, Simd};
    use crate::device::{Lighting, Shifts, Wants};
    use crate::job::Job;
    use crate::stations::Station;
    use crate::{Options, Settings, Stations, Unwatched};
    use lightcuts_import::{ImportOptions, load};
    use lightcuts_testkit::project_root;

    /// The pass that is rendered with the shifts has the hits that they were found with, in glass too.
    #[test]
    fn draws_of_a_row_begin_where_those_for_earlier_hits_end() {
        let scene = load(&project_root().join("scenes/thesis/simple.txt"), &ImportOptions::default());
        let scene = scene.expect("the scene loads").scene;
        let world = World::new(&scene).expect("the scene is sound");
        let mut settings = Settings::for_scene(&scene);
        settings.run.reproduce = true;
        let (options, device) = (Options::default(), CpuDevice::new(&world, Simd::Auto));
        let mut job = Job::new(&world, &settings, &options, &Stations::all(&device), &Unwatched);
        let shifts = original_shifts(&job.view, Tracer::new(world.shapes.geometry(), job.view.rules, Simd::Auto));
        let pass = job.pass(Lighting::Scene { occlusion: None }, Shifts::Given(&shifts), Wants::SurfacesAndHits);
        let (mut draws, mut rows, mut hits) = (OriginalDraws::new(), shifts.chunks(512), 0);
        job.merge_tiles(Station::Place, &pass, &job.tiles(), |_, result| {
            assert_eq!(rows.next(), Some(&draws.row(512)[..]), "row {}", result.tile.j);
            draws.skip(result.hits.len());
            hits += result.hits.len();
        });
        assert!(rows.next().is_none());
        assert!(hits > 512 * 512 + 10_000, "{hits} hits with those of mirrored and refracted rays");
    }
}
