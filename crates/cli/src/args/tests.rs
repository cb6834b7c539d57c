//! Holds the declarations of the flags against the settings that they set.

use super::{Cli, Command, RenderArgs, command, scope_of};
use clap::Parser;
use clap::builder::PossibleValue;
use lightcuts::Settings;
use lightcuts::rendering::{Model, Scope};
use std::collections::BTreeMap;
use toml::{Table, Value};

/// The arguments of a `render`.
fn parsed(arguments: &[&str]) -> Box<RenderArgs> {
    let words = ["lightcuts", "render", "scene"].iter().chain(arguments);
    let Command::Render(args) = Cli::try_parse_from(words).unwrap().command else { panic!("not `render`") };
    args
}

/// The settings that a command line sets.
fn flags(arguments: &[&str]) -> Table {
    parsed(arguments).settings.table()
}

/// Every key with a value, as `table.key`.
fn leaves(table: &Table, prefix: &str) -> BTreeMap<String, String> {
    let mut found = BTreeMap::new();
    for (key, value) in table {
        let name = format!("{prefix}{key}");
        match value {
            Value::Table(inner) => found.extend(leaves(inner, &format!("{name}."))),
            // As people write it: through f32, not with the digits of its neighbour in f64.
            Value::Float(number) => drop(found.insert(name, (*number as f32).to_string())),
            Value::String(text) => drop(found.insert(name, text.clone())),
            other => drop(found.insert(name, other.to_string())),
        }
    }
    found
}

#[test]
fn the_declaration_is_consistent() {
    command().debug_assert();
}

#[test]
fn nothing_is_set_without_flags() {
    assert_eq!(leaves(&flags(&[]), ""), BTreeMap::new());
}

/// Options that concern no model of light, or both alike, and are no settings.
const COMMON: [&str; 13] = [
    "scene",
    "pictures",
    "stats",
    "write_job",
    "dry_run",
    "quiet",
    "progress",
    "job",
    "folders",
    "size",
    "device",
    "threads",
    "simd",
];

#[test]
fn every_option_has_its_model_or_is_common() {
    let command = command();
    let page = include_str!("../../../../docs/guide/render.md");
    for arg in command.find_subcommand("render").unwrap().get_arguments() {
        let (id, help) = (arg.get_id().as_str(), arg.get_help().unwrap().to_string());
        let scope = scope_of(id);
        assert_eq!(scope.is_some(), !COMMON.contains(&id), "{id}: give it a scope, or name it here");
        for model in [Model::Thesis, Model::Physical] {
            let is_marked = help.contains(&format!(" ({})", model.name()));
            assert_eq!(is_marked, scope == Some(Scope::Only(model)), "{id}: {help}");
        }
        // The guide says the same, in a column of its own.
        let Some(flag) = arg.get_long() else { continue };
        let cell = match scope {
            Some(Scope::Only(model)) => model.name(),
            Some(Scope::Both) => "both",
            None => continue,
        };
        let row = page
            .lines()
            .find(|line| line.starts_with('|') && line.split('|').nth(1).unwrap().contains(&format!("`--{flag}")));
        let row = row.unwrap_or_else(|| panic!("docs/guide/render.md does not tell of --{flag}"));
        assert!(row.split('|').any(|found| found.trim() == cell), "--{flag} is for {cell}: {row}");
    }
}

#[test]
fn every_setting_has_one_flag_whose_help_tells_the_defaults() {
    let table = |mut settings: Settings| {
        settings.filter.radius = Some(0.5); // the box's
        leaves(&Table::try_from(&settings).unwrap(), "")
    };
    let (mut expected, mut physical) = (table(Settings::default()), table(Settings::for_physical()));
    for table in [&mut expected, &mut physical] {
        table.insert("display.exposure".to_owned(), "1".to_owned()); // which is not written
    }
    expected.insert("vpl.enabled".to_owned(), "false".to_owned()); // the flag is its opposite
    physical.insert("vpl.enabled".to_owned(), "false".to_owned());
    let command = command();
    let render = command.find_subcommand("render").unwrap();
    for arg in render.get_arguments().filter(|arg| Scope::of(arg.get_id().as_str()).is_some()) {
        let flag = arg.get_long().unwrap();
        let choices = arg.get_possible_values();
        let values: Vec<_> =
            if choices.is_empty() { vec!["1"] } else { choices.iter().map(PossibleValue::get_name).collect() };
        let values = if values == ["true", "false"] { vec!["true"] } else { values };
        for value in &values {
            let set = flags(&[&format!("--{flag}={value}")]);
            assert!(set.clone().try_into::<Settings>().is_ok(), "--{flag}={value}");
            // The option's id is its key.
            assert_eq!(leaves(&set, "").into_keys().collect::<Vec<_>>(), [arg.get_id().as_str()], "--{flag}");
        }
        let scope = Scope::of(arg.get_id().as_str()).unwrap();
        let args = parsed(&[&format!("--{flag}={}", values[0])]);
        for model in [Model::Thesis, Model::Physical] {
            let foreign = if scope.includes(model) { Vec::new() } else { vec![format!("--{flag}")] };
            assert_eq!(args.foreign_options(model), foreign);
        }
        let key = arg.get_id().as_str();
        let default = expected.remove(key).unwrap_or_else(|| panic!("--{flag}: no or second flag for {key}"));
        let help = arg.get_help().unwrap().to_string();
        let told = help.split("[default: ").nth(1).unwrap_or_else(|| panic!("--{flag}: no default in the help"));
        let words: Vec<_> = told.split([' ', ',', ';', ']']).collect();
        for default in [default, physical[key].clone()] {
            assert!(words.contains(&default.as_str()), "--{flag}: the help tells {told:?}, the default is {default}");
        }
    }
    assert_eq!(expected, BTreeMap::new(), "settings without a flag");
}

