//! Rays, axis-aligned boxes, and the intake that decides which rays are rays.

use glam::{DVec3, Vec3, Vec3A};

/// The set of points `origin + t * direction` for `t_min <= t <= t_max`, both ends included.
///
/// The direction need not have unit length; `t` counts in its length. Every bit of the six coordinates counts: answers
/// are exact for the values stored here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ray {
    /// Start of the ray, world units.
    pub origin: Vec3,
    /// Direction and unit of `t`, world units for each unit of `t`.
    pub direction: Vec3,
    /// Smallest parameter of interest, itself included; may be negative or `-inf`. With a NaN the ray hits nothing.
    pub t_min: f32,
    /// Largest parameter of interest, itself included; may be `inf`. With a NaN, or below `t_min`, the ray hits nothing.
    pub t_max: f32,
}

impl Ray {
    /// The ray from `origin` along `direction` over `0 <= t <= inf`.
    pub fn new(origin: Vec3, direction: Vec3) -> Self {
        Self { origin, direction, t_min: 0.0, t_max: f32::INFINITY }
    }

    /// The same ray over `t_min <= t <= t_max`, whatever its range was. Any bits will do: see [`Ray::t_min`] and [`Ray::t_max`].
    pub fn with_range(self, t_min: f32, t_max: f32) -> Self {
        Self { t_min, t_max, ..self }
    }

    /// The point at parameter `t`, world units: a product and a sum in f64, each rounded. Not finite where `t` or the ray is not.
    pub fn at(&self, t: f64) -> DVec3 {
        self.origin.as_dvec3() + t * self.direction.as_dvec3()
    }

    /// The ray that accelerators trace, or `None` if it hits nothing by definition.
    ///
    /// A ray with a component that is not finite, a NaN bound, no direction, or `t_min > t_max` hits nothing. Negative
    /// zeros become positive ones, so that later stages need not tell them apart. Every query of an accelerator begins with this;
    /// only those who call a [`Geometry`](crate::Geometry) themselves need it.
    ///
    /// ```
    /// use glam::Vec3;
    /// use skipgrid::Ray;
    ///
    /// let ray = Ray::new(Vec3::new(-0.0, 1.0, 2.0), Vec3::Z);
    /// let taken = ray.intake().expect("it is finite and has a direction");
    /// assert!(taken == ray && taken.origin.x.is_sign_positive());
    /// assert_eq!(Ray::new(Vec3::ZERO, Vec3::ZERO).intake(), None);
    /// assert_eq!(ray.with_range(1.0, f32::NAN).intake(), None);
    /// ```
    #[inline]
    pub fn intake(&self) -> Option<Ray> {
        let (origin, direction) = (Vec3A::from(self.origin), Vec3A::from(self.direction));
        let usable =
            origin.is_finite() & direction.is_finite() & (direction != Vec3A::ZERO) & (self.t_min <= self.t_max);
        // x + 0.0 is x for every x but -0.0, which becomes 0.0.
        usable.then(|| Ray {
            origin: (origin + Vec3A::ZERO).into(),
            direction: (direction + Vec3A::ZERO).into(),
            t_min: self.t_min + 0.0,
            t_max: self.t_max + 0.0,
        })
    }
}

/// An axis-aligned box, both corners included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Aabb {
    /// Least corner, world units.
    pub min: Vec3,
    /// Greatest corner, world units.
    pub max: Vec3,
}

impl Aabb {
    /// The box that contains nothing; the neutral element of [`Aabb::union`].
    pub const EMPTY: Aabb = Aabb { min: Vec3::INFINITY, max: Vec3::NEG_INFINITY };

    /// The least box around the points; [`Aabb::EMPTY`] if a coordinate is not finite or there is no point.
    pub fn of_points(points: &[Vec3]) -> Self {
        if !points.iter().all(|p| p.is_finite()) {
            return Self::EMPTY;
        }
        points.iter().fold(Self::EMPTY, |b, &p| Self { min: b.min.min(p), max: b.max.max(p) })
    }

