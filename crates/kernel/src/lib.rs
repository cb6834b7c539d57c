//! Pure rendering functions over flat records: what every device computes, written once for each.
//!
//! Nothing here does I/O, allocates, fails or holds a trait object: degenerate input contributes zero, never NaN. A
//! file belongs here if and only if it has a WGSL twin of the same stem, or stands on [`TWINS_TO_COME`].

pub mod bsdf;
pub mod camera;
pub mod cluster;
pub mod cwbvh;
pub mod dielectric;
pub mod emitter;
pub mod emitter_tree;
pub mod energy;
pub mod environment;
pub mod filter;
pub mod fresnel;
pub mod ggx;
pub mod intersect;
pub mod lens;
pub mod light;
pub mod light_tree;
pub mod material;
pub mod mip;
pub mod optics;
pub mod packed_tree;
pub mod phong;
pub mod photon;
pub mod photon_gather;
pub mod power;
pub mod ray;
pub mod rng;
pub mod rounding;
pub mod rules;
pub mod sampling;
pub mod scatter;
pub mod surface;
pub mod texture;
pub mod vector;
pub mod virtual_light;
pub mod watertight;
pub mod wgsl;

pub use rules::Rules;

/// The modules whose WGSL twins are still to be written, by file stem.
pub const TWINS_TO_COME: [&str; 15] = [
    "bsdf",
    "cluster",
    "dielectric",
    "emitter",
    "emitter_tree",
    "energy",
    "environment",
    "fresnel",
    "ggx",
    "lens",
    "mip",
    "rounding",
    "scatter",
    "virtual_light",
    "watertight",
];

#[cfg(test)]
mod tests {
    use std::path::Path;

    #[test]
    fn every_file_has_its_twin_or_stands_on_the_list() {
        let source = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
        for entry in std::fs::read_dir(source).unwrap() {
            let path = entry.unwrap().path();
            let stem = path.file_stem().unwrap().to_str().unwrap().to_owned();
            if !["lib", "wgsl"].contains(&stem.as_str()) && path.extension().is_some_and(|e| e == "rs") {
                let has_twin = path.with_extension("wgsl").exists();
                let listed = super::TWINS_TO_COME.contains(&stem.as_str());
                assert!(has_twin != listed, "{stem}: twin {has_twin}, on the list {listed}");
            }
        }
        println!("twins to come: {:?}", super::TWINS_TO_COME);
    }
}
