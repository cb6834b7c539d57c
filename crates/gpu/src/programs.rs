//! Every program: its entry points, its sources, and the buffers that it uses.

use crate::program::Program;
use lightcuts_kernel::wgsl::Source;
use lightcuts_kernel::wgsl::shaders::{
    BLOOM, COUNTERS, DIRECT, FILM, FINISH, GATHER, OCCLUDE, PLACE, PROBE, RANGE, RECORDS, ROWS, SCALE, SCAN, SEE,
    SHOOT, SORT, SPAWN, START, SUM, TONE, TRACE, TREE,
};
use lightcuts_kernel::wgsl::{
    CAMERA, CWBVH, FILTER, INTERSECT, LIGHT, LIGHT_TREE, MATERIAL, OPTICS, PACKED_TREE, PHONG, PHOTON, PHOTON_GATHER,
    POWER, RAY, RNG, RULES, SAMPLING, SURFACE, TEXTURE, VECTOR,
};

/// Sources below all others.
const BASE: &[Source] = &[RULES, VECTOR, RAY];
/// Sources of rays through the hierarchy.
const TRACING: &[Source] = &[INTERSECT, CWBVH];
/// Sources of light from lights and VPLs.
const SHADING: &[Source] = &[LIGHT, MATERIAL, POWER, PHONG];
/// Sources of the light tree.
const TREES: &[Source] = &[LIGHT_TREE, PACKED_TREE];

/// Buffers that a ray passes through.
const HIERARCHY: &[&str] = &["nodes", "items", "squares"];
/// Buffers that say what a hit is like, beside those of the hierarchy.
const SURFACES: &[&str] = &["spheres", "primitives", "corners"];

