//! Devices: which accelerator is built, whom errors go to, and the threads that build.

use crate::report;
use crate::types::{ErrorCode, ErrorFunction, MemoryMonitor, Version};
use rayon::{ThreadPool, ThreadPoolBuildError, ThreadPoolBuilder};
use skipgrid::registry;
use std::cell::RefCell;
use std::ffi::{CString, c_char, c_void};
use std::mem::ManuallyDrop;
use std::num::NonZero;
use std::ptr;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, MutexGuard, OnceLock, PoisonError};
use std::thread::{self, JoinHandle};

/// Names the accelerator if the configuration does not.
pub const VARIABLE: &str = "SKIPGRID_ACCEL";

/// The accelerator if nothing names one.
const DEFAULT_ACCEL: &str = "nested";

/// What went wrong.
#[derive(Clone, Debug, PartialEq)]
pub struct Fault {
    /// As Embree says it.
    pub code: ErrorCode,
    /// For people.
    pub message: String,
}

impl Fault {
    /// An argument that no call may have.
    pub fn argument(message: impl Into<String>) -> Self {
        Self { code: ErrorCode::InvalidArgument, message: message.into() }
    }

    /// A call that the object does not allow.
    pub fn operation(message: impl Into<String>) -> Self {
        Self { code: ErrorCode::InvalidOperation, message: message.into() }
    }

    /// A call that Embree has and this library has not.
    pub fn unsupported(what: &str) -> Self {
        Self::operation(format!("skipgrid does not support {what}"))
    }
}

/// A function of the caller and what it is called with.
#[derive(Clone, Copy, Debug)]
pub struct Callback<F> {
    /// The function, if one is set.
    pub function: Option<F>,
    /// Its first argument.
    pub user: *mut c_void,
}

impl<F> Callback<F> {
    /// No function.
    pub const NONE: Self = Self { function: None, user: ptr::null_mut() };
}

/// What all objects of a program share.
#[derive(Debug)]
pub struct Device {
    version: Version,
    accel: String,
    threads: usize,
    verbose: bool,
    team: OnceLock<Option<Team>>,
    on_error: Mutex<Callback<ErrorFunction>>,
    on_memory: Mutex<Callback<MemoryMonitor>>,
    /// True once a geometry was given a mask. A program that never sets one cannot mean the masks of its rays: some leave
    /// them 0, as builds of Embree without masks allow.
    masks: AtomicBool,
    /// What standard error was told.
    said: Mutex<Vec<String>>,
}

// SAFETY: nothing behind the pointers is touched here.
unsafe impl Send for Device {}
// SAFETY: as above.
unsafe impl Sync for Device {}

/// Threads that build. All have ended when it is gone.
#[derive(Debug)]
struct Team {
    pool: ManuallyDrop<ThreadPool>,
    threads: Arc<Mutex<Vec<JoinHandle<()>>>>,
}

impl Team {
    /// `count` threads, or as many as the machine has if that is 0.
    fn new(count: usize) -> Result<Self, ThreadPoolBuildError> {
        let count = if count > 0 { count } else { thread::available_parallelism().map_or(1, NonZero::get) };
        let threads = Arc::new(Mutex::new(Vec::with_capacity(count)));
        let handles = threads.clone();
        let builder = ThreadPoolBuilder::new().num_threads(count).spawn_handler(move |worker| {
            let named = thread::Builder::new().name(format!("skipgrid-{}", worker.index()));
            lock(&handles).push(named.spawn(|| worker.run())?);
            Ok(())
        });
        Ok(Self { pool: ManuallyDrop::new(builder.build()?), threads })
    }
}

impl Drop for Team {
    fn drop(&mut self) {
        // SAFETY: nothing uses the pool after this; its threads are told to end.
        unsafe { ManuallyDrop::drop(&mut self.pool) };
        for thread in lock(&self.threads).drain(..) {
            // A thread that panicked has ended too.
            let _ = thread.join();
        }
    }
}

thread_local! {
    /// The first error of each device that this thread has not asked for yet; null is the device that could not be made.
    static ERRORS: RefCell<Vec<(*const Device, ErrorCode)>> = const { RefCell::new(Vec::new()) };
    /// The text of the thread's last error.
    static MESSAGE: RefCell<CString> = RefCell::new(CString::default());
}

