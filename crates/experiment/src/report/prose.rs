//! Markdown of experiment files as HTML that can do no harm.
//!
//! HTML in it becomes visible text; pictures become their descriptions, for the page loads nothing; links lead to the
//! web or within the page.

use pulldown_cmark::{CowStr, Event, HeadingLevel, Options, Parser, Tag, TagEnd, html};

/// Where links may lead.
const SCHEMES: [&str; 4] = ["https://", "http://", "mailto:", "#"];

/// As HTML.
pub(super) fn to_html(markdown: &str) -> String {
    let options = Options::ENABLE_TABLES | Options::ENABLE_STRIKETHROUGH;
    let mut text = String::new();
    html::push_html(&mut text, Parser::new_ext(markdown, options).filter_map(harmless));
    text
}

fn harmless(event: Event<'_>) -> Option<Event<'_>> {
    match event {
        Event::Html(text) | Event::InlineHtml(text) => Some(Event::Text(text)),
        Event::Start(Tag::HtmlBlock) => Some(Event::Start(Tag::Paragraph)),
        Event::End(TagEnd::HtmlBlock) => Some(Event::End(TagEnd::Paragraph)),
        Event::Start(Tag::Image { .. }) | Event::End(TagEnd::Image) => None,
        Event::Start(Tag::Link { link_type, dest_url, title, id }) => {
            let is_allowed = SCHEMES.iter().any(|scheme| starts_with(&dest_url, scheme));
            // The text stays, as a link to nowhere: the end of the link comes in any case.
            let dest_url = if is_allowed { dest_url } else { CowStr::Borrowed("#") };
            Some(Event::Start(Tag::Link { link_type, dest_url, title, id }))
        }
        Event::Start(Tag::Heading { level, .. }) => {
            let (level, id, classes, attrs) = (lowered(level), None, Vec::new(), Vec::new());
            Some(Event::Start(Tag::Heading { level, id, classes, attrs }))
        }
        Event::End(TagEnd::Heading(level)) => Some(Event::End(TagEnd::Heading(lowered(level)))),
        other => Some(other),
    }
}

fn starts_with(text: &str, start: &str) -> bool {
    text.get(..start.len()).is_some_and(|found| found.eq_ignore_ascii_case(start))
}

/// The page has levels 1 and 2 for itself.
fn lowered(level: HeadingLevel) -> HeadingLevel {
    match level {
        HeadingLevel::H1 => HeadingLevel::H3,
        HeadingLevel::H2 => HeadingLevel::H4,
        _ => HeadingLevel::H5,
    }
}

/// A name as Markdown that shows it letter by letter, also within a table.
pub(super) fn escaped(name: &str) -> String {
    let mut text = String::new();
    for letter in name.chars() {
        match letter {
            '\\' | '`' | '*' | '_' | '[' | ']' | '<' | '>' | '|' | '#' | '~' | '!' | '&' | '$' => {
                text.extend(['\\', letter]);
            }
            _ if letter.is_control() => text.push(' '),
            _ => text.push(letter),
        }
    }
    text
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn markdown_becomes_html() {
        let html = to_html("# A\n\ntext *b* `c` <https://example.org>\n\n| x |\n| - |\n| 1 |\n");
        for expected in ["<h3>A</h3>", "<em>b</em>", "<code>c</code>", "<a href=\"https://example.org\">", "<td>1</td>"]
        {
            assert!(html.contains(expected), "{expected} is missing in {html}");
        }
    }

    #[test]
    fn html_scripts_and_pictures_do_not_get_through() {
        let cases = [
            "<script>alert(1)</script>",
            "text <img src=x onerror=alert(1)> text",
            "![p](http://example.org/p.png)",
            "[a](javascript:alert(1)) [b](JavaScript:alert(1)) [c](data:text/html,x) [d](<java\nscript:x>)",
            "<div onclick=\"x()\">\n\nb\n\n</div>",
            "# h {#id onclick=x}",
            "[x]: javascript:alert(1)\n\n[x]",
        ];
        for markdown in cases {
            let html = to_html(markdown);
            let tree = format!("<div>{html}</div>");
            let tree = roxmltree::Document::parse(&tree).unwrap_or_else(|error| panic!("{error} in {html}"));
            for node in tree.descendants().filter(roxmltree::Node::is_element) {
                assert!(["div", "p", "a", "h3"].contains(&node.tag_name().name()), "{html}");
                for attribute in node.attributes() {
                    assert_eq!((attribute.name(), attribute.value()), ("href", "#"), "{html}");
                }
            }
        }
        assert!(to_html("<b>x</b>").contains("&lt;b&gt;x&lt;/b&gt;"));
    }

    #[test]
    fn escaped_names_show_themselves() {
        let name = "a|b *c* <i>_d_</i> `e` [f](g) ![h] & #1 \\ ~~i~~ $j$\nk";
        let cell = format!("| head |\n| --- |\n| {} |\n", escaped(name));
        let html = to_html(&cell);
        let tree = roxmltree::Document::parse(&html).unwrap();
        let shown = tree.descendants().find(|node| node.has_tag_name("td")).unwrap();
        assert_eq!(shown.text(), Some(name.replace('\n', " ").as_str()), "{html}");
    }
}
