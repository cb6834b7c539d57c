//! Progress on standard error, in three styles, and the render's ear for signals.

use crate::args::ProgressStyle;
use crate::{console, interrupt};
use indicatif::{ProgressBar, ProgressStyle as BarStyle};
use lightcuts::{Monitor, Stage};
use std::io::{IsTerminal, stderr};
use std::sync::{Mutex, PoisonError};
use std::time::{Duration, Instant};

/// Least time between two lines of progress.
const PLAIN_PAUSE: Duration = Duration::from_secs(1);
pub(crate) const JSON_PAUSE: Duration = Duration::from_millis(200);

/// Watches a render for the person, or the program, at the other end of standard error.
pub(crate) struct Progress {
    style: ProgressStyle,
    state: Mutex<State>,
}

/// The style asked for; else none if `quiet`, a bar on a terminal that logs do not share, else plain lines.
pub(crate) fn chosen_style(style: Option<ProgressStyle>, quiet: bool, logs: bool) -> ProgressStyle {
    style.unwrap_or(match () {
        () if quiet => ProgressStyle::None,
        () if stderr().is_terminal() && !logs => ProgressStyle::Bar,
        () => ProgressStyle::Plain,
    })
}

struct State {
    stage: &'static str,
    done: u64,
    total: u64,
    start: Instant,
    /// When the last line was written, and how many tenths it told.
    told: Instant,
    tenths: u64,
    bar: ProgressBar,
}

impl Progress {
    /// With [`chosen_style`].
    pub(crate) fn new(style: Option<ProgressStyle>, quiet: bool, logs: bool) -> Self {
        let style = chosen_style(style, quiet, logs);
        let now = Instant::now();
        let bar = ProgressBar::hidden();
        Self { style, state: Mutex::new(State { stage: "", done: 0, total: 0, start: now, told: now, tenths: 0, bar }) }
    }

    /// Starts a stage that is none of a render's, as [`Monitor::begin`] starts one that is.
    pub(crate) fn begin_stage(&self, name: &'static str, steps: u64) {
        let now = Instant::now();
        self.with(|state| {
            *state =
                State { stage: name, done: 0, total: steps, start: now, told: now, tenths: 0, bar: state.bar.clone() };
            match self.style {
                ProgressStyle::Bar => state.new_bar(),
                ProgressStyle::Plain => console::note(&format!("{} ...", state.title())),
                ProgressStyle::Json => state.tell_json(),
                ProgressStyle::None => {}
            }
        });
    }

    /// Leaves the line to what comes after.
    pub(crate) fn finish(&self) {
        self.with(|state| state.bar.finish_and_clear());
    }

    /// A panic elsewhere does not make the numbers wrong, so a poisoned lock is as good as any.
    fn with(&self, change: impl FnOnce(&mut State)) {
        change(&mut self.state.lock().unwrap_or_else(PoisonError::into_inner));
    }
}

impl Monitor for Progress {
    fn begin(&self, stage: Stage, steps: u64) {
        self.begin_stage(stage.name(), steps);
    }

    fn advance(&self) {
        self.with(|state| {
            state.done += 1;
            match self.style {
                ProgressStyle::Bar => state.bar.inc(1),
                ProgressStyle::Plain => state.tell_plain_sometimes(),
                ProgressStyle::Json if state.told.elapsed() >= JSON_PAUSE => state.tell_json(),
                ProgressStyle::Json | ProgressStyle::None => {}
            }
        });
    }

    fn end(&self) {
        self.with(|state| match self.style {
            ProgressStyle::Bar => state.bar.finish_and_clear(),
            ProgressStyle::Json => state.tell_json(),
            ProgressStyle::Plain | ProgressStyle::None => {}
        });
    }

    fn note(&self, text: &str) {
        tell_note(self.style, text);
    }

    fn cancelled(&self) -> bool {
        interrupt::came()
    }
}

/// Tells what a person should know whatever the style, above the bar if there is one.
pub(crate) fn tell_note(style: ProgressStyle, text: &str) {
    match style {
        ProgressStyle::Json => console::note(&serde_json::json!({ "note": text }).to_string()),
        _ => console::note(&format!("lightcuts: {text}")),
    }
}

impl State {
    fn title(&self) -> String {
        self.stage.replace('_', " ")
    }

    /// Time left at the pace so far, in seconds.
    fn remaining_s(&self) -> Option<f64> {
        let left = self.total.checked_sub(self.done)?;
        (self.done > 0).then(|| self.start.elapsed().as_secs_f64() / self.done as f64 * left as f64)
    }

    fn new_bar(&mut self) {
        self.bar.finish_and_clear();
        let style = BarStyle::with_template("{msg:12} [{wide_bar}] {percent:>3} %, {eta} left");
        self.bar = ProgressBar::new(self.total).with_message(self.title());
        if let Ok(style) = style {
            self.bar.set_style(style.progress_chars("=> "));
        }
        console::share_with(&self.bar);
        self.bar.tick();
    }

    /// A line per tenth, unless tenths are quick.
    fn tell_plain_sometimes(&mut self) {
        let tenths = self.done * 10 / self.total.max(1);
        if tenths > self.tenths && tenths < 10 && self.told.elapsed() >= PLAIN_PAUSE {
            let left = self.remaining_s().unwrap_or_default();
            console::note(&format!("{} {} %, about {left:.0} s left", self.title(), tenths * 10));
            self.told = Instant::now();
            self.tenths = tenths;
        }
    }

    fn tell_json(&mut self) {
        let line = serde_json::json!({
            "stage": self.stage,
            "done": self.done,
            "total": self.total,
            "elapsed_s": self.start.elapsed().as_secs_f64(),
            "remaining_s": self.remaining_s(),
        });
        console::note(&line.to_string());
        self.told = Instant::now();
    }
}
