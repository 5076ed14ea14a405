//! The first stage of the triangle test, in f32: which triangles a ray certainly misses.
//!
//! Source: Woop, Benthin and Wald, "Watertight ray/triangle intersection", 2013, section 3. Departs from it: the edge functions
//! have a bound on their error, and what that leaves open is not decided here.

use super::Triangle;
use crate::geometry::decided::Decided;
use crate::ray::{Ray, greater as max, lesser as min};
use glam::Vec3;

/// What the triangle tests of one ray share: the shear that turns its direction into the axis `z`, and what the exact stage
/// has decided. It serves one [`Best`](crate::geometry::Best).
#[derive(Debug)]
pub struct TrianglePrep {
    /// Axis of the direction's greatest component.
    z: usize,
    /// The direction's other components over the greatest, in -1..=1.
    shear_x: f32,
    shear_y: f32,
    pub(in crate::geometry) decided: Decided,
}

impl TrianglePrep {
    /// The shear of `ray`, computed in f64 so that directions of any length have one.
    pub(in crate::geometry) fn new(ray: &Ray) -> Self {
        let [dx, dy, dz] = ray.direction.abs().to_array();
        let z = if dx >= dy && dx >= dz { 0 } else { 1 + usize::from(dz > dy) };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let d = ray.direction.as_dvec3().to_array();
        Self { z, shear_x: (d[x] / d[z]) as f32, shear_y: (d[y] / d[z]) as f32, decided: Decided::default() }
    }

    /// True if the triangle test goes on to its second stage; for measurements.
    #[cfg(feature = "cli")]
    pub(crate) fn passes(&self, ray: &Ray, corners: &Triangle) -> bool {
        !self.misses(ray.origin, corners)
    }

    /// True only if the ray's line certainly misses the closed triangle: all corners lie on one side of it along an
    /// axis, or two of the edge functions `U`, `V`, `W` have opposite signs.
    ///
    /// Corners relative to the origin are sheared to `(x - sx z, y - sy z)`, and the edge functions are cross products
    /// of two of them. With `e = 2^-24`, `p` the greatest of the sheared coordinates and `z` the greatest depth:
    /// coordinates relative to the origin are at most `p + z` and carry an error of `e (p + z)`, the shear's product
    /// one of `3 e z` (shear, depth, rounding), the final difference one of `e p`; so a sheared coordinate is known
    /// within `s = e (2 p + 4 z)`. An edge function is then known within
    /// `4 p s + 2 s^2 + 2 e p^2 + 2 e p^2 = 12 e p^2 + 16 e p z + 2 s^2`, the last two terms
    /// for the rounding of its products and of their difference. `5 e (p + z)`
    /// and `17 e (p + 3 e z) (p + z)` are more than these by a sixteenth at least, which is far more than the terms of
    /// higher order and the rounding of the bounds themselves.
    ///
    /// Underflow adds at most 2^-150 for each product, together less than 2^-126. An overflow or a NaN makes the bound
    /// infinite or NaN: an infinite or NaN coordinate comes with infinite `p` or `z` (the shear is at most 1, so that
    /// its product overflows only where `z` does) or from a corner that is not finite, and `p (p + z)` is at least as
    /// large as any product.
    #[inline]
    pub(super) fn misses(&self, origin: Vec3, corners: &Triangle) -> bool {
        // The branch goes the same way for all tests of a ray; within it, axes are known and no index is checked.
        match self.z {
            0 => self.misses_along::<1, 2, 0>(origin, corners),
            1 => self.misses_along::<2, 0, 1>(origin, corners),
            _ => self.misses_along::<0, 1, 2>(origin, corners),
        }
    }

    #[inline(always)]
    fn misses_along<const X: usize, const Y: usize, const Z: usize>(&self, origin: Vec3, corners: &Triangle) -> bool {
        const E: f32 = 1.0 / (1 << 24) as f32;
        let origin: &[f32; 3] = origin.as_ref();
        let shear = |corner: &Vec3| {
            let corner: &[f32; 3] = corner.as_ref();
            let z = corner[Z] - origin[Z];
            let x = (corner[X] - origin[X]) - self.shear_x * z;
            let y = (corner[Y] - origin[Y]) - self.shear_y * z;
            (x, y, z.abs())
        };
        let ((ax, ay, az), (bx, by, bz), (cx, cy, cz)) = (shear(&corners[0]), shear(&corners[1]), shear(&corners[2]));
        let z = max3(az, bz, cz);
        let (low_x, high_x) = (min3(ax, bx, cx), max3(ax, bx, cx));
        let (low_y, high_y) = (min3(ay, by, cy), max3(ay, by, cy));
        let p = max(max(high_x, -low_x), max(high_y, -low_y));
        // The greatest distance by which all corners clear the ray; one comparison and one branch.
        let margin = 5.0 * E * (p + z) + f32::MIN_POSITIVE;
        if max(max(low_x, -high_x), max(low_y, -high_y)) > margin {
            return true;
        }
        let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
        let bound = 17.0 * E * ((p + 3.0 * E * z) * (p + z)) + f32::MIN_POSITIVE;
        max3(u, v, w) > bound && min3(u, v, w) < -bound
    }
}

#[inline(always)]
fn max3(a: f32, b: f32, c: f32) -> f32 {
    max(max(a, b), c)
}

#[inline(always)]
fn min3(a: f32, b: f32, c: f32) -> f32 {
    min(min(a, b), c)
}
