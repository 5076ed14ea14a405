//! The voxel walk: start, exit, step.
//!
//! Amanatides & Woo 1987, section 2. Their X, Y, Z and justOut are folded into one voxel index and a count of the steps
//! left on each axis; their tMax is recomputed from the plane's integer coordinate, so its error does not grow along the
//! ray.
//!
//! Error: in voxel coordinates, with u = 2^-53, the origin is off by 2u|o|, a plane's distance by u(|o| + n), the direction
//! by u and its inverse by 2u relative. A crossing is therefore off by less than 8u(|o| + n) voxels along its axis, and so is
//! the entry point. [`Walk::start`] refuses to walk where four times that exceeds [`WALK_ERROR`].

use super::frame::{Frame, WALK_ERROR};
use crate::ray::{Ray, clip};
use glam::DVec3;

/// Where a walk is: a voxel, and the ray parameter at which the ray leaves it through each axis.
///
/// The arrays are indexed by axis. All parameters are the ray's own.
#[derive(Clone, Copy, Debug)]
pub(super) struct Walk {
    voxel: usize,
    /// tMax: where the ray crosses the next plane of each axis; infinite if it does not move along it.
    t_next: [f64; 3],
    /// The next plane of each axis in voxel coordinates, an integer.
    plane: [f64; 3],
    origin: [f64; 3],
    inverse: [f64; 3],
    /// +1 or -1: from plane to plane.
    sign: [f64; 3],
    /// From voxel index to voxel index.
    stride: [isize; 3],
    /// Steps that stay within the grid.
    left: [u32; 3],
    /// Where the ray leaves the grid or ends.
    t_end: f64,
}

/// How a ray meets the grid.
pub(super) enum Start {
    /// It does not.
    Miss,
    /// The origin is so far away, about 2^38 voxels, that f64 cannot tell which voxels the ray meets.
    TooFar,
    /// It does, here.
    Inside(Walk),
}

impl Walk {
    /// The first voxel of `ray`, wherever it starts. `ray` comes from [`Ray::intake`].
    #[inline]
    pub fn start(frame: &Frame, ray: &Ray) -> Start {
        let origin = frame.local(ray.origin.as_dvec3());
        let direction = ray.direction.as_dvec3() * frame.inverse;
        let size = frame.size();
        const FOUR_TIMES_ERROR: f64 = 4.0 * 8.0 / 9_007_199_254_740_992.0;
        if (origin.abs().max_element() + size.max_element()) * FOUR_TIMES_ERROR > WALK_ERROR {
            return Start::TooFar;
        }
        let range = (f64::from(ray.t_min), f64::from(ray.t_max));
        let inverse = direction.recip();
        let Some((t_start, t_end)) = clip(origin, inverse, (DVec3::ZERO, size), range) else { return Start::Miss };
        let entry = origin + t_start * direction;
        let [nx, ny, _] = frame.resolution.map(|n| n as isize);
        let strides = [1, nx, nx * ny];
        let mut walk = Walk {
            voxel: 0,
            t_next: [f64::INFINITY; 3],
            plane: [0.0; 3],
            origin: origin.to_array(),
            inverse: inverse.to_array(),
            sign: [1.0; 3],
            stride: strides,
            left: [0; 3],
            t_end,
        };
        let mut first = [0; 3];
        for axis in 0..3 {
            let last = frame.resolution[axis] - 1;
            // `as` saturates: an entry a hair outside lands in the voxel at the border.
            let i = (entry[axis] as u32).min(last);
            first[axis] = i;
            let d = direction[axis];
            if d > 0.0 {
                walk.plane[axis] = f64::from(i) + 1.0;
                walk.left[axis] = last - i;
            } else if d < 0.0 {
                walk.plane[axis] = f64::from(i);
                walk.left[axis] = i;
                walk.sign[axis] = -1.0;
                walk.stride[axis] = -strides[axis];
            } else {
                continue;
            }
            walk.t_next[axis] = (walk.plane[axis] - walk.origin[axis]) * walk.inverse[axis];
        }
        walk.voxel = frame.index(first);
        Start::Inside(walk)
    }

    /// Index of the voxel.
    #[inline(always)]
    pub fn voxel(&self) -> usize {
        self.voxel
    }

    /// The ray parameter at which the ray leaves the voxel.
    #[inline(always)]
    pub fn exit(&self) -> f64 {
        let [x, y, z] = self.t_next;
        x.min(y).min(z)
    }

    /// Goes to the next voxel; false if the ray ends before it or leaves the grid.
    ///
    /// A tie goes to one side: the voxels on the other side are met in a point only, which their padding covers.
    #[inline(always)]
    pub fn step(&mut self) -> bool {
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
    fn cross<const AXIS: usize>(&mut self) -> bool {
        if self.left[AXIS] == 0 || self.t_next[AXIS] > self.t_end {
            return false;
        }
        self.left[AXIS] -= 1;
        self.voxel = self.voxel.wrapping_add_signed(self.stride[AXIS]);
        self.plane[AXIS] += self.sign[AXIS];
        self.t_next[AXIS] = (self.plane[AXIS] - self.origin[AXIS]) * self.inverse[AXIS];
        true
    }
}
