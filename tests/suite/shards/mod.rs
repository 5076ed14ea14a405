//! Pictures in shards: equal to the bit to those of one render, or refused; and under runners that others wrote.

mod kills;
mod refusals;
mod runners;
mod same;

use crate::bad_input::{Run, names, shell, skipgrid, write};
use std::fs;
use std::path::{Path, PathBuf};

fn folder(test: &str) -> PathBuf {
    crate::folder("shards", test)
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
