//! Which packages have examples in their documentation.

use crate::project::root;
use anyhow::{Context as _, Result};
use std::fs;
use std::path::Path;

/// What may stand behind the fence of an example that is compiled.
const COMPILED: [&str; 6] = ["", "rust", "no_run", "should_panic", "compile_fail", "ignore"];

/// The names of the packages in `crates` whose sources have examples, sorted.
pub(crate) fn packages() -> Result<Vec<String>> {
    let mut names = Vec::new();
    for folder in fs::read_dir(root().join("crates"))? {
        let folder = folder?.path();
        if has_examples(&folder.join("src"))? {
            let manifest = fs::read_to_string(folder.join("Cargo.toml"))?;
            let name = manifest.lines().find_map(|line| line.strip_prefix("name = \"")?.strip_suffix('"'));
            names.push(name.with_context(|| format!("{} has no name", folder.display()))?.to_owned());
        }
    }
    names.sort();
    Ok(names)
}

fn has_examples(folder: &Path) -> Result<bool> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        let has_some = if path.is_dir() {
            has_examples(&path)?
        } else {
            path.extension().is_some_and(|extension| extension == "rs") && has_example(&fs::read_to_string(&path)?)
        };
        if has_some {
            return Ok(true);
        }
    }
    Ok(false)
}

/// Whether a block in the documentation of this source is compiled.
fn has_example(source: &str) -> bool {
    let documentation = source.lines().map(str::trim_start);
    let documentation = documentation.filter_map(|line| line.strip_prefix("///").or_else(|| line.strip_prefix("//!")));
    // Every second fence ends a block.
    let mut fences = documentation.filter_map(|line| line.trim().strip_prefix("```")).step_by(2);
    fences.any(|words| words.split(',').all(|word| COMPILED.contains(&word.trim())))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn examples_are_told_from_other_blocks() {
        let block = |words: &str| format!("/// ```{words}\n/// x\n/// ```\nfn f() {{}}\n");
        assert!(["", "rust", "no_run", "rust,no_run"].iter().all(|words| has_example(&block(words))));
        assert!(!["text", "toml", "wgsl"].iter().any(|words| has_example(&block(words))));
        assert!(has_example(&(block("text") + "//! ```\n//! ```\n")) && !has_example("let fence = \"```\";"));
    }

    #[test]
    fn the_librarys_examples_are_found() {
        let packages = packages().unwrap();
        assert!(packages.contains(&"lightcuts".to_owned()) && !packages.contains(&"lightcuts-kernel".to_owned()));
    }
}
