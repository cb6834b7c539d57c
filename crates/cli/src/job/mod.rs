//! The job: which scene, and every setting. Built-in defaults and the scene's recommendations, then job files, then flags.

mod diagnostic;
mod file;
mod merge;
mod path;

pub(crate) use file::{JOB_ATTRIBUTE, JobFile, VERSION_ATTRIBUTE, has_extension, is_job_carrier, require_regular};
pub(crate) use merge::{require_fitting, resolve};

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

/// A job as a file holds it.
#[derive(Serialize)]
#[serde(rename_all = "kebab-case")]
struct JobText<'a> {
    scene: String,
    #[serde(skip_serializing_if = "Vec::is_empty")]
    search_path: Vec<String>,
    #[serde(skip_serializing_if = "Option::is_none")]
    crease_angle: Option<f32>,
    #[serde(skip_serializing_if = "Option::is_none")]
    read_vpls: Option<String>,
    #[serde(flatten)]
    settings: &'a Settings,
}

impl Job {
    /// The whole job as TOML for a file in `directory`: paths are relative to it. Depends on nothing but the job.
    pub(crate) fn to_toml(&self, directory: &Path) -> Result<String, toml::ser::Error> {
        let relative = |path: &PathBuf| path::relative_to(path, directory);
        let mut search_path: Vec<String> = Vec::new();
        for folder in self.search_path.iter().map(relative) {
            if !search_path.contains(&folder) {
                search_path.push(folder);
            }
        }
        toml::to_string(&JobText {
            scene: relative(&self.scene),
            search_path,
            crease_angle: self.crease_angle,
            read_vpls: self.read_vpls.as_ref().map(relative),
            settings: &self.settings,
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;

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
    }
}
