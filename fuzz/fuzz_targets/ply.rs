//! Any bytes as a PLY model: they must be read or refused, and what is read must be valid.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lightcuts_import::{Limits, MemoryResolver, parse_physical};

const SCENE: &str = "format = \"lightcuts-scene\"\nversion = 1
camera = { position = [0, 0, 9], target = [0, 0, 0] }
material = [{ name = \"a\", type = \"lambert\" }]
mesh = [{ name = \"m\", file = \"m.ply\" }]
object = [{ type = \"mesh\", mesh = \"m\", material = \"a\" }]";

fuzz_target!(|data: &[u8]| {
    let resolver = MemoryResolver::from([("m.ply", data)]);
    let limits = Limits { mesh_elements: 10_000, ..Limits::default() };
    match parse_physical(SCENE, "scene.toml", &resolver, &limits) {
        Ok(imported) => assert_eq!(imported.scene.validate(), []),
        Err(error) => assert_eq!(error.faults().len(), 1),
    }
});
