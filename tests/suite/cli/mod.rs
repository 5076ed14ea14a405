//! Verbs, exit codes, messages, files: the program as its user meets it.

mod failures;
mod help;
mod measured;
mod pictures;
mod terminal;
mod traced;

use skipgrid::registry::{ENTRIES, Entry, Needs};
use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// What a run of the program gave.
struct Run {
    code: Option<i32>,
    stdout: String,
    stderr: String,
}

/// Runs the program in `folder`.
fn skipgrid(folder: &Path, args: &[&str]) -> Run {
    let (code, stdout, stderr) = crate::ended(crate::program(folder).args(args));
    Run { code, stdout, stderr }
}

/// An empty folder of the test's own.
fn folder(test: &str) -> PathBuf {
    crate::folder("cli", test)
}

/// Names of the files in `folder`, sorted.
fn files(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder exists");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}

fn json(run: &Run) -> serde_json::Value {
    serde_json::from_str(&run.stdout).unwrap_or_else(|e| panic!("{e}: {}", run.stdout))
}

/// Little-endian bytes after a magic and a count, as in `.tri` and `.rays` files.
fn raw(magic: &[u8; 4], count: u32, values: &[f32]) -> Vec<u8> {
    let numbers = values.iter().flat_map(|v| v.to_le_bytes());
    magic.iter().copied().chain(count.to_le_bytes()).chain(numbers).collect()
}

/// An .npy file, written here by NumPy's description of the format alone.
fn npy(descr: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': {descr}, 'fortran_order': False, 'shape': {shape}, }}\n");
    let mut bytes = b"\x93NUMPY\x01\x00".to_vec();
    bytes.extend((header.len() as u16).to_le_bytes());
    bytes.extend(header.bytes());
    bytes.extend(data);
    bytes
}

/// Two triangles: a right one at z = 0 over (0, 0), (1, 0), (0, 1), and the same at z = 2 with legs of 4.
const TRIANGLES: [f32; 18] = [0., 0., 0., 1., 0., 0., 0., 1., 0., /* second */ 0., 0., 2., 4., 0., 2., 0., 4., 2.];

/// A ray as in a file, and what it hits: parameter and primitive.
type RayAndHit = ([f32; 8], Option<(f32, u32)>);

/// Rays with answers by hand: t counts in the direction's length.
const RAYS: [RayAndHit; 8] = [
    ([0.25, 0.25, -5., 0., 0., 0., 1., f32::INFINITY], Some((5.0, 0))),
    ([0.25, 0.25, -5., 0., 0., 0., 2., f32::INFINITY], Some((2.5, 0))),
    ([0.75, 0.75, -5., 0., 0., 0., 1., f32::INFINITY], Some((7.0, 1))),
    ([0.25, 0.25, -5., 6., 0., 0., 1., f32::INFINITY], Some((7.0, 1))),
    ([0.25, 0.25, -5., 0., 0., 0., 1., 4.0], None),
    // Exactly through the legs of both: triangles are closed.
    ([0.5, 0.0, 5., 0., 0., 0., -1., f32::INFINITY], Some((3.0, 1))),
    ([9.0, 9.0, -5., 0., 0., 0., 1., f32::INFINITY], None),
    ([f32::NAN, 0.25, -5., 0., 0., 0., 1., f32::INFINITY], None),
];

fn ray_values() -> Vec<f32> {
    RAYS.iter().flat_map(|(ray, _)| *ray).collect()
}

fn ray_bytes() -> Vec<u8> {
    ray_values().iter().flat_map(|v| v.to_le_bytes()).collect()
}

/// A colour PFM file, little endian.
fn pfm(width: u32, height: u32, values: &[f32]) -> Vec<u8> {
    let header = format!("PF\n{width} {height}\n-1.0\n");
    header.bytes().chain(values.iter().flat_map(|v| v.to_le_bytes())).collect()
}

/// The accelerators for every scene.
fn general() -> impl Iterator<Item = &'static Entry> {
    ENTRIES.iter().filter(|e| e.needs == Needs::Any)
}

#[test]
fn quiet_leaves_data_only() {
    let folder = folder("quiet");
    let args = ["info", "random:n=5", "--accel", "brute"];
    assert!(skipgrid(&folder, &[&args[..], &["--quiet"]].concat()).stderr.is_empty());
    let args = ["compare", "random:n=5", "--accel", "brute", "--rounds", "1", "--size", "4x4"];
    assert!(!skipgrid(&folder, &args).stderr.is_empty(), "a framed camera is said");
    let run = skipgrid(&folder, &[&args[..], &["-q"]].concat());
    assert_eq!((run.code, run.stderr.as_str()), (Some(0), ""));
    assert!(!run.stdout.is_empty());
}

#[test]
fn a_reader_that_leaves_is_no_error() {
    let mut child = Command::new(env!("CARGO_BIN_EXE_skipgrid"))
        .arg("list")
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    drop(child.stdout.take());
    let output = child.wait_with_output().expect("the program ends");
    assert_eq!(output.status.code(), Some(0));
    assert!(output.stderr.is_empty(), "{}", String::from_utf8_lossy(&output.stderr));
}
