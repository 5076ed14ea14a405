//! Interrupts (SIGINT) and requests to end (SIGTERM): what is being written is finished, then the program ends.
//!
//! Without more, the first one ends the program as soon as no file is being written; since files take their names when
//! they are whole, nothing is left half-written. A verb that has something to keep asks for a [`request`] to look at
//! instead. The second one ends the program at once.

#[cfg(unix)]
use super::console;
#[cfg(unix)]
use crate::picture::io;
#[cfg(unix)]
use signal_hook::consts::{SIGINT, SIGTERM};
use std::sync::atomic::{AtomicBool, Ordering};

/// The program's exit code after an interrupt, as shells have it.
pub const EXIT_CODE: u8 = 130;

/// Somebody looks at [`REQUESTED`].
static AWAITED: AtomicBool = AtomicBool::new(false);
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Begins to listen; a system without such signals ends the program as it always does. A hang-up is left alone, so that
/// `nohup` works.
pub fn listen() {
    #[cfg(unix)]
    if let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) {
        std::thread::spawn(move || signals.forever().for_each(|_| interrupted()));
    }
}

/// What an interrupt does.
#[cfg(unix)]
fn interrupted() {
    if REQUESTED.swap(true, Ordering::SeqCst) {
        std::process::exit(EXIT_CODE.into());
    }
    if AWAITED.load(Ordering::SeqCst) {
        console::say("", "interrupted: what is finished will be kept; once more ends at once");
        return;
    }
    console::say("", "interrupted");
    // In a thread of its own, so that a second interrupt is heard while a file is written.
    std::thread::spawn(|| io::between_files(|| std::process::exit(EXIT_CODE.into())));
}

/// A flag that the first interrupt sets, from now on, instead of ending the program.
pub fn request() -> &'static AtomicBool {
    AWAITED.store(true, Ordering::SeqCst);
    &REQUESTED
}
