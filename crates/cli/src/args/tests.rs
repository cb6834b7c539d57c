//! Holds the declarations of the flags against the settings that they set.

use super::{Cli, Command};
use clap::builder::PossibleValue;
use clap::{CommandFactory, Parser};
use lightcuts::Settings;
use std::collections::BTreeMap;
use toml::{Table, Value};

/// The settings that a command line sets.
fn flags(arguments: &[&str]) -> Table {
    let words = ["lightcuts", "render", "scene"].iter().chain(arguments);
    let Command::Render(args) = Cli::try_parse_from(words).unwrap().command else { panic!("not `render`") };
    Table::try_from(&args.settings).unwrap()
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
    Cli::command().debug_assert();
}

#[test]
fn nothing_is_set_without_flags() {
    assert_eq!(leaves(&flags(&[]), ""), BTreeMap::new());
}

#[test]
fn every_setting_has_one_flag_whose_help_tells_the_default() {
    let mut settings = Settings::default();
    settings.filter.radius = Some(0.5); // the box's
    let mut expected = leaves(&Table::try_from(&settings).unwrap(), "");
    expected.insert("display.exposure".to_owned(), "1".to_owned()); // which is not written
    expected.insert("vpl.enabled".to_owned(), "false".to_owned()); // the flag is its opposite
    let command = Cli::command();
    let render = command.find_subcommand("render").unwrap();
    let is_setting = |arg: &&clap::Arg| {
        !["Output", "Job", "Performance"].contains(&arg.get_help_heading().unwrap_or("Output"))
            && arg.get_id() != "size"
    };
    for arg in render.get_arguments().filter(is_setting) {
        let flag = arg.get_long().unwrap();
        let choices = arg.get_possible_values();
        let values: Vec<_> =
            if choices.is_empty() { vec!["1"] } else { choices.iter().map(PossibleValue::get_name).collect() };
        let values = if values == ["true", "false"] { vec!["true"] } else { values };
        for value in &values {
            let set = flags(&[&format!("--{flag}={value}")]);
            assert!(set.clone().try_into::<Settings>().is_ok(), "--{flag}={value}");
            assert_eq!(leaves(&set, "").len(), 1, "--{flag}");
        }
        let key = leaves(&flags(&[&format!("--{flag}={}", values[0])]), "").into_keys().next().unwrap();
        let default = expected.remove(&key).unwrap_or_else(|| panic!("--{flag}: no or second flag for {key}"));
        let help = arg.get_help().unwrap().to_string();
        let told = help.split("[default: ").nth(1).unwrap_or_else(|| panic!("--{flag}: no default in the help"));
        let words: Vec<_> = told.split([' ', ',', ';', ']']).collect();
        assert!(words.contains(&default.as_str()), "--{flag}: the help tells {told:?}, the default is {default}");
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
    let command = Cli::command();
    let render = command.find_subcommand("render").unwrap();
    let mut flags_with_words = 0;
    for arg in render.get_arguments() {
        let mut words: Vec<_> = arg.get_possible_values().iter().map(|value| value.get_name().to_owned()).collect();
        let is_setting = !["Output", "Job", "Performance"].contains(&arg.get_help_heading().unwrap_or("Output"));
        if !is_setting || words.is_empty() || words == ["true", "false"] {
            continue;
        }
        let flag = format!("--{}={}", arg.get_long().unwrap(), words[0]);
        let key = leaves(&flags(&[&flag]), "").into_keys().next().unwrap();
        let mut expected = accepted(&key);
        words.sort_unstable();
        expected.sort_unstable();
        assert_eq!(words, expected, "{key}");
        flags_with_words += 1;
    }
    assert_eq!(flags_with_words, 7);
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
