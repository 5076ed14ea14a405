//! Interrupts (SIGINT) and requests to end (SIGTERM): what is being written is finished, then the program ends.
//!
//! Without more, the first one ends the program as soon as no file is being written; since files take their names when
//! they are whole, nothing is left half-written. A verb that has something to keep asks for a [`request`] to look at
//! instead. The second one ends the program at once.

use super::console;
use crate::picture::io;
use std::sync::atomic::{AtomicBool, Ordering};

/// The program's exit code after an interrupt, as shells have it.
pub const EXIT_CODE: u8 = 130;

/// Somebody looks at [`REQUESTED`].
static AWAITED: AtomicBool = AtomicBool::new(false);
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Begins to listen. A system without signals goes on without.
pub fn listen() {
    let _ = ctrlc::set_handler(|| {
        let again = REQUESTED.swap(true, Ordering::SeqCst);
        if again {
            std::process::exit(EXIT_CODE.into());
        }
        if AWAITED.load(Ordering::SeqCst) {
            console::say("", "interrupted: what is finished will be kept; once more ends at once");
        } else {
            console::say("", "interrupted");
            io::between_files(|| std::process::exit(EXIT_CODE.into()));
        }
    });
}

/// A flag that the first interrupt sets, from now on, instead of ending the program.
pub fn request() -> &'static AtomicBool {
    AWAITED.store(true, Ordering::SeqCst);
    &REQUESTED
}
