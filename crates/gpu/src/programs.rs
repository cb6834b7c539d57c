//! Every program: its sources, and the buffers that it uses.

use crate::program::{Binding, Program};
use lightcuts_kernel::wgsl::shaders::{
    BLOOM, COUNTERS, DIRECT, FILM, FINISH, GATHER, OCCLUDE, PLACE, PROBE, RECORDS, ROWS, SCALE, SCAN, SEE, SHOOT, SORT,
    SPAWN, START, SUM, TONE, TRACE, TREE,
};
use lightcuts_kernel::wgsl::{
    CAMERA, CWBVH, FILTER, INTERSECT, LIGHT, LIGHT_TREE, MATERIAL, OPTICS, PACKED_TREE, PHONG, PHOTON, PHOTON_GATHER,
    POWER, RAY, RNG, RULES, SAMPLING, SURFACE, TEXTURE, VECTOR,
};

/// WGSL type of the elements of each buffer.
const ELEMENTS: [(&str, &str); 41] = [
    ("nodes", "CompressedNode"),
    ("items", "LeafItem"),
    ("squares", "Square"),
    ("spheres", "Sphere"),
    ("primitives", "Primitive"),
    ("corners", "TriangleCorners"),
    ("materials", "Material"),
    ("textures", "Texture"),
    ("texels", "u32"),
    ("lights", "Light"),
    ("samples", "CameraSample"),
    ("node_rays", "NodeRay"),
    ("node_surfaces", "NodeSurface"),
    ("node_colors", "NodeColor"),
    ("node_links", "NodeLink"),
    ("node_totals", "NodeTotal"),
    ("node_occlusion", "f32"),
    ("vpls", "Vpl"),
    ("light_nodes", "PackedLightNode"),
    ("photons", "Photon"),
    ("words", "u32"),
    ("block_sums", "u32"),
    ("counters", "atomic<u32>"),
    ("placed", "Vpl"),
    ("tiles", "TileRecord"),
    ("pixels", "PixelRecord"),
    ("film_places", "Place"),
    ("film_sums", "vec4<f32>"),
    ("seen", "SeenRecord"),
    ("pairs_in", "vec2<u32>"),
    ("pairs_out", "vec2<u32>"),
    ("row_starts", "atomic<u32>"),
    ("shifts", "vec2<f32>"),
    ("probe_rays", "ProbeRay"),
    ("probe_hits", "Hit"),
    ("tone_pairs", "vec2<f32>"),
    ("plane_in", "f32"),
    ("plane_out", "f32"),
    ("blur_weights", "f32"),
    ("picture", "vec4<f32>"),
    ("bloomed", "vec4<f32>"),
];