impl Device {
    /// A device as `config` and the environment describe it.
    ///
    /// # Errors
    /// The accelerator is not known or its options are wrong, or a number is none.
    pub fn new(version: Version, config: &str) -> Result<Self, Fault> {
        let settings = Settings::parse(config)?;
        let from_environment = std::env::var(VARIABLE).ok().filter(|accel| !accel.is_empty());
        let accel = settings.accel.or(from_environment).unwrap_or_else(|| DEFAULT_ACCEL.into());
        let device = Self {
            version,
            accel,
            threads: settings.threads,
            verbose: settings.verbose > 0,
            team: OnceLock::new(),
            on_error: Mutex::new(Callback::NONE),
            on_memory: Mutex::new(Callback::NONE),
            masks: AtomicBool::new(false),
            said: Mutex::default(),
        };
        let nothing: Vec<skipgrid::Triangle> = Vec::new();
        let built = device.install(|| registry::build(&device.accel, nothing).map(drop));
        built.map_err(|error| Fault::argument(error.to_string()))?;
        report::device_made(
            match version {
                Version::Three => "skipgrid-embree3",
                Version::Four => "skipgrid-embree4",
            },
            &device.accel,
        );
        Ok(device)
    }

    /// Which interface it was made through.
    pub fn version(&self) -> Version {
        self.version
    }

    /// Specification of the accelerator.
    pub fn accel(&self) -> &str {
        &self.accel
    }

    /// Runs `work` on the threads of the device, which begin with the first call and end with the device.
    pub fn install<R: Send>(&self, work: impl FnOnce() -> R + Send) -> R {
        match self.team.get_or_init(|| Team::new(self.threads).ok()) {
            Some(team) => team.pool.install(work),
            // A machine without room for threads builds on the caller's.
            None => work(),
        }
    }

    /// Sets whom errors go to.
    pub fn set_error_function(&self, callback: Callback<ErrorFunction>) {
        *lock(&self.on_error) = callback;
    }

    /// Sets who is told of memory.
    pub fn set_memory_monitor(&self, callback: Callback<MemoryMonitor>) {
        *lock(&self.on_memory) = callback;
    }

    /// Masks of rays count from now on.
    pub fn use_masks(&self) {
        self.masks.store(true, Ordering::Relaxed);
    }

    /// True if masks of rays count.
    #[inline]
    pub fn has_masks(&self) -> bool {
        self.masks.load(Ordering::Relaxed)
    }

    /// Tells the memory monitor that `bytes` come or, if negative, have gone. False if it does not want that.
    pub fn memory(&self, bytes: isize) -> bool {
        let Callback { function, user } = *lock(&self.on_memory);
        // SAFETY: the caller set both for this purpose.
        bytes == 0 || function.is_none_or(|function| unsafe { function(user, bytes, bytes < 0) })
    }

    /// Keeps the error for the thread and tells the error function; without one, standard error says each cause once.
    pub fn raise(&self, fault: &Fault) {
        let text = keep(self, fault);
        report::error(&fault.message);
        let Callback { function, user } = *lock(&self.on_error);
        if self.verbose || (function.is_none() && is_new(&self.said, &fault.message)) {
            say(&fault.message);
        }
        if let Some(function) = function {
            // SAFETY: the caller set both for this purpose; the text lives during the call.
            unsafe {
                function(user, fault.code, text.as_ptr());
            }
        }
    }

    /// The value, or what stands for none after raising the error.
    pub fn check<T>(&self, result: Result<T, Fault>, none: T) -> T {
        result.unwrap_or_else(|fault| {
            self.raise(&fault);
            none
        })
    }
}

/// Keeps an error without a device; standard error says each cause once, for there is nobody else to tell.
pub fn raise_without_device(fault: &Fault) {
    static SAID: Mutex<Vec<String>> = Mutex::new(Vec::new());
    keep(ptr::null(), fault);
    report::error(&fault.message);
    if is_new(&SAID, &fault.message) {
        say(&fault.message);
    }
}

/// True if `list` lacks `text`, which it then has. A list without end is cut: what comes after is not new.
fn is_new(list: &Mutex<Vec<String>>, text: &str) -> bool {
    let mut list = lock(list);
    let new = list.len() < 64 && list.iter().all(|old| old != text);
    if new {
        list.push(text.into());
    }
    new
}

