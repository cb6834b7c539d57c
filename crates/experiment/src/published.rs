//! Figures of others, read from CSV files, to stand beside ours.
//!
//! Times and counts have the columns `table, scene, run, config, first_pass_s, second_pass_s, total_s,
//! light_ratio_percent, vpl_count`; accelerations the columns `table, row` and `SCENE_percent` for each scene. The
//! first line names the columns, in any order. Only a light ratio and an acceleration may be empty.

use serde::{Deserialize, Serialize};
use std::collections::BTreeMap;
use std::fs::File;
use std::io::{self, Read as _};
use std::path::{Path, PathBuf};

/// Longest file in bytes.
const MAX_BYTES: u64 = 16 << 20;
/// What `run` holds where a row is a mean over the runs.
pub const AVERAGE: &str = "average";
/// Ends the name of a column of accelerations.
const PERCENT: &str = "_percent";

/// Published figures.
#[derive(Debug, Clone, Default, PartialEq, Serialize, Deserialize)]
pub struct Published {
    /// What they are from.
    pub source: String,
    /// Times and counts.
    pub times: Vec<PublishedTime>,
    /// Accelerations.
    pub accelerations: Vec<PublishedAcceleration>,
}

/// Published times of a configuration; a row of the CSV with these columns.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PublishedTime {
    /// Table or appendix, such as `5.1` or `C.1`.
    pub table: String,
    /// Name of the scene.
    pub scene: String,
    /// `average` or the number of the run.
    pub run: String,
    /// Name of the configuration.
    pub config: String,
    /// First pass in seconds.
    pub first_pass_s: f64,
    /// Second pass in seconds.
    pub second_pass_s: f64,
    /// Both in seconds.
    pub total_s: f64,
    /// Light ratio in percent; none without lightcuts.
    pub light_ratio_percent: Option<f64>,
    /// Number of VPLs.
    pub vpl_count: u64,
}

/// Published accelerations in percent, one per scene; a row of the CSV `table,row,SCENE_percent,...`.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
pub struct PublishedAcceleration {
    /// Table, such as `5.4`.
    pub table: String,
    /// Name of the row.
    pub row: String,
    /// Percent by name of the scene.
    pub percent: BTreeMap<String, f64>,
}

/// Why published figures cannot be read.
#[derive(Debug, thiserror::Error)]
pub enum PublishedError {
    /// The system refused.
    #[error("cannot read {}: {source}", path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// The system's answer.
        source: io::Error,
    },
    /// The text is not such a table.
    #[error("{}:{line}: {reason}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: u64,
        /// What is wrong with it.
        reason: String,
    },
}

/// What is wrong in which line.
type Fault = (u64, String);

impl Published {
    /// Reads both files, or one, or none; `source` says what the figures are from.
    pub fn read(source: String, times: Option<&Path>, accelerations: Option<&Path>) -> Result<Self, PublishedError> {
        Ok(Self {
            source,
            times: times.map_or(Ok(Vec::new()), |path| read(path, parse_times))?,
            accelerations: accelerations.map_or(Ok(Vec::new()), |path| read(path, parse_accelerations))?,
        })
    }

    /// The times of a table, scene and configuration in a run, which is [`AVERAGE`] or a number.
    pub fn time(&self, table: &str, scene: &str, configuration: &str, run: &str) -> Option<&PublishedTime> {
        self.times
            .iter()
            .find(|time| time.table == table && time.scene == scene && time.config == configuration && time.run == run)
    }

    /// The acceleration in percent of a table's row in a scene.
    pub fn acceleration(&self, table: &str, row: &str, scene: &str) -> Option<f64> {
        let found = self.accelerations.iter().find(|candidate| candidate.table == table && candidate.row == row)?;
        found.percent.get(scene).copied()
    }
}

fn read<T>(path: &Path, parse: impl Fn(&str) -> Result<T, Fault>) -> Result<T, PublishedError> {
    let failed = |source| PublishedError::Io { path: path.to_owned(), source };
    let mut text = String::new();
    File::open(path).and_then(|file| file.take(MAX_BYTES + 1).read_to_string(&mut text)).map_err(failed)?;
    if text.len() as u64 > MAX_BYTES {
        return Err(failed(io::Error::other("it is longer than 16 MiB")));
    }
    parse(&text).map_err(|(line, reason)| PublishedError::Malformed { path: path.to_owned(), line, reason })
}

