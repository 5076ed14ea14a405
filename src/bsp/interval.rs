//! Arvo's second listing: the interval form.

use super::frame::Line;
use super::tree::Plane;
use super::walk::{Cut, Listing};
use crate::ray::lesser;

/// The parameters at which the ray enters and leaves the cell; no point is ever computed.
///
/// Arvo 1988, version 2, with the reciprocals of the direction computed once as the note proposes: a plane costs a
/// subtraction and a multiplication. Printed as: `dist > max` or `dist < 0`: near; `dist < min`: far; else both. `dist < 0`
/// goes with finding the near child from the origin's side; here the direction decides (see [`super::Partition`]). The stack
/// keeps the end alone: a subtree that waits begins where the last one ended.
///
/// Adds no error to that of a crossing.
#[derive(Clone, Copy, Debug)]
pub struct Interval {
    min: f64,
    max: f64,
}

impl Listing for Interval {
    const REGULAR_ONLY: bool = false;

    type Later = f64;

    #[inline(always)]
    fn new(line: &Line) -> Self {
        Self { min: line.start, max: line.end }
    }

    #[inline(always)]
    fn cut<P: Plane>(&mut self, line: &Line, plane: &P) -> (usize, Cut<f64>) {
        let (first, dist) = plane.cross(line, &line.origin);
        if dist <= self.min {
            return (first, Cut::Far);
        }
        if dist < self.max {
            let rest = self.max;
            self.max = dist;
            return (first, Cut::Both(rest));
        }
        // A NaN too.
        (first, Cut::Near)
    }

    #[inline(always)]
    fn resume(&mut self, _: &Line, later: &f64, end: f64) -> bool {
        self.min = self.max;
        self.max = lesser(*later, end);
        self.min < end
    }
}
