//! The voxel walk: start, exit, step, leap.
//!
//! Amanatides & Woo 1987, section 2. Departures from the listing, none of which changes which voxels are visited:
//!
//! - The grid is mirrored for each ray so that it moves towards greater coordinates along every axis. X, Y, Z and justOut
//!   become one voxel index and a count of the steps left on each axis.
//! - tMax is recomputed from the plane's integer coordinate, so its error does not grow along the ray.
//! - An axis along which the ray does not move has its origin at minus infinity: its crossings are at infinity by plain
//!   arithmetic, never 0/0.
//!
//! Error: in voxel coordinates, with u = 2^-53, the origin is off by 3u(|o| + n), a plane's distance by u(|o| + n), the
//! direction by u and its inverse by 2u relative. A crossing is therefore off by less than 8u(|o| + n) voxels along its axis,
//! and so is the entry point. The end of an empty region (`skip/`) adds three distances and a product: less than
//! 24u(|o| + n). [`Walk::start`] refuses to walk where 64u(|o| + n), twice their sum, exceeds [`WALK_ERROR`]; the other half
//! leaves room for [`LANDING`].

use super::frame::{Frame, WALK_ERROR};
use crate::ray::{Ray, greater, lesser};
use glam::DVec3;

/// A walk over the voxels that a ray meets, in their order along the ray.
pub trait VoxelWalk: Clone + Send + Sync {
    /// The first voxel of `ray`, wherever it starts. `ray` comes from [`Ray::intake`].
    fn start(frame: &Frame, ray: &Ray) -> Start<Self>;

    /// Index of the voxel.
    fn voxel(&self) -> usize;

    /// The ray parameter at which the ray leaves the voxel.
    fn exit(&self) -> f64;

    /// Goes to the next voxel; false if the ray ends before it or leaves the grid.
    fn step(&mut self) -> bool;

    /// Lowers the end of the ray to `t`.
    fn end_at(&mut self, t: f64);

    /// Goes to the voxel at parameter `t`, not before [`VoxelWalk::exit`]; false if the ray ends before it or leaves the grid.
    /// A walk that cannot leap takes a step.
    #[inline(always)]
    fn leap(&mut self, _t: f64) -> bool {
        self.step()
    }
}

/// A ray that is nearer than this to a plane ahead counts as beyond it where it enters the grid or lands, in voxels: leaps
/// that end on a plane need no further step. A small part of [`WALK_ERROR`].
const LANDING: f64 = 1.0 / 1_048_576.0;

/// How a ray meets the grid.
pub enum Start<W> {
    /// It does not.
    Miss,
    /// The origin is so far away, about 2^35 voxels, that the walk cannot tell which voxels the ray meets.
    TooFar,
    /// It does, here.
    Inside(W),
}

/// Where a walk is: a voxel, and the ray parameter at which the ray leaves it through each axis.
///
/// The arrays are indexed by axis; coordinates are voxels of the mirrored grid, parameters are the ray's own.
#[derive(Clone, Copy, Debug)]
pub struct Walk {
    pub(super) voxel: usize,
    /// tMax: where the ray crosses the next plane of each axis; infinite if it does not move along it.
    pub(super) t_next: [f64; 3],
    /// The next plane of each axis, an integer; 1 if the ray does not move along it.
    pub(super) plane: [f64; 3],
    /// Minus infinity if the ray does not move along the axis.
    pub(super) origin: [f64; 3],
    /// 1 if the ray does not move along the axis.
    pub(super) inverse: [f64; 3],
    /// Voxels for each unit of `t`, not negative.
    pub(super) speed: [f64; 3],
    /// From voxel index to voxel index; 0 if the ray does not move along the axis.
    pub(super) stride: [isize; 3],
    /// Steps that stay within the grid.
    pub(super) left: [u32; 3],
    /// Bit `axis` is set if the ray moves towards lesser coordinates along it: the axis is mirrored.
    pub(super) octant: usize,
    /// Where the ray entered the voxel or landed in it.
    pub(super) t: f64,
    /// Where the ray leaves the grid or ends.
    pub(super) t_end: f64,
}

