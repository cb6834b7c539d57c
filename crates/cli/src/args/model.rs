//! Which model of light an option belongs to: marked in the help, and looked up among those that were typed.

use super::{AFTER_HELP, Cli, RenderArgs, SettingFlags};
use clap::builder::StyledStr;
use clap::{Arg, Command, CommandFactory, FromArgMatches};
use lightcuts::rendering::{Model, Scope, keys_of};
use toml::Table;

/// Whether an option was given.
type IsGiven = fn(&RenderArgs) -> bool;

/// Options of one model that are no settings.
const OTHERS: [(&str, Model, IsGiven); 5] = [
    ("read-vpls", Model::Thesis, |args| args.job.read_vpls.is_some()),
    ("write-vpls", Model::Thesis, |args| args.output.write_vpls.is_some()),
    ("station-device", Model::Thesis, |args| args.performance.devices.has_stations()),
    ("gpu-budget", Model::Thesis, |args| args.performance.devices.has_budget()),
    ("crease-angle", Model::Physical, |args| args.job.crease.angle.is_some()),
];

/// Settings that take each other's place: of the thesis' model and of the physical one.
const COUNTERPARTS: [[&str; 2]; 2] = [["gather.threshold", "physical.cut-error"], ["vpl.probability", "physical.vpls"]];

/// What the marks in the help mean.
const LEGEND: &str = "\
Options marked (thesis) or (physical) belong to that model of light alone and are errors in the other one.";

/// Parses the command line; help, version and errors end the program here.
pub(crate) fn parse() -> Cli {
    let parsed = Cli::from_arg_matches(&command().get_matches());
    parsed.unwrap_or_else(|error| error.format(&mut command()).exit())
}

/// The command line's declaration, with its model in the help of each option that belongs to one.
pub(crate) fn command() -> Command {
    let after = format!("{LEGEND}\n\n{AFTER_HELP}");
    // It has one default, whatever the model of the picture.
    let of_develop = |arg: Arg| {
        let short = |help: &StyledStr| help.to_string().replace("thesis linear, physical srgb", "srgb");
        let [help, long] = [arg.get_help(), arg.get_long_help()].map(|help| help.map(short).unwrap_or_default());
        arg.help(help).long_help(long)
    };
    Cli::command()
        .mut_subcommand("render", |render| render.mut_args(marked).after_help(after))
        .mut_subcommand("develop", |develop| develop.mut_arg("display.transfer", of_develop))
}

/// The scope of an option, whose id is its key in job files: `None` for those that concern no model.
pub(crate) fn scope_of(id: &str) -> Option<Scope> {
    let other = OTHERS.iter().find(|(name, ..)| *name == id).map(|(_, model, _)| Scope::Only(*model));
    other.or_else(|| Scope::of(id))
}

/// The setting of the other model that takes the place of this one.
pub(crate) fn counterpart_of(id: &str) -> Option<&'static str> {
    let [of_thesis, of_physical] = COUNTERPARTS.into_iter().find(|pair| pair.contains(&id))?;
    Some(if id == of_thesis { of_physical } else { of_thesis })
}

fn marked(arg: Arg) -> Arg {
    let Some(Scope::Only(model)) = scope_of(arg.get_id().as_str()) else { return arg };
    let [short, long] =
        [arg.get_help(), arg.get_long_help()].map(|help| help.map(|text| mark(&text.to_string(), model)));
    let arg = short.into_iter().fold(arg, Arg::help);
    long.into_iter().fold(arg, Arg::long_help)
}

/// `text` with the model behind its first sentence, before the default.
fn mark(text: &str, model: Model) -> String {
    let paragraph = text.find("\n\n").unwrap_or(text.len());
    let place = text[..paragraph].find("[default: ").unwrap_or(paragraph);
    let (before, after) = text.split_at(place);
    let gap = if after.starts_with('[') { " " } else { "" };
    format!("{} ({}){gap}{after}", before.trim_end(), model.name())
}

/// Settings of the physical model that concern VPLs alone.
const OF_VPLS: [&str; 7] = [
    "gather.strategy",
    "physical.vpls",
    "physical.cut-error",
    "physical.max-cut",
    "physical.clamp",
    "physical.compensation",
    "physical.rejection",
];

impl SettingFlags {
    /// The tables of a job file with the keys that were given.
    pub(crate) fn table(&self) -> Table {
        Table::try_from(self).expect("flags are numbers, words and switches")
    }

    /// The option that sets `table.key`, as it was or could be typed.
    pub(crate) fn option_for(&self, key: &str) -> String {
        match key {
            "image.width" if self.image.has_size() => "the width of --size".to_owned(),
            "image.height" if self.image.has_size() => "the height of --size".to_owned(),
            key => typed(key),
        }
    }

    /// The options given that concern VPLs alone in the physical model, as they were typed.
    pub(crate) fn options_of_vpls(&self) -> Vec<String> {
        keys_of(&self.table()).iter().filter(|id| OF_VPLS.contains(&id.as_str())).map(|id| typed(id)).collect()
    }
}

impl RenderArgs {
    /// The options given that have no meaning in a model of light, as they were typed.
    pub(crate) fn foreign_options(&self, model: Model) -> Vec<String> {
        self.foreign(model).iter().map(|id| typed(id)).collect()
    }

    /// The options of a model of light that take the place of those given without a meaning in it, each before that
    /// one.
    pub(crate) fn counterparts(&self, model: Model) -> Vec<[String; 2]> {
        self.foreign(model).iter().filter_map(|id| Some([typed(counterpart_of(id)?), typed(id)])).collect()
    }

    fn foreign(&self, model: Model) -> Vec<String> {
        let others = OTHERS.iter().filter(|(.., is_given)| is_given(self)).map(|(id, ..)| (*id).to_owned());
        let given = keys_of(&self.settings.table()).into_iter().chain(others);
        given.filter(|id| scope_of(id).is_some_and(|scope| !scope.includes(model))).collect()
    }
}

/// The option with this id, or the id where there is none.
fn typed(id: &str) -> String {
    let command = Cli::command();
    let arg =
        command.find_subcommand("render").and_then(|render| render.get_arguments().find(|arg| arg.get_id() == id));
    arg.and_then(Arg::get_long).map_or_else(|| id.to_owned(), |long| format!("--{long}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counterparts_are_options_of_different_models() {
        for [of_thesis, of_physical] in COUNTERPARTS {
            assert!(typed(of_thesis).starts_with("--") && typed(of_physical).starts_with("--"));
            assert!(scope_of(of_thesis).is_some_and(|scope| !scope.includes(Model::Physical)), "{of_thesis}");
            assert!(scope_of(of_physical).is_some_and(|scope| !scope.includes(Model::Thesis)), "{of_physical}");
            assert_eq!((counterpart_of(of_thesis), counterpart_of(of_physical)), (Some(of_physical), Some(of_thesis)));
        }
        assert_eq!(counterpart_of("image.width"), None);
    }

    #[test]
    fn marks_stand_behind_the_first_sentence() {
        let model = Model::Physical;
        assert_eq!(mark("Stop [default: 0]", model), "Stop (physical) [default: 0]");
        assert_eq!(mark("Stop [default: 0]\n\nNow.", model), "Stop (physical) [default: 0]\n\nNow.");
        assert_eq!(mark("Write it.\n\nNow.", model), "Write it. (physical)\n\nNow.");
        assert_eq!(mark("Write it", model), "Write it (physical)");
    }
}
