//! Where measurements go: to standard output in one form, and to files.

use super::console::{Console, Format};
use super::input::check_file;
use crate::error::Result;
use crate::picture::io::replace_file;
use serde_json::Value;
use std::path::{Path, PathBuf};

/// Where measurements go.
#[derive(Clone, Debug, clap::Args)]
pub struct Outputs {
    /// Where a table with a line for each measurement goes
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,

    /// Where everything goes as one JSON object
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Form of the output
    #[arg(long, value_enum, default_value_t)]
    pub format: Format,
}

/// The forms of one measurement, each made only if it is asked for.
pub struct Forms<'a> {
    /// For people.
    pub text: &'a dyn Fn() -> String,
    /// As a table.
    pub csv: &'a dyn Fn() -> String,
    /// Everything.
    pub json: &'a dyn Fn() -> Value,
    /// As a plot or a page, and where that goes.
    pub shown: (Option<&'a Path>, &'a dyn Fn() -> String),
}

/// How much of a measurement there is.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Extent {
    /// All that was asked for.
    Whole,
    /// Some of it: it was interrupted.
    Part,
    /// It was interrupted before anything was finished.
    Nothing,
}

impl Extent {
    /// `finished`: whether there is anything.
    pub fn of(interrupted: bool, finished: bool) -> Self {
        match (interrupted, finished) {
            (false, _) => Self::Whole,
            (true, true) => Self::Part,
            (true, false) => Self::Nothing,
        }
    }
}

impl Outputs {
    /// Finds out before the work whether the files could be written after it, `shown` included.
    ///
    /// # Errors
    /// As [`check_file`].
    pub fn check(&self, shown: Option<&Path>) -> Result<()> {
        let files = [self.csv.as_deref(), self.json.as_deref(), shown];
        files.into_iter().flatten().try_for_each(check_file)
    }

    /// Prints one form, and writes the files that are asked for. A part goes to files called [`partial`].
    ///
    /// # Errors
    /// Standard output or a file cannot be written.
    pub fn write(&self, forms: &Forms, extent: Extent, console: &Console) -> Result<()> {
        if extent == Extent::Nothing {
            console.note("nothing was finished, nothing is written");
            return Ok(());
        }
        let printed = match self.format {
            Format::Text => console.data(&(forms.text)()),
            Format::Csv => console.data(&(forms.csv)()),
            Format::Json => console.json(&(forms.json)()),
        };
        let json = || format!("{:#}\n", (forms.json)());
        let files: [(Option<&Path>, &dyn Fn() -> String); 3] =
            [(self.csv.as_deref(), forms.csv), (self.json.as_deref(), &json), forms.shown];
        for (file, text) in files {
            let Some(file) = file else { continue };
            let file = if extent == Extent::Part { partial(file) } else { file.to_path_buf() };
            replace_file(&file, text().as_bytes())?;
            console.note(format!("written: {}", file.display()));
        }
        // Files are kept even where nobody reads what is printed.
        printed
    }
}

/// The name under which a part of `file` is kept, so that the whole one of an earlier run stays: `.partial` goes before the
/// extension.
pub fn partial(file: &Path) -> PathBuf {
    let extension = file.extension().map(|e| format!(".{}", e.to_string_lossy())).unwrap_or_default();
    file.with_extension(format!("partial{extension}"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn parts_have_names_of_their_own() {
        let names = ["a.csv", "in.b/a.b.csv", "a"].map(|name| partial(Path::new(name)));
        assert_eq!(names, ["a.partial.csv", "in.b/a.b.partial.csv", "a.partial"].map(PathBuf::from));
    }
}
