//! The job: which scene, and every setting. Built-in defaults and the scene's recommendations, then job files, then
//! flags.

mod diagnostic;
mod file;
mod kind;
mod merge;
mod path;

pub(crate) use file::{
    COMPLETE_ATTRIBUTE, JOB_ATTRIBUTE, JobFile, VERSION_ATTRIBUTE, has_extension, is_job_carrier, require_picture,
    require_regular,
};
pub(crate) use merge::{model, require_fitting, resolve};

use lightcuts::Settings;
use serde::Serialize;
use std::path::{Path, PathBuf};

/// A finished job. Its paths hold from the current folder.
#[derive(Debug)]
pub(crate) struct Job {
    pub(crate) scene: PathBuf,
    pub(crate) search_path: Vec<PathBuf>,
    /// Angle in degrees in place of those of the scene's objects.
    pub(crate) crease_angle: Option<f32>,
    pub(crate) read_vpls: Option<PathBuf>,
    pub(crate) settings: Settings,
}

/// What a job file holds above the tables of settings.
#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
struct Head {
    scene: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    search_path: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    crease_angle: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    read_vpls: Option<String>,
}

impl Job {
    /// The whole job as TOML for a file in `directory`: paths are relative to it, and settings of the other model of
    /// light are left out. Depends on nothing but the job.
    pub(crate) fn to_toml(&self, directory: &Path) -> Result<String, toml::ser::Error> {
        let relative = |path: &PathBuf| path::relative_to(path, directory);
        let mut search_path: Vec<String> = Vec::new();
        for folder in self.search_path.iter().map(relative) {
            if !search_path.contains(&folder) {
                search_path.push(folder);
            }
        }
        let read_vpls = self.read_vpls.as_ref().map(relative);
        let crease_angle = self.crease_angle;
        let head = toml::to_string(&Head { scene: relative(&self.scene), search_path, crease_angle, read_vpls })?;
        Ok(head + &self.settings.to_toml()?)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lightcuts::rendering::{Model, Run, Scope, keys_of, value_in};

    #[test]
    fn a_job_survives_its_text_exactly() {
        let mut settings = Settings::default();
        settings.filter.radius = Some(1.1);
        settings.gather.threshold = 1e-7 + f32::MIN_POSITIVE;
        settings.run.seed = u32::MAX;
        settings.display.global.max_display_luminance = 0.1;
        let job = Job {
            scene: "a".into(),
            search_path: vec![".".into(), ".".into()],
            crease_angle: Some(0.1),
            read_vpls: None,
            settings,
        };
        let text = job.to_toml(Path::new(".")).unwrap();
        let file = JobFile::parse("job.toml", &text, Path::new(".")).unwrap();
        let file_angle = file.crease_angle;
        assert_eq!(
            resolve(&Settings::default(), &[file], &crate::args::SettingFlags::default()).unwrap(),
            job.settings
        );
        assert!(file_angle == Some(0.1) && text.contains("crease-angle = 0.1\n"), "{text}");
        assert_eq!(text.matches("search-path = [\".\"]").count(), 1, "{text}");
        assert!(text.contains("radius = 1.1\n") && text.contains("max-display-luminance = 0.1\n"), "{text}");
        assert!(!text.contains("[physical]"), "of the other model");
    }

    /// What a job in `text` lends to a render in `model`, or the complaint.
    fn lent(text: &str, model: Model) -> Result<Settings, String> {
        let mut recommended = if model == Model::Thesis { Settings::default() } else { Settings::for_physical() };
        recommended.image.width = 7;
        let file = JobFile::parse("job.toml", text, Path::new("")).map_err(|failure| failure.report.to_string())?;
        let flags = crate::args::SettingFlags::default();
        let settings = resolve(&recommended, &[file], &flags).map_err(|failure| failure.report.to_string())?;
        // A flag names the model.
        Ok(Settings { run: Run { model, ..settings.run }, ..settings })
    }

    #[test]
    fn keys_of_the_other_model_are_refused_with_their_place() {
        let of_thesis = [
            ("[bloom]\nenabled = true", "job.toml:2:11: `bloom.enabled` has no meaning in the physical model"),
            ("[bloom]\nenabled = false", "job.toml:2:11: `bloom.enabled`"),
            ("[run]\nmax-depth = 4", "job.toml:2:13: `run.max-depth`"),
            ("[run]\nmodel = 'physical'\nreproduce = true", "job.toml:3:13: `run.reproduce`"),
            ("[caustics]\nenabled = true\nstep = 2", "job.toml:3:8: `caustics.step`"),
            ("read-vpls = 'v.csv'", "job.toml:1:13: `read-vpls`"),
        ];
        for (text, expected) in of_thesis {
            let found = lent(text, Model::Physical).unwrap_err();
            assert!(found.starts_with(expected), "{text:?}: {found}");
        }
        let found = lent("[image]\nwidth = 9\n[physical]\ntime-limit = 3", Model::Thesis).unwrap_err();
        assert!(
            found.starts_with("job.toml:4:14: `physical.time-limit` has no meaning in the thesis' model"),
            "{found}"
        );
        for model in [Model::Thesis, Model::Physical] {
            let both =
                lent("[image]\nwidth = 9\n[caustics]\nenabled = true\n[filter]\nkind = 'gaussian'", model).unwrap();
            assert!(both.image.width == 9 && both.caustics.enabled);
        }
    }

    #[test]
    fn every_key_is_taken_by_its_model_and_refused_by_the_other() {
        let mut settings = Settings::default();
        settings.filter.radius = Some(1.0);
        let table = toml::Table::try_from(&settings).unwrap();
        for key in keys_of(&table).into_iter().filter(|key| key != "run.model") {
            let text = format!("# a job\n{key} = {}\n", value_in(&table, &key).unwrap());
            for model in [Model::Thesis, Model::Physical] {
                match (lent(&text, model), Scope::of(&key).unwrap().includes(model)) {
                    (Ok(_), true) => {}
                    (Err(said), false) => assert!(
                        said.starts_with("job.toml:2:") && said.contains(&format!("`{key}` has no meaning in the")),
                        "{said}"
                    ),
                    (found, _) => panic!("{text} in {model:?}: {found:?}"),
                }
            }
        }
    }

    #[test]
    fn a_job_of_another_model_lends_what_both_have() {
        let job = "[run]\nmodel = 'thesis'\n[image]\nwidth = 9\n[bloom]\nenabled = true\n[vpl]\nprobability = 0.5";
        let settings = lent(job, Model::Physical).unwrap();
        assert_eq!((settings.image.width, settings.bloom.enabled), (9, false));
        assert_eq!(settings.vpl, Settings::default().vpl);
    }

    #[test]
    fn jobs_of_earlier_versions_held_both_models() {
        for (model, mut settings) in [(Model::Thesis, Settings::default()), (Model::Physical, Settings::for_physical())]
        {
            settings.image.width = 9;
            assert_eq!(lent(&toml::to_string(&settings).unwrap(), model).unwrap(), settings);
            (settings.bloom.radius, settings.physical.vpls) = (13.0, 17);
            let found = lent(&toml::to_string(&settings).unwrap(), model).unwrap_err();
            let expected = if model == Model::Thesis { "`physical.vpls` has no" } else { "`bloom.radius` has no" };
            assert!(found.contains(expected), "{found}");
        }
    }
}
