//! From the world to the tree's coordinates, and the ray as the walks see it.

use crate::accel::nearer;
use crate::ray::{Aabb, Ray, greater, lesser};
use glam::DVec3;

/// Halvings of each axis at most: midpoint planes lie on whole numbers.
pub const LEVELS: u32 = 20;

/// Levels of a tree at most: every axis halved [`LEVELS`] times.
pub const MAX_DEPTH: u32 = 3 * LEVELS;

/// Room for the subtrees that a walk puts off: one for each level, and a power of two.
pub const STACK: usize = 64;

/// Edge of the root's cube in the tree's coordinates, 2^20.
pub const SIZE: f64 = (1u32 << LEVELS) as f64;

/// Cells reach this far beyond their planes when primitives are sorted into them: 2^-24 of the cube.
///
/// A walk may be off by half of it, see [`Line::start`]; sorting is off by far less than the other half.
pub const PADDING: f64 = 1.0 / 16.0;

/// Maps the world to the tree's coordinates, in which the root is the cube from 0 to [`SIZE`] on every axis.
///
/// A cube, so that three halvings make eight equal cubes however flat the scene is. `lo` and `inverse` count as exact: the
/// builder and the walks use the same map, so its own rounding cancels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// World position of the cube's least corner.
    pub lo: DVec3,
    /// Coordinates for each world unit.
    pub inverse: f64,
    /// The part of the cube that the padded box of the scene fills is from 0 to here. Rays are clipped to it.
    pub filled: DVec3,
}

impl Frame {
    /// The frame around `bounds`.
    ///
    /// The box is padded by 2^-10 of its largest extent, so that no primitive is near its faces, and by at least 2^-26 of
    /// the largest coordinate, so that rounding a world coordinate in f64 moves it by less than 2^-7.
    pub fn new(bounds: &Aabb) -> Self {
        let ([min, max], pad) = (bounds.corners(), bounds.padding(2.0_f64.powi(-26)));
        let (lo, hi) = (min - pad, max + pad);
        let inverse = SIZE / (hi - lo).max_element();
        Self { lo, inverse, filled: ((hi - lo) * inverse).min(DVec3::splat(SIZE)) }
    }

    /// World to tree coordinates.
    pub fn local(&self, world: DVec3) -> DVec3 {
        (world - self.lo) * self.inverse
    }

    /// Tree to world coordinates.
    pub fn world(&self, local: DVec3) -> DVec3 {
        self.lo + local / self.inverse
    }
}

/// A ray in the tree's coordinates, clipped to the padded box of the scene. Parameters are the ray's own less `shift`.
///
/// Arrays are indexed by axis; the fourth entry spares a test of the index.
#[derive(Clone, Copy, Debug)]
pub struct Line {
    pub origin: [f64; 4],
    pub direction: [f64; 4],
    /// 1 / direction; plus infinity along an axis of no movement.
    pub inverse: [f64; 4],
    /// 1 if the ray moves towards lesser coordinates: the child that comes first.
    pub backward: [usize; 4],
    /// Where the ray enters the box or begins.
    pub start: f64,
    /// Where it leaves the box or ends.
    pub end: f64,
    /// 0, or how far the origin has been moved along a ray that starts far away. A little less than that, by more than the
    /// rounding of a difference with it: `t - shift` is never too small for a ray's `t`.
    pub shift: f64,
}

/// How a ray meets the box.
pub enum Start {
    /// It does not.
    Miss,
    /// The origin is so far away, some 10^15 boxes, that the walk cannot tell which cells the ray meets.
    TooFar,
    /// It does.
    Inside(Line),
}

