//! Fence 1: what Rust and WGSL declare under the same names is the same. Needs no adapter.

mod exceptions;
mod kernel_records;
mod rust_source;
mod wgsl_module;

use crate::twins::declared;
use exceptions::{RENAMED_RECORDS, RUST_CONSTANTS, WGSL_CONSTANTS, WGSL_FUNCTIONS};
use lightcuts_gpu::buffers::{Split, element};
use lightcuts_gpu::programs::PROGRAMS;
use lightcuts_gpu::records::{Layout, layouts};
use lightcuts_kernel::wgsl::{Source, TWINS};
use rust_source::RustSource;
use std::collections::BTreeSet;
use wgsl_module::WgslModule;

/// A twin's name without folder and ending.
fn stem(twin: &Source) -> &'static str {
    twin.path.trim_start_matches("src/").trim_end_matches(".wgsl")
}

/// Fails with all complaints at once.
fn assert_none(complaints: &[String]) {
    assert!(complaints.is_empty(), "\n{}", complaints.join("\n"));
}

fn is_listed<T>(list: &[(&str, T)], name: &str) -> bool {
    list.iter().any(|(listed, _)| *listed == name)
}

#[test]
fn functions_have_their_twins_with_the_same_parameters() {
    let module = WgslModule::of_twins();
    let mut complaints = Vec::new();
    for twin in &TWINS {
        let (rust, wgsl) = (RustSource::read(stem(twin)), declared(twin.text, "fn"));
        for function in rust.functions.iter().filter(|function| function.is_public) {
            if !wgsl.contains(&function.name.as_str()) {
                complaints.push(format!("{}.rs: `{}` has no twin", stem(twin), function.name));
                continue;
            }
            let (ours, theirs) = (function.parameters_on_devices(), module.parameters(&function.name));
            if ours != theirs {
                complaints.push(format!("{}: `{}` takes {ours:?} and {theirs:?}", stem(twin), function.name));
            }
        }
        for name in wgsl {
            let has_twin = rust.functions.iter().any(|function| function.name == name);
            if has_twin == is_listed(&WGSL_FUNCTIONS, name) {
                complaints.push(format!("{}: `{name}` has a twin or an exception: {has_twin}", twin.path));
            }
        }
    }
    assert_none(&complaints);
}

#[test]
fn constants_are_equal() {
    let module = WgslModule::of_twins();
    let mut complaints = Vec::new();
    for twin in &TWINS {
        let (rust, wgsl) = (RustSource::read(stem(twin)), declared(twin.text, "const"));
        for constant in &rust.constants {
            if is_listed(&RUST_CONSTANTS, &constant.name) == wgsl.contains(&constant.name.as_str()) {
                complaints.push(format!("{}.rs: `{}` has no twin, or is listed", stem(twin), constant.name));
            }
        }
        for name in wgsl {
            let of_rust = rust.constants.iter().find(|constant| constant.name == name).map(rust_source::Constant::bits);
            let listed = WGSL_CONSTANTS.iter().find(|(listed, _)| *listed == name).map(|(_, bits)| *bits);
            if of_rust.is_some() == listed.is_some() || of_rust.or(listed) != Some(module.constant(name)) {
                let found = module.constant(name);
                complaints.push(format!("{}: `{name}` is {found:#x}: {of_rust:x?}, listed {listed:x?}", twin.path));
            }
        }
    }
    assert_none(&complaints);
}

/// The twins and every program, each with its name.
fn all_modules() -> Vec<(&'static str, WgslModule)> {
    let of_program = |program: &lightcuts_gpu::program::Program| {
        (program.entries[0], WgslModule::new(&program.text(|_| Split::WHOLE).wgsl))
    };
    std::iter::once(("twins", WgslModule::of_twins())).chain(PROGRAMS.iter().map(of_program)).collect()
}

/// All records under their names in WGSL.
fn all_records() -> Vec<Layout> {
    let mut records: Vec<_> = kernel_records::layouts().into_iter().chain(layouts()).collect();
    for (name, in_wgsl) in RENAMED_RECORDS {
        let found = records.iter_mut().find(|record| record.name == name);
        found.unwrap_or_else(|| panic!("there is no record `{name}`")).name = in_wgsl;
    }
    records
}

#[test]
fn records_have_the_same_layout_in_every_program() {
    let (modules, mut complaints) = (all_modules(), Vec::new());
    for record in all_records() {
        let expected = wgsl_module::without_padding(&record);
        let found: Vec<_> =
            modules.iter().filter_map(|(name, module)| Some((name, module.layout(record.name)?))).collect();
        if found.is_empty() {
            complaints.push(format!("`{}` is in no program", record.name));
        }
        for (name, layout) in found.iter().filter(|(_, layout)| *layout != expected) {
            complaints.push(format!("`{}` in {name}:\n  {layout:?}\n  {expected:?}", record.name));
        }
    }
    assert_none(&complaints);
}

#[test]
fn every_structure_in_a_buffer_is_a_record() {
    let records: BTreeSet<_> = all_records().iter().map(|record| record.name).collect();
    for program in &PROGRAMS {
        let module = WgslModule::new(&program.text(|_| Split::WHOLE).wgsl);
        let elements = program.bindings().map(|binding| element(binding.name)).chain([program.params]);
        for element in elements.filter(|element| module.layout(element).is_some()) {
            assert!(records.contains(element), "{:?}: `{element}` is no record of Rust", program.entries);
        }
    }
}
