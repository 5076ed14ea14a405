//! The options that scenes by formula take: whole numbers, each within the range that its scene states.

use crate::error::{Error, Result};
use std::ops::RangeInclusive;

/// Options of a procedural scene; `None`: the entry's default.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Options {
    /// A count; each entry says of what.
    pub n: Option<u64>,
    /// Levels of recursion.
    pub depth: Option<u64>,
    /// Seed of the random numbers.
    pub seed: Option<u64>,
    /// Sides of each cone and cylinder.
    pub sides: Option<u64>,
    /// Spheres of triangles: halvings of an icosahedron's edges.
    pub balls: Option<u64>,
    /// Primitives that there is memory for.
    pub(in crate::scene) room: Option<u64>,
}

impl Options {
    pub(super) fn n(&self, default: u64, range: RangeInclusive<u64>) -> Result<u32> {
        within("n", self.n.unwrap_or(default), range)
    }

    pub(super) fn depth(&self, default: u64, range: RangeInclusive<u64>) -> Result<u32> {
        within("depth", self.depth.unwrap_or(default), range)
    }

    /// Refuses to make `count` primitives if memory is left for fewer.
    pub(super) fn limit(&self, count: u64) -> Result<()> {
        match self.room {
            Some(room) if count > room => Err(Error::invalid(format!("{count} primitives, memory is left for {room}"))),
            _ => Ok(()),
        }
    }

    pub(super) fn set(&mut self, key: &str, value: u64) {
        match key {
            "n" => self.n = Some(value),
            "depth" => self.depth = Some(value),
            "sides" => self.sides = Some(value),
            "balls" => self.balls = Some(value),
            _ => self.seed = Some(value),
        }
    }

    pub(super) fn given(&self) -> impl Iterator<Item = &'static str> {
        let all =
            [("n", self.n), ("depth", self.depth), ("seed", self.seed), ("sides", self.sides), ("balls", self.balls)];
        all.into_iter().filter_map(|(key, value)| value.map(|_| key))
    }
}

pub(super) fn within(key: &str, value: u64, range: RangeInclusive<u64>) -> Result<u32> {
    let good = range.contains(&value).then(|| u32::try_from(value).ok()).flatten();
    good.ok_or_else(|| Error::invalid(format!("{key}={value} is not within {} to {}", range.start(), range.end())))
}
