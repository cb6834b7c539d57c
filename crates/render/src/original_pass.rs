//! The first pass with the original's random numbers: one sequence, row by row.
//!
//! Each row's shifts depend on the number of hits before it. So they are found beforehand, by following rays without
//! any light; the pass itself is then free to render many rows at once.

use crate::Vpl;
use crate::device::{Lighting, Placement, Shifts, Wants};
use crate::job::Job;
use crate::monitor::Stage;
use crate::original::OriginalDraws;
use crate::ray_tree::TreeHit;
use crate::settings::Strategy;
use crate::stations::Station;

impl Job<'_> {
    /// The first pass with the original's draws, which decide about hits.
    pub(crate) fn first_pass_original(&mut self, mut draws: OriginalDraws) -> Vec<Vpl> {
        let view = self.view;
        let occlusion = self.occlusion();
        let lighting = Lighting::Scene { occlusion: occlusion.as_ref() };
        let shifts = self.crew.run(Station::Place, self.monitor, |device, _| device.original_shifts(&view));
        let width = view.camera.width;
        let placement = self.original_placement();
        let mut vpls = Vec::new();
        let pass = self.pass(lighting, Shifts::Given(&shifts), Wants::SurfacesAndHits);
        self.run_pass(Stage::FirstPass, &pass, |canvas, result| {
            canvas.first.merge(&result.film);
            draws.row(width);
            placement(&mut draws, &result.hits, &mut vpls);
        });
        self.draws = Some(draws);
        vpls
    }

    /// Makes VPLs of hits: each takes one of the original's draws.
    fn original_placement(&self) -> impl Fn(&mut OriginalDraws, &[TreeHit], &mut Vec<Vpl>) + use<> {
        let (camera, probability) = (&self.view.camera, self.settings.vpl.probability);
        let placement = Placement::new(&self.settings.vpl, u64::from(camera.width * camera.height), 0);
        move |draws, hits, vpls| {
            let accepted = hits.iter().filter(|_| draws.accepts(probability));
            vpls.extend(accepted.filter_map(|hit| placement.vpl(hit)));
        }
    }

    /// The draws that the original spends on its light tree.
    pub(crate) fn skip_tree_draws(&mut self, vpls: usize) {
        if let Some(draws) = &mut self.draws
            && self.settings.gather.strategy != Strategy::All
        {
            draws.skip_light_tree(vpls);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::cpu::{CpuDevice, Simd, chosen, select, select_exhaustively};
    use crate::light_tree::{LightTree, TreeLayout};
    use crate::{Options, Settings, Stations, Unwatched};
    use glam::Vec3;
    use lightcuts_import::{ImportOptions, load};
    use lightcuts_testkit::{project_root, shared};
    use lightcuts_world::World;

    /// Every hit of every ray tree of the thesis' scenes: the bounded tree finds the set that testing every VPL finds.
    #[test]
    fn the_selected_set_is_exact_at_every_hit_of_the_three_scenes() {
        let Some(models) = shared("models") else { return };
        for name in ["simple", "venus", "galleon"] {
            let options = ImportOptions { search_paths: vec![models.clone()], ..ImportOptions::default() };
            let path = project_root().join(format!("scenes/thesis/{name}.txt"));
            let scene = load(&path, &options).expect("the scene loads").scene;
            let world = World::new(&scene).expect("the scene is sound");
            let mut settings = Settings::for_scene(&scene);
            settings.run.reproduce = true;
            let (options, device) = (Options::default(), CpuDevice::new(&world, Simd::Auto));
            let mut job = Job::new(&world, &settings, &options, &Stations::all(&device), &Unwatched);
            let vpls = job.first_pass_original(OriginalDraws::new());
            let tree = LightTree::build(&vpls, TreeLayout::Wide);
            let mut draws = job.draws.expect("the job reproduces");
            draws.skip_light_tree(vpls.len());
            let shifts: Vec<[f32; 2]> = (0..512).flat_map(|_| draws.row(512)).collect();
            let pass = job.pass(Lighting::Scene { occlusion: None }, Shifts::Given(&shifts), Wants::SurfacesAndHits);
            let mut hits: Vec<TreeHit> = Vec::new();
            job.merge_tiles(Station::Place, &pass, &job.tiles(), |_, result| hits.extend(result.hits));
            let (mut found, mut together, mut expected) = (Vec::new(), Vec::new(), Vec::new());
            select_exhaustively(&tree, &mut expected);
            let (threshold, avx2) = (settings.gather.threshold, Simd::Auto.has_avx2());
            for neighbours in hits.chunks(32) {
                together.clear();
                let points = || neighbours.iter().map(|hit| hit.surface.point);
                let corners = (points().fold(Vec3::INFINITY, Vec3::min), points().fold(Vec3::NEG_INFINITY, Vec3::max));
                select(&tree, avx2, corners, threshold, &mut together);
                for point in points() {
                    found.clear();
                    select(&tree, avx2, (point, point), threshold, &mut found);
                    let all = [&found, &together, &expected];
                    let [found, together, expected] = all.map(|some| chosen(&tree, some, point, threshold));
                    assert_eq!(found, expected, "{name} at {point}");
                    assert_eq!(together, expected, "{name} at {point}, with neighbours");
                }
            }
            println!("{name}: the sets of all {} hits are equal", hits.len());
        }
    }
}
