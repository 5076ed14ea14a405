//! One ray through all parts: the grid on top, nodes below, packs at the leaves.

use super::exact::Exact;
use super::frame::{Entry, Start};
use super::lanes::{Lanes, Row};
use super::pack::{Pack, PackRay};
use super::shape::{AnyPart, Node, Part, Shape, Slot};
use crate::accel::Probe;
use crate::ray::Ray;

/// How the trace of a ray ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Outcome {
    /// The winner of the exact tests is the ray's.
    Done,
    /// The ray starts too far away for a part's arithmetic: every primitive must be tested.
    TooFar,
}

/// Nodes above one another at most: cells are not cut below [`super::build::LEAST_CELL`].
const DEPTH: usize = 12;

/// Sends `ray` through all parts; ends with the first hit if `any` will do. `ray` comes from [`Ray::intake`].
#[inline(always)]
pub(super) fn trace<S: Lanes, P: Probe>(
    shape: &Shape,
    ray: &Ray,
    any: bool,
    exact: &mut dyn Exact,
    probe: &mut P,
) -> Outcome {
    for part in &shape.parts {
        let frame = match part {
            AnyPart::Triangles(part) => &part.frame,
            AnyPart::Spheres(part) => &part.frame,
            AnyPart::Lists(part) => &part.frame,
        };
        let entry = match frame.enter(ray, exact.upper()) {
            Start::Miss => continue,
            Start::TooFar => return Outcome::TooFar,
            Start::Inside(entry) => entry,
        };
        let done = match part {
            AnyPart::Triangles(part) => Trace::<S, _, _>::new(part, &entry, any, exact, probe).run(),
            AnyPart::Spheres(part) => Trace::<S, _, _>::new(part, &entry, any, exact, probe).run(),
            AnyPart::Lists(part) => Trace::<S, _, _>::new(part, &entry, any, exact, probe).run(),
        };
        if done {
            break;
        }
    }
    Outcome::Done
}

/// A ray in a part.
struct Trace<'a, S, K, P> {
    part: &'a Part<K>,
    entry: Entry,
    any: bool,
    exact: &'a mut dyn Exact,
    probe: &'a mut P,
    ray: PackRay<S>,
    /// The part seen along the ray: signs are changed so that the ray moves forwards along every axis.
    origin: [f32; 3],
    inverse: [f32; 3],
    /// Changes the sign of the axes along which the ray moves backwards.
    sign: [f32; 3],
    /// Bit `a` is set if the ray moves backwards along axis `a`.
    octant: usize,
    /// Beyond this nothing is of interest.
    end: f32,
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

impl<'a, S: Lanes, K: Pack, P: Probe> Trace<'a, S, K, P> {
    #[inline(always)]
    fn new(part: &'a Part<K>, entry: &Entry, any: bool, exact: &'a mut dyn Exact, probe: &'a mut P) -> Self {
        let d = entry.direction;
        let (mut sign, mut origin, mut inverse) = ([1.0; 3], [0.0; 3], [0.0; 3]);
        for a in 0..3 {
            sign[a] = 1.0_f32.copysign(d[a]);
            origin[a] = entry.origin[a] * sign[a];
            inverse[a] = 1.0 / d[a].abs();
        }
        Self {
            part,
            entry: *entry,
            any,
            exact,
            probe,
            ray: PackRay::new(entry),
            origin,
            inverse,
            sign,
            octant: usize::from(d[0] < 0.0) | usize::from(d[1] < 0.0) << 1 | usize::from(d[2] < 0.0) << 2,
            end: entry.end,
        }
    }

