//! What a build may take, asked before anything large is allocated, by all threads together.

use crate::error::{Error, Result};
use std::sync::atomic::{AtomicU64, Ordering::Relaxed};

/// Bytes that may be taken, and what has been.
pub(super) struct Limit {
    allowed: u64,
    taken: AtomicU64,
}

impl Limit {
    pub fn new(allowed: u64) -> Self {
        Self { allowed, taken: AtomicU64::new(0) }
    }

    /// Takes some bytes; false if there are not so many: what needs them is to be left, as all of it will be refused.
    #[must_use]
    pub fn take(&self, bytes: u64) -> bool {
        self.taken.fetch_add(bytes, Relaxed).saturating_add(bytes) <= self.allowed
    }

    /// False if some bytes that are needed for a while only are more than all that is allowed: then it is as if they had been
    /// taken. Not added up, as how much is needed at once depends on the threads.
    #[must_use]
    pub fn lend(&self, bytes: u64) -> bool {
        bytes <= self.allowed || self.take(bytes)
    }

    /// True once more was wanted than there is.
    pub fn exceeded(&self) -> bool {
        self.taken.load(Relaxed) > self.allowed
    }

    /// Whether all that was taken was there, and a new start.
    ///
    /// # Errors
    /// It was not. The error says nothing of how much more there would be: that depends on when threads have noticed.
    pub fn check(&mut self, cells: &[u32; 3]) -> Result<()> {
        if std::mem::take(self.taken.get_mut()) <= self.allowed {
            return Ok(());
        }
        let what = format!("nested grid of {cells:?} cells and what is in them, more than there is room for");
        Err(Error::TooLarge { what, wanted: self.allowed.saturating_add(1), allowed: self.allowed })
    }
}
