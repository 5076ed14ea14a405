//! Pictures in shards: equal to the bit to those of one render, or refused; and under runners that others wrote.

mod kills;
mod refusals;
mod runners;
mod same;

use crate::bad_input::{Run, names, shell, skipgrid, write};
use std::fs;
use std::path::{Path, PathBuf};

/// An empty folder of the test's own.
fn folder(test: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("shards").join(test);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("the target folder is writable");
    folder
}

/// The lines of a plan of `picture`, shards in `parts`.
fn plan(folder: &Path, picture: &[&str], cuts: &[&str]) -> Vec<String> {
    let args = [&["plan"], picture, cuts, &["--shards-in", "parts", "-o", "merged.exr"]].concat();
    let run = skipgrid(folder, &args);
    run.done(&["when they are there: ", " merge parts -o merged.exr"]);
    run.stdout.lines().map(str::to_string).collect()
}

/// Runs a line of a plan as a shell does.
fn follow(folder: &Path, line: &str) -> Run {
    shell(folder, line, &[])
}

fn merge(folder: &Path, out: &str) -> Run {
    skipgrid(folder, &["merge", "parts", "-o", out])
}

/// One render of `picture`, the bytes of its file.
fn unsharded(folder: &Path, picture: &[&str], out: &str) -> Vec<u8> {
    skipgrid(folder, &[&["render"], picture, &["-o", out]].concat()).done(&[]);
    fs::read(folder.join(out)).expect("just written")
}

/// The shards that are there, sorted.
fn shards(folder: &Path) -> Vec<PathBuf> {
    names(&folder.join("parts")).iter().map(|name| folder.join("parts").join(name)).collect()
}
