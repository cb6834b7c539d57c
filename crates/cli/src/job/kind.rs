//! Whether a TOML file is a scene or a job, told by the names at its top, so that each is read by what can say what is
//! wrong with it.

use super::diagnostic::TOP_KEYS;
use lightcuts::Settings;
use toml::Table;

/// Keys and tables that scenes have and jobs do not.
const OF_SCENES: [&str; 8] = ["format", "version", "camera", "environment", "material", "mesh", "object", "light"];

/// Whether this is the text of a scene, maybe with errors: it names a format, or has keys of scenes and none of jobs.
pub(super) fn is_scene(text: &str) -> bool {
    let keys = top_keys(text);
    let settings = Table::try_from(Settings::default()).unwrap_or_default();
    let is_of_jobs = |key: &&str| TOP_KEYS.contains(key) || settings.contains_key(*key);
    keys.contains(&"format") || (keys.iter().any(|key| OF_SCENES.contains(key)) && !keys.iter().any(is_of_jobs))
}

/// The first names of all keys and tables at the top, in a text that need not be sound.
fn top_keys(text: &str) -> Vec<&str> {
    let first = |name: &'_ str| name.split(['.', ']', '=']).next().unwrap_or_default().trim().len();
    let mut keys = Vec::new();
    let mut in_table = false;
    for line in text.trim_start_matches('\u{feff}').lines().map(str::trim) {
        if let Some(header) = line.strip_prefix('[') {
            let name = header.trim_start_matches('[').trim_start();
            keys.push(&name[..first(name)]);
            in_table = true;
        } else if !in_table && !line.starts_with('#') && line.contains('=') {
            keys.push(&line[..first(line)]);
        }
    }
    keys
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn scenes_are_told_from_jobs_even_with_errors() {
        let scenes = [
            "format = 'lightcuts-scene'\nversion = 1\n[camera]\n",
            "\u{feff}# a scene\n  format='lightcuts-scene'",
            "format = 'lightcut-scene'",
            "[camera]\nposition = [0, 1, 4]\n",
            "version = 1\n[[object]]\ntype = 'sphere'",
            "[[ light ]]\ntype = 'point'\n[camera\n",
            "camera.position = [0, 0, 1]",
            "[environment]\nradiance = 1",
        ];
        let jobs = [
            "",
            "scene = 'a.toml'\n",
            "[image]\nwidth = 8\n",
            "scene = 'a.txt'\n[camera]\n",
            "[display.local]\nkey = 1\n",
            "[package]\nname = 'x'",
            "# format = 'lightcuts-scene'\n[run]\n",
        ];
        for text in scenes {
            assert!(is_scene(text), "{text:?}");
        }
        for text in jobs {
            assert!(!is_scene(text), "{text:?}");
        }
    }
}
