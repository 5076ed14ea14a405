//! Surfaces that their surroundings cannot shade: everything near lies behind them.
//!
//! If all primitives that could hide a light lie in the closed half-space behind some plane, then a segment that starts and
//! ends strictly before the plane meets none of them. The plane is that of the triangle on which rays start, computed in f64;
//! that it is rounded does no harm, because primitives, start and end are all compared with the rounded one, and the error of a
//! comparison is accounted for.
//!
//! Rays that start on a sphere have another plane each. There nothing but the sphere itself may be near, and a ray that starts
//! outside and goes away from the centre does not meet it again.

use crate::geometry::{Geometry, Sphere, Triangle};
use crate::ray::{Aabb, Cell, Ray};
use glam::DVec3;

/// A plane in f64.
#[derive(Clone, Copy, Debug)]
pub(super) struct Plane {
    point: DVec3,
    /// Within rounding of unit length.
    normal: DVec3,
}

impl Plane {
    /// The plane of a triangle; `None` if it has no area to speak of.
    pub fn of(triangle: &Triangle) -> Option<Self> {
        let [a, b, c] = triangle.map(|p| p.as_dvec3());
        (b - a).cross(c - a).try_normalize().map(|normal| Self { point: a, normal })
    }

    /// Distance of a point from the plane, known within [`error`] of the larger coordinate of point and plane.
    pub fn height(&self, point: DVec3) -> f64 {
        self.normal.dot(point - self.point)
    }
}

/// Bound on the error of [`Plane::height`] where no coordinate exceeds `reach`: a difference, three products and two sums of
/// at most `2 sqrt(3) reach`.
pub(super) fn error(reach: f64) -> f64 {
    reach * (1.0 / (1u64 << 48) as f64)
}

/// What rays that start on a primitive may pass by.
pub(super) enum Facing {
    /// Whatever lies behind the plane, which the normal leaves towards the light.
    Plane(Plane),
    /// The primitive itself only.
    Itself(u32),
}

impl Facing {
    /// For rays from `prim` to `light`, a box in world units; `None` if they may meet anything.
    pub fn new<G: Geometry>(geometry: &G, prim: u32, light: &Cell, slack: f64) -> Option<Self> {
        let Some(triangle) = geometry.triangle(prim) else {
            return geometry.sphere(prim).map(|_| Facing::Itself(prim));
        };
        let mut plane = Plane::of(&triangle)?;
        let centre = 0.5 * (light.min + light.max);
        if plane.height(centre) < 0.0 {
            plane.normal = -plane.normal;
        }
        let half = 0.5 * (light.max - light.min);
        let reach = centre.abs().max_element() + half.max_element() + plane.point.abs().max_element();
        let least = plane.height(centre) - half.dot(plane.normal.abs());
        (least > slack + error(reach)).then_some(Facing::Plane(plane))
    }

    /// True only if such rays surely do not meet `prim`; `slack` as for the rays.
    pub fn clears<G: Geometry>(&self, geometry: &G, prim: u32, slack: f64) -> bool {
        let plane = match self {
            Facing::Itself(own) => return *own == prim,
            Facing::Plane(plane) => plane,
        };
        let (highest, reach) = if let Some(triangle) = geometry.triangle(prim) {
            let corners = triangle.map(|p| p.as_dvec3());
            let reach = corners.iter().map(|p| p.abs().max_element()).fold(0.0, f64::max);
            (corners.map(|p| plane.height(p)).into_iter().fold(f64::NEG_INFINITY, f64::max), reach)
        } else if let Some(Sphere { centre, radius }) = geometry.sphere(prim) {
            let (centre, radius) = (centre.as_dvec3(), f64::from(radius));
            (plane.height(centre) + radius * (1.0 + 1e-12), centre.abs().max_element() + radius)
        } else {
            let Aabb { min, max } = geometry.bounds(prim);
            let (min, max) = (min.as_dvec3(), max.as_dvec3());
            let farthest = DVec3::select(plane.normal.cmpgt(DVec3::ZERO), max, min);
            (plane.height(farthest), min.abs().max(max.abs()).max_element())
        };
        let reach = reach.max(plane.point.abs().max_element());
        // False for a NaN.
        highest + error(reach) <= slack
    }
}

/// True only if a ray surely leaves a sphere for good.
pub(super) fn leaves(sphere: &Sphere, ray: &Ray) -> bool {
    let (from, way) = (ray.origin.as_dvec3() - sphere.centre.as_dvec3(), ray.direction.as_dvec3());
    let radius = f64::from(sphere.radius);
    // The difference is exact but for one rounding, products and sums have five more: 2^-40 is plenty.
    const MARGIN: f64 = 1.0 / (1u64 << 40) as f64;
    let outside = from.length_squared() * (1.0 - MARGIN) > radius * radius;
    outside && from.dot(way) > MARGIN * from.length() * way.length()
}