fn say(message: &str) {
    eprintln!("skipgrid (in the place of Embree): {message}");
}

/// Keeps the error for the thread; its text, for callers in C.
fn keep(device: *const Device, fault: &Fault) -> CString {
    // Messages quote what callers send, which may hold a NUL.
    let text = CString::new(fault.message.replace('\0', "\\0")).unwrap_or_default();
    let _ = ERRORS.try_with(|errors| {
        let mut errors = errors.borrow_mut();
        if !errors.iter().any(|(d, _)| *d == device) {
            errors.push((device, fault.code));
        }
    });
    let _ = MESSAGE.try_with(|message| message.replace(text.clone()));
    text
}

/// The text of the thread's last error, until its next one.
pub fn last_message() -> *const c_char {
    MESSAGE.with(|message| message.borrow().as_ptr())
}

/// The thread's first error of a device, or without one, since it last asked.
pub fn take_error(device: *const Device) -> ErrorCode {
    ERRORS.with(|errors| {
        let mut errors = errors.borrow_mut();
        let found = errors.iter().position(|(d, _)| *d == device);
        found.map_or(ErrorCode::None, |i| errors.swap_remove(i).1)
    })
}

fn lock<T>(mutex: &Mutex<T>) -> MutexGuard<'_, T> {
    mutex.lock().unwrap_or_else(PoisonError::into_inner)
}

/// What a configuration asks for; the other settings of Embree change nothing here.
#[derive(Debug, Default, PartialEq)]
struct Settings {
    /// Threads that build, 0 for as many as there are.
    threads: usize,
    verbose: u32,
    accel: Option<String>,
}

impl Settings {
    /// `name=value` apart from each other by commas or spaces. In `accel`, options are kept apart by semicolons:
    /// `accel=grid:density=4;mailbox=on`.
    fn parse(config: &str) -> Result<Self, Fault> {
        let mut settings = Self::default();
        for token in config.split([',', ' ', '\t', '\n']).filter(|token| !token.is_empty()) {
            let (name, value) = token.split_once('=').unwrap_or((token, ""));
            let wrong = || Fault::argument(format!("configuration `{token}`: a whole number is wanted"));
            match name {
                "threads" => settings.threads = value.parse().map_err(|_| wrong())?,
                "verbose" => settings.verbose = value.parse().map_err(|_| wrong())?,
                "accel" => settings.accel = Some(value.replace(';', ",")),
                _ => {}
            }
        }
        Ok(settings)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn configurations_are_read() {
        let settings = Settings::parse("verbose=2,threads=3 accel=grid:density=4;mailbox=on,isa=avx2").unwrap();
        let accel = Some("grid:density=4,mailbox=on".to_string());
        assert_eq!(settings, Settings { threads: 3, verbose: 2, accel });
        assert!(Settings::parse("threads=many").is_err());
        assert_eq!(Settings::parse("").unwrap(), Settings::default());
    }

    #[test]
    fn unknown_accelerators_are_refused() {
        let fault = Device::new(Version::Three, "accel=gird").unwrap_err();
        assert_eq!(fault.code, ErrorCode::InvalidArgument);
        assert!(fault.message.contains("did you mean `grid`"), "{}", fault.message);
        assert_eq!(
            Device::new(Version::Three, "accel=grid:density=4;mailbox=on").unwrap().accel(),
            "grid:density=4,mailbox=on"
        );
    }

    #[test]
    fn the_first_error_is_kept_for_the_thread_that_made_it() {
        let device = Device::new(Version::Three, "").unwrap();
        device.set_error_function(Callback { function: Some(ignore), user: ptr::null_mut() });
        device.raise(&Fault::argument("one"));
        device.raise(&Fault::operation("two"));
        std::thread::scope(|scope| {
            scope.spawn(|| assert_eq!(take_error(&device), ErrorCode::None));
        });
        assert_eq!(take_error(&device), ErrorCode::InvalidArgument);
        assert_eq!(take_error(&device), ErrorCode::None);
    }

    unsafe extern "C-unwind" fn ignore(_: *mut c_void, _: ErrorCode, _: *const std::ffi::c_char) {}
}
