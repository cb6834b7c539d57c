//! A scene of the physical model, for people.

use super::physical::{Camera, Environment, Light, Material, Object, PhysicalInfo};
use super::text::{bounds, count, line, table, vector};

/// A line per matter, and tables of lights, objects and materials.
pub(super) fn of_physical(info: &PhysicalInfo) -> String {
    let amounts = [(info.triangles, "triangle"), (info.spheres, "sphere"), (info.rectangles, "rectangle")];
    let mut lines = vec![
        line("scene", &info.name),
        line("model", "physical"),
        line("camera", &camera(&info.camera)),
        line("environment", &info.environment.as_ref().map_or("none".to_owned(), environment)),
        line("lights", &lights(info)),
    ];
    lines.extend(table(["", "line", "type", "where", "light"], &info.lights, light));
    lines.push(line("objects", &info.objects.len().to_string()));
    lines.extend(table(["", "line", "type", "name", "material", "triangles", "bounds"], &info.objects, object));
    lines.push(line("materials", &info.materials.len().to_string()));
    lines.extend(table(["", "type", "name", ""], &info.materials, material));
    lines.push(line("images", &info.images.to_string()));
    lines.push(line("totals", &amounts.map(|(n, name)| count(n, name)).join(", ")));
    lines.push(line("smoothed", &smoothed(info)));
    lines.push(line("bounds", &info.bounds.map_or("nothing to see".to_owned(), bounds)));
    lines.extend(info.files.iter().map(|file| line("read", file)));
    // The warnings themselves went to standard error.
    lines.push(line("warnings", &info.warnings.len().to_string()));
    lines.join("")
}

fn camera(camera: &Camera) -> String {
    let view = match (camera.fov, camera.height) {
        (Some(fov), _) => format!("fov {fov} degrees"),
        (None, height) => format!("parallel rays, height {}", height.unwrap_or_default()),
    };
    let lens = match camera.lens_radius {
        0.0 => String::new(),
        radius => format!("; lens radius {radius}, sharp at {}", camera.focus_distance),
    };
    let near = if camera.near > 0.0 { format!("; near {}", camera.near) } else { String::new() };
    let [position, direction, up] = [camera.position, camera.direction, camera.up].map(vector);
    format!("{view}; position {position}, direction {direction}, up {up}{lens}{near}")
}

fn environment(environment: &Environment) -> String {
    let radiance = format!("radiance {}", vector(environment.radiance));
    let image = environment.image.as_ref().map_or(String::new(), |image| format!(" times {image}"));
    let turned =
        if environment.rotate == 0.0 { String::new() } else { format!(", turned by {} degrees", environment.rotate) };
    radiance + &image + &turned
}

fn lights(info: &PhysicalInfo) -> String {
    format!("{}; {}", info.lights.len(), count(info.emissive, "emissive surface"))
}

fn light(light: &Light) -> [String; 5] {
    let place = [
        light.position.map(|position| format!("at {}", vector(position))),
        light.direction.map(|direction| format!("towards {}", vector(direction))),
        light.bounds.map(bounds),
    ];
    let place: Vec<String> = place.into_iter().flatten().collect();
    let value = format!("{} {}", light.quantity, vector(light.value));
    [String::new(), light.line.to_string(), light.kind.to_owned(), place.join(", "), value]
}

fn object(object: &Object) -> [String; 7] {
    let kind = object.mesh.as_ref().map_or(object.kind.to_owned(), |mesh| format!("{} {mesh}", object.kind));
    let triangles = if object.triangles == 0 { String::new() } else { object.triangles.to_string() };
    let bounds = object.bounds.map_or("nothing to see".to_owned(), bounds);
    [String::new(), object.line.to_string(), kind, object.name.clone(), object.material.clone(), triangles, bounds]
}

fn material(material: &Material) -> [String; 4] {
    let emissive = if material.emissive { "emissive" } else { "" };
    [String::new(), material.kind.to_owned(), material.name.clone(), emissive.to_owned()]
}

/// Meshes whose missing normals were made of their faces.
fn smoothed(info: &PhysicalInfo) -> String {
    let told = info.smoothed_meshes.iter().map(|(degrees, number)| {
        format!("{} without normals, up to {degrees} degrees between faces", count_meshes(*number))
    });
    let told: Vec<String> = told.collect();
    if told.is_empty() {
        "none: every mesh has normals, or stays flat by choice or by its crease angle".to_owned()
    } else {
        told.join("; ")
    }
}

fn count_meshes(number: usize) -> String {
    if number == 1 { "1 mesh".to_owned() } else { format!("{number} meshes") }
}
