//! Where the program's words go: data to standard output, all else to standard error.

use crate::error::{Error, Result};
use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::fmt::Display;
use std::io::{ErrorKind, Write, stderr, stdout};
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

    /// A bar of `length` steps, or a spinner if `length` is 0; nothing if quiet or standard error is no terminal.
    pub fn progress(&self, length: u64) -> ProgressBar {
        if self.quiet {
            return ProgressBar::hidden();
        }
        let bar = ProgressBar::with_draw_target((length > 0).then_some(length), ProgressDrawTarget::stderr());
        let template = if length > 0 { "{msg} {wide_bar} {pos}/{len} {eta}" } else { "{spinner} {msg}" };
        if let Ok(style) = ProgressStyle::with_template(template) {
            bar.set_style(style);
        }
        bar.enable_steady_tick(Duration::from_millis(200));
        bar
    }
}

/// One line on standard error. If that fails there is nobody to tell.
pub(super) fn say(kind: &str, text: impl Display) {
    let line = text.to_string().split_whitespace().collect::<Vec<_>>().join(" ");
    let _ = writeln!(stderr().lock(), "skipgrid: {kind}{line}");
}
