//! Lights made flat.

use bytemuck::Zeroable;
use glam::Vec3;
use lightcuts_kernel::Rules;
use lightcuts_kernel::light::{DIRECTIONAL, HEMISPHERE, Light, OMNI};
use lightcuts_kernel::ray::{normalize_or_zero, spawn_epsilon};
use lightcuts_scene::{LightDesc, LightKind, SceneDesc};

/// All point lights of a scene in file order.
pub(crate) fn flatten(scene: &SceneDesc) -> Vec<Light> {
    let mut lights = Vec::new();
    for desc in &scene.lights {
        push(&mut lights, desc);
    }
    lights
}

fn push(lights: &mut Vec<Light>, desc: &LightDesc) {
    let base = Light {
        attenuation: desc.attenuation,
        specular: desc.specular,
        diffuse: desc.diffuse,
        ambient: desc.ambient,
        ..Light::zeroed()
    };
    match desc.kind {
        LightKind::Omni { position } => lights.push(Light { kind: OMNI, position, ..base }),
        LightKind::Hemisphere { position, direction } => {
            lights.push(Light { kind: HEMISPHERE, position, direction: normalize_or_zero(direction), ..base });
        }
        LightKind::Directional { direction } => {
            lights.push(Light { kind: DIRECTIONAL, direction: normalize_or_zero(direction), ..base });
        }
        LightKind::Area { center, normal, head, width, height, .. } => {
            let cells = desc.kind.subdivision().expect("an area light is subdivided");
            push_cells(lights, base, &Square::new(center, normal, head, width, height), cells);
        }
    }
}

/// An area light's geometry.
pub(crate) struct Square {
    pub(crate) center: Vec3,
    pub(crate) normal: Vec3,
    pub(crate) along: Vec3,
    pub(crate) across: Vec3,
    pub(crate) width: f32,
    pub(crate) height: f32,
}

impl Square {
    /// The side along `head` has length `height`, the side along cross(head, normal) has length `width`. The head is
    /// made perpendicular to the normal.
    pub(crate) fn new(center: Vec3, normal: Vec3, head: Vec3, width: f32, height: f32) -> Self {
        let normal = normalize_or_zero(normal);
        let along = normalize_or_zero(head - normal * head.dot(normal));
        Self { center, normal, along, across: along.cross(normal), width, height }
    }
}

/// A hemisphere light at the middle of each cell, a little above the square, with an equal share of the colours.
fn push_cells(lights: &mut Vec<Light>, base: Light, square: &Square, (across, along): (u64, u64)) {
    let share = 1.0 / (across * along) as f32;
    let size = square.center.abs().max_element().max(square.width).max(square.height);
    let lift = square.normal * spawn_epsilon(Rules::Repaired, square.center, size);
    let at = |index: u64, cells: u64, length: f32| ((index as f32 + 0.5) / cells as f32 - 0.5) * length;
    for j in 0..along {
        for i in 0..across {
            let offset = square.across * at(i, across, square.width) + square.along * at(j, along, square.height);
            lights.push(Light {
                kind: HEMISPHERE,
                position: square.center + offset + lift,
                direction: square.normal,
                specular: base.specular * share,
                diffuse: base.diffuse * share,
                ambient: base.ambient * share,
                ..base
            });
        }
    }
}
