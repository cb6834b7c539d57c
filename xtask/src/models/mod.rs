//! The stand-in models of `scenes/models/` and a sky, made by formulas: no third-party mesh or picture is part of the project.

mod field;
mod model;

mod part;
mod reduce;
mod ring;
mod ship;
mod sky;
mod statue;
mod surface;
mod vector;

use std::fs;
use std::path::Path;

use anyhow::{Context as _, Result, ensure};

use self::model::{Material, Model, mtl};

/// What is needed to write one model.
struct Recipe {
    name: &'static str,
    title: &'static str,
    triangles: usize,
    materials: &'static [Material],
    build: fn() -> Result<Model>,
}

const RECIPES: [Recipe; 3] = [
    Recipe {
        name: "statue",
        title: statue::TITLE,
        triangles: statue::TRIANGLES,
        materials: &statue::MATERIALS,
        build: statue::build,
    },
    Recipe {
        name: "ship",
        title: ship::TITLE,
        triangles: ship::TRIANGLES,
        materials: &ship::MATERIALS,
        build: ship::build,
    },
    Recipe {
        name: "ring",
        title: ring::TITLE,
        triangles: ring::TRIANGLES,
        materials: &ring::MATERIALS,
        build: ring::build,
    },
];

/// Writes every model, as OBJ with its MTL, and the sky into `directory`.
pub(crate) fn generate(directory: &Path) -> Result<()> {
    fs::create_dir_all(directory).with_context(|| format!("cannot create {}", directory.display()))?;
    RECIPES.iter().try_for_each(|recipe| recipe.write(directory).with_context(|| format!("model {}", recipe.name)))?;
    sky::write(directory)
}

impl Recipe {
    fn write(&self, directory: &Path) -> Result<()> {
        let model = (self.build)()?;
        let count = model.triangle_count();
        ensure!(count == self.triangles, "has {count} triangles, not {}", self.triangles);
        for (extension, text) in [("obj", model.obj(self.name, self.title)), ("mtl", mtl(self.title, self.materials))] {
            let path = directory.join(self.name).with_extension(extension);
            fs::write(&path, text).with_context(|| format!("cannot write {}", path.display()))?;
        }
        Ok(())
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_model_has_its_triangles_and_the_same_bytes_on_each_run() {
        let folders = ["first", "second"].map(|run| {
            let folder = std::env::temp_dir().join(format!("lightcuts-models-{}-{run}", std::process::id()));
            generate(&folder).expect("the models can be made");
            folder
        });
        for Recipe { name, .. } in RECIPES {
            for extension in ["obj", "mtl"] {
                let [first, second] =
                    folders.each_ref().map(|folder| fs::read(folder.join(name).with_extension(extension)).unwrap());
                assert!(first == second, "{name}.{extension} differs");
            }
        }
        for folder in folders {
            fs::remove_dir_all(folder).unwrap();
        }
    }
}
