//! Files are never left half-written, whatever ends the program.

use crate::error::{Error, Result};
use std::fs::File;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{PoisonError, RwLock};

/// Puts `bytes` in the place of the file `path`: whole or not at all.
///
/// They are written to a new file beside it, which then takes its name; on failure the old file stays. A link is
/// followed.
///
/// # Errors
/// The folder is missing or not writable, the disk is full, or `path` exists and is no regular file.
pub fn replace_file(path: impl AsRef<Path>, bytes: &[u8]) -> Result<()> {
    let _writing = WRITERS.read().unwrap_or_else(PoisonError::into_inner);
    let path = path.as_ref();
    let fail = |source| Error::io(path, source);
    let target = target_of(path)?;
    let (part, mut file) = new_beside(&target).map_err(fail)?;
    let written = file.write_all(bytes).and_then(|()| file.sync_all());
    // Some systems rename no open file.
    drop(file);
    written.and_then(|()| std::fs::rename(&part, &target)).map_err(|source| {
        // The first error is the one to report.
        let _ = std::fs::remove_file(&part);
        Error::io(path, source)
    })
}

/// Finds out whether [`replace_file`] could write `path` now, by making the new file and taking it away again.
///
/// # Errors
/// As [`replace_file`], but for full disks.
#[cfg(feature = "cli")]
pub(crate) fn check_replaceable(path: &Path) -> Result<()> {
    let _writing = WRITERS.read().unwrap_or_else(PoisonError::into_inner);
    let target = target_of(path)?;
    let (part, _) = new_beside(&target).map_err(|source| Error::io(path, source))?;
    std::fs::remove_file(&part).map_err(|source| Error::io(path, source))
}

/// The file that `path` stands for, links followed.
fn target_of(path: &Path) -> Result<PathBuf> {
    match std::fs::metadata(path) {
        Ok(meta) if !meta.is_file() => Err(Error::malformed(path, "is no regular file, not overwritten")),
        Ok(_) => std::fs::canonicalize(path).map_err(|source| Error::io(path, source)),
        Err(_) => Ok(path.to_path_buf()),
    }
}

/// A file of our own beside `target`. A name that is taken is left alone: a process that was killed can have left it, or one
/// of the same number on another machine be writing it.
fn new_beside(target: &Path) -> std::io::Result<(PathBuf, File)> {
    static COUNTER: AtomicU64 = AtomicU64::new(0);
    const MOST_TRIES: u32 = 10_000;
    let mut tries = 0;
    loop {
        let mut name = target.file_name().unwrap_or_default().to_os_string();
        name.push(format!(".{}-{}.part", std::process::id(), COUNTER.fetch_add(1, Ordering::Relaxed)));
        let part = target.with_file_name(name);
        match File::create_new(&part) {
            Err(error) if error.kind() == ErrorKind::AlreadyExists && tries < MOST_TRIES => tries += 1,
            made => return made.map(|file| (part, file)),
        }
    }
}

/// Held for reading by whoever writes a file.
static WRITERS: RwLock<()> = RwLock::new(());

/// Calls `then` once no file is being written; as long as it runs none is begun.
#[cfg(all(feature = "cli", unix))]
pub(crate) fn between_files<T>(then: impl FnOnce() -> T) -> T {
    let _alone = WRITERS.write().unwrap_or_else(PoisonError::into_inner);
    then()
}
