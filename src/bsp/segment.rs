//! Arvo's first listing: the segment form.

use super::frame::Line;
use super::tree::Plane;
use super::walk::{Cut, Listing};
use crate::ray::lesser;

/// The point at which the ray enters the cell and the length that it has left in it.
///
/// Arvo 1988, version 1: `Intersect(node, P, D, len)`; a plane at `0 < dist < len` gives `dist` to the near child, and
/// `len - dist` to the far one with the point moved to `Q = P + dist D`. The print has near from the side of P, which says
/// nothing once P lies on the plane, and takes near alone at `dist = 0`; here the direction decides (see [`super::Partition`])
/// and `dist <= 0` takes far alone. The length run so far is kept beside the point, for the winner is the ray's.
///
/// Error: lengths count from where the line enters the box, so that a far origin is left behind; at most
/// [`super::BspOptions::MAX_DEPTH`] moves lead to a point, each off by less than 8u n.
#[derive(Clone, Copy, Debug)]
pub struct Segment {
    point: [f64; 4],
    /// From the line's start to the point.
    run: f64,
    length: f64,
}

impl Listing for Segment {
    const REGULAR_ONLY: bool = false;

    type Later = (f64, f64, [f64; 3]);

    #[inline(always)]
    fn new(line: &Line) -> Self {
        Self { point: moved(&line.origin, line, line.start), run: 0.0, length: line.end - line.start }
    }

    #[inline(always)]
    fn cut<P: Plane>(&mut self, line: &Line, plane: &P) -> (usize, Cut<Self::Later>) {
        let (first, dist) = plane.cross(line, &self.point);
        if dist <= 0.0 {
            return (first, Cut::Far);
        }
        if dist < self.length {
            let [x, y, z, _] = moved(&self.point, line, dist);
            let rest = (self.run + dist, self.length - dist, [x, y, z]);
            self.length = dist;
            return (first, Cut::Both(rest));
        }
        (first, Cut::Near)
    }

    #[inline(always)]
    fn resume(&mut self, line: &Line, &(run, length, [x, y, z]): &Self::Later, end: f64) -> bool {
        let left = (end - line.start) - run;
        *self = Self { point: [x, y, z, 0.0], run, length: lesser(length, left) };
        left > 0.0
    }
}

/// Q = P + dist D.
#[inline(always)]
fn moved(p: &[f64; 4], line: &Line, dist: f64) -> [f64; 4] {
    let d = &line.direction;
    [p[0] + dist * d[0], p[1] + dist * d[1], p[2] + dist * d[2], 0.0]
}