/// All programs.
pub static PROGRAMS: [Program; 39] = [
    Program {
        entry: "start",
        params: "StartParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, CAMERA, RECORDS, START],
        bindings: &[reads("samples"), writes("node_rays"), writes("node_links")],
    },
    Program {
        entry: "trace",
        params: "RangeParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, INTERSECT, CWBVH, SURFACE, RECORDS, TRACE],
        bindings: &[
            reads("nodes"),
            reads("items"),
            reads("squares"),
            reads("spheres"),
            reads("primitives"),
            reads("corners"),
            reads("node_rays"),
            writes("node_surfaces"),
            writes("node_colors"),
        ],
    },
    Program {
        entry: "direct",
        params: "DirectParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, INTERSECT, CWBVH, LIGHT, MATERIAL, POWER, PHONG, RECORDS, COUNTERS, DIRECT],
        bindings: &[
            reads("nodes"),
            reads("items"),
            reads("squares"),
            reads("lights"),
            reads("materials"),
            reads("node_rays"),
            reads("node_surfaces"),
            writes("node_colors"),
            writes("counters"),
        ],
    },
    Program {
        entry: "occlude",
        params: "OccludeParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, INTERSECT, CWBVH, RNG, SAMPLING, MATERIAL, RECORDS, COUNTERS, OCCLUDE],
        bindings: &[
            reads("nodes"),
            reads("items"),
            reads("squares"),
            reads("materials"),
            reads("samples"),
            reads("node_surfaces"),
            reads("node_links"),
            writes("node_occlusion"),
            writes("counters"),
        ],
    },
    Program {
        entry: "finish",
        params: "FinishParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, INTERSECT, SAMPLING, SURFACE, TEXTURE, MATERIAL, RECORDS, FINISH],
        bindings: &[
            reads("spheres"),
            reads("squares"),
            reads("primitives"),
            reads("corners"),
            reads("materials"),
            reads("textures"),
            reads("texels"),
            reads("node_surfaces"),
            reads("node_occlusion"),
            writes("node_colors"),
        ],
    },
    Program {
        entry: "gather_all",
        params: "GatherParams",
        workgroup: 64,
        sources: &[
            RULES,
            VECTOR,
            RAY,
            INTERSECT,
            CWBVH,
            LIGHT,
            MATERIAL,
            POWER,
            PHONG,
            LIGHT_TREE,
            PACKED_TREE,
            RECORDS,
            COUNTERS,
            GATHER,
        ],
        bindings: &[
            reads("nodes"),
            reads("items"),
            reads("squares"),
            reads("materials"),
            reads("vpls"),
            reads("light_nodes"),
            reads("node_surfaces"),
            writes("node_colors"),
            writes("counters"),
        ],
    },
    Program {
        entry: "gather_cut",
        params: "GatherParams",
        workgroup: 64,
        sources: &[
            RULES,
            VECTOR,
            RAY,
            INTERSECT,
            CWBVH,
            LIGHT,
            MATERIAL,
            POWER,
            PHONG,
            LIGHT_TREE,
            PACKED_TREE,
            RECORDS,
            COUNTERS,
            GATHER,
        ],
        bindings: &[
            reads("nodes"),
            reads("items"),
            reads("squares"),
            reads("materials"),
            reads("vpls"),
            reads("light_nodes"),
            reads("node_surfaces"),
            writes("node_colors"),
            writes("counters"),
        ],
    },
    Program {
        entry: "scale",
        params: "ScaleParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, MATERIAL, SAMPLING, LIGHT, PHOTON, PHOTON_GATHER, RECORDS, SCALE],
        bindings: &[reads("materials"), reads("photons"), reads("node_surfaces"), writes("node_colors")],
    },
    Program {
        entry: "count_children",
        params: "SpawnParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, OPTICS, MATERIAL, RECORDS, SPAWN],
        bindings: &[
            reads("materials"),
            writes("node_rays"),
            reads("node_surfaces"),
            writes("node_links"),
            writes("words"),
        ],
    },
    Program {
        entry: "spawn",
        params: "SpawnParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, OPTICS, MATERIAL, RECORDS, SPAWN],
        bindings: &[
            reads("materials"),
            writes("node_rays"),
            reads("node_surfaces"),
            writes("node_links"),
            writes("words"),
        ],
    },
    Program {
        entry: "sum_layer",
        params: "RangeParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, RECORDS, SUM],
        bindings: &[reads("node_surfaces"), writes("node_colors"), writes("node_links"), writes("node_totals")],
    },
    Program {
        entry: "root_sizes",
        params: "PlaceParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, RNG, LIGHT, RECORDS, PLACE],
        bindings: &[
            reads("samples"),
            reads("node_surfaces"),
            reads("node_colors"),
            writes("node_links"),
            writes("words"),
            writes("placed"),
        ],
    },
    Program {
        entry: "rank_roots",
        params: "PlaceParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, RNG, LIGHT, RECORDS, PLACE],
        bindings: &[
            reads("samples"),
            reads("node_surfaces"),
            reads("node_colors"),
            writes("node_links"),
            writes("words"),
            writes("placed"),
        ],
    },
    Program {
        entry: "rank_children",
        params: "PlaceParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, RNG, LIGHT, RECORDS, PLACE],
        bindings: &[
            reads("samples"),
            reads("node_surfaces"),
            reads("node_colors"),
            writes("node_links"),
            writes("words"),
            writes("placed"),
        ],
    },
    Program {
        entry: "mark_vpls",
        params: "PlaceParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, RNG, LIGHT, RECORDS, PLACE],
        bindings: &[
            reads("samples"),
            reads("node_surfaces"),
            reads("node_colors"),
            writes("node_links"),
            writes("words"),
            writes("placed"),
        ],
    },
    Program {
        entry: "place_vpls",
        params: "PlaceParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, RNG, LIGHT, RECORDS, PLACE],
        bindings: &[
            reads("samples"),
            reads("node_surfaces"),
            reads("node_colors"),
            writes("node_links"),
            writes("words"),
            writes("placed"),
        ],
    },
    Program {
        entry: "film",
        params: "FilmParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, POWER, FILTER, RECORDS, FILM],
        bindings: &[
            reads("samples"),
            reads("node_colors"),
            reads("tiles"),
            reads("pixels"),
            reads("film_places"),
            writes("film_sums"),
        ],
    },
    Program {
        entry: "see",
        params: "RangeParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, INTERSECT, SURFACE, MATERIAL, RECORDS, SEE],
        bindings: &[
            reads("pixels"),
            reads("node_totals"),
            reads("node_surfaces"),
            reads("primitives"),
            reads("corners"),
            reads("spheres"),
            reads("squares"),
            reads("materials"),
            writes("seen"),
        ],
    },
    Program {
        entry: "scan_blocks",
        params: "ScanParams",
        workgroup: 256,
        sources: &[SCAN],
        bindings: &[writes("words"), writes("block_sums")],
    },
    Program {
        entry: "add_block_sums",
        params: "ScanParams",
        workgroup: 256,
        sources: &[SCAN],
        bindings: &[writes("words"), writes("block_sums")],
    },
    Program {
        entry: "count_digits",
        params: "SortParams",
        workgroup: 256,
        sources: &[SORT],
        bindings: &[reads("pairs_in"), writes("pairs_out"), writes("words")],
    },
    Program {
        entry: "scatter",
        params: "SortParams",
        workgroup: 256,
        sources: &[SORT],
        bindings: &[reads("pairs_in"), writes("pairs_out"), writes("words")],
    },
    Program {
        entry: "morton_keys",
        params: "TreeParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, LIGHT, LIGHT_TREE, PACKED_TREE, TREE],
        bindings: &[reads("vpls"), reads("pairs_in"), writes("pairs_out"), writes("placed"), writes("light_nodes")],
    },
    Program {
        entry: "reorder",
        params: "TreeParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, LIGHT, LIGHT_TREE, PACKED_TREE, TREE],
        bindings: &[reads("vpls"), reads("pairs_in"), writes("pairs_out"), writes("placed"), writes("light_nodes")],
    },
    Program {
        entry: "build_leaves",
        params: "TreeParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, LIGHT, LIGHT_TREE, PACKED_TREE, TREE],
        bindings: &[reads("vpls"), reads("pairs_in"), writes("pairs_out"), writes("placed"), writes("light_nodes")],
    },
    Program {
        entry: "build_level",
        params: "TreeParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, LIGHT, LIGHT_TREE, PACKED_TREE, TREE],
        bindings: &[reads("vpls"), reads("pairs_in"), writes("pairs_out"), writes("placed"), writes("light_nodes")],
    },
    Program {
        entry: "count_photons",
        params: "ShootParams",
        workgroup: 64,
        sources: &[
            RULES, VECTOR, RAY, INTERSECT, CWBVH, SURFACE, OPTICS, MATERIAL, LIGHT, SAMPLING, PHOTON, RECORDS,
            COUNTERS, SHOOT,
        ],
        bindings: &[
            reads("nodes"),
            reads("items"),
            reads("squares"),
            reads("spheres"),
            reads("primitives"),
            reads("corners"),
            reads("materials"),
            writes("words"),
            writes("photons"),
            writes("counters"),
        ],
    },
    Program {
        entry: "store_photons",
        params: "ShootParams",
        workgroup: 64,
        sources: &[
            RULES, VECTOR, RAY, INTERSECT, CWBVH, SURFACE, OPTICS, MATERIAL, LIGHT, SAMPLING, PHOTON, RECORDS,
            COUNTERS, SHOOT,
        ],
        bindings: &[
            reads("nodes"),
            reads("items"),
            reads("squares"),
            reads("spheres"),
            reads("primitives"),
            reads("corners"),
            reads("materials"),
            writes("words"),
            writes("photons"),
            writes("counters"),
        ],
    },
    Program {
        entry: "draw_row",
        params: "RowParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, INTERSECT, CWBVH, RNG, CAMERA, SURFACE, OPTICS, MATERIAL, RECORDS, ROWS],
        bindings: &[
            reads("nodes"),
            reads("items"),
            reads("squares"),
            reads("spheres"),
            reads("primitives"),
            reads("corners"),
            reads("materials"),
            writes("row_starts"),
            writes("shifts"),
        ],
    },
    Program {
        entry: "bloom",
        params: "BloomParams",
        workgroup: 64,
        sources: &[BLOOM],
        bindings: &[reads("picture"), writes("bloomed")],
    },
    Program {
        entry: "closest_hits",
        params: "RangeParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, INTERSECT, CWBVH, PROBE],
        bindings: &[reads("nodes"), reads("items"), reads("squares"), reads("probe_rays"), writes("probe_hits")],
    },
    Program {
        entry: "any_hits",
        params: "RangeParams",
        workgroup: 64,
        sources: &[RULES, VECTOR, RAY, INTERSECT, CWBVH, PROBE],
        bindings: &[reads("nodes"), reads("items"), reads("squares"), reads("probe_rays"), writes("probe_hits")],
    },
    Program {
        entry: "measure",
        params: "ToneParams",
        workgroup: 64,
        sources: &[VECTOR, POWER, TONE],
        bindings: &[
            reads("picture"),
            writes("bloomed"),
            writes("tone_pairs"),
            writes("plane_in"),
            writes("plane_out"),
            reads("blur_weights"),
        ],
    },
    Program {
        entry: "tone_global",
        params: "ToneParams",
        workgroup: 64,
        sources: &[VECTOR, POWER, TONE],
        bindings: &[
            reads("picture"),
            writes("bloomed"),
            writes("tone_pairs"),
            writes("plane_in"),
            writes("plane_out"),
            reads("blur_weights"),
        ],
    },
    Program {
        entry: "expose",
        params: "ToneParams",
        workgroup: 64,
        sources: &[VECTOR, POWER, TONE],
        bindings: &[
            reads("picture"),
            writes("bloomed"),
            writes("tone_pairs"),
            writes("plane_in"),
            writes("plane_out"),
            reads("blur_weights"),
        ],
    },
    Program {
        entry: "blur_transposed",
        params: "ToneParams",
        workgroup: 64,
        sources: &[VECTOR, POWER, TONE],
        bindings: &[
            reads("picture"),
            writes("bloomed"),
            writes("tone_pairs"),
            writes("plane_in"),
            writes("plane_out"),
            reads("blur_weights"),
        ],
    },
    Program {
        entry: "adapt",
        params: "ToneParams",
        workgroup: 64,
        sources: &[VECTOR, POWER, TONE],
        bindings: &[
            reads("picture"),
            writes("bloomed"),
            writes("tone_pairs"),
            writes("plane_in"),
            writes("plane_out"),
            reads("blur_weights"),
        ],
    },
    Program {
        entry: "begin_adaptation",
        params: "ToneParams",
        workgroup: 64,
        sources: &[VECTOR, POWER, TONE],
        bindings: &[
            reads("picture"),
            writes("bloomed"),
            writes("tone_pairs"),
            writes("plane_in"),
            writes("plane_out"),
            reads("blur_weights"),
        ],
    },
    Program {
        entry: "tone_local",
        params: "ToneParams",
        workgroup: 64,
        sources: &[VECTOR, POWER, TONE],
        bindings: &[
            reads("picture"),
            writes("bloomed"),
            writes("tone_pairs"),
            writes("plane_in"),
            writes("plane_out"),
            reads("blur_weights"),
        ],
    },
];

/// The program with this entry point.
pub fn program(entry: &str) -> &'static Program {
    PROGRAMS.iter().find(|program| program.entry == entry).expect("programs are named where they are made")
}

const fn reads(name: &'static str) -> Binding {
    Binding { name, element: element(name), is_written: false }
}

const fn writes(name: &'static str) -> Binding {
    Binding { name, element: element(name), is_written: true }
}

/// The WGSL type of a buffer's elements.
const fn element(name: &str) -> &'static str {
    let mut k = 0;
    while k < ELEMENTS.len() {
        if is_equal(ELEMENTS[k].0, name) {
            return ELEMENTS[k].1;
        }
        k += 1;
    }
    panic!("no such buffer")
}

const fn is_equal(a: &str, b: &str) -> bool {
    let (a, b) = (a.as_bytes(), b.as_bytes());
    if a.len() != b.len() {
        return false;
    }
    let mut k = 0;
    while k < a.len() {
        if a[k] != b[k] {
            return false;
        }
        k += 1;
    }
    true
}
