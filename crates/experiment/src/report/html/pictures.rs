//! Pictures of the page: side by side, under sliders, and FLIP maps.

use crate::report::document::{Map, Pair, Picture, Pictures};
use crate::report::gallery::{Gallery, Held};
use crate::report::number::significant;
use maud::{Markup, html};

/// All of a section.
pub(super) fn markup(pictures: &Pictures, gallery: &mut Gallery<'_>) -> Markup {
    html! {
        div.pictures {
            @for picture in &pictures.items { (figure(picture, gallery)) }
            @for (title, reason) in &pictures.absent {
                figure.picture {
                    div.hole { p { (reason) } }
                    figcaption { (title) }
                }
            }
        }
        @for pair in &pictures.pairs { (comparison(pair, gallery)) }
    }
}

fn figure(picture: &Picture, gallery: &mut Gallery<'_>) -> Markup {
    html! {
        figure.picture {
            (image(picture, gallery))
            figcaption { (picture.title) }
        }
    }
}

/// The picture at its first place, a copy that the script fills in at others, or why there is none.
fn image(picture: &Picture, gallery: &mut Gallery<'_>) -> Markup {
    match gallery.hold(picture) {
        Ok(Held { anchor, width, height, uri: Some(uri) }) => html! {
            img id=(anchor) src=(uri) alt=(picture.alternative) width=(width) height=(height);
        },
        Ok(held) => copy(&held, &picture.alternative),
        Err(reason) => html! { div.hole { p { (reason) } } },
    }
}

fn copy(held: &Held, alternative: &str) -> Markup {
    html! {
        img data-picture=(held.anchor) alt=(alternative) width=(held.width) height=(held.height);
    }
}

fn comparison(pair: &Pair, gallery: &mut Gallery<'_>) -> Markup {
    let (Ok(left), Ok(right)) = (gallery.hold(&pair.left), gallery.hold(&pair.right)) else { return html! {} };
    html! {
        div.comparison {
            figure.slider {
                (stage(pair, &left, &right))
                figcaption {
                    "Left: " b { (pair.left.title) } ". Right: " b { (pair.right.title) } "."
                }
            }
            @if let Some(map) = &pair.map { (flip_map(map, pair, gallery)) }
        }
    }
}

/// The right picture with the left one over it, cut off at the divider. The range input makes the divider reachable by
/// keyboard and for screen readers; dragging is the script's.
fn stage(pair: &Pair, left: &Held, right: &Held) -> Markup {
    let label = format!("Divider: {} on the left, {} on the right", pair.left.title, pair.right.title);
    html! {
        div.stage data-stage="" style={ "aspect-ratio:" (left.width) "/" (left.height) } {
            div.under { (copy(right, &pair.right.alternative)) }
            div.over { (copy(left, &pair.left.alternative)) }
            input type="range" min="0" max="100" step="1" value="50" aria-label=(label);
            span.handle aria-hidden="true" {}
            span.tag.left aria-hidden="true" { (pair.left.title) }
            span.tag.right aria-hidden="true" { (pair.right.title) }
        }
    }
}

fn flip_map(map: &Map, pair: &Pair, gallery: &mut Gallery<'_>) -> Markup {
    let mean = map.mean.map_or("unknown".to_owned(), significant);
    let against = map.against.as_ref().unwrap_or(&pair.left.title);
    html! {
        figure.map {
            (image(&map.picture, gallery))
            figcaption { "FLIP against " (against) ": mean " b { (mean) } ". Bright is where a viewer sees a difference." }
        }
    }
}
