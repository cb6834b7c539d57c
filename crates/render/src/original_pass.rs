//! The first pass with the original's random numbers: one sequence, row by row.

use crate::Vpl;
use crate::device::{Lighting, Placement, Shifts, Tile, Wants};
use crate::job::Job;
use crate::monitor::Stage;
use crate::original::OriginalDraws;
use crate::ray_tree::TreeHit;
use crate::settings::Strategy;
use crate::stations::Station;

/// Pixels of a row that are traced in one go: many enough to be worth handing over, few enough to keep all cores busy.
const PIECE: u32 = 64;

impl Job<'_> {
    /// The first pass with the original's draws.
    pub(crate) fn first_pass_original(&mut self, draws: OriginalDraws) -> Vec<Vpl> {
        let view = self.view;
        let occlusion = self.occlusion();
        let lighting = Lighting::Scene { occlusion: occlusion.as_ref() };
        match self.crew.run(Station::Place, self.monitor, |device, _| device.original_shifts(&view)) {
            Some(shifts) => self.first_pass_at(lighting, &shifts, draws),
            None => self.first_pass_by_rows(lighting, draws),
        }
    }

    /// The original's first pass with shifts that a device has found beforehand; the draws decide about hits only.
    fn first_pass_at(&mut self, lighting: Lighting<'_>, shifts: &[[f32; 2]], mut draws: OriginalDraws) -> Vec<Vpl> {
        let width = self.view.camera.width;
        let placement = self.original_placement();
        let mut vpls = Vec::new();
        let pass = self.pass(lighting, Shifts::Given(shifts), Wants::SurfacesAndHits);
        self.run_pass(Stage::FirstPass, &pass, |canvas, result| {
            canvas.first.merge(&result.film);
            draws.row(width);
            placement(&mut draws, &result.hits, &mut vpls);
        });
        self.draws = Some(draws);
        vpls
    }

    /// The original's first pass row by row, because each row's shifts depend on the number of hits before it.
    fn first_pass_by_rows(&mut self, lighting: Lighting<'_>, mut draws: OriginalDraws) -> Vec<Vpl> {
        let (width, height) = (self.view.camera.width, self.view.camera.height);
        let placement = self.original_placement();
        let mut shifts = vec![[0.0; 2]; (width * height) as usize];
        let mut vpls = Vec::new();
        self.monitor.begin(Stage::FirstPass, u64::from(height * width.div_ceil(PIECE)));
        for j in 0..height {
            let start = (j * width) as usize;
            shifts[start..start + width as usize].copy_from_slice(&draws.row(width));
            let tiles: Vec<Tile> = (0..width)
                .step_by(PIECE as usize)
                .map(|i| Tile { i, j, width: PIECE.min(width - i), height: 1 })
                .collect();
            let pass = self.pass(lighting, Shifts::Given(&shifts), Wants::SurfacesAndHits);
            let complete = self.merge_tiles(Station::Place, &pass, &tiles, |canvas, result| {
                canvas.first.merge(&result.film);
                placement(&mut draws, &result.hits, &mut vpls);
            });
            if !complete {
                break;
            }
        }
        self.monitor.end();
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
    use crate::cpu::{CpuDevice, Simd, select, select_exhaustively};
    use crate::light_tree::tests::chosen;
    use crate::light_tree::{LightTree, TreeLayout};
    use crate::{Options, Settings, Stations, Unwatched};
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
            let mut hits = Vec::new();
            job.merge_tiles(Station::Place, &pass, &job.tiles(), |_, result| hits.extend(result.hits));
            let (mut found, mut expected) = (Vec::new(), Vec::new());
            for hit in &hits {
                found.clear();
                expected.clear();
                let (point, threshold) = (hit.surface.point, settings.gather.threshold);
                select(&tree, Simd::Auto.has_avx2(), point, threshold, &mut found);
                select_exhaustively(&tree, &mut expected);
                let sets = [&found, &expected].map(|candidates| chosen(&tree, candidates, point, threshold));
                assert_eq!(sets[0], sets[1], "{name} at {point}");
            }
            println!("{name}: the sets of all {} hits are equal", hits.len());
        }
    }
}
