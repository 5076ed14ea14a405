//! A ray through a cell that is cut into nodes of 4 x 4 x 4 cells: all planes of a node at once, and its cells front to back by
//! their bits.

use super::{DEPTH, Next, Trace, Waiting};
use crate::accel::Probe;
use crate::nested::lanes::{Lanes, Row};
use crate::nested::pack::Pack;
use crate::nested::shape::{Node, Slot};
use crate::ray::{greater, lesser};

impl<S: Lanes, K: Pack, P: Probe, const EXACT: bool> Trace<'_, S, K, P, EXACT> {
    /// What a cell of the grid holds, which the ray crosses from `near` to `far`: packs, or nodes, front to back.
    #[inline(always)]
    pub(super) fn visit(&mut self, mut slot: Slot, mut near: f32, mut far: f32, stack: &mut [Waiting; DEPTH]) -> Next {
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
            near = greater(axes[0].0[x], greater(axes[1].0[y], axes[2].0[z]));
            if near > self.end {
                return Next::Part;
            }
            far = lesser(axes[0].0[x + 4], lesser(axes[1].0[y + 4], axes[2].0[z + 4]));
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
