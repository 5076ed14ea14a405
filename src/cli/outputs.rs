//! Where measurements go: to standard output in one form, and to files.

use super::console::{Console, Format};
use super::input::check_folder;
use crate::error::Result;
use crate::picture::io::replace_file;
use serde_json::Value;
use std::path::PathBuf;

/// Where measurements go.
#[derive(Clone, Debug, clap::Args)]
pub struct Outputs {
    /// Where a table with a line for each measurement goes
    #[arg(long, value_name = "FILE")]
    csv: Option<PathBuf>,

    /// Where everything goes as one JSON object
    #[arg(long, value_name = "FILE")]
    json: Option<PathBuf>,

    /// Where the plot goes
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,

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
    /// As a plot.
    pub svg: &'a dyn Fn() -> String,
}

impl Outputs {
    /// Finds out before the work whether the files could be written after it.
    ///
    /// # Errors
    /// A folder is missing.
    pub fn check(&self) -> Result<()> {
        self.csv.iter().chain(&self.json).chain(&self.svg).try_for_each(|file| check_folder(file))
    }

    /// Prints one form, and writes the files that are asked for.
    ///
    /// # Errors
    /// Standard output or a file cannot be written.
    pub fn write(&self, forms: &Forms, console: &Console) -> Result<()> {
        match self.format {
            Format::Text => console.data(&(forms.text)())?,
            Format::Csv => console.data(&(forms.csv)())?,
            Format::Json => console.json(&(forms.json)())?,
        }
        let json = || format!("{:#}\n", (forms.json)());
        let files: [(&Option<PathBuf>, &dyn Fn() -> String); 3] =
            [(&self.csv, forms.csv), (&self.json, &json), (&self.svg, forms.svg)];
        for (file, text) in files {
            let Some(file) = file else { continue };
            replace_file(file, text().as_bytes())?;
            console.note(format!("written: {}", file.display()));
        }
        Ok(())
    }
}
