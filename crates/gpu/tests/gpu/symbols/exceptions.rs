//! What has no twin by nature. Everything else that has none is an error, and so is what stands here in vain.

/// Functions of WGSL that no free function of Rust stands beside, with the reason.
pub(crate) const WGSL_FUNCTIONS: [(&str, &str); 4] = [
    ("no_hit", "`Hit::none`: WGSL has no methods"),
    ("take_nearer", "`Hit::take_nearer`, which changes its hit in place"),
    ("vpl_intensity", "`Vpl::intensity`"),
    ("is_incident", "whether Rust's `incidence` is `Some`"),
];

/// Constants of WGSL that Rust takes from its library, with the bits that they must have.
pub(crate) const WGSL_CONSTANTS: [(&str, u32); 7] = [
    // Stands for infinity, which WGSL does not spell.
    ("FAR", f32::MAX.to_bits()),
    ("TAU", std::f32::consts::TAU.to_bits()),
    ("PI", std::f32::consts::PI.to_bits()),
    ("LOG2_E", std::f32::consts::LOG2_E.to_bits()),
    // `Decision` as numbers.
    ("REJECT", lightcuts_kernel::light_tree::Decision::Reject as u32),
    ("ACCEPT", lightcuts_kernel::light_tree::Decision::Accept as u32),
    ("DESCEND", lightcuts_kernel::light_tree::Decision::Descend as u32),
];

/// Records whose structure has another name in WGSL, with that name.
pub(crate) const RENAMED_RECORDS: [(&str, &str); 1] = [
    // The kernel's `Hit` as bytes.
    ("ProbeHit", "Hit"),
];

/// Constants of Rust that WGSL does without, with the reason.
pub(crate) const RUST_CONSTANTS: [(&str, &str); 1] =
    [("END_SLACK", "boxes of GPUs are padded along every axis instead")];