fn parse_times(text: &str) -> Result<Vec<PublishedTime>, Fault> {
    let mut reader = reader(text);
    let names = reader.headers().map_err(|error| fault(&error))?.clone();
    let mut times = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| fault(&error))?;
        let time: PublishedTime = record.deserialize(Some(&names)).map_err(|error| fault(&error))?;
        // serde takes `NaN` and `inf` for numbers; a table has none.
        let values = [time.first_pass_s, time.second_pass_s, time.total_s].into_iter().chain(time.light_ratio_percent);
        if values.into_iter().any(|value| !value.is_finite() || value < 0.0) {
            return Err((line_of(&record), "times and light ratios are finite numbers from 0 on".to_owned()));
        }
        times.push(time);
    }
    Ok(times)
}

fn parse_accelerations(text: &str) -> Result<Vec<PublishedAcceleration>, Fault> {
    let mut reader = reader(text);
    let names = reader.headers().map_err(|error| fault(&error))?.clone();
    for required in ["table", "row"] {
        if !names.iter().any(|name| name == required) {
            return Err((1, format!("there is no column `{required}`")));
        }
    }
    let mut accelerations = Vec::new();
    for record in reader.records() {
        let record = record.map_err(|error| fault(&error))?;
        accelerations.push(acceleration(&names, &record).map_err(|reason| (line_of(&record), reason))?);
    }
    Ok(accelerations)
}

fn acceleration(names: &csv::StringRecord, record: &csv::StringRecord) -> Result<PublishedAcceleration, String> {
    let mut found = PublishedAcceleration { table: String::new(), row: String::new(), percent: BTreeMap::new() };
    for (name, value) in names.iter().zip(record) {
        match (name, name.strip_suffix(PERCENT)) {
            ("table", _) => value.clone_into(&mut found.table),
            ("row", _) => value.clone_into(&mut found.row),
            (_, Some(_)) if value.is_empty() => {}
            (_, Some(scene)) => {
                let percent = value.parse().ok().filter(|percent: &f64| percent.is_finite());
                let percent = percent.ok_or_else(|| format!("`{value}` in column `{name}` is not a number"))?;
                found.percent.insert(scene.to_owned(), percent);
            }
            (_, None) => return Err(format!("unknown column `{name}`; expected `table`, `row` or `SCENE{PERCENT}`")),
        }
    }
    Ok(found)
}

fn reader(text: &str) -> csv::Reader<&[u8]> {
    csv::ReaderBuilder::new().trim(csv::Trim::All).from_reader(text.as_bytes())
}

fn line_of(record: &csv::StringRecord) -> u64 {
    record.position().map_or(1, csv::Position::line)
}

/// The line is that of the record; the reader's own message would name bytes and fields by number.
fn fault(error: &csv::Error) -> Fault {
    let line = error.position().map_or(1, csv::Position::line);
    let reason = match error.kind() {
        csv::ErrorKind::Deserialize { err, .. } => err.to_string(),
        csv::ErrorKind::UnequalLengths { expected_len, len, .. } => format!("{len} fields instead of {expected_len}"),
        _ => error.to_string(),
    };
    (line, reason)
}

#[cfg(test)]
mod tests {
    use super::*;

    const HEAD: &str = "table,scene,run,config,first_pass_s,second_pass_s,total_s,light_ratio_percent,vpl_count\n";

    #[test]
    fn times_are_read_with_and_without_a_light_ratio() {
        let text = format!("{HEAD}5.1,simple,average,cpu,0.808,76.945,77.753,,271\nC.1, a ,2,b,1,2,3,60.5,4\n");
        let times = parse_times(&text).unwrap();
        assert_eq!(times.len(), 2);
        assert_eq!((times[0].total_s, times[0].light_ratio_percent, times[0].vpl_count), (77.753, None, 271));
        assert_eq!((times[1].scene.as_str(), times[1].light_ratio_percent), ("a", Some(60.5)));
        let published = Published { times, ..Published::default() };
        assert_eq!(published.time("5.1", "simple", "cpu", AVERAGE).unwrap().first_pass_s, 0.808);
        assert!(published.time("5.1", "simple", "cpu", "1").is_none());
    }

