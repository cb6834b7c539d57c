//! The light tree that the device builds.

use crate::support::{has_adapter, open, small_scene};
use glam::Vec3;
use lightcuts_gpu::GpuOptions;
use lightcuts_kernel::light::Vpl;
use lightcuts_kernel::packed_tree::{BLOCK_SIZE, is_empty_cluster, unpack_cluster};
use lightcuts_kernel::ray::normalize_or_zero;
use lightcuts_kernel::rng::random4;
use lightcuts_render::device::{Device, LightTree, TreeLayout};
use lightcuts_render::{Options, Stations, Strategy, Unwatched, render_on};

/// Kinds of sets that trees find hard.
#[derive(Debug, Clone, Copy)]
enum Kind {
    Scattered,
    Coincident,
    Collinear,
    NoPower,
}

fn vpls(count: u32, kind: Kind) -> Vec<Vpl> {
    (0..count)
        .map(|k| {
            let [a, b, c, d] = random4(k, 0, 0, 21);
            let [e, f, g, _] = random4(k, 1, 0, 21);
            let scattered = (Vec3::new(a, b, c) - 0.5) * 400.0;
            Vpl {
                position: match kind {
                    Kind::Coincident => Vec3::new(3.0, -7.0, 11.0),
                    Kind::Collinear => Vec3::new(a * 1000.0, 5.0, -2.0),
                    _ => scattered,
                },
                direction: normalize_or_zero(Vec3::new(e, f, g) - 0.5),
                diffuse: if matches!(kind, Kind::NoPower) && k % 3 > 0 { Vec3::ZERO } else { Vec3::new(d, e, f) },
                attenuation: 0.1,
                ..Vpl::default()
            }
        })
        .collect()
}

/// Every node holds the VPLs under it, each VPL is under one leaf, and intensities add up.
fn check(tree: &LightTree, vpls: &[Vpl], what: &str) {
    let packed = tree.packed().expect("GPUs build packed trees");
    let leaves = packed.nodes.len() / 2;
    assert!(leaves.is_power_of_two() && leaves * BLOCK_SIZE as usize >= vpls.len(), "{what}");
    let mut seen = vec![false; vpls.len()];
    for (place, &index) in packed.order.iter().enumerate() {
        assert!(!std::mem::replace(&mut seen[index as usize], true), "{what}: VPL {index} is there twice");
        let vpl = &vpls[index as usize];
        let mut node = leaves + place / BLOCK_SIZE as usize;
        while node > 0 {
            let cluster = unpack_cluster(&packed.nodes[node]);
            let holds = cluster.lower.cmple(vpl.position).all() && cluster.upper.cmpge(vpl.position).all();
            let spans = cluster.axis.dot(vpl.direction) >= cluster.cos_spread;
            let bounds = cluster.min_intensity <= vpl.intensity() && vpl.intensity() <= cluster.max_intensity;
            assert!(holds && spans && bounds, "{what}: node {node} does not hold {vpl:?}: {cluster:?}");
            node /= 2;
        }
    }
    assert!(seen.iter().all(|&is_there| is_there), "{what}");
    let total: f64 = vpls.iter().map(|vpl| f64::from(vpl.intensity())).sum();
    let root = f64::from(packed.nodes[1].intensity);
    assert!((root - total).abs() <= total * 1e-5, "{what}: {root} of {total}");
    let full = vpls.len().div_ceil(BLOCK_SIZE as usize);
    assert!(packed.nodes[leaves + full..].iter().all(|node| is_empty_cluster(&unpack_cluster(node))), "{what}");
}

#[test]
fn trees_of_every_size_and_kind_hold_their_vpls() {
    if !has_adapter() {
        return;
    }
    let (world, _) = small_scene("thesis/simple.txt");
    let device = open(&world, &GpuOptions::default());
    for count in [1, 2, 3, 8, 9, 1000, 5000] {
        for kind in [Kind::Scattered, Kind::Coincident, Kind::Collinear, Kind::NoPower] {
            let vpls = vpls(count, kind);
            let tree = device.build_tree(&vpls, TreeLayout::Packed).expect("no fault");
            check(&tree, &vpls, &format!("{count} {kind:?}"));
            let plain = LightTree::build(&vpls, TreeLayout::Packed);
            let (built, expected) = (tree.packed().expect("packed"), plain.packed().expect("packed"));
            assert_eq!(built.order, expected.order, "{count} {kind:?}");
            let differing = built.nodes.iter().zip(&expected.nodes).filter(|(a, b)| a != b).count();
            println!("{count} {kind:?}: {differing} of {} nodes differ from the CPU's", built.nodes.len());
            // Cards may fuse and round otherwise, so that a number in 16 bits is the next one; both trees hold their VPLs.
            let is_exact = device.info().name.contains("llvmpipe");
            assert!(differing == 0 || !is_exact, "{count} {kind:?}: {differing}");
        }
    }
}

#[test]
fn a_million_vpls_fit() {
    if !has_adapter() {
        return;
    }
    let (world, _) = small_scene("thesis/simple.txt");
    let device = open(&world, &GpuOptions::default());
    for kind in [Kind::Scattered, Kind::Coincident] {
        let vpls = vpls(1_000_000, kind);
        let tree = device.build_tree(&vpls, TreeLayout::Packed).expect("no fault");
        check(&tree, &vpls, &format!("a million, {kind:?}"));
        println!("{kind:?}: {} MiB on the device", device.allocated_bytes() >> 20);
    }
}

/// The bounded walk chooses what testing every VPL chooses, at every hit, for every number of VPLs.
#[test]
fn the_selected_set_is_the_exhaustive_one() {
    if !has_adapter() {
        return;
    }
    let (world, mut settings) = small_scene("thesis/simple.txt");
    let device = open(&world, &GpuOptions::default());
    let cases = [(1, 24, 1e-7), (2, 24, 1e-7), (3, 24, 1e-7), (1000, 24, 2e-5), (1_000_000, 4, 2e-3)];
    for (count, size, threshold) in cases {
        // A million are tested one by one at every hit: one kind of them must do.
        let kinds = [Kind::NoPower, Kind::Scattered, Kind::Coincident, Kind::Collinear];
        for &kind in if count < 10_000 { &kinds[..] } else { &kinds[..1] } {
            (settings.image.width, settings.image.height) = (size, size);
            settings.gather.threshold = threshold;
            let options = Options { vpls: Some(vpls(count, kind)), ..Options::default() };
            let mut with = |strategy| {
                settings.gather.strategy = strategy;
                render_on(&world, &settings, &options, &Stations::all(&device), &Unwatched).expect("valid settings")
            };
            let (cut, tested) = (with(Strategy::Lightcuts), with(Strategy::LightcutsExhaustive));
            assert_eq!(cut.lights_selected, tested.lights_selected, "{count} {kind:?}");
            assert_eq!(cut.second_pass, tested.second_pass, "{count} {kind:?}");
            let visits = cut.stats.tree.visits_per_hit;
            println!("{count} {kind:?}: ratio {:.3} %, {visits:.0} visits", cut.stats.light_ratio_percent);
            // Directions at random give cones that say nothing; where VPLs are many, boxes decide.
            assert!(count < 10_000 || visits < f64::from(count) * 0.5, "{count} {kind:?}: {visits}");
        }
    }
}
