//! The page in a real browser.

mod driver;

use crate::fixture::{Results, names, times};
use base64::Engine as _;
use base64::engine::general_purpose::STANDARD;
use driver::Browser;
use lightcuts_experiment::layout::{Content, Quantity};
use serde_json::{Value, json};
use std::path::{Path, PathBuf};

/// The arrow keys and Home in WebDriver.
const LEFT: &str = "\u{e012}";
const RIGHT: &str = "\u{e014}";
const HOME: &str = "\u{e011}";
/// What of the right picture the left one covers, in percent.
const SPLIT: &str = "parseFloat(getComputedStyle(document.querySelector('[data-stage] .over')).clipPath.match(/calc\\(100% - ([0-9.]+)%/)?.[1] \
                     ?? 100 - parseFloat(getComputedStyle(document.querySelector('[data-stage] .over')).clipPath.split(' ')[1]))";

/// A report with everything that a page can show.
fn written() -> (Results, PathBuf) {
    let images = Content::Images {
        scene: "simple".to_owned(),
        configurations: names(&["cpu", "cpu-lightcuts", "gpu"]),
        point: None,
    };
    let agreement = Content::Agreement {
        configurations: names(&["cpu-lightcuts", "gpu"]),
        metrics: names(&["pdiff_px", "flip_ldr", "rmse", "psnr"]),
        published_pass: names(&["simple"]),
    };
    let mut results = Results::new()
        .with_thesis_figures()
        .with_pictures()
        .with("pictures", images)
        .with("times", times("simple", Some("5.1")))
        .with("accelerations", crate::acceleration::section(Some("5.5")))
        .with("agreement", agreement)
        .with("slips", Content::PublishedArithmetic);
    results.scene("venus").stand_in = Some("our statue".to_owned());
    let folder = results.folder().join("report");
    results.try_report().unwrap().write(&folder).unwrap();
    (results, folder.join("index.html"))
}

fn open(browser: &Browser, page: &Path) {
    browser.open(&format!("file://{}", page.display()));
    assert_eq!(browser.value("document.readyState"), "complete");
}

/// Fails if the page complained or asked for anything but itself and its own pictures.
fn assert_quiet(browser: &Browser) {
    assert_eq!(browser.log("browser"), [""; 0], "console");
    let page = browser.handle();
    let mut requests = 0;
    for entry in browser.log("performance") {
        let entry: Value = serde_json::from_str(&entry).unwrap();
        // The browser has pages of its own.
        if entry["webview"] != page {
            continue;
        }
        let (kind, parameters) = (&entry["message"]["method"], &entry["message"]["params"]);
        assert_ne!(kind, "Network.loadingFailed", "{parameters}");
        if kind == "Network.requestWillBeSent" {
            let url = parameters["request"]["url"].as_str().unwrap();
            assert!(url.starts_with("file:") || url.starts_with("data:"), "{url}");
            requests += 1;
        }
    }
    assert!(requests > 0, "the log holds the request of the page itself");
}

#[test]
fn the_page_loads_quietly_and_shows_everything() {
    let Some(browser) = Browser::start() else { return };
    let (_results, page) = written();
    open(&browser, &page);
    assert_eq!(browser.title(), "A small experiment");
    let counts = "['h2', 'table', 'figure.chart svg', '.picture img', '[data-stage]', '.map img', '.hole'].map(s => document.querySelectorAll(s).length)";
    // Tables: times, accelerations, agreement, and three of slips.
    assert_eq!(browser.value(counts), json!([5, 6, 1, 2, 1, 1, 1]));
    let loaded = "[...document.images].every(image => image.complete && image.naturalWidth === 96)";
    assert_eq!(browser.value(loaded), true);
    assert_eq!(browser.value("[...document.images].every(image => image.alt !== '')"), true);
    let unscoped = "[...document.querySelectorAll('th')].filter(head => !head.scope).length";
    assert_eq!(browser.value(unscoped), 0);
    let broken = "[...document.querySelectorAll('a[href^=\"#\"]')].filter(a => !document.getElementById(a.hash.slice(1))).length";
    assert_eq!(browser.value(broken), 0);
    let twice = "(ids => ids.length - new Set(ids).size)([...document.querySelectorAll('[id]')].map(node => node.id))";
    assert_eq!(browser.value(twice), 0);
    assert_quiet(&browser);
}

