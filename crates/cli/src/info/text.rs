//! The same for people.

use super::picture::{PictureInfo, Rectangle, Windows};
use super::scene::{Camera, Object, Parameter, SceneInfo, Texture};

/// Objects, lights and materials that are listed; more are only counted.
const MAX_LISTED: usize = 100;

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
    let header = ["", "line", "kind", "F R K E", "triangles", "material", "texture"];
    lines.extend(table(header, &info.objects, row));
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
    let incomplete = if info.complete { String::new() } else { line("complete", "no: the render was interrupted") };
    line("picture", &info.file)
        + &line("format", info.format)
        + &line("size", &format!("{} x {}", info.width, info.height))
        + &info.window.as_ref().map_or_else(String::new, window)
        + &line("layers", &layers.join(", "))
        + &line("version", info.version.as_deref().unwrap_or("unknown"))
        + &incomplete
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

/// A header and a line for each, or nothing; more than some are only counted. The first cell becomes the number.
pub(super) fn table<T, const N: usize>(header: [&str; N], all: &[T], row: impl Fn(&T) -> [String; N]) -> Vec<String> {
    if all.is_empty() {
        return Vec::new();
    }
    let numbered = all.iter().take(MAX_LISTED).enumerate().map(|(i, one)| {
        let mut cells = row(one);
        cells[0] = (i + 1).to_string();
        cells
    });
    let rows: Vec<[String; N]> = std::iter::once(header.map(str::to_owned)).chain(numbered).collect();
    aligned(&rows).into_iter().chain(more(all.len())).collect()
}

/// A line for each row, with cells of one column below each other.
fn aligned<const N: usize>(rows: &[[String; N]]) -> Vec<String> {
    let width = |column: usize| rows.iter().map(|row| row[column].chars().count()).max().unwrap_or(0);
    let widths: Vec<_> = (0..N).map(width).collect();
    let line = |row: &[String; N]| {
        let cells = row.iter().zip(&widths).map(|(cell, &width)| format!("{cell:<width$}"));
        format!("  {}\n", cells.collect::<Vec<_>>().join("  ").trim_end())
    };
    rows.iter().map(line).collect()
}

/// How many there are beside those that are listed.
fn more(all: usize) -> Option<String> {
    (all > MAX_LISTED).then(|| format!("  ... and {} more\n", all - MAX_LISTED))
}

/// Corners, rounded to about a hundred-thousandth of the longest edge: digits below that are rounding noise.
pub(super) fn bounds(corners: [[f32; 3]; 2]) -> String {
    let [lower, upper] = corners;
    let longest = (0..3).map(|axis| f64::from(upper[axis]) - f64::from(lower[axis])).fold(0.0, f64::max);
    let scale = 10_f64.powf(5.0 - longest.log10().floor());
    // A single point is shown as it is. Adding 0 turns -0 into 0.
    let rounded =
        |value: f32| if longest > 0.0 { (f64::from(value) * scale).round() / scale + 0.0 } else { value.into() };
    let [lower, upper] = corners.map(|corner| vector(corner.map(|value| rounded(value) as f32)));
    format!("{lower} to {upper}")
}

fn row(object: &Object) -> [String; 7] {
    let kind = if object.name.is_empty() { object.kind.to_owned() } else { format!("{} {}", object.kind, object.name) };
    let texture = object
        .texture
        .as_ref()
        .map_or(String::new(), |Texture { name, width, height, mode }| format!("{name} {width} x {height} {mode}"));
    let triangles = if object.triangles == 0 { String::new() } else { object.triangles.to_string() };
    let optics = object.optics.map(|ratio| ratio.to_string()).join(" ");
    [String::new(), object.line.to_string(), kind, optics, triangles, object.material.clone(), texture]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bounds_are_rounded_relative_to_their_size() {
        for (corners, expected) in [
            ([[-7.0, 1.192_092_9e-8, -0.35], [7.0, 2.699_999_8, 0.55]], "(-7, 0, -0.35) to (7, 2.7, 0.55)"),
            ([[-5.960_464_5e-8, -1e-7, 0.073_499_99], [1.426_5, 0.0, 0.1]], "(0, 0, 0.0735) to (1.4265, 0, 0.1)"),
            ([[-200.001_92; 3], [200.001_92; 3]], "(-200.002, -200.002, -200.002) to (200.002, 200.002, 200.002)"),
            ([[1.5e-6, 0.0, 1e-13], [2e-6, 1e-6, 3e-6]], "(0.0000015, 0, 0) to (0.000002, 0.000001, 0.000003)"),
            ([[0.4, -3e6, 0.0], [1.6, 123_456.79, 7e6]], "(0, -3000000, 0) to (0, 123460, 7000000)"),
            ([[100_000.13, 0.0, 0.0], [100_001.5, 1.0, 0.0]], "(100000.13, 0, 0) to (100001.5, 1, 0)"),
            ([[0.1, 1e-20, 0.0]; 2], "(0.1, 0.00000000000000000001, 0) to (0.1, 0.00000000000000000001, 0)"),
        ] {
            assert_eq!(bounds(corners), expected);
        }
    }

    #[test]
    fn rounded_bounds_are_those_of_the_box_at_any_scale() {
        for exponent in -36..=36 {
            let size = 10_f32.powi(exponent);
            let corners = [[-0.123_456_79, 0.333_333_34, 1e-9], [0.987_654_3, 0.666_666_7, 0.5]];
            let corners = corners.map(|corner| corner.map(|value: f32| value * size));
            let text = bounds(corners).replace(" to ", ", ").replace(['(', ')'], "");
            let told = text.split(", ").map(|number| number.parse::<f32>().unwrap());
            for (told, exact) in told.zip(corners.into_iter().flatten()) {
                assert!((told - exact).abs() <= 1e-5 * size, "{told} {exact}");
            }
            assert!(text.split(", ").nth(2) == Some("0"), "{text}");
        }
    }
}