/// All programs.
pub static PROGRAMS: [Program; 20] = [
    Program {
        entries: &["start"],
        params: "StartParams",
        workgroup: 64,
        sources: &[BASE, &[CAMERA, RECORDS, START]],
        reads: &[&["samples"]],
        writes: &["node_rays", "node_links"],
    },
    Program {
        entries: &["trace"],
        params: "RangeParams",
        workgroup: 64,
        sources: &[BASE, TRACING, &[SURFACE, RECORDS, RANGE, TRACE]],
        reads: &[HIERARCHY, SURFACES, &["node_rays"]],
        writes: &["node_surfaces", "node_colors"],
    },
    Program {
        entries: &["direct"],
        params: "DirectParams",
        workgroup: 64,
        sources: &[BASE, TRACING, SHADING, &[RECORDS, COUNTERS, DIRECT]],
        reads: &[HIERARCHY, &["lights", "materials", "node_rays", "node_surfaces"]],
        writes: &["node_colors", "counters"],
    },
    Program {
        entries: &["occlude"],
        params: "OccludeParams",
        workgroup: 64,
        sources: &[BASE, TRACING, &[RNG, SAMPLING, MATERIAL, RECORDS, COUNTERS, OCCLUDE]],
        reads: &[HIERARCHY, &["materials", "samples", "node_surfaces", "node_links"]],
        writes: &["node_occlusion", "counters"],
    },
    Program {
        entries: &["finish"],
        params: "FinishParams",
        workgroup: 64,
        sources: &[BASE, &[INTERSECT, SAMPLING, SURFACE, TEXTURE, MATERIAL, RECORDS, FINISH]],
        reads: &[SURFACES, &["squares", "materials", "textures", "texels", "node_surfaces", "node_occlusion"]],
        writes: &["node_colors"],
    },
    Program {
        entries: &["gather_all", "gather_cut"],
        params: "GatherParams",
        workgroup: 64,
        sources: &[BASE, TRACING, SHADING, TREES, &[RECORDS, COUNTERS, GATHER]],
        reads: &[HIERARCHY, &["materials", "vpls", "light_nodes", "node_surfaces"]],
        writes: &["node_colors", "counters"],
    },
    Program {
        entries: &["scale"],
        params: "ScaleParams",
        workgroup: 64,
        sources: &[BASE, &[MATERIAL, SAMPLING, LIGHT, PHOTON, PHOTON_GATHER, RECORDS, SCALE]],
        reads: &[&["materials", "photons", "node_surfaces"]],
        writes: &["node_colors"],
    },
    Program {
        entries: &["count_children", "spawn"],
        params: "SpawnParams",
        workgroup: 64,
        sources: &[BASE, &[OPTICS, MATERIAL, RECORDS, SPAWN]],
        reads: &[&["materials", "node_surfaces"]],
        writes: &["node_rays", "node_links", "words"],
    },
    Program {
        entries: &["sum_layer"],
        params: "RangeParams",
        workgroup: 64,
        sources: &[BASE, &[RECORDS, RANGE, SUM]],
        reads: &[&["node_surfaces"]],
        writes: &["node_colors", "node_links", "node_totals"],
    },
    Program {
        entries: &["root_sizes", "rank_roots", "rank_children", "mark_vpls", "place_vpls"],
        params: "PlaceParams",
        workgroup: 64,
        sources: &[BASE, &[RNG, LIGHT, RECORDS, PLACE]],
        reads: &[&["samples", "node_surfaces", "node_colors"]],
        writes: &["node_links", "words", "placed"],
    },
    Program {
        entries: &["film"],
        params: "FilmParams",
        workgroup: 64,
        sources: &[BASE, &[POWER, FILTER, RECORDS, FILM]],
        reads: &[&["samples", "node_colors", "tiles", "pixels", "film_places"]],
        writes: &["film_sums"],
    },
    Program {
        entries: &["see"],
        params: "RangeParams",
        workgroup: 64,
        sources: &[BASE, &[INTERSECT, SURFACE, MATERIAL, RECORDS, RANGE, SEE]],
        reads: &[SURFACES, &["squares", "materials", "pixels", "node_totals", "node_surfaces"]],
        writes: &["seen"],
    },
    Program {
        entries: &["scan_blocks", "add_block_sums"],
        params: "ScanParams",
        workgroup: 256,
        sources: &[&[SCAN]],
        reads: &[],
        writes: &["words", "block_sums"],
    },
    Program {
        entries: &["count_digits", "scatter"],
        params: "SortParams",
        workgroup: 256,
        sources: &[&[SORT]],
        reads: &[&["pairs_in"]],
        writes: &["pairs_out", "words"],
    },
    Program {
        entries: &["morton_keys", "reorder", "build_leaves", "build_level"],
        params: "TreeParams",
        workgroup: 64,
        sources: &[BASE, &[LIGHT], TREES, &[TREE]],
        reads: &[&["vpls", "pairs_in"]],
        writes: &["pairs_out", "placed", "light_nodes"],
    },
    Program {
        entries: &["count_photons", "store_photons"],
        params: "ShootParams",
        workgroup: 64,
        sources: &[BASE, TRACING, &[SURFACE, OPTICS, MATERIAL, LIGHT, SAMPLING, PHOTON, RECORDS, COUNTERS, SHOOT]],
        reads: &[HIERARCHY, SURFACES, &["materials"]],
        writes: &["words", "photons", "counters"],
    },
    Program {
        entries: &["draw_row"],
        params: "RowParams",
        workgroup: 64,
        sources: &[BASE, TRACING, &[RNG, CAMERA, SURFACE, OPTICS, MATERIAL, RECORDS, ROWS]],
        reads: &[HIERARCHY, SURFACES, &["materials"]],
        writes: &["row_starts", "shifts"],
    },
    Program {
        entries: &["bloom"],
        params: "BloomParams",
        workgroup: 64,
        sources: &[&[BLOOM]],
        reads: &[&["picture"]],
        writes: &["bloomed"],
    },
    Program {
        entries: &["closest_hits", "any_hits"],
        params: "RangeParams",
        workgroup: 64,
        sources: &[BASE, TRACING, &[RANGE, PROBE]],
        reads: &[HIERARCHY, &["probe_rays"]],
        writes: &["probe_hits"],
    },
    Program {
        entries: &["measure", "tone_global", "expose", "blur_transposed", "adapt", "begin_adaptation", "tone_local"],
        params: "ToneParams",
        workgroup: 64,
        sources: &[&[VECTOR, POWER, TONE]],
        reads: &[&["picture", "blur_weights"]],
        writes: &["bloomed", "tone_pairs", "plane_in", "plane_out"],
    },
];

/// The program with this entry point.
pub fn program(entry: &str) -> &'static Program {
    PROGRAMS.iter().find(|program| program.entries.contains(&entry)).expect("entries are named where they are made")
}