impl Line {
    /// Clips `ray`, which comes from [`Ray::intake`].
    ///
    /// Error: with u = 2^-53, n = [`SIZE`] and |o| the origin's largest coordinate, the origin is off by 3u(|o| + n), the
    /// direction by u and its inverse by 2u relative; a crossing (plane - o) * inverse is therefore off by less than
    /// 8u(|o| + n) along its axis, and so are both ends here. Each walk says what it adds; none comes to more than
    /// 48u(|o| + n) + 2^9 u n. A ray for which 64u(|o| + n) exceeds a quarter of [`PADDING`], one that starts two million
    /// boxes away, is taken from [`nearer`]; 2^9 u n is 2^-24.
    pub fn start(frame: &Frame, ray: &Ray) -> Start {
        const ERROR: f64 = 64.0 * (f64::EPSILON / 2.0);
        let mut origin = frame.local(ray.origin.as_dvec3());
        let direction = ray.direction.as_dvec3() * frame.inverse;
        let too_far = |origin: DVec3| (origin.abs().max_element() + SIZE) * ERROR > PADDING / 4.0;
        let mut moved = 0.0;
        if too_far(origin) {
            let axis;
            (origin, moved, axis) = nearer(ray, frame.lo + 0.5 * frame.filled / frame.inverse, frame.lo);
            origin *= frame.inverse;
            // Beside the box while it is level with it: along no other axis does it move faster.
            let level = origin[axis].abs() <= 4.0 * SIZE;
            if level && origin.abs().max_element() > 16.0 * SIZE {
                return Start::Miss;
            }
            if too_far(origin) {
                return Start::TooFar;
            }
        }
        // More than the rounding of a difference with `moved`, and far less than a cell.
        let slack = 4.0 * f64::EPSILON * f64::abs(moved);
        let mut line = Line {
            origin: [origin.x, origin.y, origin.z, 0.0],
            direction: [direction.x, direction.y, direction.z, 0.0],
            inverse: [f64::INFINITY; 4],
            backward: [0; 4],
            start: f64::from(ray.t_min) - (moved + slack),
            end: f64::from(ray.t_max) - (moved - slack),
            shift: moved - slack,
        };
        for axis in 0..3 {
            let (o, d, filled) = (origin[axis], direction[axis], frame.filled[axis]);
            if d == 0.0 {
                if o < 0.0 || o > filled {
                    return Start::Miss;
                }
                continue;
            }
            // Finite: a direction is at least 1e-45 and a scene at most 1e39 wide.
            line.inverse[axis] = 1.0 / d;
            line.backward[axis] = usize::from(d < 0.0);
            let (low, high) = ((0.0 - o) * line.inverse[axis], (filled - o) * line.inverse[axis]);
            line.start = greater(line.start, lesser(low, high));
            line.end = lesser(line.end, greater(low, high));
        }
        // A bounded box and a ray that moves: both are finite here.
        if line.start <= line.end { Start::Inside(line) } else { Start::Miss }
    }

    /// The lattice cell at parameter `t` along an axis, within `low..=high`.
    #[inline]
    pub fn cell(&self, axis: usize, t: f64, low: u32, high: u32) -> u32 {
        // `as` saturates at 0; never falls as `t` moves on, for rounding keeps the order.
        ((self.origin[axis] + t * self.direction[axis]) as u32).clamp(low, high)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn every_extent_and_scale_gives_a_finite_frame() {
        for (min, max) in [
            (Vec3::ZERO, Vec3::ZERO),
            (Vec3::splat(1e7), Vec3::splat(1e7)),
            (Vec3::splat(-3e38), Vec3::splat(3e38)),
            (Vec3::ZERO, Vec3::splat(1e-45)),
            (Vec3::new(1e30, 0.0, 0.0), Vec3::new(1e30, 1e-30, 1.0)),
        ] {
            let frame = Frame::new(&Aabb { min, max });
            assert!(frame.inverse.is_finite() && frame.lo.is_finite(), "{min} {max}: {frame:?}");
            assert!(frame.filled.max_element() <= SIZE, "{frame:?}");
            for corner in [min, max] {
                let local = frame.local(corner.as_dvec3());
                let clear = PADDING * 16.0;
                assert!(local.cmpgt(DVec3::splat(clear)).all(), "{min} {max}: {local}");
                assert!(local.cmplt(frame.filled - clear).all(), "{min} {max}: {local}");
                let back = frame.local(frame.world(local));
                assert!((back - local).abs().max_element() < 1.0 / 64.0, "{min} {max}: {local} {back}");
            }
        }
    }
}