    /// From cell to cell of the grid; true if the ray needs no other part.
    #[inline(always)]
    fn run(mut self) -> bool {
        let top = &self.part.top;
        if let [slot] = top.slots[..] {
            return self.look(slot, 0.0, self.end) == Next::Nothing;
        }
        let count = top.slots.len();
        let free = &top.free[self.octant * count..][..count];
        // A plane is crossed at its number times the pace less the base; `left` steps stay within the grid.
        let (mut base, mut pace, mut speed) = ([0.0_f32; 3], [0.0_f32; 3], [0.0_f32; 3]);
        let (mut left, mut plane, mut crossing) = ([0_i32; 3], [0.0_f32; 3], [0.0_f32; 3]);
        let (mut stride, mut cell) = ([0_isize; 3], 0_isize);
        let mut step = 1;
        for a in 0..3 {
            let from = top.half[a] + self.origin[a];
            base[a] = from * self.inverse[a];
            pace[a] = top.cell[a] * self.inverse[a];
            speed[a] = top.per_unit[a] * self.entry.direction[a].abs();
            let last = top.cells[a] as i32 - 1;
            // Saturates; the origin is in the grid but for rounding.
            let at = ((from * top.per_unit[a]) as i32).clamp(0, last);
            left[a] = last - at;
            plane[a] = (at + 1) as f32;
            crossing[a] = plane[a] * pace[a] - base[a];
            let backward = self.octant >> a & 1 != 0;
            stride[a] = if backward { -step } else { step };
            cell += (if backward { last - at } else { at }) as isize * step;
            step *= top.cells[a] as isize;
        }
        let mut s = 0.0;
        loop {
            self.probe.step();
            let [x, y, z] = crossing;
            let distance = free[cell as usize];
            if distance == 0 {
                let out = least(x, least(y, z));
                match self.look(top.slots[cell as usize], s, out) {
                    Next::Cell => {}
                    next => return next == Next::Nothing,
                }
            } else if distance > 2 {
                // The cube of this edge that begins with the cell is empty: to where the ray leaves it.
                self.probe.leap();
                let reach = f32::from(distance) - 1.0;
                let exits = [x + reach * pace[0], y + reach * pace[1], z + reach * pace[2]];
                s = least(exits[0], least(exits[1], exits[2]));
                if s > self.end {
                    return false;
                }
                let mut outside = 0;
                for a in 0..3 {
                    // Planes crossed on the way; all of the cube's along the axis of the exit.
                    let within = ((s - crossing[a]) * speed[a]) as i32 + i32::from(s > crossing[a]);
                    let crossed = if exits[a] == s { i32::from(distance) } else { within.clamp(0, i32::from(distance) - 1) };
                    left[a] -= crossed;
                    outside |= left[a];
                    plane[a] += crossed as f32;
                    cell += crossed as isize * stride[a];
                    crossing[a] = plane[a] * pace[a] - base[a];
                }
                if outside < 0 {
                    return false;
                }
                continue;
            }
            let a = if x < y { if x < z { 0 } else { 2 } } else if y < z { 1 } else { 2 };
            s = crossing[a];
            left[a] -= 1;
            if s > self.end || left[a] < 0 {
                return false;
            }
            plane[a] += 1.0;
            cell += stride[a];
            crossing[a] = plane[a] * pace[a] - base[a];
        }
    }

    /// What a cell of the grid holds, which the ray crosses from `near` to `far`.
    #[inline(always)]
    fn look(&mut self, slot: Slot, near: f32, far: f32) -> Next {
        if slot.is_node() { self.descend(slot, near, far) } else { self.test(slot, far) }
    }

    /// The packs of a cell that the ray leaves at `far`.
    #[inline(always)]
    fn test(&mut self, slot: Slot, far: f32) -> Next {
        for pack in &self.part.packs[slot.first as usize..][..slot.count as usize] {
            let mut survivors = pack.survivors::<S>(&self.ray, S::splat(self.end));
            while survivors != 0 {
                let prim = pack.prims()[survivors.trailing_zeros() as usize & 7];
                survivors &= survivors - 1;
                self.probe.test();
                let upper = self.exact.test(prim);
                if upper < f64::INFINITY {
                    if self.any {
                        return Next::Nothing;
                    }
                    self.end = least(self.end, self.entry.beyond(upper));
                }
            }
        }
        if self.end < far { Next::Part } else { Next::Cell }
    }

