//! Where a ray leaves the region that is known to be empty: a city-block ball, or a box of voxels.

use crate::grid::walk::Walk;
use crate::ray::lesser;

/// The plane form of the safe length, for some of the axes.
///
/// A ball of city-block radius D around voxel v contains every voxel less than D crossings ahead. Ahead of v it is bounded by
/// the plane s.p = s.v + D, where s is the ray's sense and v the corner of the voxel where it would enter: in mirrored
/// coordinates the sum of p is the sum of v plus D. The ray gets there at t = (D + sum(v) - sum(o)) / sum(d), whatever its
/// position in v. Every voxel it meets before has a lesser sum of coordinates than sum(v) + D, so fewer than D crossings lie
/// between, and it is empty.
#[derive(Clone, Copy, Debug)]
pub struct Diamond {
    /// One over the ray's city-block length for each unit of `t`; infinite if it does not move along these axes.
    inverse: f64,
    /// Sum of the origin's coordinates; minus infinity if the ray does not move along these axes.
    origin: f64,
}

impl Diamond {
    /// Over the given axes. Those along which the ray does not move drop out.
    #[inline(always)]
    pub(super) fn new(walk: &Walk, axes: &[usize]) -> Self {
        let (mut length, mut origin) = (0.0, 0.0);
        for &axis in axes {
            if walk.speed[axis] > 0.0 {
                length += walk.speed[axis];
                origin += walk.origin[axis];
            }
        }
        Self { inverse: 1.0 / length, origin: if length > 0.0 { origin } else { f64::NEG_INFINITY } }
    }

    /// One over the city-block length for each unit of `t`; infinite if the ray does not move along these axes.
    #[inline(always)]
    pub(super) fn inverse(&self) -> f64 {
        self.inverse
    }

    /// Where the ray leaves the ball of radius `distance` around the voxel whose coordinates along these axes sum to
    /// `corner`; infinite if it does not move along them.
    #[inline(always)]
    pub(super) fn end(&self, distance: u32, corner: f64) -> f64 {
        (f64::from(distance) + corner - self.origin) * self.inverse
    }
}

/// The coordinate of the walk's voxel along an axis; 0 if the ray does not move along it.
#[inline(always)]
pub(super) fn coordinate(walk: &Walk, axis: usize) -> f64 {
    walk.plane[axis] - 1.0
}

/// Their sum over all axes.
#[inline(always)]
pub(super) fn corner(walk: &Walk) -> f64 {
    walk.plane[0] + walk.plane[1] + walk.plane[2] - 3.0
}

/// Where the ray leaves the box of `distance` voxels along each axis whose first corner is the walk's voxel.
#[inline(always)]
pub(super) fn box_end(walk: &Walk, distance: u32) -> f64 {
    let beyond = f64::from(distance) - 1.0;
    let end = |axis: usize| (walk.plane[axis] + beyond - walk.origin[axis]) * walk.inverse[axis];
    lesser(lesser(end(0), end(1)), end(2))
}