/// The words that the settings accept for a key: those that serde names when it is given another.
fn accepted(key: &str) -> Vec<String> {
    let set = key
        .rsplit('.')
        .fold(Value::String("?".to_owned()), |value, key| Value::Table(Table::from_iter([(key.to_owned(), value)])));
    let error = set.try_into::<Settings>().unwrap_err().to_string();
    let (_, expected) = error.lines().next().unwrap().split_once(", expected ").unwrap();
    expected.split('`').skip(1).step_by(2).map(str::to_owned).collect()
}

#[test]
fn flags_offer_every_word_that_the_settings_accept() {
    let command = command();
    let render = command.find_subcommand("render").unwrap();
    let mut flags_with_words = 0;
    for arg in render.get_arguments() {
        let mut words: Vec<_> = arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
        let is_setting = Scope::of(arg.get_id().as_str()).is_some();
        if !is_setting || words.is_empty() || words == ["true", "false"] {
            continue;
        }
        let key = arg.get_id().as_str();
        let mut expected = accepted(key);
        words.sort_unstable();
        expected.sort_unstable();
        assert_eq!(words, expected, "{key}");
        flags_with_words += 1;
    }
    assert_eq!(flags_with_words, 7);
}

#[test]
fn options_are_told_as_they_are_typed() {
    let args = parsed(&["--size=3x4", "--no-second-pass", "--bloom", "--read-vpls=v.csv"]);
    let foreign = args.foreign_options(Model::Physical);
    assert_eq!(foreign, ["--bloom", "--no-second-pass", "--read-vpls"]);
    assert_eq!(args.foreign_options(Model::Thesis), [""; 0]);
    for (option, model) in [
        ("--read-vpls=v.csv", Model::Thesis),
        ("--write-vpls=v.csv", Model::Thesis),
        ("--station-device=gather=cpu", Model::Thesis),
        ("--gpu-budget=30", Model::Thesis),
        ("--crease-angle=40", Model::Physical),
    ] {
        let other = if model == Model::Thesis { Model::Physical } else { Model::Thesis };
        let (args, name) = (parsed(&[option]), option.split('=').next().unwrap());
        assert_eq!((args.foreign_options(model), args.foreign_options(other)), (vec![], vec![name.to_owned()]));
    }
    let told =
        ["image.width", "filter.kind", "display.global.max-display-luminance"].map(|key| args.settings.option_for(key));
    assert_eq!(told, ["the width of --size", "--filter", "--global-luminance"]);
}

#[test]
fn switches_go_both_ways() {
    for (flag, key) in [("ao", "ambient-occlusion"), ("caustics", "caustics"), ("bloom", "bloom")] {
        assert_eq!(flags(&[&format!("--{flag}")])[key]["enabled"].as_bool(), Some(true));
        assert_eq!(flags(&[&format!("--{flag}=false")])[key]["enabled"].as_bool(), Some(false));
    }
    assert_eq!(flags(&["--no-second-pass"])["vpl"]["enabled"].as_bool(), Some(false));
    assert_eq!(flags(&["--no-second-pass=false"])["vpl"]["enabled"].as_bool(), Some(true));
}

#[test]
fn a_size_is_width_and_height() {
    assert_eq!(flags(&["--size", "640x480"]), flags(&["--width=640", "--height", "480"]));
    for arguments in
        [&["--size=2x2", "--width=3"][..], &["--size", "2"], &["--height=-1"], &["--seed", "x"], &["--ao=1"]]
    {
        let words = ["lightcuts", "render", "scene"].iter().chain(arguments);
        assert!(Cli::try_parse_from(words).is_err(), "{arguments:?}");
    }
}
