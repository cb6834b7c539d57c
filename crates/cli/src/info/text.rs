//! The same for people.

use super::picture::{PictureInfo, Rectangle, Windows};
use super::scene::{Camera, Object, Parameter, SceneInfo, Texture};

/// Objects, lights and materials that are listed; more are only counted.
pub(super) const MAX_LISTED: usize = 100;

/// Of a scene: a line per matter, a table of the objects.
pub(super) fn of_scene(info: &SceneInfo) -> String {
    let totals = &info.totals;
    let mut lines = vec![
        line("scene", &info.name),
        line("camera", &camera(&info.camera)),
        line("background", &vector(info.background)),
        line("lights", &lights(info)),
        line("objects", &info.objects.len().to_string()),
    ];
    lines.extend(table(&info.objects));
    let amounts = [(totals.triangles, "triangle"), (totals.spheres, "sphere"), (totals.squares, "square")];
    lines.push(line("totals", &amounts.map(|(n, name)| count(n, name)).join(", ")));
    lines.push(line("bounds", &info.bounds.map_or("nothing to see".to_owned(), bounds)));
    lines.push(line("recommended", &recommended(&info.recommended)));
    lines.extend(info.files.iter().map(|file| line("read", file)));
    // The warnings themselves went to standard error.
    lines.push(line("warnings", &info.warnings.len().to_string()));
    lines.join("")
}

/// Of a picture.
pub(super) fn of_picture(info: &PictureInfo) -> String {
    let layers: Vec<_> = info.layers.iter().map(|layer| format!("{} ({})", layer.name, layer.kind)).collect();
    let job = info.job.as_ref().map_or(line("job", "none"), |job| format!("job\n{}\n", indented(job)));
    let window = |windows: &Windows| {
        let told = |window: &Rectangle| {
            format!("{} x {} at column {}, row {}", window.width, window.height, window.x, window.y)
        };
        line("data window", &told(&windows.data)) + &line("display", &told(&windows.display))
    };
    line("picture", &info.file)
        + &line("format", info.format)
        + &line("size", &format!("{} x {}", info.width, info.height))
        + &info.window.as_ref().map_or_else(String::new, window)
        + &line("layers", &layers.join(", "))
        + &line("version", info.version.as_deref().unwrap_or("unknown"))
        + &job
}

pub(super) fn line(name: &str, value: &str) -> String {
    format!("{name:<12} {value}\n")
}

fn indented(text: &str) -> String {
    let lines = text.lines().map(|line| if line.is_empty() { String::new() } else { format!("  {line}") });
    lines.collect::<Vec<_>>().join("\n")
}

pub(super) fn vector([x, y, z]: [f32; 3]) -> String {
    format!("({x}, {y}, {z})")
}

pub(super) fn count(number: usize, name: &str) -> String {
    format!("{number} {name}{}", if number == 1 { "" } else { "s" })
}

fn camera(camera: &Camera) -> String {
    let eye =
        camera.eye_distance.map_or("parallel rays".to_owned(), |d| format!("eye {d} units behind the view plane"));
    let (center, view, up) = (vector(camera.center), vector(camera.view), vector(camera.up));
    format!("{eye}; centre {center}, view {view}, up {up}")
}

fn lights(info: &SceneInfo) -> String {
    let kinds: Vec<_> = info.lights.iter().map(|(kind, number)| format!("{number} {kind}")).collect();
    let kinds = if kinds.is_empty() { "none".to_owned() } else { kinds.join(", ") };
    format!("{kinds}; {}", count(info.emitters, "emitter"))
}

fn recommended(parameters: &[Parameter]) -> String {
    let told =
        parameters.iter().map(
            |&Parameter { name, cpu, gpu }| {
                if cpu == gpu { format!("{name} {cpu}") } else { format!("{name} {cpu} (GPU {gpu})") }
            },
        );
    let told: Vec<_> = told.collect();
    if told.is_empty() { "nothing".to_owned() } else { told.join(", ") }
}

fn table(objects: &[Object]) -> Vec<String> {
    let header = ["", "line", "kind", "F R K E", "triangles", "material", "texture"].map(str::to_owned);
    let rows: Vec<_> = objects.iter().take(MAX_LISTED).enumerate().map(|(i, object)| row(i, object)).collect();
    if rows.is_empty() {
        return Vec::new();
    }
    let rows: Vec<_> = std::iter::once(header).chain(rows).collect();
    aligned(&rows).into_iter().chain(more(objects.len())).collect()
}

/// A line for each row, with cells of one column below each other.
pub(super) fn aligned<const N: usize>(rows: &[[String; N]]) -> Vec<String> {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<_> = (0..N).map(width).collect();
    let line = |row: &[String; N]| {
        let cells = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}"));
        format!("  {}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

/// How many there are beside those that are listed.
pub(super) fn more(all: usize) -> Option<String> {
    (all > MAX_LISTED).then(|| format!("  ... and {} more\n", all - MAX_LISTED))
}

pub(super) fn bounds([lower, upper]: [[f32; 3]; 2]) -> String {
    format!("{} to {}", vector(lower), vector(upper))
}

fn row(index: usize, object: &Object) -> [String; 7] {
    let kind = if object.name.is_empty() { object.kind.to_owned() } else { format!("{} {}", object.kind, object.name) };
    let texture = object
        .texture
        .as_ref()
        .map_or(String::new(), |Texture { name, width, height, mode }| format!("{name} {width} x {height} {mode}"));
    let triangles = if object.triangles == 0 { String::new() } else { object.triangles.to_string() };
    let optics = object.optics.map(|ratio| ratio.to_string()).join(" ");
    [(index + 1).to_string(), object.line.to_string(), kind, optics, triangles, object.material.clone(), texture]
}
