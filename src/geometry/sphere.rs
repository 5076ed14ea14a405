//! Spheres: the test without cancellation, in f64.

use super::{Best, Geometry};
use crate::ray::{Aabb, Ray};
use glam::Vec3;

/// The surface of a ball, world units. A radius that is not finite or negative is never hit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, world units.
    pub centre: Vec3,
    /// Radius, world units, at least 0.
    pub radius: f32,
}

/// What the sphere tests of one ray share.
#[derive(Clone, Copy, Debug)]
pub struct SpherePrep {}

impl Geometry for [Sphere] {
    type Prep = SpherePrep;

    fn len(&self) -> u32 {
        u32::try_from(<[Sphere]>::len(self)).unwrap_or(u32::MAX - 1)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        let s = &self[prim as usize];
        Aabb::of_points(&[s.centre - s.radius, s.centre + s.radius])
    }

    fn prepare(&self, _ray: &Ray) -> SpherePrep {
        SpherePrep {}
    }

    fn test(&self, prim: u32, ray: &Ray, _prep: &SpherePrep, best: &mut Best) {
        // Placeholder until the stable test lands.
        let s = &self[prim as usize];
        let (f, d) = ((ray.origin - s.centre).as_dvec3(), ray.direction.as_dvec3());
        let (a, b, r) = (d.length_squared(), -f.dot(d), f64::from(s.radius));
        let disc = r * r - (f + b / a * d).length_squared();
        if disc >= 0.0 {
            let c = f.length_squared() - r * r;
            let q = b + (a * disc).sqrt().copysign(b);
            let (t0, t1) = (c / q, q / a);
            best.offer(ray, t0.min(t1), prim);
            best.offer(ray, t0.max(t1), prim);
        }
    }
}
