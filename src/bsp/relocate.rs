//! From leaf to leaf: the walk of 1987 over an octree, each leaf found from the root or from the nearest common ancestor.
//!
//! A. Glassner, "Space subdivision for fast ray tracing", 1984: the point beyond the leaf's exit is located from the root.
//! J. Amanatides and A. Woo 1987 note that their step serves octrees too: the leaf's own three planes ahead give tMax for
//! each axis, the least of them is crossed, and the tree is climbed as far as the two leaves differ.
//! Departs from both: no point beyond a face is made up. The lattice coordinate of the crossed axis is the plane itself, so
//! the ray always moves on; on the other axes the position at the crossing is clamped to the leaf that is left, so rounding
//! cannot lead past it. Two leaves with a common piece of a face are parted by a plane across that axis where their paths
//! divide, hence the new one lies behind the old one in the tree's order along the ray, and the walk ends.
//!
//! For trees alone that halve x, y and z in turn. Error: that of a crossing; on the axes that are not crossed that of the
//! position, 8u(|o| + n) as well.

use super::frame::{LEVELS, Line, STACK};
use super::tree::{Look, Tree};
use super::walk::{Visit, Walk};
use crate::ray::{greater, lesser};

/// Locates every leaf from the root: O(N log N) for the O(N) leaves of a ray. The baseline of Arvo's note.
#[derive(Clone, Copy, Debug)]
pub struct Retraverse;

/// Locates the next leaf from the lowest node that holds both: the highest bit in which the coordinates of the crossed axis
/// differ says at which level it is.
#[derive(Clone, Copy, Debug)]
pub struct Climb;

impl Walk for Retraverse {
    const REGULAR_ONLY: bool = true;

    #[inline(always)]
    fn walk<T: Tree, V: Visit<T::Leaf>>(tree: &T, line: &Line, visit: &mut V) {
        relocate::<false, T, V>(tree, line, visit);
    }
}

impl Walk for Climb {
    const REGULAR_ONLY: bool = true;

    #[inline(always)]
    fn walk<T: Tree, V: Visit<T::Leaf>>(tree: &T, line: &Line, visit: &mut V) {
        relocate::<true, T, V>(tree, line, visit);
    }
}

#[inline(always)]
fn relocate<const CLIMB: bool, T: Tree, V: Visit<T::Leaf>>(tree: &T, line: &Line, visit: &mut V) {
    const LAST: u32 = (1 << LEVELS) - 1;
    let mut place = [0, 1, 2].map(|axis| line.cell(axis, line.start, 0, LAST));
    // The nodes that lead to the leaf, by their depth.
    let mut path = [tree.root(); STACK];
    let mut depth = 0;
    let mut t = line.start;
    let mut end = line.end;
    loop {
        let leaf = loop {
            let node = path[depth as usize % STACK];
            if tree.is_nil(node) {
                break None;
            }
            visit.node();
            match tree.look(node) {
                Look::Leaf(leaf) => break Some(leaf),
                Look::Inner(_, children) => {
                    let bit = place[depth as usize % 3] >> (LEVELS - 1 - depth / 3) & 1;
                    depth += 1;
                    path[depth as usize % STACK] = children[bit as usize];
                }
            }
        };
        end = lesser(end, visit.leaf(leaf));

        // x was halved as often as y and z, or once more.
        let edge = [0, 1, 2].map(|axis: u32| 1_u32 << (LEVELS - (depth + 2 - axis) / 3));
        let low = [0, 1, 2].map(|axis: usize| place[axis] & !(edge[axis] - 1));
        let mut exit = (f64::INFINITY, 0);
        for axis in 0..3 {
            if line.direction[axis] != 0.0 {
                let plane = if line.backward[axis] == 0 { low[axis] + edge[axis] } else { low[axis] };
                let crossing = (f64::from(plane) - line.origin[axis]) * line.inverse[axis];
                if crossing < exit.0 {
                    exit = (crossing, axis);
                }
            }
        }
        t = greater(t, exit.0);
        if t >= end {
            return;
        }
        let axis = exit.1;
        let next = if line.backward[axis] == 0 { low[axis] + edge[axis] } else { low[axis].wrapping_sub(1) };
        if next > LAST {
            return;
        }
        for other in [(axis + 1) % 3, (axis + 2) % 3] {
            place[other] = line.cell(other, t, low[other], low[other] + (edge[other] - 1));
        }
        depth = 0;
        if CLIMB {
            // The coordinates differ, so there is a bit.
            depth = 3 * (LEVELS - 1 - (place[axis] ^ next).ilog2()) + axis as u32;
        }
        place[axis] = next;
    }
}
