//! How often the triangle test needs its last stage: for measurements.

use std::cell::Cell;

thread_local! {
    static DECISIONS: Cell<u64> = const { Cell::new(0) };
}

/// Notes that a test of this thread went to the last stage. Called in that stage alone, which takes a thousand times as long.
pub(super) fn note_decision() {
    DECISIONS.set(DECISIONS.get().wrapping_add(1));
}

/// Tests of this thread that went to the last stage so far.
#[cfg(feature = "cli")]
pub(crate) fn decisions() -> u64 {
    DECISIONS.get()
}
