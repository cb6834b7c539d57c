//! Any text as a scene of the physical model: it must be read or refused, with messages that can be shown, and what is read
//! must be valid.

#![no_main]

use libfuzzer_sys::fuzz_target;
use lightcuts_import::{Limits, MemoryResolver, parse_physical};

/// Files that scenes can name.
const MODEL: &[u8] = b"mtllib m.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nusemtl a\nf 1 2 3\n";
const LIBRARY: &[u8] = b"newmtl a\nKd 1 0 0\nKs 1 1 1\nKe 1 1 1\nillum 3\nmap_Kd i.pfm\nmap_d i.pfm\n";
const PLY: &[u8] = b"ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n\
    element face 1\nproperty list uchar int vertex_index\nend_header\n0 0 0 1 0 0 0 1 0 3 0 1 2\n";
const IMAGE: &[u8] = b"Pf\n1 1\n-1\n\0\0\0\x3f";

/// The start of every scene, so that the fuzzer need not find it.
const HEAD: &str = "format = \"lightcuts-scene\"\nversion = 1\n";

fuzz_target!(|data: &[u8]| {
    let text = String::from_utf8_lossy(data);
    let files = [("m.obj", MODEL), ("m.mtl", LIBRARY), ("m.ply", PLY), ("i.pfm", IMAGE)];
    let resolver = MemoryResolver::from(files);
    let limits = Limits { directives: 1000, mesh_elements: 10_000, ..Limits::default() };
    for text in [format!("{HEAD}{text}"), text.into_owned()] {
        match parse_physical(&text, "scene.toml", &resolver, &limits) {
            Ok(imported) => {
                assert_eq!(imported.scene.validate(), []);
                assert!(imported.warnings.len() <= 100);
            }
            Err(error) => {
                assert!((1..=20).contains(&error.faults().len()));
                assert!(error.to_string().contains("scene.toml:") || error.to_string().contains("m."));
                assert!(error.to_string().len() < 10_000);
            }
        }
    }
});
