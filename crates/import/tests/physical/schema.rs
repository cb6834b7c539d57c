//! What is written about the format holds of the importer.

use super::{memory, scene};
use lightcuts_testkit::project_root;
use serde_json::Value;
use std::collections::BTreeSet;
use std::fs;

fn written(name: &str) -> String {
    fs::read_to_string(project_root().join("docs/formats").join(name)).expect("it is written")
}

/// The keys that the importer knows in a table, told by what it says about another key there.
fn known(table: &str) -> BTreeSet<String> {
    let text = format!("format = \"lightcuts-scene\"\nversion = 1\n{table}\n");
    let error = memory(&text, &[]).expect_err("the key is unknown");
    let fault = error.faults().iter().map(ToString::to_string).find(|fault| fault.contains("unknown key `zzz`"));
    let fault = fault.unwrap_or_else(|| panic!("{table}: {error}"));
    let (_, list) = fault.split_once("; expected one of ").expect("the keys are listed");
    list.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

fn properties(table: &Value) -> BTreeSet<String> {
    assert_eq!(table["additionalProperties"], false, "{table}");
    table["properties"].as_object().unwrap_or_else(|| panic!("{table}")).keys().cloned().collect()
}

#[test]
fn the_schema_has_the_keys_of_the_importer() {
    let schema: Value = serde_json::from_str(&written("scene.schema.json")).expect("it is JSON");
    let parts = &schema["$defs"];
    assert_eq!(properties(&schema), known("zzz = 1"));
    for (part, table) in [
        ("camera", "[camera]\nzzz = 1"),
        ("environment", "[environment]\nzzz = 1"),
        ("mesh", "[[mesh]]\nname = \"m\"\nzzz = 1"),
        (
            "rotation",
            "[[material]]\nname = \"m\"\ntype = \"mirror\"\n[[object]]\ntype = \"box\"\nmaterial = \"m\"\ncenter = [0, 0, 0]\nsize = [1, 1, 1]\nrotate = { zzz = 1 }",
        ),
        (
            "weighting",
            "[[material]]\nname = \"m\"\ntype = \"mix\"\nfirst = \"m\"\nsecond = \"m\"\nweight = { zzz = 1 }",
        ),
    ] {
        assert_eq!(properties(&parts[part]), known(table), "{part}");
    }
    for part in ["material", "object", "light"] {
        let name = if part == "material" { "name = \"m\"\n" } else { "" };
        for variant in parts[part]["oneOf"].as_array().expect("a list") {
            let kind = variant["properties"]["type"]["const"].as_str().expect("it has a type");
            let table = format!("[[{part}]]\n{name}type = \"{kind}\"\nzzz = 1");
            assert_eq!(properties(variant), known(&table), "{part} {kind}");
        }
    }
    for (part, key) in [("tint", "albedo"), ("emission", "emission"), ("mask", "alpha")] {
        let tables = parts[part]["oneOf"].as_array().expect("a list");
        let table = tables.iter().find(|variant| variant["type"] == "object").expect("one is a table");
        let text = format!("[[material]]\nname = \"m\"\ntype = \"lambert\"\n{key} = {{ zzz = 1 }}");
        assert_eq!(properties(table), known(&text), "{part}");
    }
}

#[test]
fn every_type_is_in_the_schema() {
    let schema: Value = serde_json::from_str(&written("scene.schema.json")).expect("it is JSON");
    for part in ["material", "object", "light"] {
        let head = "format = \"lightcuts-scene\"\nversion = 1\n";
        let error = memory(&format!("{head}[[{part}]]\nname = \"m\"\ntype = \"zzz\""), &[]).expect_err("it is unknown");
        let fault = error.to_string();
        let (_, list) = fault.split_once("; expected one of ").expect("the types are listed");
        let types: Vec<&str> = list.split('`').skip(1).step_by(2).collect();
        let variants = schema["$defs"][part]["oneOf"].as_array().expect("a list");
        let written: Vec<&str> = variants.iter().filter_map(|v| v["properties"]["type"]["const"].as_str()).collect();
        assert_eq!(written, types, "{part}");
    }
}

#[test]
fn the_documented_example_is_a_scene() {
    let page = written("scene.md");
    let example = page.split("```toml\n").nth(1).and_then(|rest| rest.split("```").next()).expect("there is one");
    let (_, body) = example.split_once("fov = 45\n").expect("its camera ends so");
    assert_eq!(scene(body, &[]).objects.len(), 3);
    let imported = memory(example, &[]).expect("it is sound");
    assert_eq!((imported.warnings, imported.scene.materials.len()), (Vec::new(), 3));
}
