//! No primitive is tested twice by a ray.
//!
//! Amanatides & Woo 1987, "Avoiding Multiple Intersections": each ray has a number, and a primitive remembers the number of
//! the last ray that met it. Departs from the paper: the memory belongs to the thread instead of the primitive, so rays can
//! be traced in parallel, and it is cleared when the numbers run out.

use std::cell::Cell;

thread_local!(static MEMORY: Cell<Memory> = Cell::default());

/// Number of the last ray that met each primitive. Ray numbers are unique in a thread, so grids can share it.
#[derive(Default)]
struct Memory {
    last: Vec<u32>,
    ray: u32,
}

/// This thread's memory, lent to one ray; it goes back when dropped.
///
/// A ray that is traced within the test of a user-defined primitive finds the memory gone and starts an empty one.
pub(super) struct Mailbox(Memory);

impl Mailbox {
    /// Takes the memory for a new ray among `prims` primitives.
    #[inline]
    pub fn take(prims: u32) -> Self {
        let mut memory = MEMORY.take();
        memory.next_ray(prims);
        Self(memory)
    }

    /// True at the first call with `prim` for the current ray.
    #[inline(always)]
    pub fn first_time(&mut self, prim: u32) -> bool {
        let last = &mut self.0.last[prim as usize];
        let first = *last != self.0.ray;
        *last = self.0.ray;
        first
    }
}

impl Drop for Mailbox {
    #[inline]
    fn drop(&mut self) {
        MEMORY.set(std::mem::take(&mut self.0));
    }
}

impl Memory {
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_start_again_with_an_empty_memory() {
        MEMORY.set(Memory { last: vec![0, u32::MAX], ray: u32::MAX });
        let mut mailbox = Mailbox::take(2);
        assert!(mailbox.first_time(0) && mailbox.first_time(1));
        assert!(!mailbox.first_time(0) && !mailbox.first_time(1));
        // A ray within a ray.
        assert!(Mailbox::take(2).first_time(0));
        assert!(!mailbox.first_time(0));
    }
}
