//! Reports: from results to tables, charts and one page, without rendering.
//!
//! [`Report::read`] makes every file in memory; [`Report::write`] writes them:
//!
//! | file | what it is |
//! | --- | --- |
//! | `tables/ID.csv` | each table for machines |
//! | `charts/ID.svg` | each chart |
//! | `report.md` | everything but the pictures, as Markdown |
//! | `index.html` | everything in one page that loads nothing |

mod chart;
mod device;
mod document;
mod gallery;
mod html;
mod markdown;
mod measured;
mod number;
mod prose;
mod provenance;
mod section;

pub use chart::curves::{Line, LogChart, Mark, Point};

use crate::layout::Section;
use crate::record::Header;
use crate::results::{Results, ResultsError};
use document::{Block, Document};
use gallery::Gallery;
use lightcuts::image::{ImageError, write_atomic};
use measured::Measured;
use std::collections::BTreeSet;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

/// A report whose files are made and not written yet.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Report {
    /// Files with their content in the order of writing; names are relative to the report's folder.
    pub files: Vec<(PathBuf, Vec<u8>)>,
    /// Pictures that the page cannot show, with the reasons; the page says the same.
    pub missing: Vec<String>,
}

/// Why there is no report.
#[derive(Debug, thiserror::Error)]
pub enum ReportError {
    /// The results cannot be read.
    #[error(transparent)]
    Results(#[from] ResultsError),
    /// The file holds no header.
    #[error("{} holds no experiment yet: its first line is missing", path.display())]
    NoHeader {
        /// The file.
        path: PathBuf,
    },
    /// A section refers to something that does not exist.
    #[error("{}: section `{section}`: {reason}", path.display())]
    Section {
        /// The file.
        path: PathBuf,
        /// Its id.
        section: String,
        /// What is wrong with it.
        reason: String,
    },
    /// The report's folder cannot be made.
    #[error("cannot make the folder {}: {source}", path.display())]
    Folder {
        /// The folder.
        path: PathBuf,
        /// The system's answer.
        source: io::Error,
    },
    /// A file cannot be written.
    #[error(transparent)]
    Write(#[from] ImageError),
}

impl Report {
    /// Makes the report of a file of results, whose pictures lie where its rows say. A missing picture is no failure.
    pub fn read(path: &Path) -> Result<Self, ReportError> {
        let results = Results::read(path)?;
        let header = results.header.as_ref().ok_or_else(|| ReportError::NoHeader { path: path.to_owned() })?;
        let refuse = |section: &Section, reason: String| ReportError::Section {
            path: path.to_owned(),
            section: section.id.clone(),
            reason,
        };
        let measured = Measured::new(header, &results);
        let mut parts = Vec::new();
        let mut names = BTreeSet::new();
        for section in &header.sections {
            check_id(&section.id).map_err(|reason| refuse(section, reason))?;
            let part = section::part(&measured, section).map_err(|reason| refuse(section, reason))?;
            let files = part.blocks.iter().filter_map(file_name).chain([section.id.to_lowercase()]);
            // A table and a chart may share a name with their section, two sections may not.
            if let Some(taken) = files.collect::<BTreeSet<_>>().into_iter().find(|name| !names.insert(name.clone())) {
                return Err(refuse(section, format!("another section has files with the name `{taken}`")));
            }
            parts.push(part);
        }
        Ok(Self::of(&document(header, &measured, parts), path.parent().unwrap_or(Path::new(""))))
    }

    fn of(document: &Document, pictures: &Path) -> Self {
        let mut files = Vec::new();
        for block in document.parts.iter().flat_map(|part| &part.blocks) {
            match block {
                Block::Table(table) => {
                    files.push((format!("tables/{}.csv", table.id).into(), table.csv.to_text().into_bytes()));
                }
                Block::Chart(chart) => {
                    files.push((format!("charts/{}.svg", chart.id).into(), chart.svg.clone().into_bytes()));
                }
                Block::Notice(_) | Block::Pictures(_) => {}
            }
        }
        let mut gallery = Gallery::new(pictures);
        files.push(("report.md".into(), markdown::to_markdown(document).into_bytes()));
        files.push(("index.html".into(), html::page(document, &mut gallery).into_bytes()));
        Self { files, missing: gallery.missing() }
    }

    /// Writes every file into a folder, which is created if absent, each atomically; returns their paths.
    pub fn write(&self, folder: &Path) -> Result<Vec<PathBuf>, ReportError> {
        let mut written = Vec::new();
        for (name, content) in &self.files {
            let path = folder.join(name);
            let parent = path.parent().unwrap_or(folder);
            fs::create_dir_all(parent).map_err(|source| ReportError::Folder { path: parent.to_owned(), source })?;
            write_atomic(&path, content)?;
            written.push(path);
        }
        Ok(written)
    }
}

fn document(header: &Header, measured: &Measured<'_>, parts: Vec<document::Part>) -> Document {
    Document {
        title: header.title.clone(),
        description: header.description.clone(),
        provenance: provenance::terms(measured),
        notices: provenance::notices(measured),
        parts,
    }
}

/// File systems may take upper and lower case for the same.
fn file_name(block: &Block) -> Option<String> {
    match block {
        Block::Table(table) => Some(table.id.to_lowercase()),
        Block::Chart(chart) => Some(chart.id.to_lowercase()),
        Block::Notice(_) | Block::Pictures(_) => None,
    }
}

/// An id becomes a file name and an anchor.
fn check_id(id: &str) -> Result<(), String> {
    let is_word = |c: char| c.is_ascii_alphanumeric() || matches!(c, '-' | '_' | '.');
    if id.is_empty() || id.len() > 80 || id.starts_with('.') || !id.chars().all(is_word) {
        return Err("an id is a word of at most 80 letters, digits, `-`, `_` and `.`".to_owned());
    }
    Ok(())
}
