//! The scenes of the thesis' experiment (chapter 5), with what the original program needs for them.

use clap::ValueEnum;
use std::path::Path;

/// The thesis' scenes.
#[derive(Debug, Clone, Copy, PartialEq, Eq, ValueEnum)]
pub(crate) enum Scene {
    Simple,
    Venus,
    Galleon,
}

/// What the original program needs for a scene, and what is wanted of ours.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) struct Reference {
    /// CPU seconds of the original program's CPU path: plain, with lightcuts. Measured on the kind of machine that
    /// `docs/benchmarks.md` names.
    pub(crate) original_cpu_s: [f64; 2],
    /// How many times faster ours is to be.
    pub(crate) target_factor: f64,
}

/// A scene as it is measured here.
#[derive(Debug, Clone, PartialEq)]
pub(crate) struct Case {
    pub(crate) title: String,
    /// File in scenes/thesis.
    pub(crate) file: &'static str,
    /// `None` for a stand-in: its times say nothing about the original's.
    pub(crate) reference: Option<Reference>,
    /// The mesh that a stand-in takes the place of.
    pub(crate) absent_model: Option<&'static str>,
}

impl Scene {
    pub(crate) const ALL: [Self; 3] = [Self::Simple, Self::Venus, Self::Galleon];

    fn title(self) -> &'static str {
        match self {
            Self::Simple => "Simple",
            Self::Venus => "Venus",
            Self::Galleon => "Galleon",
        }
    }

    fn file(self) -> &'static str {
        match self {
            Self::Simple => "simple.txt",
            Self::Venus => "venus.txt",
            Self::Galleon => "galleon.txt",
        }
    }

    /// The mesh that the scene needs, and the scene that stands in where it is absent.
    fn model(self) -> Option<(&'static str, &'static str)> {
        match self {
            Self::Simple => None,
            Self::Venus => Some(("venus.obj", "statue.txt")),
            Self::Galleon => Some(("galleon.obj", "ship.txt")),
        }
    }

    fn reference(self) -> Reference {
        let (original_cpu_s, target_factor) = match self {
            Self::Simple => ([8.8, 14.7], 20.0),
            Self::Venus => ([175.5, 174.9], 150.0),
            Self::Galleon => ([572.6, 489.3], 500.0),
        };
        Reference { original_cpu_s, target_factor }
    }
}

impl Case {
    /// The scene itself if its mesh is in `models`, else its stand-in.
    pub(crate) fn new(scene: Scene, models: &Path) -> Self {
        let title = scene.title();
        match scene.model() {
            Some((model, stand_in)) if !models.join(model).is_file() => Self {
                title: format!("{title} (stand-in)"),
                file: stand_in,
                reference: None,
                absent_model: Some(model),
            },
            _ => Self {
                title: title.to_owned(),
                file: scene.file(),
                reference: Some(scene.reference()),
                absent_model: None,
            },
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stand_ins_take_the_place_of_absent_meshes() {
        let folder = tempfile::tempdir().unwrap();
        std::fs::write(folder.path().join("venus.obj"), "").unwrap();
        let cases = Scene::ALL.map(|scene| Case::new(scene, folder.path()));
        assert_eq!(cases.clone().map(|case| case.file), ["simple.txt", "venus.txt", "ship.txt"]);
        assert_eq!(cases.map(|case| case.reference.is_some()), [true, true, false]);
    }
}
