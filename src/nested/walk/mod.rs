//! One ray through all parts, and through the grid on top of each; `nodes` and `leaf` have what is below.

mod leaf;
mod nodes;
#[cfg(test)]
mod tests;

use super::boxes::BoxRay;
use super::crowd;
use super::exact::Exact;
use super::frame::Start;
use super::lanes::{Lanes, Portable};
use super::pack::{Pack, PackRay};
use super::shape::{AnyPart, Part, Shape};
use super::sight::Entry;
use super::step::Place;
use super::tree;
use crate::accel::{Counts, Probe};
use crate::geometry::NO_PRIM;
use crate::ray::{Ray, lesser};
use glam::Vec3A;

/// How the trace of a ray ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// The winner of the exact tests is the ray's.
    Done,
    /// There is a hit, and any will do.
    Hit,
    /// The ray starts too far away for a part's arithmetic: every primitive must be tested.
    TooFar,
}

/// As [`trace`], in portable code, and adds the work done.
pub(super) fn trace_counted(
    shape: &Shape,
    ray: &Ray,
    any: bool,
    exact: &mut dyn Exact,
    counts: &mut Counts,
) -> Outcome {
    trace::<Portable, _, true>(shape, ray, any, exact, counts)
}

/// Nodes above one another at most: cells are not cut below [`super::cut::LEAST_CELL`], 2^-15.
const DEPTH: usize = 8;

/// Groups that may wait: seven of each level above the last one of a tree.
const GROUPS: usize = 32;
const _: () = assert!(7 * (tree::LEVELS as usize - 1) <= GROUPS);

/// Sends `ray` through all parts; ends with the first hit if `any` will do. `ray` comes from [`Ray::intake`].
#[inline(always)]
pub(super) fn trace<S: Lanes, P: Probe, const EXACT: bool>(
    shape: &Shape,
    ray: &Ray,
    any: bool,
    exact: &mut dyn Exact,
    probe: &mut P,
) -> Outcome {
    let mut winner = None;
    for part in &shape.parts {
        let frame = match part {
            AnyPart::Triangles(part) => &part.frame,
            AnyPart::Spheres(part) => &part.frame,
            AnyPart::Lists(part) => &part.frame,
        };
        let entry = match frame.enter(ray, winner) {
            Start::Miss => continue,
            Start::TooFar => return Outcome::TooFar,
            Start::Inside(entry) => entry,
        };
        let done = match part {
            AnyPart::Triangles(part) => Trace::<S, _, _, EXACT>::new(part, &entry, any, exact, probe).run(),
            AnyPart::Spheres(part) => Trace::<S, _, _, EXACT>::new(part, &entry, any, exact, probe).run(),
            AnyPart::Lists(part) => Trace::<S, _, _, EXACT>::new(part, &entry, any, exact, probe).run(),
        };
        if done {
            return Outcome::Hit;
        }
        if shape.parts.len() > 1 {
            winner = exact.known();
        }
    }
    Outcome::Done
}

/// A ray in a part; `EXACT` is false where answers are to be as in f32, to measure what exactness costs.
struct Trace<'a, S, K, P, const EXACT: bool> {
    part: &'a Part<K>,
    entry: &'a Entry,
    any: bool,
    exact: &'a mut dyn Exact,
    probe: &'a mut P,
    ray: PackRay<S>,
    boxes: BoxRay<S>,
    /// Groups of boxes that are still to come.
    groups: [Group; GROUPS],
    /// The part seen along the ray: signs are changed so that the ray moves forwards along every axis.
    origin: Vec3A,
    /// Bit `a` is set if the ray moves backwards along axis `a`.
    octant: usize,
    /// The `s` at or beyond the winner, or the ray's end: beyond this nothing is of interest.
    end: f32,
    /// That in the packs' `p`.
    limit: f32,
    /// The `p` at or before the winner and the ray's end.
    sure: f32,
    /// The winner, as a lane of a pack, if its parameter is known to f32 only.
    pending: Option<(&'a K, usize)>,
    /// The winner so far, or [`NO_PRIM`]: it is met again in every cell up to where it is hit.
    winner: u32,
    /// True if there is a winner that has been, or one that need not be.
    found: bool,
    /// What is known where many primitives are near the ray.
    crowd: crowd::Known,
}

/// A group of boxes that a ray enters at a `p`.
#[derive(Clone, Copy, Default)]
struct Group {
    enter: f32,
    index: u32,
}

/// A node with cells that are still to come.
#[derive(Clone, Copy, Default)]
struct Waiting {
    cells: u64,
    index: u64,
    near: f32,
    far: f32,
}

/// Whether a ray goes on.
#[derive(PartialEq)]
enum Next {
    /// To the next cell.
    Cell,
    /// To the next part: the winner of this one is certain.
    Part,
    /// Nowhere: any hit will do, and there is one.
    Nothing,
}

impl<'a, S: Lanes, K: Pack, P: Probe, const EXACT: bool> Trace<'a, S, K, P, EXACT> {
    #[inline(always)]
    fn new(part: &'a Part<K>, entry: &'a Entry, any: bool, exact: &'a mut dyn Exact, probe: &'a mut P) -> Self {
        Self {
            part,
            entry,
            any,
            exact,
            probe,
            ray: PackRay::new::<K>(&entry.sight),
            boxes: BoxRay::new(entry),
            groups: [Group::default(); GROUPS],
            origin: entry.origin * entry.sign,
            octant: entry.sign.is_negative_bitmask() as usize,
            end: entry.end,
            limit: entry.sight.end[1],
            sure: entry.sight.end[0],
            pending: None,
            winner: NO_PRIM,
            found: false,
            crowd: crowd::Known::default(),
        }
    }

    /// Through the part; true if any hit will do and there is one.
    #[inline(always)]
    fn run(&mut self) -> bool {
        self.cells();
        self.settle();
        self.any && self.found
    }

    /// From cell to cell of the grid.
    #[inline(always)]
    fn cells(&mut self) {
        let top = &self.part.top;
        let count = top.slots.len();
        let free = &top.free[self.octant * count..][..count];
        let mut at = match count {
            1 => Place::only(self.end),
            _ => Place::new(top, self.origin, self.entry, self.octant),
        };
        let mut s = 0.0;
        let mut stack = [Waiting::default(); DEPTH];
        loop {
            self.probe.step();
            let [x, y, z] = at.crossing;
            let distance = free[at.cell as usize];
            if distance == 0 {
                let out = lesser(x, lesser(y, z));
                if self.visit(top.slots[at.cell as usize], s, out, &mut stack) != Next::Cell {
                    return;
                }
            } else if distance > 2 {
                self.probe.leap();
                if !at.leap(f32::from(distance), self.end, &mut s) {
                    return;
                }
                continue;
            }
            // One branch for each axis: which of them it is tells the predictor where the ray is going.
            let inside = if x < y {
                if x < z { at.step::<0>(&mut s) } else { at.step::<2>(&mut s) }
            } else if y < z {
                at.step::<1>(&mut s)
            } else {
                at.step::<2>(&mut s)
            };
            if !inside || s > self.end {
                return;
            }
        }
    }
}
