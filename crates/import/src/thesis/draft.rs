//! The scene under construction.

use crate::obj::Library;
use crate::report::Report;
use lightcuts_scene::SceneDesc;
use std::rc::Rc;

/// A scene that grows, with what is needed to say where its parts come from. Places are bytes of the scene's text.
#[derive(Debug, Default)]
pub(super) struct Draft {
    pub(super) scene: SceneDesc,
    pub(super) report: Report,
    /// One per material of the scene.
    pub(super) materials: Vec<MaterialOrigin>,
    /// Start of the directive that first used each mesh of the scene.
    pub(super) meshes: Vec<usize>,
    /// Start of the directive of each light, of each object.
    pub(super) lights: Vec<usize>,
    pub(super) objects: Vec<usize>,
}

/// Where a material was described.
#[derive(Debug, Clone)]
pub(super) enum MaterialOrigin {
    /// In the directive that starts there.
    Directive(usize),
    /// Colours and exponent in a library, under this name; ratios in the directive.
    Library(Rc<Library>, String, usize),
}
