//! What a process traced, written at its end for `skipgrid run-under`.
//!
//! The environment variable `SKIPGRID_REPORT` names a file; each process that made a device appends one line of JSON to it. Without
//! the variable nothing is counted.

use std::cell::OnceCell;
use std::fmt::Write as _;
use std::fs::OpenOptions;
use std::io::Write as _;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, AtomicI64, AtomicU64, Ordering};
use std::sync::{Arc, Mutex, Once, PoisonError};
use std::time::Duration;

/// Names the file.
pub const VARIABLE: &str = "SKIPGRID_REPORT";

static COUNTING: AtomicBool = AtomicBool::new(false);
static DEVICES: AtomicU64 = AtomicU64::new(0);
static COMMITS: AtomicU64 = AtomicU64::new(0);
static BUILD_NANOSECONDS: AtomicU64 = AtomicU64::new(0);
static ERRORS: AtomicU64 = AtomicU64::new(0);
static PRIMITIVES: Level = Level::new();
static BYTES: Level = Level::new();
static TEXTS: Mutex<Texts> =
    Mutex::new(Texts { library: "", file: None, accelerator: String::new(), causes: Vec::new() });
static THREADS: Mutex<Vec<Arc<Rays>>> = Mutex::new(Vec::new());

struct Texts {
    library: &'static str,
    file: Option<PathBuf>,
    accelerator: String,
    /// What went wrong, each cause once.
    causes: Vec<String>,
}

/// A sum that goes up and down, and its greatest value.
struct Level {
    now: AtomicI64,
    most: AtomicI64,
}

impl Level {
    const fn new() -> Self {
        Self { now: AtomicI64::new(0), most: AtomicI64::new(0) }
    }

    fn add(&self, amount: i64) {
        let now = self.now.fetch_add(amount, Ordering::Relaxed) + amount;
        self.most.fetch_max(now, Ordering::Relaxed);
    }
}

/// Rays of a thread: no other one writes, so that counting costs no locked instruction.
#[derive(Default)]
struct Rays {
    closest: AtomicU64,
    any: AtomicU64,
}

thread_local! {
    static MINE: OnceCell<Arc<Rays>> = const { OnceCell::new() };
}

/// Counts from now on if the variable says where to, and writes at the end of the process.
pub fn device_made(library: &'static str, accelerator: &str) {
    static START: Once = Once::new();
    START.call_once(|| {
        let Some(file) = std::env::var_os(VARIABLE) else { return };
        let mut texts = lock(&TEXTS);
        (texts.library, texts.file) = (library, Some(PathBuf::from(file)));
        drop(texts);
        COUNTING.store(true, Ordering::Relaxed);
        at_exit();
    });
    DEVICES.fetch_add(1, Ordering::Relaxed);
    accelerator.clone_into(&mut lock(&TEXTS).accelerator);
}

/// A scene was built.
pub fn built(time: Duration) {
    COMMITS.fetch_add(1, Ordering::Relaxed);
    BUILD_NANOSECONDS.fetch_add(u64::try_from(time.as_nanos()).unwrap_or(u64::MAX), Ordering::Relaxed);
}

/// A structure came or, with negative numbers, went.
pub fn holds(primitives: i64, bytes: i64) {
    PRIMITIVES.add(primitives);
    BYTES.add(bytes);
}

/// An error was raised. The report names the first few causes: what follows from them comes later.
pub fn error(message: &str) {
    ERRORS.fetch_add(1, Ordering::Relaxed);
    let causes = &mut lock(&TEXTS).causes;
    if causes.len() < 8 && !causes.iter().any(|cause| cause == message) {
        causes.push(message.into());
    }
}

/// Rays are traced.
#[inline]
pub fn rays(closest: bool, count: u64) {
    if COUNTING.load(Ordering::Relaxed) {
        // At the end of a thread its rays may come too late to be counted.
        let _ = MINE.try_with(|mine| {
            let mine = mine.get_or_init(|| {
                let rays = Arc::<Rays>::default();
                lock(&THREADS).push(rays.clone());
                rays
            });
            let counter = if closest { &mine.closest } else { &mine.any };
            counter.store(counter.load(Ordering::Relaxed) + count, Ordering::Relaxed);
        });
    }
}

fn lock<T>(mutex: &Mutex<T>) -> std::sync::MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

fn at_exit() {
    unsafe extern "C" {
        safe fn atexit(function: extern "C" fn()) -> i32;
    }
    extern "C" fn end() {
        write();
    }
    // Without a place in the list there is no report, which the reader of the file notices.
    let _ = atexit(end);
}

/// One line at the end of the file. A file that cannot be written is said on standard error.
fn write() {
    let texts = lock(&TEXTS);
    let Some(file) = &texts.file else { return };
    let line = line(&texts);
    let written =
        OpenOptions::new().create(true).append(true).open(file).and_then(|mut f| f.write_all(line.as_bytes()));
    if let Err(error) = written {
        eprintln!("{}: {VARIABLE}={}: {error}", texts.library, file.display());
    }
}

fn line(texts: &Texts) -> String {
    let (mut closest, mut any) = (0, 0);
    for rays in lock(&THREADS).iter() {
        closest += rays.closest.load(Ordering::Relaxed);
        any += rays.any.load(Ordering::Relaxed);
    }
    let counter = |c: &AtomicU64| c.load(Ordering::Relaxed);
    format!(
        "{{\"library\":{},\"version\":{},\"process\":{},\"accelerator\":{},\"devices\":{},\"commits\":{},\"build_seconds\":{:e},\
         \"primitives\":{},\"bytes\":{},\"closest_rays\":{closest},\"any_rays\":{any},\"errors\":{},\"causes\":{}}}\n",
        quoted(texts.library),
        quoted(env!("CARGO_PKG_VERSION")),
        std::process::id(),
        quoted(&texts.accelerator),
        counter(&DEVICES),
        counter(&COMMITS),
        Duration::from_nanos(counter(&BUILD_NANOSECONDS)).as_secs_f64(),
        PRIMITIVES.most.load(Ordering::Relaxed),
        BYTES.most.load(Ordering::Relaxed),
        counter(&ERRORS),
        quoted(&texts.causes.join("; ")),
    )
}

/// A string of JSON.
fn quoted(text: &str) -> String {
    let mut out = String::from('"');
    for c in text.chars() {
        match c {
            '"' | '\\' => out.extend(['\\', c]),
            c if c < ' ' => {
                // Writing to a string cannot fail.
                let _ = write!(out, "\\u{:04x}", c as u32);
            }
            c => out.push(c),
        }
    }
    out.push('"');
    out
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_quoted_as_json_wants() {
        assert_eq!(quoted("a \"b\"\\\n\u{e9}"), "\"a \\\"b\\\"\\\\\\u000a\u{e9}\"");
    }

    #[test]
    fn levels_remember_their_greatest_value() {
        let level = Level::new();
        level.add(5);
        level.add(-3);
        level.add(2);
        assert_eq!((level.now.into_inner(), level.most.into_inner()), (4, 5));
    }
}
