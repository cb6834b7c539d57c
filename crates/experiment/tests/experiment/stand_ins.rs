//! Scenes whose models are not there.

use crate::support::{Folder, HEAD, LIBRARY, MESH, MODEL, PAIR, SCENE, complaint};

fn text() -> String {
    let stand_in = "stand-in = { file = 'plain.txt', note = 'without the model' }\n";
    format!("{HEAD}{stand_in}{PAIR}")
}

/// A scene with a model that is not there, and its stand-in.
fn folder() -> Folder {
    let folder = Folder::new();
    folder.write("scene.txt", format!("{SCENE}{MESH}"));
    folder.write("plain.txt", SCENE);
    folder
}

#[test]
fn the_stand_in_is_rendered_where_a_model_is_missing() {
    let folder = folder();
    let plan = folder.plan(&text());
    assert_eq!(plan.scenes[0].missing, ["a.obj"]);
    assert_eq!(plan.scenes[0].file, folder.at("plain.txt"));
    assert_eq!(plan.header.scenes[0].stand_in.as_deref(), Some("without the model"));
    folder.run(&text());
    assert!(folder.results().rows.iter().all(|row| row.stand_in));
    assert!(folder.try_plan(&format!("{HEAD}{PAIR}")).is_err(), "without a stand-in it is an error");
}

#[test]
fn the_scene_is_rendered_where_the_model_is_found() {
    let folder = folder();
    let before = folder.plan(&text());
    std::fs::create_dir(folder.at("models")).unwrap();
    folder.write("models/a.obj", MODEL);
    folder.write("models/a.mtl", LIBRARY);
    let found = folder.plan(&format!("search-path = ['models']\n{}", text()));
    assert_eq!(found.header.scenes[0].stand_in, None);
    assert_eq!((found.scenes[0].missing.len(), &found.scenes[0].file), (0, &folder.at("scene.txt")));
    assert!(before.jobs.iter().zip(&found.jobs).all(|(before, found)| before.hash != found.hash));
    assert!(folder.plan(&text()).header.scenes[0].stand_in.is_some(), "only on the search path");
}

#[test]
fn a_scene_with_another_fault_is_not_replaced() {
    let folder = folder();
    folder.write("scene.txt", format!("{SCENE}{MESH}L OMNI|POS{{x}}\n"));
    let error = folder.try_plan(&text()).unwrap_err().to_string();
    assert!(error.contains("scene.txt:"), "{error}");
    folder.write("scene.txt", format!("{SCENE}{MESH}"));
    folder.write("a.obj", "f 1 2 3\n");
    let error = folder.try_plan(&text()).unwrap_err().to_string();
    assert!(error.contains("a.obj:1:"), "a model with a fault is not a missing one: {error}");
    std::fs::remove_file(folder.at("a.obj")).unwrap();
    std::fs::remove_file(folder.at("plain.txt")).unwrap();
    let error = complaint(&folder.try_plan(&text()).unwrap_err());
    assert!(error.starts_with("a.toml:7:") && error.contains("plain.txt"), "{error}");
}
