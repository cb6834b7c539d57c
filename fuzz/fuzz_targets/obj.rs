//! Any bytes as a model and its material library, separated by the line `===`: they must be read or refused, and what
//! is read must be valid.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lightcuts_import::{ImportError, Imported, Limits, MemoryResolver, parse_physical, parse_thesis};

const SCENE: &str = "C | ORTHO | C{0, 0, 9} | V{0, 0, -1} | U{0, 1, 0}
O | FRKE{0, 0, 1, 1} | PATH:m.obj | MAT(0) | S{0, 0, 0} | D{1, 1, 1} | A{0, 0, 0} | SH(20)
O | FRKE{0, 0, 2, 1} | PATH:m.obj | MAT(0) | S{0, 0, 0} | D{1, 1, 1} | A{0, 0, 0} | SH(20)";
/// The same model in the physical model, where polygons are cut along their outlines and all of the library counts.
const PHYSICAL: &str = "format = 'lightcuts-scene'
version = 1
camera = { position = [0, 0, 9], target = [0, 0, 0] }
mesh = [{ name = 'm', file = 'm.obj' }]
object = [{ type = 'mesh', mesh = 'm' }, { type = 'mesh', mesh = 'm', crease-angle = 180 }]";

const SEPARATOR: &[u8] = b"\n===\n";

fuzz_target!(|data: &[u8]| {
    let split = data.windows(SEPARATOR.len()).position(|window| window == SEPARATOR);
    let (model, library) = split.map_or((data, &data[..0]), |i| (&data[..i], &data[i + SEPARATOR.len()..]));
    let resolver = MemoryResolver::from([("m.obj", model), ("m.mtl", library), ("t.png", library)]);
    let limits = Limits { mesh_elements: 10_000, texture_side: 256, ..Limits::default() };
    check(parse_thesis(SCENE, "scene.txt", &resolver, &limits), |scene| scene.validate());
    check(parse_physical(PHYSICAL, "scene.toml", &resolver, &limits), |scene| scene.validate());
});

fn check<S, I>(outcome: Result<Imported<S>, ImportError>, validate: impl FnOnce(&S) -> Vec<I>) {
    match outcome {
        Ok(imported) => assert!(validate(&imported.scene).is_empty()),
        Err(error) => assert!((1..=20).contains(&error.faults().len())),
    }
}
