//! Puts the library where the program's loader finds it, runs the program, and clears up.

use super::super::interrupt;
use super::library::Swap;
use crate::error::{Error, Result};
use std::ffi::{OsStr, OsString};
use std::fs::{self, DirBuilder};
use std::io::ErrorKind;
use std::os::unix::fs::{DirBuilderExt, symlink};
use std::path::{Path, PathBuf};
use std::process::{Command, ExitStatus};

/// The library reads its accelerator's specification from here.
const ACCEL: &str = "SKIPGRID_ACCEL";

/// The library writes a line to the file of this name when a process ends.
const REPORT: &str = "SKIPGRID_REPORT";

/// A folder that nobody else can read, and that goes away with this value.
struct Private(PathBuf);

impl Private {
    fn new() -> Result<Self> {
        let base = std::env::temp_dir();
        if base.to_string_lossy().contains(|c: char| c == ':' || c == ';' || c == '$' || c.is_whitespace()) {
            // The loader's lists have no way to say these.
            return Err(Error::malformed(
                base,
                "a temporary folder with a colon, semicolon, dollar or space; set TMPDIR",
            ));
        }
        for attempt in 0..100 {
            let path = base.join(format!("skipgrid-{}-{attempt}", std::process::id()));
            match DirBuilder::new().mode(0o700).create(&path) {
                Ok(()) => return Ok(Self(path)),
                Err(error) if error.kind() == ErrorKind::AlreadyExists => {}
                Err(error) => return Err(Error::io(path, error)),
            }
        }
        Err(Error::io(base, ErrorKind::AlreadyExists.into()))
    }

    fn link(&self, name: &str, to: &Path) -> Result<PathBuf> {
        let link = self.0.join(name);
        match symlink(to, &link) {
            Err(error) if error.kind() != ErrorKind::AlreadyExists => Err(Error::io(link, error)),
            _ => Ok(link),
        }
    }
}

impl Drop for Private {
    fn drop(&mut self) {
        // What cannot be removed is a few links in the system's temporary folder.
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// Runs the program with `swaps` in place to its end; gives how it ended, and what the library reported.
///
/// # Errors
/// The folder cannot be made, or the program does not start.
pub fn run(program: &OsStr, args: &[OsString], accel: &str, swaps: &[Swap]) -> Result<(ExitStatus, String)> {
    let interrupts = interrupt::pass_on();
    let folder = Private::new()?;
    let report = folder.0.join("report");
    let mut command = Command::new(program);
    command.args(args).env(ACCEL, accel).env(REPORT, &report);

    let mut preloads: Vec<PathBuf> = Vec::new();
    for swap in swaps {
        if swap.group.preload {
            let name = swap.library.file_name().unwrap_or_default().to_string_lossy();
            let link = folder.link(&name, &swap.library)?;
            if !preloads.contains(&link) {
                preloads.push(link);
            }
        } else {
            folder.link(&swap.group.name, &swap.library)?;
        }
    }
    command.env("LD_LIBRARY_PATH", before("LD_LIBRARY_PATH", std::slice::from_ref(&folder.0)));
    if !preloads.is_empty() {
        command.env("LD_PRELOAD", before("LD_PRELOAD", &preloads));
    }

    let mut child = command.spawn().map_err(|error| Error::io(program, error))?;
    interrupts.to(&child);
    let status = child.wait().map_err(|error| Error::io(program, error))?;
    interrupts.ended();
    let text = match fs::read(&report) {
        Ok(bytes) => String::from_utf8_lossy(&bytes).into_owned(),
        Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
        Err(error) => return Err(Error::io(&report, error)),
    };
    Ok((status, text))
}

/// The list of paths in the environment variable `name`, with `first` put before.
fn before(name: &str, first: &[PathBuf]) -> OsString {
    let old = std::env::var_os(name).filter(|old| !old.is_empty());
    let all: Vec<OsString> = first.iter().map(|path| path.clone().into_os_string()).chain(old).collect();
    all.join(OsStr::new(":"))
}
