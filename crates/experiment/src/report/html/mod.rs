//! The report as one page that loads nothing.
//!
//! Every text goes through the template's escaping or through [`prose`](super::prose); charts are escaped by their
//! backend. The page's policy forbids every request and every script but its own, should anything get through.

mod pictures;
mod table;

use super::document::{Block, Chart, Document, Notice, Part, Tone};
use super::gallery::Gallery;
use super::number::roman;
use super::prose;
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use maud::{DOCTYPE, Markup, PreEscaped, html};
use sha2::{Digest as _, Sha256};

const STYLE: &str = include_str!("page.css");
const SCRIPT: &str = include_str!("page.js");

/// Numbers of the last table and figure.
#[derive(Default)]
struct Numbers {
    table: usize,
    figure: usize,
}

/// The whole file.
pub(super) fn page(document: &Document, gallery: &mut Gallery<'_>) -> String {
    let mut numbers = Numbers::default();
    let parts: Vec<Markup> =
        document.parts.iter().enumerate().map(|(i, content)| part(content, i + 1, &mut numbers, gallery)).collect();
    let markup = html! {
        (DOCTYPE)
        html lang="en" {
            (head(&document.title))
            body {
                a.skip href="#content" { "Skip to the content" }
                header {
                    h1 { (document.title) }
                    div.lead { (PreEscaped(prose::to_html(&document.description))) }
                }
                div.layout {
                    (contents(&document.parts))
                    main id="content" {
                        (provenance(document))
                        @for notice in &document.notices { (callout(notice)) }
                        @for part in &parts { (part) }
                    }
                }
                footer { "Made by lightcuts " (env!("CARGO_PKG_VERSION")) ". This page loads nothing from elsewhere." }
                script { (PreEscaped(SCRIPT)) }
            }
        }
    };
    markup.into_string()
}

fn head(title: &str) -> Markup {
    let policy = format!(
        "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'sha256-{}'",
        STANDARD.encode(Sha256::digest(SCRIPT))
    );
    html! {
        head {
            meta charset="utf-8";
            meta http-equiv="Content-Security-Policy" content=(policy);
            meta name="viewport" content="width=device-width, initial-scale=1";
            meta name="color-scheme" content="light dark";
            title { (title) }
            link rel="icon" href="data:,";
            style { (PreEscaped(STYLE)) }
        }
    }
}

fn contents(parts: &[Part]) -> Markup {
    html! {
        nav aria-label="Contents" {
            details open {
                summary { "Contents" }
                ol {
                    @for part in parts {
                        li { a href={ "#" (part.id) } { (part.title) } }
                    }
                }
            }
        }
    }
}

fn provenance(document: &Document) -> Markup {
    html! {
        dl.provenance aria-label="Where the figures come from" {
            @for (term, text) in &document.provenance {
                div { dt { (term) } dd { (text) } }
            }
        }
    }
}

fn part(part: &Part, number: usize, numbers: &mut Numbers, gallery: &mut Gallery<'_>) -> Markup {
    html! {
        section id=(part.id) {
            h2 { span.number { (number) } " " (part.title) }
            (PreEscaped(prose::to_html(&part.text)))
            @for block in &part.blocks {
                @match block {
                    Block::Notice(notice) => (callout(notice)),
                    Block::Table(content) => {
                        @let () = numbers.table += 1;
                        (table::markup(content, numbers.table))
                    }
                    Block::Chart(content) => {
                        @let () = numbers.figure += 1;
                        (chart(content, numbers.figure))
                    }
                    Block::Pictures(content) => (pictures::markup(content, gallery)),
                }
            }
        }
    }
}

fn callout(notice: &Notice) -> Markup {
    let (class, word) = match notice.tone {
        Tone::Finding => ("callout finding", "Result"),
        Tone::Warning => ("callout warning", "Note"),
    };
    html! {
        div class=(class) role="note" {
            p { strong { (word) "." } " " (notice.text) }
            @if !notice.items.is_empty() {
                ul { @for item in &notice.items { li { (item) } } }
            }
        }
    }
}

fn chart(chart: &Chart, number: usize) -> Markup {
    html! {
        figure.chart id={ (chart.id) ":chart" } {
            div.scroll tabindex="0" role="img" aria-label=(chart.alternative) { (PreEscaped(&chart.svg)) }
            figcaption { b { "Figure " (roman(number)) "." } " " (chart.caption) }
        }
    }
}
