//! `skipgrid merge`: one picture of all its shards.

use super::Outcome;
use super::console::Console;
use super::input::check_picture;
use super::plan::line;
use crate::error::{Error, Result};
use crate::picture::io;
use crate::shards::{self, Merged};
use std::path::{Path, PathBuf};

const DETAILS: &str = "\
The picture is equal to the bit to that of one `skipgrid render`, and so is its file. Shards that are damaged, of another picture \
or of samples that others have are refused by name, and nothing is written. If shards are missing, nothing is written either; the \
commands that make them go to standard output, one a line, and the exit code is 1.

Examples:
  skipgrid merge parts -o cornell.exr
  skipgrid merge parts -o cornell.exr > missing.txt || parallel < missing.txt
  skipgrid merge left.shard.exr right.shard.exr -o cornell.exr";

/// Make one picture of its shards
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    /// Shards, or folders, of which all files `*.shard.exr` are taken
    #[arg(required = true, value_name = "SHARDS")]
    shards: Vec<PathBuf>,

    /// The picture: .exr, .png or .pfm
    #[arg(long = "output", short = 'o', value_name = "OUT")]
    out: PathBuf,
}

/// Merges and writes.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    check_picture(&args.out)?;
    let mut files = Vec::new();
    for path in &args.shards {
        if path.is_dir() {
            files.extend(shards_in(path)?);
        } else {
            files.push(path.clone());
        }
    }
    let progress = console.progress("merging");
    let merged = shards::merge_with(&files, &|done, all, next| progress.at(done as u64, all as u64, next))?;
    drop(progress);
    let (job, film) = match merged {
        Merged::Whole(job, film) => (job, film),
        Merged::Missing(job, places) => {
            let folder = files[0].parent().unwrap_or(Path::new(""));
            for place in &places {
                console.data(&(line(&job, place, &[], folder)? + "\n"))?;
            }
            let (all, first) = (places.len(), &places[0]);
            let commands = "the commands on standard output make what is missing";
            console.error(format!("{all} of the shards are missing, the first one is {first}; {commands}"));
            return Ok(Outcome::CheckFailed);
        }
    };
    io::write(&args.out, &film.picture(), &job.attributes)?;
    if film.stats.discarded > 0 {
        console.warn(format!("{} samples were not finite and count as black", film.stats.discarded));
    }
    let rays = film.stats.rays() as f64 / 1e6;
    console.note(format!("{}: {} shards, {rays:.3} million rays", args.out.display(), files.len()));
    Ok(Outcome::Done)
}

/// The files of a folder that are called shards, by name.
fn shards_in(folder: &Path) -> Result<Vec<PathBuf>> {
    let fail = |error| Error::io(folder, error);
    let ending = format!(".{}", shards::EXTENSION);
    let mut files = Vec::new();
    for entry in std::fs::read_dir(folder).map_err(fail)? {
        let entry = entry.map_err(fail)?;
        if entry.file_name().to_string_lossy().ends_with(&ending) {
            files.push(entry.path());
        }
    }
    if files.is_empty() {
        return Err(Error::malformed(folder, format!("has no file that ends in {ending}")));
    }
    files.sort();
    Ok(files)
}
