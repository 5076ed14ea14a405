//! Where the planes lie, when splitting ends, what a tree may take.

use super::frame::MAX_DEPTH;
use crate::accel::default_budget;
use crate::error::{Error, Result};

/// How planes are chosen.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Choice {
    /// Cells are halved along x, y and z in turn: three levels are one of an octree.
    #[default]
    Midpoint,
    /// Across the axis and at the place, one of 25 for each axis, that promise the least cost by the surface area heuristic
    /// (MacDonald & Booth 1990).
    Sah,
    /// As that, from planes across the axes and across the diagonals of two of them.
    Oblique,
}

/// How to build a [`super::Bsp`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BspOptions {
    /// Where the planes lie.
    pub planes: Choice,
    /// Lists of so many primitives or fewer are not split further; at least 1.
    pub leaf: u32,
    /// Most levels below the root, 0 to [`BspOptions::MAX_DEPTH`]; `None`: by the number of primitives.
    pub depth: Option<u32>,
    /// Bytes that the tree may take, its builder's lists included; one that needs more is refused.
    pub memory: u64,
}

impl Default for BspOptions {
    /// Midpoint planes, lists of two, a quarter of the machine's memory but at most 8 GiB.
    fn default() -> Self {
        Self { planes: Choice::Midpoint, leaf: 2, depth: None, memory: default_budget() }
    }
}

impl BspOptions {
    /// Most levels of a tree.
    pub const MAX_DEPTH: u32 = MAX_DEPTH;

    /// # Errors
    /// The list length is 0, or there are more levels than [`BspOptions::MAX_DEPTH`].
    pub(super) fn check(&self) -> Result<()> {
        if self.leaf == 0 {
            return Err(Error::invalid("bsp leaf is 0, but must be at least 1"));
        }
        match self.depth {
            Some(depth) if depth > MAX_DEPTH => {
                Err(Error::invalid(format!("bsp depth is {depth}, but must be 0 to {MAX_DEPTH}")))
            }
            _ => Ok(()),
        }
    }

    /// Levels for `count` primitives: 8 + 1.3 log2 n where planes are chosen by cost, as kd-trees have it (Havran 2000);
    /// 9 + 1.8 log2 n for halves, for a surface of n triangles is about sqrt n of them wide, and an octree that wide has
    /// 1.5 log2 n levels.
    pub(super) fn levels(&self, count: usize) -> u32 {
        let log = (count.max(1) as f64).log2();
        let usual = match self.planes {
            Choice::Midpoint => 9.0 + 1.8 * log,
            Choice::Sah | Choice::Oblique => 8.0 + 1.3 * log,
        };
        self.depth.unwrap_or(usual as u32).min(MAX_DEPTH)
    }
}
