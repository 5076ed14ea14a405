//! Where the program's words go: data to standard output, all else to standard error.

use crate::error::{Error, Result};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressState, ProgressStyle, WeakProgressBar};
use std::fmt::{Display, Write as _};
use std::io::{ErrorKind, Write, stderr, stdout};
use std::sync::{Mutex, PoisonError};
use std::time::Duration;

/// The form of tables on standard output.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
pub enum Format {
    /// Aligned columns for people
    #[default]
    Text,
    /// One JSON object
    Json,
    /// Comma-separated values with a header
    Csv,
}

/// Prints, and keeps quiet where asked to.
#[derive(Clone, Copy, Debug)]
pub struct Console {
    quiet: bool,
}

impl Console {
    /// `quiet`: only data and errors are printed.
    pub fn new(quiet: bool) -> Self {
        Self { quiet }
    }

    /// Writes `text` to standard output. A reader that has gone away is no error.
    ///
    /// # Errors
    /// Standard output cannot be written to.
    pub fn data(&self, text: &str) -> Result<()> {
        let mut out = stdout().lock();
        match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
            Err(error) if error.kind() != ErrorKind::BrokenPipe => Err(Error::io("standard output", error)),
            _ => Ok(()),
        }
    }

    /// As [`Console::data`], for a JSON value.
    ///
    /// # Errors
    /// As [`Console::data`].
    pub fn json(&self, value: &serde_json::Value) -> Result<()> {
        self.data(&format!("{value:#}\n"))
    }

    /// Says something that is neither data nor a fault.
    pub fn note(&self, text: impl Display) {
        if !self.quiet {
            say("", text);
        }
    }

    /// Says what is odd but no reason to stop.
    pub fn warn(&self, text: impl Display) {
        if !self.quiet {
            say("warning: ", text);
        }
    }

    /// Says why the program stops, even when quiet.
    pub fn error(&self, text: impl Display) {
        say("error: ", text);
    }

    /// Shows that `what` is being done, on the last line of the terminal; nothing if quiet or standard error is no terminal.
    pub fn progress(&self, what: impl Into<String>) -> Progress {
        let target = if self.quiet { ProgressDrawTarget::hidden() } else { ProgressDrawTarget::stderr() };
        let bar = ProgressBar::with_draw_target(None, target);
        if let Ok(style) = ProgressStyle::with_template("{spinner} {wide_msg}") {
            bar.set_style(style.tick_chars(r"-\|/ "));
        }
        bar.set_message(what.into());
        bar.enable_steady_tick(Duration::from_millis(200));
        *shown() = Some(bar.downgrade());
        Progress(bar)
    }
}

/// A line of the terminal that says what is done, how much of it, and how long the rest may take. It goes when this does.
pub struct Progress(ProgressBar);

impl Progress {
    /// `done` of `all` stages are done, `next` comes next; none before this is called.
    pub fn at(&self, done: u64, all: u64, next: &str) {
        if self.0.length().is_none() {
            let template = "{wide_msg} [{bar:24}] {percent:>3} %{left}";
            if let Ok(style) = ProgressStyle::with_template(template) {
                self.0.set_style(style.progress_chars("=> ").with_key("left", left));
            }
        }
        if self.0.message() != next {
            self.0.set_message(next.to_string());
        }
        self.0.set_position(done);
        self.0.set_length(all);
    }
}

impl Drop for Progress {
    fn drop(&mut self) {
        *shown() = None;
        self.0.finish_and_clear();
    }
}

/// The line that is on the terminal, so that other words do not run into it.
static SHOWN: Mutex<Option<WeakProgressBar>> = Mutex::new(None);

fn shown() -> std::sync::MutexGuard<'static, Option<WeakProgressBar>> {
    SHOWN.lock().unwrap_or_else(PoisonError::into_inner)
}

fn left(state: &ProgressState, out: &mut dyn std::fmt::Write) {
    // Into a line in memory.
    let _ = out.write_str(&time_left(state.elapsed(), state.pos(), state.len().unwrap_or(0)));
}

/// What the rest takes if each stage takes what those before it took; nothing as long as that tells little.
fn time_left(elapsed: Duration, done: u64, all: u64) -> String {
    let mut words = String::new();
    if done == 0 || elapsed < Duration::from_secs(1) {
        return words;
    }
    // Up: nobody waits for 0 seconds.
    let seconds = (elapsed.as_secs_f64() / done as f64 * all.saturating_sub(done) as f64).ceil() as u64;
    let (hours, minutes) = (seconds / 3600, seconds / 60 % 60);
    let _ = match (hours, minutes) {
        (0, 0) => write!(words, ", about {seconds} s left"),
        (0, _) => write!(words, ", about {minutes} min {:02} s left", seconds % 60),
        _ => write!(words, ", about {hours} h {minutes:02} min left"),
    };
    words
}

/// One line on standard error. If that fails there is nobody to tell.
pub(super) fn say(kind: &str, text: impl Display) {
    let line = text.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    let print = || {
        let _ = writeln!(stderr().lock(), "skipgrid: {kind}{line}");
    };
    let bar = shown().as_ref().and_then(WeakProgressBar::upgrade);
    match bar {
        Some(bar) => bar.suspend(print),
        None => print(),
    }
}

/// Takes the line of progress away, before the program ends in the middle of its work.
pub(super) fn clear() {
    let bar = shown().take().and_then(|bar| bar.upgrade());
    if let Some(bar) = bar {
        bar.finish_and_clear();
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_time_left_is_said_once_it_can_be_told() {
        let left = |seconds, done, all| time_left(Duration::from_secs_f64(seconds), done, all);
        assert_eq!([left(60.0, 0, 9), left(0.9, 5, 9)], ["", ""]);
        assert_eq!(left(2.0, 1, 9), ", about 16 s left");
        assert_eq!(left(59.5, 1, 3), ", about 1 min 59 s left");
        assert_eq!(left(3600.0, 1, 3), ", about 2 h 00 min left");
        assert_eq!(left(5.0, 9, 9), ", about 0 s left");
    }
}