#[test]
fn the_slider_follows_pointer_and_keyboard() {
    let Some(browser) = Browser::start() else { return };
    let (_results, page) = written();
    open(&browser, &page);
    browser.value("document.querySelector('[data-stage]').scrollIntoView({ block: 'center', behavior: 'instant' })");
    let place = browser.value(
        "(b => [b.left, b.top, b.width, b.height])(document.querySelector('[data-stage]').getBoundingClientRect())",
    );
    let [left, top, width, height] = [0, 1, 2, 3].map(|i| place[i].as_f64().unwrap());
    let at = |share: f64| ((left + share * width) as i64, (top + 0.5 * height) as i64);
    let split = || browser.value(SPLIT).as_f64().unwrap();
    assert!((split() - 50.0).abs() < 0.1, "{}", split());
    browser.drag(at(0.5), at(0.2));
    assert!((split() - 20.0).abs() < 1.0, "{}", split());
    // Where the handle is not, it comes to the pointer.
    browser.drag(at(0.9), at(0.8));
    assert!((split() - 80.0).abs() < 1.0, "{}", split());
    // Past the edge.
    browser.drag(at(0.8), (left as i64 + width as i64 + 40, at(0.0).1));
    assert!((split() - 100.0).abs() < 0.1, "{}", split());
    // The drag left the focus on the range.
    browser.press(&[LEFT, LEFT, LEFT, RIGHT]);
    assert!((split() - 98.0).abs() < 0.1, "{}", split());
    browser.press(&[HOME]);
    assert!(split().abs() < 0.1, "{}", split());
    assert_eq!(browser.value("document.querySelector('[data-stage] input').value"), "0");
    let name = browser.value("document.activeElement.getAttribute('aria-label')");
    assert_eq!(name, "Divider: CPU on the left, CPU, lightcuts on the right");
    assert_quiet(&browser);
}

#[test]
fn the_page_fits_narrow_and_dark_screens() {
    let Some(browser) = Browser::start() else { return };
    let (_results, page) = written();
    let screens = [("light", 1280, "light"), ("dark", 1280, "dark"), ("narrow", 400, "light")];
    for (name, width, scheme) in screens {
        let feature = json!({ "features": [{ "name": "prefers-color-scheme", "value": scheme }] });
        browser.devtools("Emulation.setEmulatedMedia", &feature);
        let size = json!({ "width": width, "height": 900, "deviceScaleFactor": 1, "mobile": false });
        browser.devtools("Emulation.setDeviceMetricsOverride", &size);
        open(&browser, &page);
        let overflow = browser.value("document.documentElement.scrollWidth - document.documentElement.clientWidth");
        assert_eq!(overflow, 0, "{name}: the page scrolls sideways");
        let paper = browser.value("getComputedStyle(document.body).backgroundColor");
        assert_eq!(paper == "rgb(255, 255, 255)", scheme == "light", "{name}: {paper}");
        let chart = browser.value("getComputedStyle(document.querySelector('.chart svg rect')).fill");
        assert_eq!(chart, paper, "{name}: the chart has the page's ground");
        screenshot(&browser, name);
    }
    assert_quiet(&browser);
}

#[test]
fn curves_are_drawn() {
    let Some(browser) = Browser::start() else { return };
    let points = [64, 128, 256, 512, 1024, 4096].map(|n| (n, 0.01 * n as f64, 0.2 * (n as f64).sqrt()));
    let curves = Content::Curves {
        scene: "simple".to_owned(),
        configurations: names(&["cpu", "cpu-lightcuts"]),
        quantity: Quantity::TimePerPixel,
        crossover: Some(["cpu".to_owned(), "cpu-lightcuts".to_owned()]),
    };
    let results = Results::sweep(&points).with("curves", curves);
    let folder = results.folder().join("report");
    results.try_report().unwrap().write(&folder).unwrap();
    open(&browser, &folder.join("index.html"));
    assert_eq!(browser.value("document.querySelectorAll('.chart svg polyline').length > 2"), true);
    // Letters lie within the chart.
    let outside = "(box => [...document.querySelectorAll('.chart text')].map(t => t.getBoundingClientRect())\
                   .filter(b => b.left < box.left - 1 || b.right > box.right + 1 || b.top < box.top - 1 || b.bottom > box.bottom + 1)\
                   .length)(document.querySelector('.chart svg').getBoundingClientRect())";
    assert_eq!(browser.value(outside), 0);
    screenshot(&browser, "curves");
    assert_quiet(&browser);
}

/// The whole page as a picture, for eyes, in the build's folder.
fn screenshot(browser: &Browser, name: &str) {
    let answer = browser.devtools("Page.captureScreenshot", &json!({ "captureBeyondViewport": true }));
    let png = STANDARD.decode(answer["data"].as_str().unwrap()).unwrap();
    let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("report-{name}.png"));
    std::fs::write(&path, &png).unwrap();
    assert!(png.len() > 10_000, "{} is empty", path.display());
}
