//! Every file of the collection of malformed inputs behaves as its index says.

use crate::shared;
use skipgrid::scene::{LoadOptions, load};
use std::path::Path;

/// What reading a file led to.
enum Outcome {
    Refused(String),
    Read { warnings: Vec<String> },
}

/// Reads a file as whatever its extension says.
fn read(path: &Path) -> Outcome {
    if path.extension().is_some_and(|e| e == "exr") {
        return read_picture(path);
    }
    let spec = path.to_str().expect("the collection's names are UTF-8");
    match load(spec, &LoadOptions::default()) {
        Ok(scene) => Outcome::Read { warnings: scene.warnings },
        Err(e) => Outcome::Refused(e.to_string()),
    }
}

/// EXR files go through the picture reader, which has no warnings.
fn read_picture(path: &Path) -> Outcome {
    match skipgrid::picture::io::read(path) {
        Ok(_) => Outcome::Read { warnings: Vec::new() },
        Err(e) => Outcome::Refused(e.to_string()),
    }
}

/// `None` if the outcome is as expected, else what is wrong.
fn judge(expected: &str, name: &str, outcome: &Outcome) -> Option<String> {
    match (expected, outcome) {
        (_, Outcome::Refused(message)) if !message.contains(name) => {
            Some(format!("the message does not name the file: {message}"))
        }
        ("reject" | "reject-or-warn", Outcome::Refused(_)) => None,
        ("accept-with-warning" | "reject-or-warn", Outcome::Read { warnings }) => {
            // The file at fault may be one that this one refers to.
            let named = warnings.iter().any(|w| w.contains("scenes/malformed/"));
            (!named).then(|| format!("read without a warning that names a file: {warnings:?}"))
        }
        ("accept", Outcome::Read { warnings }) => {
            (!warnings.is_empty()).then(|| format!("read with warnings: {warnings:?}"))
        }
        ("reject", Outcome::Read { .. }) => Some("was read".into()),
        ("accept" | "accept-with-warning", Outcome::Refused(message)) => Some(format!("was refused: {message}")),
        (other, _) => Some(format!("the index expects `{other}`, which this test does not know")),
    }
}

#[test]
fn the_collection_behaves_as_its_index_says() {
    let Some(folder) = shared("scenes/malformed") else { return };
    let index = std::fs::read_to_string(folder.join("INDEX.md")).expect("the index is beside the files");
    let rows: Vec<(String, String)> = index.lines().filter_map(row).collect();
    assert_eq!(rows.len(), 64, "the index lists 64 files");
    let judged = |(name, expected): &(String, String)| {
        judge(expected, name, &read(&folder.join(name))).map(|wrong| format!("{name}: {wrong}"))
    };
    let failures: Vec<String> = rows.iter().filter_map(judged).collect();
    assert!(failures.is_empty(), "{}", failures.join("\n"));
}

/// File and expectation of a row `| file | expected | ...` of the index.
fn row(line: &str) -> Option<(String, String)> {
    let mut cells = line.strip_prefix('|')?.split('|').map(str::trim);
    let (name, expected) = (cells.next()?, cells.next()?);
    let is_row = expected.starts_with("accept") || expected.starts_with("reject");
    is_row.then(|| (name.to_owned(), expected.to_owned()))
}
