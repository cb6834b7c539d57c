//! Reports of hand-made results: their figures, words and files, and the page in a browser.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on should stop")]

mod acceleration;
mod agreement;
mod arithmetic;
mod browser;
mod curves;
mod devices;
mod fixture;
mod harm;
mod times;
mod whole;