impl VoxelWalk for Walk {
    #[inline]
    fn start(frame: &Frame, ray: &Ray) -> Start<Self> {
        let origin = frame.local(ray.origin.as_dvec3());
        let direction = ray.direction.as_dvec3() * frame.inverse;
        let size = frame.size();
        const TWICE_ERROR: f64 = 64.0 / 9_007_199_254_740_992.0;
        if (greatest(origin.abs()) + greatest(size)) * TWICE_ERROR > WALK_ERROR {
            return Start::TooFar;
        }
        let mut walk = Walk {
            voxel: 0,
            t_next: [f64::INFINITY; 3],
            plane: [1.0; 3],
            origin: [f64::NEG_INFINITY; 3],
            inverse: [1.0; 3],
            speed: [0.0; 3],
            stride: [0; 3],
            left: [0; 3],
            octant: 0,
            t: f64::from(ray.t_min),
            t_end: f64::from(ray.t_max),
        };
        for axis in 0..3 {
            let speed = direction[axis].abs();
            let inverse = 1.0 / speed;
            if !inverse.is_finite() {
                // No movement along this axis: the ray is in one slab of voxels, or beside the grid.
                if origin[axis] < 0.0 || origin[axis] > size[axis] {
                    return Start::Miss;
                }
                continue;
            }
            let mirrored = direction[axis] < 0.0;
            walk.octant |= usize::from(mirrored) << axis;
            walk.origin[axis] = if mirrored { size[axis] - origin[axis] } else { origin[axis] };
            walk.inverse[axis] = inverse;
            walk.speed[axis] = speed;
            walk.t = greater(walk.t, (0.0 - walk.origin[axis]) * inverse);
            walk.t_end = lesser(walk.t_end, (size[axis] - walk.origin[axis]) * inverse);
        }
        // A bounded box and a ray that moves: both are finite here.
        if walk.t > walk.t_end {
            return Start::Miss;
        }
        let mut stride = 1;
        for axis in 0..3 {
            let last = frame.resolution[axis] - 1;
            if walk.speed[axis] > 0.0 {
                let entry = whole(walk.t * walk.speed[axis] + (walk.origin[axis] + LANDING)).1.min(last);
                walk.plane[axis] = f64::from(entry + 1);
                walk.left[axis] = last - entry;
                walk.t_next[axis] = walk.crossing(axis);
                let mirrored = walk.octant >> axis & 1 != 0;
                walk.stride[axis] = if mirrored { -stride } else { stride };
                walk.voxel += (if mirrored { last - entry } else { entry }) as usize * stride as usize;
            } else {
                walk.voxel += whole(origin[axis] + LANDING).1.min(last) as usize * stride as usize;
            }
            stride *= frame.resolution[axis] as isize;
        }
        Start::Inside(walk)
    }

    #[inline(always)]
    fn voxel(&self) -> usize {
        self.voxel
    }

    #[inline(always)]
    fn exit(&self) -> f64 {
        let [x, y, z] = self.t_next;
        lesser(lesser(x, y), z)
    }

    /// A tie goes to one side: the voxels on the other side are met in a point only, which their padding covers.
    #[inline(always)]
    fn step(&mut self) -> bool {
        let [x, y, z] = self.t_next;
        if x < y {
            if x < z { self.cross::<0>() } else { self.cross::<2>() }
        } else if y < z {
            self.cross::<1>()
        } else {
            self.cross::<2>()
        }
    }

    #[inline(always)]
    fn end_at(&mut self, t: f64) {
        self.t_end = lesser(self.t_end, t);
    }

    /// The landing voxel is never behind the present one: planes are crossed forwards only. At least one is crossed, so the
    /// walk always ends. Where a voxel lies beyond the grid, `t` is within rounding of the grid's face, where nothing is.
    ///
    /// No branch but the ends of the ray and the grid: where a leap goes is as good as random to a branch predictor.
    #[inline(always)]
    fn leap(&mut self, t: f64) -> bool {
        if t >= self.t_end {
            return false;
        }
        self.t = t;
        let mut inside = true;
        for axis in 0..3 {
            // At least 1 where `t` is not before the crossing, however large the rounding errors of a far origin are. NaN, and
            // so nothing, along an axis of no movement; at most the voxels of the axis, as `t` lies before `t_end`.
            let crossed = whole((t - self.t_next[axis]) * self.speed[axis] + (1.0 + LANDING));
            inside &= crossed.1 <= self.left[axis];
            self.left[axis] = self.left[axis].wrapping_sub(crossed.1);
            self.plane[axis] += crossed.0;
            self.voxel = self.voxel.wrapping_add_signed(self.stride[axis] * crossed.1 as isize);
            self.t_next[axis] = self.crossing(axis);
        }
        inside
    }
}

/// The whole part of `x`, which is less than 2^31; 0 if `x` is negative or NaN. As a floating-point number and as an integer. A
/// whole number itself may give the next lesser one.
///
/// Adding 2^52 + 2^51 leaves a whole number in the low bits, without the tests of range that a conversion would take.
#[inline(always)]
fn whole(x: f64) -> (f64, u32) {
    const SHIFT: f64 = 6_755_399_441_055_744.0;
    // The sum rounds to the nearest; the half is what makes it round down.
    let shifted = greater(x - 0.5, -0.5) + SHIFT;
    (shifted - SHIFT, shifted.to_bits() as u32)
}

#[inline(always)]
fn greatest(v: DVec3) -> f64 {
    greater(greater(v.x, v.y), v.z)
}

impl Walk {
    /// Where the ray crosses the next plane of an axis.
    #[inline(always)]
    pub(super) fn crossing(&self, axis: usize) -> f64 {
        (self.plane[axis] - self.origin[axis]) * self.inverse[axis]
    }

    /// The axis of the next crossing, by the rule of [`VoxelWalk::step`].
    #[inline(always)]
    pub(super) fn next_axis(&self) -> usize {
        let [x, y, z] = self.t_next;
        if x < y {
            if x < z { 0 } else { 2 }
        } else if y < z {
            1
        } else {
            2
        }
    }

    /// Crosses the next plane of an axis; false if the ray ends before it or leaves the grid.
    #[inline(always)]
    pub(super) fn cross<const AXIS: usize>(&mut self) -> bool {
        if self.left[AXIS] == 0 || self.t_next[AXIS] >= self.t_end {
            return false;
        }
        self.left[AXIS] -= 1;
        self.voxel = self.voxel.wrapping_add_signed(self.stride[AXIS]);
        self.plane[AXIS] += 1.0;
        self.t = self.t_next[AXIS];
        self.t_next[AXIS] = self.crossing(AXIS);
        true
    }
}
