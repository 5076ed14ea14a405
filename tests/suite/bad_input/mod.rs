//! Nothing bad that comes in may break anything: each kind of bad input has its message, its exit code and no after-effect.
//!
//! Every message is `path: cause`, where the cause names an index, a line or a byte; the exit code is 2 for bad input and 3
//! where the system refuses; nothing is half-written; there is no panic, no abort and no runaway memory: the program runs
//! under a limit of its address space here.
//!
//! | what | test |
//! | --- | --- |
//! | vertex, normal, texture coordinate that is not finite; `--drop-invalid` | [`numbers`], `mesh_files.rs` |
//! | matrix, camera, colour, light that is not finite | [`numbers`] |
//! | index beyond the vertices, faces of two corners, empty scenes, missing materials and textures | [`meshes`] |
//! | accessors beyond their buffers, count * stride + offset overflowing | [`gltf`], `mesh_files.rs` |
//! | node cycles, a node below itself, 100 000 levels, singular and infinite matrices | [`gltf`], `mesh_files.rs` |
//! | resolutions, films, procedural scenes, headers that ask for too much memory | [`sizes`] |
//! | pictures that decode to too much: PNG, EXR, PFM, textures | [`sizes`], `pictures.rs`, `malformed.rs` |
//! | folders, pipes, devices, unreadable, empty and missing files, names that are not UTF-8 | [`files`] |
//! | full disks and read-only folders, for every verb that writes | [`outputs`] |
//! | pixels that are not finite in either picture | [`files`], `cli.rs`, `validate.rs` |
//! | interrupts | [`interrupts`] |
//! | `../shared/scenes/malformed` | `malformed.rs` |
//! | bytes at random | `fuzz.rs` |

mod files;
mod gltf;
mod interrupts;
mod meshes;
mod numbers;
mod outputs;
mod sizes;

use std::fs;
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};

/// What a run of the program gave.
pub struct Run {
    pub code: Option<i32>,
    pub stdout: String,
    pub stderr: String,
}

impl Run {
    fn new(what: &dyn std::fmt::Debug, output: &Output) -> Self {
        let text = |bytes: &[u8]| String::from_utf8_lossy(bytes).into_owned();
        let run = Self { code: output.status.code(), stdout: text(&output.stdout), stderr: text(&output.stderr) };
        for word in ["panicked", "overflowed its stack", "memory allocation of"] {
            assert!(!run.stderr.contains(word), "{what:?}: {}", run.stderr);
        }
        run
    }

    /// It ended with this code and one line of error that has all of `words`.
    pub fn refused(&self, code: i32, words: &[&str]) -> &Self {
        assert_eq!(self.code, Some(code), "{}", self.stderr);
        let errors: Vec<&str> = self.stderr.lines().filter(|l| l.starts_with("skipgrid: error: ")).collect();
        assert_eq!(errors.len(), 1, "{}", self.stderr);
        words.iter().for_each(|word| assert!(errors[0].contains(word), "no `{word}` in: {}", errors[0]));
        self
    }

    /// `skipgrid info` counted this.
    pub fn counts(&self, what: &str, count: u64) -> &Self {
        let lines = self.stdout.lines().filter_map(|line| line.split_once(char::is_whitespace));
        let found: Vec<&str> = lines.filter(|(name, _)| *name == what).map(|(_, value)| value.trim()).collect();
        assert_eq!(found, [count.to_string()], "{}", self.stdout);
        self
    }

    /// It did what it was asked, and its words, if any, have all of `words`.
    pub fn done(&self, words: &[&str]) -> &Self {
        assert_eq!(self.code, Some(0), "{}", self.stderr);
        words.iter().for_each(|word| assert!(self.stderr.contains(word), "no `{word}` in: {}", self.stderr));
        self
    }
}

/// Runs the program in `folder`, where the system allows with at most 3 GB of address space.
pub fn skipgrid(folder: &Path, args: &[&str]) -> Run {
    shell(folder, "ulimit -v 3000000; exec \"$0\" \"$@\"", args)
}

/// Runs `script` in `folder`; its `$0` is the program, `$@` are `args`.
pub fn shell(folder: &Path, script: &str, args: &[&str]) -> Run {
    let mut command = if cfg!(unix) {
        let mut command = Command::new("sh");
        command.args(["-c", script, env!("CARGO_BIN_EXE_skipgrid")]);
        command
    } else {
        Command::new(env!("CARGO_BIN_EXE_skipgrid"))
    };
    let output = command.args(args).current_dir(folder).stdin(Stdio::null()).output().expect("the program starts");
    Run::new(&args, &output)
}

pub fn folder(test: &str) -> PathBuf {
    crate::folder("bad-input", test)
}

/// Writes a file of `folder`.
pub fn write(folder: &Path, name: &str, content: impl AsRef<[u8]>) {
    fs::write(folder.join(name), content).expect("the target folder is writable");
}

/// Names of the files in `folder`, sorted.
pub fn names(folder: &Path) -> Vec<String> {
    let entries = fs::read_dir(folder).expect("the folder exists");
    let mut names: Vec<String> =
        entries.map(|e| e.expect("readable").file_name().to_string_lossy().into_owned()).collect();
    names.sort();
    names
}
