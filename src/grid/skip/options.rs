//! How a skip table is built.

use crate::error::{Error, Result};

/// How distances are stored.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Distances {
    /// One byte each, 1 to 255.
    #[default]
    Linear,
    /// Rounded down to a power of two, four bits each (Semwal & Kvarnstrom 1997 §6).
    Log2,
    /// Rounded down to 1, 2, 3, 4, 6, 8, 12, .. 192, four bits each.
    HalfLog2,
}

/// How to build a skip table.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SkipOptions {
    /// How distances are stored.
    pub distances: Distances,
    /// The least distance worth a leap, 1 to 255; lesser ones count as 1, which is a step. The paper's is 5, which also hides
    /// part of what its landing rule gets wrong; here it is a matter of cost alone: a leap costs about four steps.
    pub threshold: u8,
    /// Half width of the lanes of dual extents, 1 to 255 voxels: their preprocessing grows with it. Other methods do not
    /// look at it.
    pub lane: u8,
}

impl Default for SkipOptions {
    fn default() -> Self {
        Self { distances: Distances::Linear, threshold: 3, lane: 16 }
    }
}

impl SkipOptions {
    /// # Errors
    /// The threshold or the lane is 0.
    pub(super) fn check(&self) -> Result<()> {
        for (name, value) in [("threshold", self.threshold), ("lane", self.lane)] {
            if value == 0 {
                return Err(Error::invalid(format!("{name} is 0, but must be 1 to 255")));
            }
        }
        Ok(())
    }

    /// What is stored for a distance of at least 1. Never more, so a region can only shrink.
    pub(super) fn stored(&self, distance: u8) -> u8 {
        if distance < self.threshold { 1 } else { self.rounded(distance) }
    }

    /// The same for a width, which has no threshold.
    pub(super) fn rounded(&self, distance: u8) -> u8 {
        match self.distances {
            // What does not fit into four bits is rounded down by the slot.
            Distances::Linear | Distances::HalfLog2 => distance,
            Distances::Log2 => 1 << distance.max(1).ilog2(),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn distances_are_rounded_down() {
        let log = SkipOptions { distances: Distances::Log2, threshold: 1, lane: 1 };
        for d in 1..=255 {
            let stored = log.stored(d);
            assert!(stored.is_power_of_two() && stored <= d && u32::from(stored) * 2 > u32::from(d), "{d}: {stored}");
        }
        let paper = SkipOptions { threshold: 5, ..SkipOptions::default() };
        assert_eq!([1, 4, 5, 255].map(|d| paper.stored(d)), [1, 1, 5, 255]);
    }
}
