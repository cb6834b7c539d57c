//! An entry of a log of measurements: when, on what and of what the numbers are.

use crate::place;
use anyhow::{Context as _, Result};
use lightcuts::device::processor_name;
use std::fs;
use std::io::Write as _;
use std::path::Path;
use std::process::Command;
use std::time::{SystemTime, UNIX_EPOCH};

/// The log of what is no table of the thesis, relative to the project's root.
const LOG: &str = "benches/LOG.md";

/// What a new log begins with.
pub(crate) const INTRODUCTION: &str = "\
# Measurements

A log, newest entry last. Each entry is what one call prints:

```sh
cargo xtask bench gpu --append          # a GPU
cargo xtask bench rays --append         # rays on the CPU
cargo xtask bench scaling --append      # the physical model: the work of cuts
cargo xtask bench equal-time --append   # the physical model: error after equal time
```

`--help` says what is measured and how. Entries of a software driver, such as llvmpipe, say nothing about GPUs: they show that
the programs run, and how the governor does on a device whose speed changes all the time.
";

/// The entry for a table, of today unless a date is given.
pub(crate) fn entry(date: Option<&str>, runs: u32, table: &str) -> String {
    let median = if runs == 1 { "one run".to_owned() } else { format!("median of {runs} runs") };
    let heading = heading(date, None);
    format!("{heading}{}; {median} per configuration.\n\n{table}", machine())
}

/// As many threads as the machine runs at once.
pub(crate) fn hardware_threads() -> usize {
    std::thread::available_parallelism().map_or(1, std::num::NonZero::get)
}

/// The processor and its threads.
pub(crate) fn machine() -> String {
    format!("{}, {} hardware threads", processor_name(), hardware_threads())
}

/// The heading of an entry: the date, today's unless one is given, the git revision, and of what the numbers are.
pub(crate) fn heading(date: Option<&str>, subject: Option<&str>) -> String {
    let date = date.map_or_else(today, str::to_owned);
    let subject = subject.map(|subject| format!(", {subject}")).unwrap_or_default();
    format!("\n## {date}, revision {}{subject}\n\n", revision())
}

/// Adds an entry to a file; a new file begins with an introduction.
pub(crate) fn append(path: &Path, introduction: &str, entry: &str) -> Result<()> {
    let is_new = fs::metadata(path).map_or(true, |file| file.len() == 0);
    if let Some(folder) = path.parent() {
        fs::create_dir_all(folder).with_context(|| format!("cannot make {}", folder.display()))?;
    }
    let open = fs::OpenOptions::new().append(true).create(true).open(path);
    let mut file = open.with_context(|| format!("cannot open {}", path.display()))?;
    let text = if is_new { introduction.to_owned() + entry } else { entry.to_owned() };
    file.write_all(text.as_bytes()).with_context(|| format!("cannot write to {}", path.display()))?;
    println!("appended to {}", path.display());
    Ok(())
}

/// Adds what was measured to the log, under today's heading.
pub(crate) fn append_to_log(subject: &str, text: &str) -> Result<()> {
    let entry = format!("{}{}.\n\n{}", heading(None, Some(subject)), machine(), text.trim_start());
    append(&place::root().join(LOG), INTRODUCTION, &entry)
}

fn today() -> String {
    let seconds = SystemTime::now().duration_since(UNIX_EPOCH).map_or(0, |elapsed| elapsed.as_secs());
    date_of(seconds / 86_400)
}

/// The date of a day counted from 1970-01-01, as year-month-day.
fn date_of(mut day: u64) -> String {
    let is_leap = |year: u64| year.is_multiple_of(4) && (!year.is_multiple_of(100) || year.is_multiple_of(400));
    let mut year = 1970;
    while day >= 365 + u64::from(is_leap(year)) {
        day -= 365 + u64::from(is_leap(year));
        year += 1;
    }
    let february = 28 + u64::from(is_leap(year));
    let mut month = 1;
    for length in [31, february, 31, 30, 31, 30, 31, 31, 30, 31, 30] {
        if day < length {
            break;
        }
        day -= length;
        month += 1;
    }
    format!("{year:04}-{month:02}-{:02}", day + 1)
}

/// The git revision, with a remark if files have changed since.
fn revision() -> String {
    let git = |arguments: &[&str]| {
        let output = Command::new("git").args(arguments).current_dir(place::root()).output().ok()?;
        output.status.success().then(|| String::from_utf8_lossy(&output.stdout).trim().to_owned())
    };
    let Some(revision) = git(&["rev-parse", "--short=12", "HEAD"]) else { return "unknown".to_owned() };
    match git(&["status", "--porcelain"]) {
        Some(changes) if changes.is_empty() => revision,
        _ => format!("{revision} with changes"),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn days_become_dates() {
        for (day, date) in [
            (0, "1970-01-01"),
            (58, "1970-02-28"),
            (59, "1970-03-01"),
            (11_016, "2000-02-29"),
            (11_017, "2000-03-01"),
            (20_453, "2025-12-31"),
            (20_454, "2026-01-01"),
        ] {
            assert_eq!(date_of(day), date);
        }
    }

    #[test]
    fn an_entry_has_its_date_and_table() {
        let entry = entry(Some("2026-11-30"), 3, "| a |\n");
        assert!(entry.starts_with("\n## 2026-11-30, revision "), "{entry}");
        assert!(entry.ends_with("median of 3 runs per configuration.\n\n| a |\n"), "{entry}");
    }

    #[test]
    fn only_a_new_file_is_introduced() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("benches/LOG.md");
        for entry in ["first\n", "second\n"] {
            append(&path, "# Log\n", entry).unwrap();
        }
        assert_eq!(fs::read_to_string(path).unwrap(), "# Log\nfirst\nsecond\n");
    }
}
