//! Rays that start far away, moved near without losing more than their first rounding.

use crate::geometry::expansion::two_sum;
use crate::ray::Ray;
use glam::DVec3;

/// The origin of a ray that starts far away, seen from `corner`, once it is moved to where it is about level with `middle` along
/// its fastest axis; by which parameter it was moved, and which axis that is. World units.
///
/// The parameter has 29 bits and a direction's component 24, so that their product is exact; the sum with the origin is kept
/// with its error until the corner is subtracted. So the new origin is off by no more than one that had been there from the
/// start. The parameter is known within 2^-28 of itself: the 2^-28th part of the distance may remain.
#[cold]
pub(crate) fn nearer(ray: &Ray, middle: DVec3, corner: DVec3) -> (DVec3, f64, usize) {
    let (origin, direction) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let speed = direction.abs();
    let axis = (0..3).max_by(|&a, &b| speed[a].total_cmp(&speed[b])).unwrap_or(0);
    let t = f64::from_bits(((middle[axis] - origin[axis]) / direction[axis]).to_bits() & !((1 << 24) - 1));
    let mut moved = DVec3::ZERO;
    for i in 0..3 {
        let (sum, error) = two_sum(origin[i], t * direction[i]);
        moved[i] = (sum - corner[i]) + error;
    }
    (moved, t, axis)
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn a_ray_is_moved_along_itself_and_near() {
        // 2^60 away along x, where f32 and f64 have no fractions; it passes through the middle.
        let far = 2f32.powi(60);
        let ray = Ray::new(Vec3::new(far, 0.25, -0.5), Vec3::new(-1.0, 0.0, 0.0));
        let (middle, corner) = (DVec3::new(3.0, 0.0, 0.0), DVec3::splat(-1.0));
        let (origin, t, axis) = nearer(&ray, middle, corner);
        assert_eq!(axis, 0);
        assert_eq!(origin, DVec3::new((f64::from(far) - t) + 1.0, 1.25, 0.5));
        assert!((origin.x - 4.0).abs() <= f64::from(far) * 2f64.powi(-28), "{origin}");
    }
}
