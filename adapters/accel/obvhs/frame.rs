//! From the world to coordinates in which obvhs' f32 box test is safe, and the ray as obvhs is given it.

use crate::ray::{Aabb, Ray, greater, lesser};
use glam::{DVec3, Vec3, Vec3A};

/// Boxes reach this far beyond their primitives, in units of the frame.
const PADDING: f64 = 1.0 / 131_072.0;

/// Rays start this far before their first point, in units of the frame: more than the 1e-4 before which `CwBvh` takes a box
/// to be behind the ray, and not much more, since every box in between is a box too many.
const RUN_UP: f64 = 1.0 / 8192.0;

/// World to frame: `(world - centre) * scale`, with a power of two as scale.
pub(super) struct Frame {
    centre: Vec3,
    scale: f64,
    /// The scale where f32 can hold it and what is scaled with it.
    near_scale: Option<f32>,
    /// Half the edge lengths of the scene's padded box.
    half: DVec3,
}

impl Frame {
    /// The frame around `bounds`; any frame if they are empty.
    pub fn new(bounds: &Aabb) -> Self {
        if bounds.is_empty() {
            return Self { centre: Vec3::ZERO, scale: 1.0, near_scale: None, half: DVec3::ZERO };
        }
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        // A point has no extent: any scale below the least distance of f32 will do.
        let extent = (max - min).max_element().max(1e-60);
        // The largest extent becomes 0.5..1.
        let scale = 2.0_f64.powi(-(extent.log2().floor() as i32) - 1);
        let near_scale = (1e-30..1e30).contains(&scale).then_some(scale as f32);
        let centre = ((min + max) * 0.5).as_vec3();
        let half = (max - centre.as_dvec3()).max(centre.as_dvec3() - min) * scale + PADDING;
        Self { centre, scale, near_scale, half }
    }

    fn to_local(&self, world: DVec3) -> DVec3 {
        (world - self.centre.as_dvec3()) * self.scale
    }

    /// A box in the frame, padded.
    pub fn local_box(&self, aabb: &Aabb) -> obvhs::aabb::Aabb {
        let (min, max) = (self.to_local(aabb.min.as_dvec3()) - PADDING, self.to_local(aabb.max.as_dvec3()) + PADDING);
        obvhs::aabb::Aabb { min: min.as_vec3a(), max: max.as_vec3a() }
    }

    /// The ray in the frame, or why it has none.
    #[inline]
    pub fn local_ray(&self, ray: &Ray) -> Entry {
        self.near_ray(ray).unwrap_or_else(|| self.far_ray(ray))
    }

    /// The ray as it is, in f32 and by powers of two alone, if it starts within two units of the centre: subtracting the
    /// centre and running up then round the origin by less than 6u, and nothing else is rounded.
    #[inline]
    fn near_ray(&self, ray: &Ray) -> Option<Entry> {
        let scale = self.near_scale?;
        let origin = (ray.origin - self.centre) * scale;
        let exponent = ray.direction.abs().max_element().to_bits() >> 23;
        // Not so for a NaN; the exponents keep the scaled direction and its scale within the normal numbers.
        if !(origin.abs().max_element() <= 2.0 && ray.t_min >= 0.0 && (1..=252).contains(&exponent)) {
            return None;
        }
        // The largest component becomes 1..2.
        let direction = ray.direction * f32::from_bits((254 - exponent) << 23);
        let speed = f64::from(f32::from_bits(exponent << 23)) * self.scale;
        let local = obvhs::ray::Ray::new(
            vec3a(origin - direction * RUN_UP as f32),
            vec3a(direction),
            0.0,
            raised(f64::from(ray.t_max) * speed + RUN_UP),
        );
        Some(Entry::Inside { local, speed, offset: RUN_UP })
    }

    /// The ray from where it enters the scene's box, found in f64.
    #[cold]
    fn far_ray(&self, ray: &Ray) -> Entry {
        let origin = self.to_local(ray.origin.as_dvec3());
        // 2^-52 |o| is the rounding of the entry point.
        if origin.abs().max_element() > f64::from(1 << 30) {
            return Entry::TooFar;
        }
        let direction = ray.direction.as_dvec3() * self.scale;
        let range = (f64::from(ray.t_min), f64::from(ray.t_max));
        let Some((enter, leave)) = clip(origin, direction.recip(), (-self.half, self.half), range) else {
            return Entry::Miss;
        };
        let speed = direction.abs().max_element();
        let pace = 1.0 / speed;
        let start = enter - RUN_UP * pace;
        let local = obvhs::ray::Ray::new(
            (origin + start * direction).as_vec3a(),
            vec3a((direction * pace).as_vec3()),
            0.0,
            raised((leave - start) * speed),
        );
        Entry::Inside { local, speed, offset: -start * speed }
    }
}

/// Four lanes, with +0.0 for -0.0, which obvhs' tests do not treat alike.
#[inline]
fn vec3a(v: Vec3) -> Vec3A {
    Vec3A::from(v) + Vec3A::ZERO
}

/// A parameter of the frame, raised by more than all errors of the box test.
#[inline]
pub(super) fn raised(t: f64) -> f32 {
    (t + PADDING) as f32
}

/// How a ray meets the scene's box.
pub(super) enum Entry {
    Miss,
    TooFar,
    /// The parameter `t` of the ray is `t * speed + offset` in the frame.
    Inside {
        local: obvhs::ray::Ray,
        speed: f64,
        offset: f64,
    },
}

/// The part of `t_min..=t_max` over which `origin + t * direction` lies between the planes of a box, or `None`.
///
/// `inverse` is 1 over each component of the direction. A component that is zero, the inverse infinite, is a test of the
/// origin, never a product with infinity. The result is right up to a few roundings of f64, so callers pad their boxes. The
/// direction is not zero and the box is bounded, so the result is finite.
#[inline(always)]
fn clip(origin: DVec3, inverse: DVec3, (min, max): (DVec3, DVec3), (t_min, t_max): (f64, f64)) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (t_min, t_max);
    let (a, b) = ((min - origin) * inverse, (max - origin) * inverse);
    for axis in 0..3 {
        if inverse[axis].is_finite() {
            enter = greater(enter, lesser(a[axis], b[axis]));
            leave = lesser(leave, greater(a[axis], b[axis]));
        } else if origin[axis] < min[axis] || origin[axis] > max[axis] {
            return None;
        }
    }
    (enter <= leave).then_some((enter, leave))
}
