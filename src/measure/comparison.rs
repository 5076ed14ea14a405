//! What a comparison of accelerators gives: answers that differ, and costs.

use super::machine::Machine;
use super::rays::{Query, RayKind};
use super::rounds::same;
use crate::accel::{Counts, Hit, Memory};
use crate::ray::Ray;

/// What came out. Rays are traced on one thread, through `&dyn Accel`, and timed by the processor time of that thread.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The scene's name.
    pub scene: String,
    /// Number of primitives.
    pub primitives: u32,
    /// Timed rounds.
    pub rounds: u32,
    /// What it was measured on.
    pub machine: Machine,
    /// The ray sets.
    pub kinds: Vec<Kind>,
    /// One row for each accelerator, in the order given.
    pub rows: Vec<Row>,
    /// Rays on which the answer of an accelerator that promises exact ones differed; one ray counts once for each of them.
    pub differing: u64,
    /// The first of them.
    pub difference: Option<Difference>,
    /// Row whose answers the others are held against: the first that promises exact ones, else the first.
    pub truth: usize,
}

impl Comparison {
    /// True if every accelerator that promises exact answers gave the same, to the bit, on every ray.
    pub fn identical(&self) -> bool {
        self.differing == 0
    }

    /// Rays in all sets.
    pub fn rays(&self) -> u64 {
        self.kinds.iter().map(|k| k.rays).sum()
    }
}

/// One ray set.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Kind {
    /// Where the rays come from.
    pub kind: RayKind,
    /// What was timed.
    pub query: Query,
    /// Number of rays.
    pub rays: u64,
    /// Rays that hit something.
    pub hits: u64,
}

/// One accelerator.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// Specification as given.
    pub accel: String,
    /// What was built, and what the accelerator has to say after all rays were traced; may be empty.
    pub described: String,
    /// Cost of building.
    pub build: Build,
    /// One for each ray set; `None` if the set is empty.
    pub rates: Vec<Option<Rate>>,
    /// Whether it promises exact answers; see [`crate::registry::promises_exact`].
    pub exact: bool,
    /// How its answers differ, over all sets.
    pub deviations: Deviations,
}

/// Rays on which an accelerator's answer differs, each counted once: by the first of these that applies.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Deviations {
    /// It finds nothing where there is something.
    pub missed: u64,
    /// It finds something where there is nothing.
    pub extra: u64,
    /// Another primitive.
    pub primitive: u64,
    /// The right primitive, but other bits of `t`.
    pub parameter: u64,
    /// The closest hit is right, but any hit or an answer with counting is not.
    pub other: u64,
}

impl Deviations {
    /// All of them.
    pub fn total(&self) -> u64 {
        self.missed + self.extra + self.primitive + self.parameter + self.other
    }

    pub(super) fn count(&mut self, truth: Option<Hit>, hit: Option<Hit>) {
        *match (truth, hit) {
            (Some(_), None) => &mut self.missed,
            (None, Some(_)) => &mut self.extra,
            (Some(a), Some(b)) if a.prim != b.prim => &mut self.primitive,
            _ if !same(truth, hit) => &mut self.parameter,
            _ => &mut self.other,
        } += 1;
    }
}

/// Cost of building.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Build {
    /// Median of one to three builds, milliseconds of wall time, on all cores.
    pub milliseconds: f64,
    /// The same in milliseconds that all threads together computed.
    pub cpu_milliseconds: f64,
    /// Bytes held beside the geometry.
    pub memory: Memory,
}

/// Speed and work on one ray set.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Rate {
    /// Rays traced in a second of processor time: median of the rounds.
    pub rays_per_second: f64,
    /// Half the distance between the fastest and the slowest round, as a share of the median; 0 for one round.
    pub spread: f64,
    /// Work for the whole set; independent of the machine.
    pub counts: Counts,
    /// Rays of the set on which the answers differ.
    pub differing: u64,
}

impl Rate {
    /// Primitive tests a ray; NaN if they are not counted: an accelerator that makes neither tests nor steps counts nothing.
    pub fn tests_per_ray(&self) -> f64 {
        self.per_ray(self.counts.tests, self.counts.tests > 0 || self.counts.steps > 0)
    }

    /// Voxels or nodes visited a ray; NaN if they are not counted: an accelerator that takes no step counts none.
    pub fn steps_per_ray(&self) -> f64 {
        self.per_ray(self.counts.steps, self.counts.steps > 0)
    }

    /// Leaps a ray; NaN if not even steps are counted.
    pub fn leaps_per_ray(&self) -> f64 {
        self.per_ray(self.counts.leaps, self.counts.steps > 0)
    }

    fn per_ray(&self, number: u64, counted: bool) -> f64 {
        if counted { number as f64 / self.counts.rays as f64 } else { f64::NAN }
    }
}

/// A ray on which two accelerators disagree.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// The set.
    pub kind: RayKind,
    /// Index in the set.
    pub index: usize,
    /// The ray.
    pub ray: Ray,
    /// Question: "closest hit", "any hit" or one of them with counting.
    pub query: &'static str,
    /// The accelerator that the others are held against, and its answer.
    pub first: (String, Option<Hit>),
    /// The other one and its answer: for any-hit questions `Err` holds the flag.
    pub other: (String, std::result::Result<Option<Hit>, bool>),
}
