//! `skipgrid validate`: our pictures against those of POV-Ray and Mitsuba.

use super::Outcome;
use super::console::{Console, Format};
use super::input::{DEFAULT_ACCELS, check_folder};
use crate::error::{Error, Result};
use crate::picture::io::replace_file;
use crate::validate::{self, Options};
use serde_json::json;
use std::path::{Path, PathBuf};

/// What marks a folder of reference pictures.
const MANIFEST: &str = "manifest.toml";

const DETAILS: &str = "\
Every scene of the reference folder is rendered with every accelerator. POV-Ray's pictures have no noise and are \
compared pixel by pixel; Mitsuba's are compared tile by tile within the noise of both sides. The pictures of all \
accelerators must be equal to the bit. The exit code is 1 if anything differs.

The reference folder is `reference` in the current folder, else in a folder above the program.

Examples:
  skipgrid validate
  skipgrid validate glass cornell --accel grid:density=8 --report report.html";

/// Compare our pictures with those of POV-Ray and Mitsuba
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    /// Names in the reference folder's manifest; default: all
    cases: Vec<String>,

    /// Accelerator, with options; give it once for each
    #[arg(long = "accel", value_name = "A", default_values = DEFAULT_ACCELS)]
    accels: Vec<String>,

    /// The reference folder
    #[arg(long, value_name = "DIR")]
    reference: Option<PathBuf>,

    /// Where a self-contained HTML page with all pictures goes
    #[arg(long, value_name = "FILE")]
    report: Option<PathBuf>,

    /// Where the pictures go: ours, theirs, difference
    #[arg(long, value_name = "DIR")]
    pictures: Option<PathBuf>,

    /// Worker threads; default: as many as there are cores
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,

    /// Form of the table
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Validates and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    args.report.as_deref().map(check_folder).transpose()?;
    let folder = match &args.reference {
        Some(folder) => folder.clone(),
        None => find_reference()?,
    };
    let bar = console.progress(1);
    let progress = |done: usize, all: usize, next: &str| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
        bar.set_message(next.to_string());
    };
    let options = Options {
        threads: args.threads.map(|n| n as usize),
        keep_pictures: args.report.is_some() || args.pictures.is_some(),
        progress: Some(&progress),
        ..Options::default()
    };
    let report = validate::run(folder.join(MANIFEST), &args.cases, &args.accels, &options);
    bar.finish_and_clear();
    let report = report?;

    match args.format {
        Format::Text => console.data(&format!("{report}\n"))?,
        Format::Csv => console.data(&report.csv())?,
        Format::Json => {
            let version = env!("CARGO_PKG_VERSION");
            console.json(&json!({ "version": version, "passed": report.passed(), "report": report }))?;
        }
    }
    if let Some(file) = &args.report {
        replace_file(file, report.html().as_bytes())?;
        console.note(format!("report: {}", file.display()));
    }
    if let Some(folder) = &args.pictures {
        let count = report.write_pictures(folder)?;
        console.note(format!("{count} pictures in {}", folder.display()));
    }
    Ok(if report.passed() { Outcome::Done } else { Outcome::CheckFailed })
}

/// `reference` in the current folder, else in a folder above the program.
fn find_reference() -> Result<PathBuf> {
    let program = std::env::current_exe().ok();
    let above = program.iter().flat_map(|path| path.ancestors().skip(1));
    std::iter::once(Path::new("."))
        .chain(above)
        .map(|folder| folder.join("reference"))
        .find(|folder| folder.join(MANIFEST).is_file())
        .ok_or_else(|| {
            Error::invalid(format!(
                "no reference/{MANIFEST} in the current folder or above the program; name the folder with --reference"
            ))
        })
}
