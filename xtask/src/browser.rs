//! The browser that tests drive: found, or installed where that is possible.

use crate::packages::{Need, is_installed};

/// If set, tests fail where there is no browser; else they skip.
pub(crate) const REQUIRED: &str = "LIGHTCUTS_REQUIRE_BROWSER";
/// Names under which systems install the browser.
const BROWSERS: [&str; 4] = ["chromium", "chromium-browser", "google-chrome", "google-chrome-stable"];
const DRIVER: &str = "chromedriver";

const NEED: Need = Need {
    tests: "tests of pages",
    things: "Chromium and chromedriver",
    is_there,
    debian: &["chromium", "chromium-driver"],
    ubuntu: &["chromium-browser", "chromium-chromedriver"],
};

/// Installs Chromium and its driver unless they are there, if that is allowed; says what it does. Without them tests of
/// pages skip.
pub(crate) fn provide(may_install: bool) {
    NEED.provide(may_install);
}

/// Whether tests shall fail without a browser: where one is, and on build servers.
pub(crate) fn is_required() -> bool {
    NEED.is_required()
}

fn is_there() -> bool {
    BROWSERS.iter().any(|name| is_installed(name)) && is_installed(DRIVER)
}