    #[test]
    fn columns_may_stand_in_any_order() {
        let times = parse_times(
            "vpl_count,scene,table,run,config,total_s,second_pass_s,first_pass_s,light_ratio_percent\n9,s,5.1,1,c,3,2,1,\n",
        );
        let time = times.unwrap().remove(0);
        assert_eq!((time.first_pass_s, time.second_pass_s, time.total_s, time.vpl_count), (1.0, 2.0, 3.0, 9));
    }

    #[test]
    fn faults_in_times_tell_their_line() {
        let good = "5.1,s,1,c,1,2,3,,4\n";
        let cases = [
            (format!("{HEAD}{good}5.1,s,1,c,one,2,3,,4\n"), 3, "invalid float"),
            (format!("{HEAD}{good}{good}5.1,s,1,c,1,2,3,,4.5\n"), 4, "invalid digit"),
            (format!("{HEAD}5.1,s,1,c,1,2\n"), 2, "6 fields instead of 9"),
            (format!("{HEAD}{good}5.1,s,1,c,NaN,2,3,,4\n"), 3, "finite"),
            (format!("{HEAD}5.1,s,1,c,-1,2,3,,4\n"), 2, "from 0 on"),
            ("table,scene\n5.1,s\n".to_owned(), 2, "missing field `run`"),
            (HEAD.replace("vpl_count", "vpls") + good, 2, "unknown field `vpls`"),
        ];
        for (text, line, expected) in cases {
            let (found, reason) = parse_times(&text).unwrap_err();
            assert_eq!(found, line, "{text}");
            assert!(reason.contains(expected), "{expected} is missing in {reason}");
        }
    }

    #[test]
    fn accelerations_are_read_by_scene() {
        let text = "table,row,simple_percent,big_ship_percent\n5.4,pass 1,-88.262,\n5.6,\"a, b\",1,2.5\n";
        let published = Published { accelerations: parse_accelerations(text).unwrap(), ..Published::default() };
        assert_eq!(published.acceleration("5.4", "pass 1", "simple"), Some(-88.262));
        assert_eq!(published.acceleration("5.4", "pass 1", "big_ship"), None);
        assert_eq!(published.acceleration("5.6", "a, b", "big_ship"), Some(2.5));
    }

    #[test]
    fn faults_in_accelerations_tell_their_line() {
        let cases = [
            ("table,s_percent\n1,2\n", 1, "no column `row`"),
            ("table,row,s_percent\n5.4,a,1\n5.4,b,fast\n", 3, "`fast` in column `s_percent`"),
            ("table,row,s_percent\n5.4,a,inf\n", 2, "is not a number"),
            ("table,row,s\n5.4,a,1\n", 2, "unknown column `s`"),
            ("table,row,s_percent\n5.4,a,1,2\n", 2, "4 fields instead of 3"),
        ];
        for (text, line, expected) in cases {
            let (found, reason) = parse_accelerations(text).unwrap_err();
            assert_eq!(found, line, "{text}");
            assert!(reason.contains(expected), "{expected} is missing in {reason}");
        }
    }

    #[test]
    fn a_file_is_named_in_its_faults() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("times.csv");
        let error = Published::read(String::new(), Some(&path), None).unwrap_err().to_string();
        assert!(error.contains("cannot read") && error.contains("times.csv"), "{error}");
        std::fs::write(&path, format!("{HEAD}x\n")).unwrap();
        let error = Published::read(String::new(), Some(&path), None).unwrap_err().to_string();
        assert!(error.contains("times.csv:2: 1 fields instead of 9"), "{error}");
    }

    #[test]
    fn the_thesis_files_are_read_whole() {
        let (Some(times), Some(accelerations)) =
            (lightcuts_testkit::shared("data/thesis_tables.csv"), lightcuts_testkit::shared("data/thesis_derived.csv"))
        else {
            return;
        };
        let thesis = Published::read("thesis".to_owned(), Some(&times), Some(&accelerations)).unwrap();
        assert_eq!((thesis.times.len(), thesis.accelerations.len()), (48, 6));
        assert_eq!(thesis.acceleration("5.6", "overall", "simple"), Some(9.941));
    }
}
