//! Triangles: filtered exact ray test.

use super::{Best, Geometry};
use crate::ray::{Aabb, Ray};
use glam::Vec3;

/// A closed, two-sided triangle given by its corners, world units.
pub type Triangle = [Vec3; 3];

/// What the triangle tests of one ray share.
#[derive(Clone, Copy, Debug)]
pub struct TrianglePrep {}

impl Geometry for [Triangle] {
    type Prep = TrianglePrep;

    fn len(&self) -> u32 {
        u32::try_from(<[Triangle]>::len(self)).unwrap_or(u32::MAX - 1)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        Aabb::of_points(&self[prim as usize])
    }

    fn prepare(&self, _ray: &Ray) -> TrianglePrep {
        TrianglePrep {}
    }

    fn test(&self, prim: u32, ray: &Ray, _prep: &TrianglePrep, best: &mut Best) {
        // Placeholder until the filtered exact test lands: Moeller-Trumbore in f64.
        let [a, b, c] = self[prim as usize].map(|p| p.as_dvec3());
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let (e1, e2) = (b - a, c - a);
        let p = d.cross(e2);
        let det = e1.dot(p);
        if det == 0.0 {
            return;
        }
        let s = o - a;
        let u = s.dot(p) / det;
        let q = s.cross(e1);
        let v = d.dot(q) / det;
        if u >= 0.0 && v >= 0.0 && u + v <= 1.0 {
            best.offer(ray, e2.dot(q) / det, prim);
        }
    }

    fn triangle(&self, prim: u32) -> Option<Triangle> {
        Some(self[prim as usize])
    }
}