    /// True if the box contains no point: a corner's coordinate is a NaN, or `min` is beyond `max` along an axis.
    pub fn is_empty(&self) -> bool {
        !(self.min.cmple(self.max).all())
    }

    /// The least box around both, neither with a NaN.
    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Edge lengths, world units; zero for an empty box, infinite where f32 cannot hold one.
    pub fn extent(&self) -> Vec3 {
        if self.is_empty() { Vec3::ZERO } else { self.max - self.min }
    }
}

/// For builders: the corners of an empty box are the origin here, so that there is a place to put what holds nothing.
impl Aabb {
    /// Both corners.
    pub(crate) fn corners(&self) -> [DVec3; 2] {
        if self.is_empty() { [DVec3::ZERO; 2] } else { [self.min.as_dvec3(), self.max.as_dvec3()] }
    }

    /// The largest coordinate of a corner, without its sign.
    pub(crate) fn reach(&self) -> f64 {
        let [min, max] = self.corners();
        min.abs().max(max.abs()).max_element()
    }

    /// By how much structures pad the box: 2^-10 of its largest extent, so that flat scenes have a thickness, and at least
    /// `least` of its [`Aabb::reach`], so that f64 can tell its faces apart.
    pub(crate) fn padding(&self, least: f64) -> f64 {
        let [min, max] = self.corners();
        // 1e-60: below any f32 distance, far above where one over it would overflow.
        ((max - min).max_element() / 1024.0).max(self.reach() * least).max(1e-60)
    }
}

/// An axis-aligned box in f64: a grid cell, which may be smaller than f32 can tell apart.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cell {
    /// Least corner, world units.
    pub min: DVec3,
    /// Greatest corner, world units.
    pub max: DVec3,
}

impl Cell {
    /// True if the closed boxes share a point; false if either has a NaN.
    pub fn meets(&self, aabb: &Aabb) -> bool {
        self.min.cmple(aabb.max.as_dvec3()).all() && self.max.cmpge(aabb.min.as_dvec3()).all()
    }
}

/// The lesser of two numbers, `b` if one is a NaN: one instruction, where `min` of the standard library takes five.
#[inline(always)]
pub(crate) fn lesser<T: PartialOrd>(a: T, b: T) -> T {
    if a < b { a } else { b }
}

/// The greater of two numbers, `b` if one is a NaN.
#[inline(always)]
pub(crate) fn greater<T: PartialOrd>(a: T, b: T) -> T {
    if a > b { a } else { b }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn intake_drops_negative_zeros_and_rays_that_hit_nothing() {
        let ray = Ray::new(Vec3::new(-0.0, 1.0, 2.0), Vec3::new(0.0, -0.0, 1.0));
        let taken = ray.intake().expect("a finite ray with a direction");
        assert_eq!(taken.origin.x.to_bits(), 0);
        assert_eq!(taken.direction.y.to_bits(), 0);
        for bad in [
            Ray::new(Vec3::NAN, Vec3::X),
            Ray::new(Vec3::ZERO, Vec3::new(f32::INFINITY, 0.0, 0.0)),
            Ray::new(Vec3::ZERO, Vec3::new(0.0, -0.0, 0.0)),
            Ray::new(Vec3::ZERO, Vec3::X).with_range(f32::NAN, 1.0),
            Ray::new(Vec3::ZERO, Vec3::X).with_range(0.0, f32::NAN),
            Ray::new(Vec3::ZERO, Vec3::X).with_range(2.0, 1.0),
        ] {
            assert_eq!(bad.intake(), None, "{bad:?}");
        }
        assert!(Ray::new(Vec3::ZERO, Vec3::X).with_range(f32::NEG_INFINITY, f32::INFINITY).intake().is_some());
    }

    #[test]
    fn boxes_with_bad_points_are_empty() {
        assert!(Aabb::of_points(&[]).is_empty());
        assert!(Aabb::of_points(&[Vec3::ZERO, Vec3::NAN]).is_empty());
        assert!(!Aabb::of_points(&[Vec3::ZERO]).is_empty());
    }
}
