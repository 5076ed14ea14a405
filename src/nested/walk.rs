//! One ray through all parts: the grid on top, nodes below, packs at the leaves.

use super::boxes::BoxRay;
use super::crowd::{self, Aside, Beaten, Crowd, Met};
use super::exact::{Exact, Known};
use super::frame::{Entry, Start};
use super::lanes::{Lanes, Portable, Row};
use super::pack::{Pack, PackRay, Seen, Verdict};
use super::shape::{AnyPart, Node, Part, Shape, Slot};
use super::step::{Place, least, most};
use super::tree;
use crate::accel::{Counts, Probe};
use crate::geometry::NO_PRIM;
use crate::ray::Ray;
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

/// More than the rounding of a parameter to f32, relative to it.
const EASE: f64 = 1.0 / (1 << 23) as f64;

/// Parameters known to f64 are known within this, relative to them.
const CLOSE: f64 = 1.0 / (1 << 30) as f64;

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
        let mut at = Place::new(top, self.origin, self.entry, self.octant);
        let mut s = 0.0;
        let mut stack = [Waiting::default(); DEPTH];
        loop {
            self.probe.step();
            let [x, y, z] = at.crossing;
            let distance = free[at.cell as usize];
            if distance == 0 {
                let out = least(x, least(y, z));
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

    /// The packs of a cell that the ray leaves at `far`: one, or those that the ray meets of trees, packs before groups and nearer groups
    /// before others.
    #[inline(always)]
    fn test(&mut self, slot: Slot, far: f32) -> Next {
        if slot.groups() == 0 {
            return Next::Cell;
        }
        let part: &'a Part<K> = self.part;
        let (boxed, last) = (slot.is_boxed(), slot.first + (slot.groups() - 1));
        let (mut root, mut index, mut waiting) = (slot.first, slot.first, 0_usize);
        'groups: loop {
            let (first, below, inner, enters, mut met) = if boxed {
                self.probe.step();
                let boxes = &part.boxes[index as usize];
                let (enters, met) = boxes.look(&self.boxes, self.limit);
                (boxes.first, boxes.below, (1_u32 << (boxes.inner & 15)) - 1, enters, met)
            } else {
                (slot.first, 0, 0, S::splat(0.0), 1)
            };
            let mut packs = met & !inner;
            while packs != 0 {
                let pack = &part.packs[first.wrapping_add(packs.trailing_zeros()) as usize];
                packs &= packs - 1;
                self.probe.leaf();
                if self.crowd.thick && self.aside(pack) {
                    continue;
                }
                let (ray, end) = (&self.ray, S::splat(self.limit));
                let seen = if EXACT { pack.look::<S>(ray, end) } else { pack.look_rounded::<S>(ray, end) };
                if seen.survivors != 0 {
                    if self.meet(pack, seen) {
                        return Next::Nothing;
                    }
                    met &= !S::bits(S::splat(self.limit).less(enters));
                    packs &= met;
                }
            }
            met &= inner;
            if met != 0 {
                index = below + met.trailing_zeros();
                met &= met - 1;
                if met != 0 {
                    let Row(enters) = enters.row();
                    let mut near = enters[(index - below) as usize & 7];
                    while met != 0 {
                        let lane = met.trailing_zeros();
                        met &= met - 1;
                        let mut other = Group { enter: enters[lane as usize & 7], index: below + lane };
                        if other.enter < near {
                            std::mem::swap(&mut other.enter, &mut near);
                            std::mem::swap(&mut other.index, &mut index);
                        }
                        self.groups[waiting % GROUPS] = other;
                        waiting += 1;
                    }
                }
                continue;
            }
            while waiting != 0 {
                waiting -= 1;
                let Group { enter, index: next } = self.groups[waiting % GROUPS];
                if enter <= self.limit {
                    index = next;
                    continue 'groups;
                }
            }
            if root == last {
                break;
            }
            root += 1;
            index = root;
        }
        if self.end < far { Next::Part } else { Next::Cell }
    }

    /// What survives of a pack; true if that is all the ray wants.
    #[inline(always)]
    fn meet(&mut self, pack: &'a K, seen: Seen<S>) -> bool {
        if !EXACT {
            return self.meet_rounded(pack, seen);
        }
        let (from, to) = (seen.p - seen.bound, seen.p + seen.bound);
        let in_range = to.less(S::splat(self.sure)) & self.ray.begin.less(from);
        let certain = if K::CERTAIN { S::bits(seen.certain & in_range) } else { 0 };
        if self.any && certain != 0 {
            self.found = true;
            return true;
        }
        let (Row(from), Row(to)) = (from.row(), to.row());
        let mut survivors = seen.survivors;
        if !crowd::few(survivors & !certain) {
            survivors &= !self.crowd(pack, survivors & !certain);
        }
        while survivors != 0 {
            let lane = survivors.trailing_zeros() as usize & 7;
            survivors &= survivors - 1;
            let prim = pack.prims()[lane];
            if prim == self.winner {
                continue;
            }
            let known = if K::CERTAIN && certain >> lane & 1 != 0 {
                Some((from[lane], to[lane]))
            } else {
                match pack.judge(lane, &self.entry.sight, self.limit) {
                    Verdict::Miss => continue,
                    Verdict::Hit { p, bound } => {
                        let ease = bound + EASE * p.abs();
                        Some(((p - ease) as f32, (p + ease) as f32))
                    }
                    Verdict::Open => None,
                }
            };
            if let Some((from, to)) = known {
                if self.any {
                    self.found = true;
                    return true;
                }
                if to < self.sure {
                    // Before all that was met so far: the winner, whose exact parameter can wait.
                    (self.pending, self.limit, self.sure) = (Some((pack, lane)), to, from);
                    self.winner = prim;
                    self.end = least(self.end, self.entry.walked(self.limit));
                    continue;
                }
                if from > self.limit {
                    continue;
                }
            }
            self.settle();
            if self.exactly(prim) {
                self.crowd.met = pack.corner(lane, &self.entry.sight).map(|corner| Met { corner, prim });
                let met = self.crowd.met;
                survivors &= !S::apart(Beaten { pack, met: &met });
            }
            if self.any && self.found {
                return true;
            }
        }
        false
    }

    /// As [`Trace::meet`], of hits as f32 has them.
    #[inline(always)]
    fn meet_rounded(&mut self, pack: &'a K, seen: Seen<S>) -> bool {
        let Row(p) = seen.p.row();
        let mut survivors = seen.survivors;
        while survivors != 0 && !(self.any && self.found) {
            let lane = survivors.trailing_zeros() as usize & 7;
            survivors &= survivors - 1;
            if p[lane] <= self.limit {
                (self.pending, self.limit, self.found) = (Some((pack, lane)), p[lane], true);
            }
        }
        self.end = least(self.end, self.entry.walked(self.limit));
        self.any && self.found
    }

    /// The lanes that need not be looked at one by one, where many primitives are near the ray.
    #[inline(always)]
    fn crowd(&mut self, pack: &K, open: u32) -> u32 {
        // One that waits is nearer than the one that has been.
        let winner = if self.pending.is_some() { None } else { self.exact.known().map(|known| known.prim) };
        // A copy: what is lent out of `self` would keep all of it in memory.
        let mut known = self.crowd;
        let before = known.met.map(|met| met.prim);
        let done = S::apart(Crowd { pack, sight: &self.entry.sight, end: self.limit, open, winner, known: &mut known });
        if let Some(met) = known.met.filter(|met| Some(met.prim) != before) {
            self.exact.rename(met.prim);
        }
        self.crowd = known;
        done
    }

    /// True if nothing of a pack is left, of one after a pack of which nothing was.
    #[inline(always)]
    fn aside(&mut self, pack: &K) -> bool {
        let mut known = self.crowd;
        let aside = S::apart(Aside { pack, known: &mut known });
        self.crowd = known;
        aside
    }

    /// Finds the parameter of the winner that waits, if one does.
    #[inline(always)]
    fn settle(&mut self) {
        if let Some((pack, lane)) = self.pending.take() {
            let prim = pack.prims()[lane];
            if !EXACT {
                let (t, err) = self.entry.parameter(self.limit.into(), 0.0);
                self.exact.replace(prim, t, err);
                return;
            }
            let found = match pack.judge(lane, &self.entry.sight, f32::INFINITY) {
                Verdict::Hit { p, bound } => Some(self.entry.parameter(p, bound)),
                _ => None,
            };
            let known = match found {
                // Good enough to be rounded to f32; next to the ray's origin it may not be.
                Some((t, err)) if err < t.abs() * CLOSE => self.exact.replace(prim, t, err),
                _ => {
                    self.probe.test();
                    self.exact.settle(prim)
                }
            };
            self.know(known);
        }
    }

    /// Tests a primitive exactly; true if it wins.
    #[inline(always)]
    fn exactly(&mut self, prim: u32) -> bool {
        self.probe.test();
        let known = self.exact.test(prim);
        self.know(known);
        known.is_some_and(|known| known.prim == prim)
    }

    /// Lowers the end to the winner.
    #[inline(always)]
    fn know(&mut self, known: Option<Known>) {
        if let Some(Known { prim, lower, upper }) = known {
            (self.found, self.winner) = (true, prim);
            self.limit = least(self.limit, self.entry.around(upper)[1]);
            self.sure = least(self.sure, self.entry.around(lower)[0]);
            self.end = least(self.end, self.entry.walked(self.limit));
        }
    }

    /// What a cell of the grid holds, which the ray crosses from `near` to `far`: packs, or nodes, front to back.
    #[inline(always)]
    fn visit(&mut self, mut slot: Slot, mut near: f32, mut far: f32, stack: &mut [Waiting; DEPTH]) -> Next {
        let mut waiting = 0;
        // The innermost node that the ray is in.
        let mut inner = Waiting::default();
        let mut axes = [Row([0.0; 8]); 3];
        // Turns the coordinates round of the axes along which the ray moves backwards.
        let flip = FLIPS[self.octant & 7];
        loop {
            let mut enter = None;
            if slot.is_node() {
                if inner.cells != 0 {
                    stack[waiting % DEPTH] = inner;
                    waiting += 1;
                }
                enter = Some(Waiting { cells: u64::MAX, index: slot.first.into(), near, far });
            } else {
                match self.test(slot, far) {
                    Next::Cell => {}
                    next => return next,
                }
            }
            loop {
                if let Some(node) = enter {
                    self.probe.step();
                    inner = node;
                    let node = &self.part.nodes[inner.index as usize];
                    axes = self.crossings(node, inner.near, inner.far);
                    inner.cells &= S::crossed(&axes) & S::mirrored(node.mask, self.octant);
                }
                if inner.cells != 0 {
                    break;
                }
                if waiting == 0 {
                    return Next::Cell;
                }
                waiting -= 1;
                enter = Some(stack[waiting % DEPTH]);
            }
            let node = &self.part.nodes[inner.index as usize];
            let cell = inner.cells.trailing_zeros() as usize;
            inner.cells &= inner.cells - 1;
            let (x, y, z) = (cell & 3, cell >> 2 & 3, cell >> 4 & 3);
            near = most(axes[0].0[x], most(axes[1].0[y], axes[2].0[z]));
            if near > self.end {
                return Next::Part;
            }
            far = least(axes[0].0[x + 4], least(axes[1].0[y + 4], axes[2].0[z + 4]));
            let below = node.mask & ((1 << (cell ^ flip)) - 1);
            slot = self.part.slots[node.base as usize + below.count_ones() as usize];
        }
    }

    /// Where the ray, which is in the node from `near` to `far`, is in each slice of it: for each axis four begins, then four
    /// ends. The outermost slices have no outer planes: what is there of the ray is in the node.
    #[inline(always)]
    fn crossings(&self, node: &Node, near: f32, far: f32) -> [Row; 3] {
        const BEYOND: f32 = 1e9;
        const PLANES: Row = Row([-BEYOND, -1.0, 0.0, 1.0, -1.0, 0.0, 1.0, BEYOND]);
        let planes = S::of(&PLANES);
        let x = self.crossings_of(node, planes, 0);
        let y = self.crossings_of(node, planes, 1);
        // Clipping one axis clips the cells.
        let ends = S::halves(f32::INFINITY, far);
        let begins = S::halves(near, f32::NEG_INFINITY);
        let z = self.crossings_of(node, planes, 2).max(begins).min(ends);
        [x.row(), y.row(), z.row()]
    }

    /// Where the ray crosses planes of an axis, given in cells from the node's centre.
    #[inline(always)]
    fn crossings_of(&self, node: &Node, planes: S, axis: usize) -> S {
        let at = S::splat(node.centre[axis] * self.entry.sign[axis]) + planes * S::splat(node.cell[axis]);
        (at - S::splat(self.origin[axis])) * S::splat(self.entry.inverse[axis])
    }
}

/// For each octant the bits of a cell's number that differ when the node is seen along it.
const FLIPS: [usize; 8] = [0, 3, 12, 15, 48, 51, 60, 63];
