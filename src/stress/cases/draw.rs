//! Random points, directions and rays that several families share.

use crate::random::Random;
use crate::ray::Ray;
use glam::Vec3;

/// One of `items`, which is not empty.
pub(super) fn pick<T: Copy>(random: &mut Random, items: &[T]) -> T {
    items[random.below(items.len())]
}

/// 1 or -1.
pub(super) fn sign(random: &mut Random) -> f32 {
    pick(random, &[1.0, -1.0])
}

/// 0 or -0.
pub(super) fn zero(random: &mut Random) -> f32 {
    pick(random, &[0.0, -0.0])
}

/// Uniform in the cube from -1 to 1.
pub(super) fn in_cube(random: &mut Random) -> Vec3 {
    Vec3::from([(); 3].map(|()| random.within(-1.0, 1.0) as f32))
}

/// Uniform in the box from `low` to `high` along each axis.
pub(super) fn in_box(random: &mut Random, low: f64, high: f64) -> Vec3 {
    Vec3::from([(); 3].map(|()| random.within(low, high) as f32))
}

/// A direction of length 1 within rounding.
pub(super) fn unit(random: &mut Random) -> Vec3 {
    random.direction().as_vec3()
}

/// A whole number from `low` to `high`, both included.
pub(super) fn whole(random: &mut Random, low: i32, high: i32) -> f32 {
    (low + random.below((high - low + 1) as usize) as i32) as f32
}

/// From `origin` at `target`: at unit length or, as often, as the difference that f32 gives, which is zero for none of
/// the callers.
pub(super) fn aim(random: &mut Random, origin: Vec3, target: Vec3) -> Ray {
    let raw = target - origin;
    let to = (target.as_dvec3() - origin.as_dvec3()).normalize().as_vec3();
    Ray::new(origin, if random.below(2) == 0 { raw } else { to })
}

/// Along an axis, either way, with zeros of both signs in the other components.
pub(super) fn axis(random: &mut Random) -> Vec3 {
    let mut d = Vec3::new(zero(random), zero(random), zero(random));
    d[random.below(3)] = sign(random);
    d
}

/// From a distance of about `1.5 size` from `centre`, on all sides, at a point within `size / 2` of it.
pub(super) fn inwards(random: &mut Random, centre: Vec3, size: f32) -> Ray {
    let origin = centre + unit(random) * (1.5 * size);
    let target = centre + in_cube(random) * (0.5 * size);
    let to = (target.as_dvec3() - origin.as_dvec3()).normalize_or(glam::DVec3::X);
    Ray::new(origin, to.as_vec3())
}
