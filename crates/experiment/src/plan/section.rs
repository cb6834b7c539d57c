//! `[[section]]` tables: the key `shows` names the content, and the content's own keys stand beside it.

use super::fault::{PlanError, Source};
use super::file::Document;
use crate::layout::{Content, Quantity, Section};
use lightcuts::image::metrics::Metric;
use lightcuts::rendering::{TomlFault, value_at};
use serde::Deserialize;
use toml::Spanned;
use toml::de::{DeTable, DeValue, Deserializer, Error, ValueDeserializer};

/// The keys of every section.
const HEAD_KEYS: [&str; 4] = ["id", "title", "text", "shows"];

/// The contents without keys of their own.
const PLAIN: [&str; 2] = ["text", "published-arithmetic"];

/// The keys of every section, read.
#[derive(Deserialize)]
struct Head {
    id: String,
    title: String,
    #[serde(default)]
    text: String,
    shows: Spanned<String>,
}

/// Reads section number `i` of a document that is sound apart from its sections.
pub(super) fn read(source: &Source, i: usize) -> Result<Section, PlanError> {
    let refuse = |error: Error| source.toml(TomlFault::new(&error));
    let value = value_at(&source.text, &format!("section.{i}"));
    let value = value.unwrap_or_else(|| Spanned::new(0..0, DeValue::Boolean(false)));
    let span = value.span();
    let Head { id, title, text, shows } = Head::deserialize(ValueDeserializer::from(value.clone())).map_err(refuse)?;
    let mut keys = DeTable::new();
    if let DeValue::Table(all) = value.into_inner() {
        keys.extend(all.into_iter().filter(|(key, _)| !HEAD_KEYS.contains(&&**key.get_ref())));
    }
    match keys.keys().next().filter(|_| PLAIN.contains(&shows.get_ref().as_str())) {
        Some(key) => Err(source.toml(TomlFault::unknown(key.span(), "key", key.get_ref(), &HEAD_KEYS))),
        None => Ok(Section { id, title, text, content: content(shows, Spanned::new(span, keys)).map_err(refuse)? }),
    }
}

/// A table `{ shows = "x", a = 1 }` is read as the table `{ x = { a = 1 } }`, which keeps the place of each value.
fn content(shows: Spanned<String>, keys: Spanned<DeTable<'_>>) -> Result<Content, Error> {
    let span = keys.span();
    let kind = Spanned::new(shows.span(), shows.into_inner().into());
    let mut outer = DeTable::new();
    outer.insert(kind, Spanned::new(span.clone(), DeValue::Table(keys.into_inner())));
    Content::deserialize(Deserializer::from(Spanned::new(span, outer)))
}

/// Checks that every scene, configuration, point and metric that a section names is there.
pub(super) fn check(source: &Source, document: &Document, sections: &[Section]) -> Result<(), PlanError> {
    for (i, section) in sections.iter().enumerate() {
        let names = Names { source, document, place: format!("section.{i}") };
        super::check::word(source, &format!("section.{i}.id"), &section.id)?;
        if sections[..i].iter().any(|other| other.id == section.id) {
            let message = format!("two sections have the id `{}`", section.id);
            return Err(source.fault(&format!("section.{i}.id"), message, "another id"));
        }
        names.check(&section.content)?;
    }
    Ok(())
}

/// The names that a section at `place` may use.
struct Names<'a> {
    source: &'a Source,
    document: &'a Document,
    place: String,
}

impl Names<'_> {
    fn check(&self, content: &Content) -> Result<(), PlanError> {
        match content {
            Content::Text => Ok(()),
            Content::Times { scene, configurations, published, .. } => {
                self.scene("scene", scene)?;
                self.configurations(configurations)?;
                published.iter().try_for_each(|_| self.publication("published"))
            }
            Content::Acceleration { rows, published, .. } => {
                for (i, row) in rows.iter().enumerate() {
                    self.configuration(&format!("rows.{i}.slow"), &row.slow)?;
                    self.configuration(&format!("rows.{i}.fast"), &row.fast)?;
                }
                published.iter().try_for_each(|_| self.publication("published"))
            }
            Content::Images { scene, configurations, point } => {
                self.scene("scene", scene)?;
                self.configurations(configurations)?;
                point.iter().try_for_each(|point| self.point(point))
            }
            Content::Agreement { configurations, metrics, published_pass } => {
                self.configurations(configurations)?;
                each(metrics).try_for_each(|(i, key)| self.metric(&format!("metrics.{i}"), key))?;
                each(published_pass).try_for_each(|(i, scene)| self.scene(&format!("published-pass.{i}"), scene))
            }
            Content::Curves { scene, configurations, quantity, crossover } => {
                self.scene("scene", scene)?;
                self.configurations(configurations)?;
                if let Quantity::Metric(key) = quantity {
                    self.metric("quantity.metric", key)?;
                }
                let crossover = crossover.as_ref().map_or(&[][..], |both| both);
                each(crossover).try_for_each(|(i, name)| self.configuration(&format!("crossover.{i}"), name))
            }
            Content::PublishedArithmetic => self.publication("shows"),
        }
    }

    fn known<'k>(
        &self,
        key: &str,
        what: &str,
        name: &str,
        known: impl Iterator<Item = &'k str> + Clone,
    ) -> Result<(), PlanError> {
        if known.clone().any(|other| other == name) {
            return Ok(());
        }
        Err(self.source.unknown(&format!("{}.{key}", self.place), what, name, known))
    }

    fn scene(&self, key: &str, name: &str) -> Result<(), PlanError> {
        self.known(key, "scene", name, self.document.scene.iter().map(|scene| scene.name.as_str()))
    }

    fn configuration(&self, key: &str, name: &str) -> Result<(), PlanError> {
        self.known(key, "configuration", name, self.document.configuration.iter().map(|it| it.name.as_str()))
    }

    fn configurations(&self, names: &[String]) -> Result<(), PlanError> {
        if names.is_empty() {
            let place = format!("{}.configurations", self.place);
            return Err(self.source.fault(&place, "there are no configurations", "at least one"));
        }
        each(names).try_for_each(|(i, name)| self.configuration(&format!("configurations.{i}"), name))
    }

    fn point(&self, name: &str) -> Result<(), PlanError> {
        self.known("point", "point", name, self.document.point.iter().map(|point| point.name.as_str()))
    }

    /// A metric that is measured.
    fn metric(&self, key: &str, name: &str) -> Result<(), PlanError> {
        match &self.document.metrics {
            Some(metrics) => self.known(key, "metric", name, metrics.iter().map(String::as_str)),
            None => self.known(key, "metric", name, Metric::ALL.iter().map(|metric| metric.key())),
        }
    }

    fn publication(&self, key: &str) -> Result<(), PlanError> {
        if self.document.published.is_some() {
            return Ok(());
        }
        let place = format!("{}.{key}", self.place);
        Err(self.source.fault(
            &place,
            "there are no published figures",
            "`published = { source = \"...\" }` at the top",
        ))
    }
}

fn each(names: &[String]) -> impl Iterator<Item = (usize, &String)> {
    names.iter().enumerate()
}
