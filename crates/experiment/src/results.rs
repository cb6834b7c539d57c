//! The file `results.jsonl`: read whole, written line by line by one process at a time.

use crate::record::{FORMAT, Header, Record, Row};
use serde::Deserialize;
use std::collections::HashMap;
use std::fs::{File, OpenOptions, TryLockError};
use std::io::{self, Read, Seek, SeekFrom, Write};
use std::path::{Path, PathBuf};

/// The name of the file in an experiment's folder.
pub const FILE_NAME: &str = "results.jsonl";

/// Longest file in bytes; a row has about 2 KB.
const MAX_BYTES: u64 = 1 << 30;

/// What a file of results holds.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct Results {
    /// The last header; none in an empty file.
    pub header: Option<Header>,
    /// Every row, the oldest first.
    pub rows: Vec<Row>,
}

/// What a render is, apart from how it is done: of the rows with one key the last one counts.
#[derive(Debug, Clone, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Key<'a> {
    /// Scene.
    pub scene: &'a str,
    /// Configuration.
    pub configuration: &'a str,
    /// Point of the swept parameter.
    pub point: Option<&'a str>,
    /// Seed of the random numbers.
    pub seed: u32,
    /// Number of the run, from 1.
    pub run: u32,
}

/// Why results cannot be read or written.
#[derive(Debug, thiserror::Error)]
pub enum ResultsError {
    /// The system refused.
    #[error("cannot {action} {}: {source}", path.display())]
    Io {
        /// `read`, `write`, ...
        action: &'static str,
        /// The file.
        path: PathBuf,
        /// The system's answer.
        source: io::Error,
    },
    /// Another experiment writes to it.
    #[error("{} is in use by another `lightcuts experiment`", path.display())]
    InUse {
        /// The file.
        path: PathBuf,
    },
    /// It is no regular file, or longer than any experiment makes it.
    #[error("{} {reason}", path.display())]
    Unfit {
        /// The file.
        path: PathBuf,
        /// What it is instead.
        reason: &'static str,
    },
    /// A line is no record.
    #[error("{}:{line}: {reason}", path.display())]
    Malformed {
        /// The file.
        path: PathBuf,
        /// Number of the line, from 1.
        line: usize,
        /// What is wrong with it.
        reason: String,
    },
}

impl Row {
    /// The key of the row.
    pub fn key(&self) -> Key<'_> {
        Key {
            scene: &self.scene,
            configuration: &self.configuration,
            point: self.point.as_deref(),
            seed: self.seed,
            run: self.run,
        }
    }
}

impl Results {
    /// Reads a file. A last line without its end, which a writer that was killed left behind, is passed over.
    pub fn read(path: &Path) -> Result<Self, ResultsError> {
        let failed = |source| ResultsError::Io { action: "read", path: path.to_owned(), source };
        require_regular(path)?;
        let text = read_text(&mut File::open(path).map_err(failed)?, path)?;
        Self::parse(&text[..whole_lines(&text)], path)
    }

    /// Of whole lines; `path` is for messages.
    fn parse(text: &[u8], path: &Path) -> Result<Self, ResultsError> {
        let mut results = Self::default();
        for (i, line) in text.split_inclusive(|&byte| byte == b'\n').enumerate() {
            let malformed = |reason| ResultsError::Malformed { path: path.to_owned(), line: i + 1, reason };
            match parse_line(line).map_err(malformed)? {
                Record::Header(header) => results.header = Some(*header),
                Record::Run(row) => results.rows.push(*row),
            }
        }
        Ok(results)
    }

    /// The rows that count: the last one of each key, by key.
    pub fn current(&self) -> HashMap<Key<'_>, &Row> {
        self.rows.iter().map(|row| (row.key(), row)).collect()
    }
}

/// A file of results that is being written: locked, so that no other process writes to it.
#[derive(Debug)]
pub struct ResultsFile {
    path: PathBuf,
    file: File,
}

impl ResultsFile {
    /// Opens a file, made if absent, and reads what it holds. A last line without its end is cut off.
    pub fn open(path: &Path) -> Result<(Self, Results), ResultsError> {
        let failed = |action| move |source| ResultsError::Io { action, path: path.to_owned(), source };
        if path.exists() {
            require_regular(path)?;
        }
        let options = OpenOptions::new().read(true).append(true).create(true).open(path);
        let mut file = options.map_err(failed("open"))?;
        match file.try_lock() {
            Ok(()) => {}
            Err(TryLockError::WouldBlock) => return Err(ResultsError::InUse { path: path.to_owned() }),
            Err(TryLockError::Error(source)) => return Err(failed("lock")(source)),
        }
        let text = read_text(&mut file, path)?;
        let whole = whole_lines(&text);
        let results = Results::parse(&text[..whole], path)?;
        if whole < text.len() {
            file.set_len(whole as u64).map_err(failed("write"))?;
        }
        file.seek(SeekFrom::End(0)).map_err(failed("write"))?;
        Ok((Self { path: path.to_owned(), file }, results))
    }

    /// Appends a record. When this returns, the record is on the disk: killing the process no longer loses it.
    pub fn append(&mut self, record: &Record) -> Result<(), ResultsError> {
        let failed = |source| ResultsError::Io { action: "write", path: self.path.clone(), source };
        let mut line = serde_json::to_vec(record).map_err(|error| failed(error.into()))?;
        line.push(b'\n');
        self.file.write_all(&line).and_then(|()| self.file.sync_data()).map_err(failed)
    }
}

/// Fails unless there is a regular file: a pipe would be waited for without end.
fn require_regular(path: &Path) -> Result<(), ResultsError> {
    match std::fs::metadata(path) {
        Ok(metadata) if metadata.is_file() => Ok(()),
        Ok(_) => Err(ResultsError::Unfit { path: path.to_owned(), reason: "is not a regular file" }),
        Err(source) => Err(ResultsError::Io { action: "read", path: path.to_owned(), source }),
    }
}

fn read_text(file: &mut File, path: &Path) -> Result<Vec<u8>, ResultsError> {
    let mut bytes = Vec::new();
    let failed = |source| ResultsError::Io { action: "read", path: path.to_owned(), source };
    file.take(MAX_BYTES + 1).read_to_end(&mut bytes).map_err(failed)?;
    if bytes.len() as u64 > MAX_BYTES {
        return Err(ResultsError::Unfit { path: path.to_owned(), reason: "is longer than 1 GiB" });
    }
    Ok(bytes)
}

/// Length of the lines that have their end.
fn whole_lines(text: &[u8]) -> usize {
    text.iter().rposition(|&byte| byte == b'\n').map_or(0, |i| i + 1)
}

fn parse_line(line: &[u8]) -> Result<Record, String> {
    // Before the rest: another format has other keys.
    match serde_json::from_slice(line) {
        Ok(Version { format: Some(format) }) if format != FORMAT => {
            Err(format!("the format is {format}; this version of lightcuts reads {FORMAT}"))
        }
        _ => serde_json::from_slice(line).map_err(|error| format!("this is not a record: {error}")),
    }
}

/// What a header of any format has.
#[derive(Deserialize)]
struct Version {
    format: Option<u32>,
}
