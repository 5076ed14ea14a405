//! No primitive is tested twice by a ray.
//!
//! Amanatides & Woo 1987, "Avoiding Multiple Intersections": each ray has a number, and a primitive remembers the number of
//! the last ray that met it. Departs from the paper: the memory belongs to the thread instead of the primitive, so rays can
//! be traced in parallel, and it is cleared when the numbers run out.

use std::cell::RefCell;

/// Tells whether the current ray meets a primitive for the first time.
pub(super) trait RayMailbox {
    /// True at the first call with `prim` for the current ray, or always.
    fn first_time(&mut self, prim: u32) -> bool;
}

/// Remembers nothing; costs nothing.
pub(super) struct NoMailbox;

impl RayMailbox for NoMailbox {
    #[inline(always)]
    fn first_time(&mut self, _prim: u32) -> bool {
        true
    }
}

/// Number of the last ray that met each primitive. Ray numbers are unique in a thread, so grids can share it.
#[derive(Default)]
pub(super) struct Mailbox {
    last: Vec<u32>,
    ray: u32,
}

impl Mailbox {
    fn next_ray(&mut self, prims: u32) {
        if self.last.len() < prims as usize {
            self.last.resize(prims as usize, 0);
        }
        self.ray = self.ray.checked_add(1).unwrap_or_else(|| {
            self.last.fill(0);
            1
        });
    }
}

impl RayMailbox for Mailbox {
    #[inline(always)]
    fn first_time(&mut self, prim: u32) -> bool {
        let last = &mut self.last[prim as usize];
        let first = *last != self.ray;
        *last = self.ray;
        first
    }
}

/// Runs `trace` with this thread's mailbox, set to a new ray; `None` if the mailbox is in use, which happens when a
/// user-defined primitive traces a ray within its own test.
#[inline]
pub(super) fn with<R>(prims: u32, trace: impl FnOnce(&mut Mailbox) -> R) -> Option<R> {
    thread_local!(static MAILBOX: RefCell<Mailbox> = RefCell::default());
    MAILBOX.with(|mailbox| {
        let mut mailbox = mailbox.try_borrow_mut().ok()?;
        mailbox.next_ray(prims);
        Some(trace(&mut mailbox))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_start_again_with_an_empty_memory() {
        let mut mailbox = Mailbox { last: vec![0, u32::MAX], ray: u32::MAX };
        mailbox.next_ray(2);
        assert!(mailbox.first_time(0) && mailbox.first_time(1));
        assert!(!mailbox.first_time(0) && !mailbox.first_time(1));
    }
}
