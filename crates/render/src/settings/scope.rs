//! Which model of light each setting belongs to: the one list behind help texts, the check of flags and job files, and
//! what a written job holds.

use super::{Model, Settings};
use toml::{Table, Value};

/// The models of light in which a setting has a meaning.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Scope {
    /// Both.
    Both,
    /// This one alone.
    Only(Model),
}

use Scope::{Both, Only};

const THESIS: Scope = Only(Model::Thesis);
const PHYSICAL: Scope = Only(Model::Physical);

/// Every setting: a whole table, or one of its keys. None is listed twice.
const SCOPES: [(&str, Scope); 24] = [
    ("run.model", Both),
    ("run.reproduce", THESIS),
    ("run.seed", Both),
    ("run.max-depth", THESIS),
    ("image", Both),
    ("sampling.sampler", THESIS),
    ("sampling.samples", Both),
    ("sampling.adaptive-samples", THESIS),
    ("sampling.adaptive-threshold", THESIS),
    ("filter", Both),
    ("vpl", THESIS),
    ("gather.strategy", Both),
    ("gather.threshold", THESIS),
    ("ambient-occlusion", THESIS),
    ("caustics.enabled", Both),
    ("caustics.step", THESIS),
    ("caustics.radius", THESIS),
    ("caustics.min-photons", THESIS),
    ("caustics.min-reflection", THESIS),
    ("caustics.min-refraction", THESIS),
    ("caustics.min-diffuse", THESIS),
    ("bloom", THESIS),
    ("display", Both),
    ("physical", PHYSICAL),
];

impl Model {
    /// Its word in job files and on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Self::Thesis => "thesis",
            Self::Physical => "physical",
        }
    }

    /// As messages name it: "the thesis' model", "the physical model".
    pub fn title(self) -> &'static str {
        match self {
            Self::Thesis => "the thesis' model",
            Self::Physical => "the physical model",
        }
    }
}

impl Scope {
    /// Of the setting `table.key`; `None` if there is no such setting.
    pub fn of(key: &str) -> Option<Self> {
        let covers = |name: &str| key == name || key.strip_prefix(name).is_some_and(|rest| rest.starts_with('.'));
        SCOPES.iter().find(|(name, _)| covers(name)).map(|(_, scope)| *scope)
    }

    /// Whether the setting has a meaning in this model.
    pub fn includes(self, model: Model) -> bool {
        matches!(self, Both) || self == Only(model)
    }
}

/// Every `table.key` with a value in `table`, in the order of its text or, of a sorted table, by name.
pub fn keys_of(table: &Table) -> Vec<String> {
    let mut found = Vec::new();
    collect(table, "", &mut found);
    found
}

/// The value of `table.key` in `table`.
pub fn value_in<'t>(table: &'t Table, key: &str) -> Option<&'t Value> {
    let mut steps = key.split('.');
    let first = table.get(steps.next()?)?;
    steps.try_fold(first, |value, step| value.get(step))
}

fn collect(table: &Table, prefix: &str, found: &mut Vec<String>) {
    for (key, value) in table {
        match value {
            Value::Table(inner) => collect(inner, &format!("{prefix}{key}."), found),
            _ => found.push(format!("{prefix}{key}")),
        }
    }
}

impl Settings {
    /// The tables of a job file, with those settings only that have a meaning in the model of light.
    pub fn to_toml(&self) -> Result<String, toml::ser::Error> {
        let mut text = String::new();
        let mut table = String::new();
        let mut header = None;
        // Each value stands on a line of its own.
        for line in toml::to_string(self)?.lines() {
            if let Some(name) = line.strip_prefix('[').and_then(|rest| rest.strip_suffix(']')) {
                (table, header) = (name.to_owned(), Some(line.to_owned()));
            } else if let Some((key, _)) = line.split_once(" = ") {
                let scope = Scope::of(&format!("{table}.{key}"));
                if scope.is_none_or(|scope| scope.includes(self.run.model)) {
                    text.extend(header.take().map(|header| format!("\n{header}\n")));
                    text.extend([line, "\n"]);
                }
            }
        }
        Ok(text)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every setting, the optional one too.
    fn all() -> Vec<String> {
        let mut settings = Settings::default();
        settings.filter.radius = Some(1.0);
        keys_of(&Table::try_from(&settings).unwrap())
    }

    #[test]
    fn every_setting_has_one_scope_and_every_scope_a_setting() {
        let all = all();
        let covers = |name: &str, key: &str| key == name || key.starts_with(&format!("{name}."));
        for key in &all {
            assert_eq!(SCOPES.iter().filter(|(name, _)| covers(name, key)).count(), 1, "{key}");
        }
        for (name, _) in SCOPES {
            assert!(all.iter().any(|key| covers(name, key)), "{name} is no setting");
        }
        assert_eq!([Scope::of("vplx.probability"), Scope::of("run"), Scope::of("")], [None; 3]);
    }

    #[test]
    fn a_written_job_holds_what_its_model_knows_and_reads_the_same() {
        for mut settings in [Settings::default(), Settings::for_physical()] {
            settings.filter.radius = Some(1.1);
            let text = settings.to_toml().unwrap();
            assert_eq!(toml::from_str::<Settings>(&text).unwrap(), settings);
            let written = keys_of(&toml::from_str::<Table>(&text).unwrap());
            let mut expected = all();
            expected.retain(|key| Scope::of(key).unwrap().includes(settings.run.model));
            assert_eq!(written, expected);
            assert_eq!(text.contains("[physical]"), settings.run.model == Model::Physical, "{text}");
            assert_eq!(text.contains("[bloom]"), settings.run.model == Model::Thesis, "{text}");
        }
    }
}
