//! Where rays from surfaces start and end, such that no surface hides itself.
//!
//! Intersection is exact, so only the rounding of a ray to f32 can put its start on the wrong side of the surface. A
//! coordinate `c` is rounded by at most `2^-24 |c|`, a point `p` hence by at most `2^-24 sqrt(3) |p|` along a unit
//! normal, `|p|` being the largest coordinate. Lifting the point by `2^-22 |p|` leaves more than `2^-23 |p|` to the
//! error of the point itself, which f64 keeps below `2^-44` of the coordinates of the primitive; the latter are added,
//! as they may be far greater than those of the point. So a start lies strictly on the outgoing side of the plane of
//! its triangle, or of the tangent plane of its sphere, by far less than anything visible, and `t_min` is 0.
//!
//! A direction along the surface could still be rounded to the other side, and the ray come back to a plane from any
//! height: where that happens the direction is turned outwards by `2^-22`, four times the error of its rounding.

use crate::ray::{Aabb, Ray};
use glam::DVec3;

/// Lift of a point off its surface, in units of its largest coordinate.
const LIFT: f64 = 1.0 / (1 << 22) as f64;

/// Lift in units of the largest coordinate of the scene.
const FLOOR: f64 = 1.0 / (1u64 << 44) as f64;

/// Turn of a direction that rounding has put on the wrong side, radians.
const TURN: f64 = LIFT;

/// End of a ray to a light without extent: two ulps below 1, so that a surface on which the light lies hides nothing.
const BEFORE_LIGHT: f32 = 1.0 - f32::EPSILON;

/// Makes rays that start on surfaces of one scene.
#[derive(Clone, Copy, Debug)]
pub(super) struct Spawner {
    floor: f64,
}

impl Spawner {
    /// For surfaces within `bounds`.
    pub fn new(bounds: &Aabb) -> Self {
        let reach = if bounds.is_empty() { 0.0 } else { bounds.min.abs().max(bounds.max.abs()).max_element() };
        Self { floor: FLOOR * f64::from(reach) }
    }

    /// `position`, lifted off its surface towards the unit `normal`; `reach` is its largest coordinate or more.
    fn lift(&self, position: DVec3, normal: DVec3, reach: f64) -> DVec3 {
        position + normal * (LIFT * reach + self.floor)
    }

    /// The ray from `position` on a surface with unit `normal` (either side) along the unit `direction`, without end.
    pub fn along(&self, position: DVec3, normal: DVec3, direction: DVec3) -> Ray {
        let outwards = side(normal, direction);
        let mut rounded = direction.as_vec3();
        if outwards.dot(rounded.as_dvec3()) < 0.0 {
            rounded = (direction + TURN * outwards).as_vec3();
        }
        Ray::new(self.lift(position, outwards, largest(position)).as_vec3(), rounded)
    }

    /// The ray from `position` on a surface with unit `normal` (either side) to just before `target`.
    pub fn ending_at(&self, position: DVec3, normal: DVec3, target: DVec3) -> Ray {
        let origin = self.lift(position, side(normal, target - position), largest(position)).as_vec3();
        Ray::new(origin, (target - origin.as_dvec3()).as_vec3()).with_range(0.0, BEFORE_LIGHT)
    }

    /// As [`Spawner::ending_at`], for a target on a surface with the unit normal `target_normal` on the side of
    /// `position`: the ray ends in front of that surface.
    pub fn ending_on(&self, position: DVec3, normal: DVec3, target: DVec3, target_normal: DVec3) -> Ray {
        // The end is off by the rounding of the direction, too.
        let reach = largest(target).max(largest(target - position));
        self.ending_at(position, normal, self.lift(target, target_normal, reach))
    }
}

/// The largest coordinate.
fn largest(v: DVec3) -> f64 {
    v.abs().max_element()
}

