//! Any text as a scene: it must be read or refused, with messages that can be shown, and what is read must be valid.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lightcuts_import::{Limits, MemoryResolver, parse_thesis};

/// A model that scenes can name.
const MODEL: &[u8] = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl a\nf 1 2 3\n";
const LIBRARY: &[u8] = b"newmtl a\nKd 1 0 0\nmap_Kd t.png\n";

fuzz_target!(|data: &[u8]| {
    let text: String = match std::str::from_utf8(data) {
        Ok(text) => text.to_owned(),
        Err(_) => data.iter().map(|&byte| char::from(byte)).collect(),
    };
    let resolver = MemoryResolver::from([("m.obj", MODEL), ("m.mtl", LIBRARY), ("t.png", &[])]);
    let limits = Limits { directives: 1000, mesh_elements: 10_000, ..Limits::default() };
    match parse_thesis(&text, "scene.txt", &resolver, &limits) {
        Ok(imported) => {
            assert_eq!(imported.scene.validate(), []);
            assert!(imported.warnings.len() <= 100);
            for warning in &imported.warnings {
                assert!(warning.to_string().len() < 10_000);
            }
        }
        Err(error) => {
            assert!((1..=20).contains(&error.faults().len()));
            assert!(error.to_string().contains(".txt:") || error.to_string().contains("m."));
        }
    }
});
