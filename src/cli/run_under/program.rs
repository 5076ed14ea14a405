//! Which file is run when a program is named: on the search path, behind `#!`; and for Python, which packages it may load.

use super::elf;
use crate::error::{Error, Result};
use std::ffi::{OsStr, OsString};
use std::fs::{self, File};
use std::io::{ErrorKind, Read};
use std::os::unix::ffi::OsStrExt;
use std::os::unix::fs::PermissionsExt;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

/// Interpreters of interpreters: the kernel allows four.
const MOST_SCRIPTS: usize = 5;

/// A program, and what runs it.
#[derive(Debug)]
pub struct Program {
    /// The file that was named.
    pub path: PathBuf,
    /// The machine code that the kernel loads for it: itself or the interpreter at the end of the `#!` lines.
    pub binary: PathBuf,
    /// If it is Python, or a script of Python.
    pub python: Option<Python>,
}

/// A Python interpreter.
#[derive(Debug)]
pub struct Python {
    /// The interpreter itself.
    pub executable: PathBuf,
    /// Where it looks for packages.
    pub path: Vec<PathBuf>,
}

/// Finds what running `name` runs.
///
/// # Errors
/// There is no such program, or it cannot be run.
pub fn find(name: &OsStr) -> Result<Program> {
    let path = on_path(name)?;
    let binary = behind_scripts(&path)?;
    let is_python = |file: &Path| file.file_name().is_some_and(|n| n.as_bytes().starts_with(b"python"));
    // A script by the name of python is one of those that choose a version.
    let ask = if is_python(&path) { Some(&path) } else { Some(&binary).filter(|binary| is_python(binary)) };
    let python = ask.map(|ask| ask_python(ask)).transpose()?;
    let binary = python.as_ref().map_or(binary, |python| python.executable.clone());
    Ok(Program { path, binary, python })
}

/// The file that `name` stands for, as shells find it.
fn on_path(name: &OsStr) -> Result<PathBuf> {
    let runs = |path: &Path| fs::metadata(path).is_ok_and(|m| m.is_file() && m.permissions().mode() & 0o111 != 0);
    if name.as_bytes().contains(&b'/') {
        let path = PathBuf::from(name);
        return match fs::metadata(&path) {
            Err(error) => Err(Error::io(path, error)),
            Ok(_) if runs(&path) => Ok(path),
            Ok(_) => Err(Error::io(path, ErrorKind::PermissionDenied.into())),
        };
    }
    let folders = std::env::var_os("PATH").unwrap_or_default();
    std::env::split_paths(&folders)
        .map(|folder| folder.join(name))
        .find(|path| runs(path))
        .ok_or_else(|| Error::io(name, std::io::Error::new(ErrorKind::NotFound, "no such program on PATH")))
}

/// Follows `#!` lines to machine code.
fn behind_scripts(path: &Path) -> Result<PathBuf> {
    let mut path = path.to_path_buf();
    for _ in 0..MOST_SCRIPTS {
        if elf::is_elf(&path) {
            return path.canonicalize().map_err(|error| Error::io(&path, error));
        }
        path = match interpreter(&first_line(&path)?) {
            Some(next) => on_path(&next)?,
            None => return Err(Error::malformed(&path, "neither an ELF file nor a script that begins with `#!`")),
        };
    }
    Err(Error::malformed(path, format!("a script of a script, and so on {MOST_SCRIPTS} times")))
}

fn first_line(path: &Path) -> Result<String> {
    let mut bytes = Vec::new();
    let read = File::open(path).and_then(|file| file.take(4096).read_to_end(&mut bytes));
    read.map_err(|error| Error::io(path, error))?;
    Ok(String::from_utf8_lossy(&bytes).lines().next().unwrap_or_default().to_string())
}

/// The interpreter of a `#!` line; behind `env`, the program that it starts.
fn interpreter(line: &str) -> Option<OsString> {
    let mut words = line.strip_prefix("#!")?.split_whitespace();
    let first = words.next()?;
    if first.rsplit('/').next() != Some("env") {
        return Some(first.into());
    }
    words.find(|word| !word.starts_with('-') && !word.contains('=')).map(OsString::from)
}

/// Asks a Python interpreter what it is and where it looks for packages.
fn ask_python(python: &Path) -> Result<Python> {
    const QUESTION: &str = "import json, sys; print(json.dumps([sys.executable] + sys.path[1:]))";
    let run = Command::new(python).args(["-c", QUESTION]).stdin(Stdio::null()).output();
    let output = run.map_err(|error| Error::io(python, error))?;
    let answer: Option<Vec<PathBuf>> = serde_json::from_slice(&output.stdout).ok();
    match answer.as_deref() {
        Some([executable, path @ ..]) if output.status.success() => {
            let executable = executable.canonicalize().map_err(|error| Error::io(executable, error))?;
            Ok(Python { executable, path: path.to_vec() })
        }
        _ => {
            let cause = String::from_utf8_lossy(&output.stderr).lines().last().unwrap_or("no answer").to_string();
            Err(Error::malformed(python, format!("asked as a Python for its `sys.path`: {cause}")))
        }
    }
}

impl Python {
    /// Shared libraries in the folders of its packages.
    pub fn libraries(&self) -> Vec<PathBuf> {
        let mut libraries = Vec::new();
        let mut open: Vec<PathBuf> = self.path.iter().filter(|folder| folder.is_dir()).cloned().collect();
        let mut seen: std::collections::HashSet<PathBuf> = open.iter().cloned().collect();
        while let Some(folder) = open.pop() {
            let Ok(entries) = fs::read_dir(&folder) else { continue };
            for entry in entries.flatten() {
                // Links are not followed: what they lead to is a package's own affair, and may lead in circles.
                let Ok(kind) = entry.file_type() else { continue };
                let (path, name) = (entry.path(), entry.file_name());
                let name = name.to_string_lossy();
                if kind.is_dir() && name != "__pycache__" {
                    if seen.insert(path.clone()) {
                        open.push(path);
                    }
                } else if !kind.is_dir() && (name.ends_with(".so") || name.contains(".so.")) {
                    libraries.push(path);
                }
            }
        }
        libraries.sort();
        libraries
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn interpreters_are_read_from_the_first_line() {
        for (line, name) in [
            ("#!/bin/sh", Some("/bin/sh")),
            ("#! /usr/bin/python3 -E", Some("/usr/bin/python3")),
            ("#!/usr/bin/env python3", Some("python3")),
            ("#!/usr/bin/env -S A=b python3 -u", Some("python3")),
            ("#!", None),
            ("plain text", None),
        ] {
            assert_eq!(interpreter(line), name.map(OsString::from), "{line}");
        }
    }
}
