//! A part of a plan, by names.

use super::Plan;

/// A pattern that fits no scene, configuration or point.
#[derive(Debug, Clone, PartialEq, Eq, thiserror::Error)]
#[error("no scene, configuration or point has the name `{pattern}`")]
pub struct UnknownName {
    /// The pattern.
    pub pattern: String,
    /// The names that there are.
    pub known: Vec<String>,
}

impl Plan {
    /// The jobs, by their numbers and in order, that `patterns` ask for, and the references that these need.
    ///
    /// A pattern is the name of a scene, a configuration or a point, `*` for any characters. Those of one kind add up;
    /// a kind without any is not restricted. Fails if a pattern fits nothing.
    pub fn select(&self, patterns: &[String]) -> Result<Vec<usize>, UnknownName> {
        let header = &self.header;
        let scenes: Vec<&str> = header.scenes.iter().map(|scene| scene.name.as_str()).collect();
        let configurations: Vec<&str> = header.configurations.iter().map(|it| it.name.as_str()).collect();
        let points: Vec<&str> = header.points.iter().map(String::as_str).collect();
        let kinds = [&scenes, &configurations, &points];
        for pattern in patterns {
            if !kinds.iter().any(|names| names.iter().any(|name| fits(pattern, name))) {
                let known = kinds.iter().flat_map(|names| names.iter().map(ToString::to_string)).collect();
                return Err(UnknownName { pattern: pattern.clone(), known });
            }
        }
        let wanted = kinds.map(|names| chosen(patterns, names));
        let fits = |names: &[&str], name: &str| names.contains(&name);
        let mut picked: Vec<bool> = self
            .jobs
            .iter()
            .map(|job| {
                fits(&wanted[0], &job.scene_name)
                    && fits(&wanted[1], &job.configuration)
                    && job.point.as_deref().is_none_or(|point| fits(&wanted[2], point))
            })
            .collect();
        for (i, job) in self.jobs.iter().enumerate() {
            if picked[i] {
                job.references.iter().for_each(|&reference| picked[reference] = true);
            }
        }
        Ok((0..picked.len()).filter(|&i| picked[i]).collect())
    }
}

/// The names that some pattern fits; all names if none of this kind is asked for.
fn chosen<'n>(patterns: &[String], names: &[&'n str]) -> Vec<&'n str> {
    let fitting: Vec<&str> =
        names.iter().copied().filter(|name| patterns.iter().any(|pattern| fits(pattern, name))).collect();
    if fitting.is_empty() { names.to_vec() } else { fitting }
}

/// Whether `name` is `pattern`, in which `*` stands for any characters.
fn fits(pattern: &str, name: &str) -> bool {
    let Some((start, rest)) = pattern.split_once('*') else { return pattern == name };
    let Some(tail) = name.strip_prefix(start) else { return false };
    let starts = tail.char_indices().map(|(i, _)| i).chain([tail.len()]);
    let mut tails = starts.map(|i| &tail[i..]);
    tails.any(|tail| fits(rest, tail))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn stars_stand_for_anything() {
        for (pattern, name) in
            [("cpu", "cpu"), ("*", ""), ("*", "x"), ("c*", "cpu"), ("*u", "cpu"), ("c*-*s", "cpu-lightcuts")]
        {
            assert!(fits(pattern, name), "{pattern} {name}");
        }
        for (pattern, name) in [("cpu", "cpu2"), ("c*", "gpu"), ("*x*", "cpu"), ("", "x"), ("a*a", "a")] {
            assert!(!fits(pattern, name), "{pattern} {name}");
        }
    }
}