/// The normal on the side to which `direction` points.
fn side(normal: DVec3, direction: DVec3) -> DVec3 {
    if normal.dot(direction) < 0.0 { -normal } else { normal }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Accel, BruteForce};
    use crate::geometry::{Geometry, Sphere, Triangle};
    use crate::render::sampler::{PixelSamples, mix};
    use crate::render::{Sampler, frame};
    use glam::Vec3;

    /// Directions at all angles, most of them within 1e-8 to 1 radians of the surface.
    fn directions(normal: DVec3, seed: u64) -> impl Iterator<Item = DVec3> {
        let pixel = PixelSamples::new(Sampler::Regular(10), seed, 0, 0);
        (0..60).map(move |i| {
            let [a, b, c, _] = pixel.sample(i).four(1);
            let height = if i % 6 == 0 { 0.0 } else { 10f64.powf(-8.0 * a) * if b < 0.5 { -1.0 } else { 1.0 } };
            let [x, y] = frame::tangents(normal);
            let angle = c * std::f64::consts::TAU;
            (normal * height + x * angle.cos() + y * angle.sin()).normalize()
        })
    }

    fn unit(seed: u64) -> DVec3 {
        let [a, b, ..] = PixelSamples::new(Sampler::Regular(1), seed, 0, 0).sample(0).four(0);
        let [c, d, ..] = PixelSamples::new(Sampler::Regular(1), seed, 1, 0).sample(0).four(0);
        frame::uniform_sphere([a, b]) * (0.5 + c + d)
    }

    fn places() -> impl Iterator<Item = (f32, Vec3, u64)> {
        let scales = [1e-3f32, 1.0, 1e3, 1e6];
        let offsets = [0.0f32, 1.0, 1e4];
        scales.into_iter().flat_map(move |s| {
            offsets.into_iter().flat_map(move |o| {
                (0..20).map(move |i| {
                    let seed = mix(u64::from(s.to_bits()) << 32 | u64::from(o.to_bits())) ^ i;
                    (s, (unit(mix(seed)) * f64::from(o)).as_vec3(), seed)
                })
            })
        })
    }

    /// A triangle of that size about a point, and its unit normal; `None` for a needle, which has no normal to speak of.
    fn triangle((scale, offset, seed): (f32, Vec3, u64)) -> Option<(Triangle, DVec3)> {
        let triangle = [0, 1, 2].map(|i: u64| offset + (unit(mix(seed ^ (i << 40))) * f64::from(scale)).as_vec3());
        let [a, b, c] = triangle.map(|p| p.as_dvec3());
        let normal = (b - a).cross(c - a);
        (normal.length() >= 0.01 * (b - a).length() * (c - a).length()).then(|| (triangle, normal.normalize()))
    }

    #[test]
    fn rays_leave_their_triangle_at_every_scale() {
        for (scale, offset, seed) in places() {
            let Some((triangle, normal)) = triangle((scale, offset, seed)) else { continue };
            let [a, b, c] = triangle.map(|p| p.as_dvec3());
            let accel = BruteForce::new(vec![triangle]);
            let spawner = Spawner::new(&accel.bounds());
            for (w, weights) in [[0.2, 0.3, 0.5], [0.0, 0.5, 0.5], [1.0, 0.0, 0.0]].into_iter().enumerate() {
                let position = a * weights[0] + b * weights[1] + c * weights[2];
                for direction in directions(normal, seed + w as u64) {
                    let ray = spawner.along(position, normal, direction);
                    assert_eq!(accel.closest_hit(&ray), None, "{triangle:?} {ray:?}");
                }
            }
        }
    }

    #[test]
    fn rays_leave_their_sphere_at_every_scale() {
        for (scale, offset, seed) in places() {
            let spheres = vec![Sphere { centre: offset, radius: scale }];
            let accel = BruteForce::new(spheres);
            let spawner = Spawner::new(&accel.bounds());
            let normal = unit(seed).normalize();
            let position = offset.as_dvec3() + normal * f64::from(scale);
            for direction in directions(normal, seed).filter(|d| d.dot(normal) >= 0.0) {
                let ray = spawner.along(position, normal, direction);
                assert_eq!(accel.closest_hit(&ray), None, "{scale} {offset} {ray:?}");
            }
        }
    }

    #[test]
    fn surfaces_do_not_hide_lights_on_them() {
        // Of surfaces no larger than the distance of neighbouring f32 numbers there is no front to be in.
        for (scale, offset, seed) in places().filter(|(s, o, _)| *s > 1e-5 * o.abs().max_element()) {
            let Some((emitter, normal)) = triangle((scale, offset, seed)) else { continue };
            let [a, b, c] = emitter.map(|p| p.as_dvec3());
            let sphere = Sphere { centre: offset, radius: scale };
            let place = offset.as_dvec3() + unit(seed ^ 77).normalize() * f64::from(scale);
            let sphere_normal = (place - offset.as_dvec3()).normalize();
            check_target(vec![emitter], a * 0.2 + b * 0.3 + c * 0.5, normal, f64::from(scale), seed);
            check_target(vec![sphere], place, sphere_normal, f64::from(scale), seed);
        }
    }

    /// From points in front of the surface, at angles down to 1e-8, nothing lies before the target.
    fn check_target<G: Geometry>(geometry: G, place: DVec3, normal: DVec3, scale: f64, seed: u64) {
        let accel = BruteForce::new(geometry);
        let spawner = Spawner::new(&accel.bounds());
        let mut checked = 0;
        for direction in directions(normal, seed).filter(|d| d.dot(normal) > 0.0) {
            let from = place + direction * scale * 3.0;
            let ray = spawner.ending_on(from, direction, place, normal);
            // A start so close to the emitter's plane that rounding has put it there or behind sees no front.
            if (ray.origin.as_dvec3() - place).dot(normal) > spawner.floor {
                assert!(!accel.any_hit(&ray), "{place} {normal} {ray:?}");
                checked += 1;
            }
        }
        assert!(checked > 0);
    }
}