    /// The nodes below a cell, front to back.
    #[inline(always)]
    fn descend(&mut self, slot: Slot, mut near: f32, mut far: f32) -> Next {
        /// A node with cells that are still to come.
        #[derive(Clone, Copy, Default)]
        struct Waiting {
            cells: u64,
            index: u32,
            near: f32,
            far: f32,
        }
        let mut stack = [Waiting::default(); DEPTH];
        let mut waiting = 0;
        let mut index = slot.first;
        let mut part_of_node = u64::MAX;
        loop {
            self.probe.step();
            let node = &self.part.nodes[index as usize];
            let axes = self.crossings(node, near, far);
            let mut cells = S::crossed(&axes) & mirrored(node.mask, self.octant) & part_of_node;
            let flip = (self.octant & 1) * 3 | (self.octant >> 1 & 1) * 12 | (self.octant >> 2) * 48;
            let deeper = loop {
                if cells == 0 {
                    break None;
                }
                let cell = cells.trailing_zeros() as usize;
                cells &= cells - 1;
                let (x, y, z) = (cell & 3, cell >> 2 & 3, cell >> 4 & 3);
                let from = most(axes[0].0[x], most(axes[1].0[y], axes[2].0[z]));
                if from > self.end {
                    return Next::Part;
                }
                let to = least(axes[0].0[x + 4], least(axes[1].0[y + 4], axes[2].0[z + 4]));
                let below = node.mask & ((1 << (cell ^ flip)) - 1);
                let slot = self.part.slots[node.base as usize + below.count_ones() as usize];
                if slot.is_node() {
                    break Some((slot.first, from, to));
                }
                match self.test(slot, to) {
                    Next::Cell => {}
                    next => return next,
                }
            };
            match deeper {
                Some((child, from, to)) => {
                    if cells != 0 {
                        stack[waiting % DEPTH] = Waiting { cells, index, near, far };
                        waiting += 1;
                    }
                    (index, near, far, part_of_node) = (child, from, to, u64::MAX);
                }
                None if waiting == 0 => return Next::Cell,
                None => {
                    waiting -= 1;
                    let Waiting { cells, index: node, near: from, far: to } = stack[waiting % DEPTH];
                    (index, near, far, part_of_node) = (node, from, to, cells);
                }
            }
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
        let at = S::splat(node.centre[axis] * self.sign[axis]) + planes * S::splat(node.cell[axis]);
        (at - S::splat(self.origin[axis])) * S::splat(self.inverse[axis])
    }
}

/// The cells of a node seen along an octant of directions: bit `i` becomes bit `i` with the coordinates turned round of the
/// axes along which rays move backwards.
#[inline(always)]
fn mirrored(mut mask: u64, octant: usize) -> u64 {
    if octant & 1 != 0 {
        mask = (mask >> 1 & 0x5555_5555_5555_5555) | (mask & 0x5555_5555_5555_5555) << 1;
        mask = (mask >> 2 & 0x3333_3333_3333_3333) | (mask & 0x3333_3333_3333_3333) << 2;
    }
    if octant & 2 != 0 {
        mask = (mask >> 4 & 0x0f0f_0f0f_0f0f_0f0f) | (mask & 0x0f0f_0f0f_0f0f_0f0f) << 4;
        mask = (mask >> 8 & 0x00ff_00ff_00ff_00ff) | (mask & 0x00ff_00ff_00ff_00ff) << 8;
    }
    if octant & 4 != 0 {
        mask = (mask >> 16 & 0x0000_ffff_0000_ffff) | (mask & 0x0000_ffff_0000_ffff) << 16;
        mask = mask.rotate_left(32);
    }
    mask
}

/// The lesser one, neither a NaN: one instruction.
#[inline(always)]
fn least(a: f32, b: f32) -> f32 {
    if a < b { a } else { b }
}

/// The greater one.
#[inline(always)]
fn most(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}
