//! Jansen's form: no plane is intersected.

use super::frame::{LEVELS, Line, SIZE};
use super::tree::Plane;
use super::walk::{Cut, Listing};
use crate::ray::{greater, lesser};

/// The six parameters at which the ray crosses the planes of the cell: where two of them are halved, a plane is crossed.
///
/// F. Jansen, "Data structures for ray tracing", 1986, and his reply to Arvo in the Ray Tracing News: the root's six values
/// are computed, and every plane in the middle of a cell is crossed in the middle of the cell's own two crossings along that
/// axis. Departs from it: along an axis of no movement there are no values to halve; the bits of the position on the
/// lattice choose the child. The whole ray's interval is kept beside the six.
///
/// For trees alone that halve x, y and z in turn. Error: every halving adds at most u(|o| + n) along its axis, 20
/// of them together 20u(|o| + n).
#[derive(Clone, Copy, Debug)]
pub struct Midpoint {
    cell: Crossings,
    min: f64,
    /// Lattice position; of use along axes of no movement.
    place: [u32; 3],
}

/// Where the ray crosses the planes of a cell.
#[derive(Clone, Copy, Debug, Default)]
pub struct Crossings {
    /// Where it enters the slab of each axis.
    enter: [f64; 3],
    /// Where it leaves it.
    leave: [f64; 3],
    /// Where it leaves the cell or ends.
    max: f64,
    /// Halvings of the root that lead to the cell.
    depth: u32,
}

impl Listing for Midpoint {
    const REGULAR_ONLY: bool = true;

    type Later = Crossings;

    fn new(line: &Line) -> Self {
        let side = |axis: usize, low: bool| {
            let plane = if low == (line.backward[axis] == 0) { 0.0 } else { SIZE };
            (plane - line.origin[axis]) * line.inverse[axis]
        };
        let cell = Crossings {
            enter: [0, 1, 2].map(|axis| side(axis, true)),
            leave: [0, 1, 2].map(|axis| side(axis, false)),
            max: line.end,
            depth: 0,
        };
        let place = [0, 1, 2].map(|axis| line.cell(axis, line.start, 0, (1 << LEVELS) - 1));
        Self { cell, min: line.start, place }
    }

    #[inline(always)]
    fn cut<P: Plane>(&mut self, line: &Line, _: &P) -> (usize, Cut<Crossings>) {
        let cell = &mut self.cell;
        let (axis, level) = ((cell.depth % 3) as usize, cell.depth / 3);
        cell.depth += 1;
        let first = line.backward[axis];
        if line.direction[axis] == 0.0 {
            let high = self.place[axis] >> (LEVELS - 1 - level) & 1 != 0;
            return (first, if high { Cut::Far } else { Cut::Near });
        }
        let middle = 0.5 * (cell.enter[axis] + cell.leave[axis]);
        if middle <= self.min {
            cell.enter[axis] = middle;
            return (first, Cut::Far);
        }
        if middle < cell.max {
            let mut rest = *cell;
            rest.enter[axis] = middle;
            cell.leave[axis] = middle;
            cell.max = middle;
            return (first, Cut::Both(rest));
        }
        cell.leave[axis] = middle;
        (first, Cut::Near)
    }

    #[inline(always)]
    fn resume(&mut self, _: &Line, later: &Crossings, end: f64) -> bool {
        self.min = greater(self.min, self.cell.max);
        self.cell = *later;
        self.cell.max = lesser(self.cell.max, end);
        self.min < end
    }
}
