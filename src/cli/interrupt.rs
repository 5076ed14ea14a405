//! Interrupts (SIGINT) and requests to end (SIGTERM): what is being written is finished, then the program ends.
//!
//! Without more, the first one ends the program as soon as no file is being written; since files take their names when
//! they are whole, nothing is left half-written. A verb that has something to keep asks for a [`request`] to look at
//! instead. The second one ends the program at once.
//!
//! While another program runs in front of ours, both are passed on to it and end nothing here: see [`pass_on`].

#[cfg(unix)]
use super::console;
#[cfg(unix)]
use crate::picture::io;
#[cfg(target_os = "linux")]
use rustix::process::{Pid, Signal, getpgrp, kill_process};
#[cfg(unix)]
use signal_hook::consts::{SIGINT, SIGTERM};
#[cfg(target_os = "linux")]
use std::sync::Mutex;
use std::sync::atomic::{AtomicBool, Ordering};

/// The program's exit code after either signal: what shells have for an interrupt.
pub const EXIT_CODE: u8 = 130;

/// Somebody looks at [`REQUESTED`].
static AWAITED: AtomicBool = AtomicBool::new(false);
static REQUESTED: AtomicBool = AtomicBool::new(false);

/// Begins to listen; a system without such signals ends the program as it always does. A hang-up is left alone, so that
/// `nohup` works.
pub fn listen() {
    #[cfg(unix)]
    if let Ok(mut signals) = signal_hook::iterator::Signals::new([SIGINT, SIGTERM]) {
        std::thread::spawn(move || signals.forever().for_each(interrupted));
    }
}

/// What an interrupt does.
#[cfg(unix)]
fn interrupted(signal: i32) {
    #[cfg(target_os = "linux")]
    if passed_on(signal) {
        return;
    }
    #[cfg(not(target_os = "linux"))]
    let _ = signal;
    if REQUESTED.swap(true, Ordering::SeqCst) {
        end();
    }
    if AWAITED.load(Ordering::SeqCst) {
        console::say("", "interrupted: what is finished will be kept; once more ends at once");
        return;
    }
    console::say("", "interrupted");
    // In a thread of its own, so that a second interrupt is heard while a file is written.
    std::thread::spawn(|| io::between_files(|| end()));
}

/// Ends the program with a clean last line.
#[cfg(unix)]
fn end() -> ! {
    console::clear();
    std::process::exit(EXIT_CODE.into())
}

/// A flag that the first interrupt sets, from now on, instead of ending the program.
pub fn request() -> &'static AtomicBool {
    AWAITED.store(true, Ordering::SeqCst);
    &REQUESTED
}

/// Who gets the signals instead of us.
#[cfg(target_os = "linux")]
enum Other {
    /// Nobody.
    None,
    /// A program that is about to start, with what came meanwhile; or one that has ended.
    Awaited(Option<Signal>),
    /// A running program.
    Running(Pid),
}

#[cfg(target_os = "linux")]
static OTHER: Mutex<Other> = Mutex::new(Other::None);

#[cfg(target_os = "linux")]
fn other() -> std::sync::MutexGuard<'static, Other> {
    OTHER.lock().unwrap_or_else(std::sync::PoisonError::into_inner)
}

/// Signals go to another program from now on, until this value goes.
#[cfg(target_os = "linux")]
pub struct PassedOn(());

/// Keeps signals for a program that is about to start.
#[cfg(target_os = "linux")]
pub fn pass_on() -> PassedOn {
    *other() = Other::Awaited(None);
    PassedOn(())
}

#[cfg(target_os = "linux")]
impl PassedOn {
    /// The program has started.
    pub fn to(&self, child: &std::process::Child) {
        let child = Pid::from_child(child);
        if let Other::Awaited(Some(signal)) = std::mem::replace(&mut *other(), Other::Running(child)) {
            let _ = kill_process(child, signal);
        }
    }

    /// The program has ended, so that its number may soon be another's.
    pub fn ended(&self) {
        *other() = Other::Awaited(None);
    }
}

#[cfg(target_os = "linux")]
impl Drop for PassedOn {
    fn drop(&mut self) {
        *other() = Other::None;
    }
}

/// Passes a signal on to the other program, if there is one.
#[cfg(target_os = "linux")]
fn passed_on(signal: i32) -> bool {
    let signal = if signal == SIGINT { Signal::INT } else { Signal::TERM };
    match &mut *other() {
        Other::None => return false,
        Other::Awaited(pending) => *pending = Some(signal),
        // The keyboard's interrupt goes to every program in front of the terminal. A program that has ended needs no signal.
        Other::Running(child) => {
            if signal != Signal::INT || !in_front_of_terminal() {
                let _ = kill_process(*child, signal);
            }
        }
    }
    true
}

/// True if the keyboard's interrupts reach this process.
#[cfg(target_os = "linux")]
fn in_front_of_terminal() -> bool {
    let terminal = std::fs::File::open("/dev/tty");
    terminal.is_ok_and(|terminal| rustix::termios::tcgetpgrp(&terminal).is_ok_and(|front| front == getpgrp()))
}
