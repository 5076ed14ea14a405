//! Triangles and spheres in one index space; used only when a scene has both.

use super::exact::Crossing;
use super::sphere::parameter;
use super::{Best, Geometry, Sphere, SpherePrep, Triangle, TrianglePrep, triangle};
use crate::ray::{Aabb, Cell, Ray};
use std::cmp::Ordering;

/// Triangles first, then spheres: sphere `i` has index `triangles.len() + i`.
///
/// A triangle's parameter is an exact quotient and a sphere's an f64 taken as exact, so that all hits of a ray have one
/// order. At most 2^32 - 2 primitives can be told apart; those beyond are never hit.
#[derive(Clone, Debug, Default)]
pub struct Mixed {
    /// Primitives `0..triangles.len()`.
    pub triangles: Vec<Triangle>,
    /// The primitives after the triangles.
    pub spheres: Vec<Sphere>,
}

impl Mixed {
    /// Makes sphere `prim`, met at `t` in range, the winner if it comes first.
    fn offer(&self, ray: &Ray, t: f64, prim: u32, best: &mut Best) {
        match best.prim().and_then(|prim| self.triangle(prim)) {
            // A triangle's bound has room for the rounding of sums with it.
            Some(_) if t > best.upper() => {}
            Some(winner) if t >= best.t() - best.err() => {
                // Triangles have the lesser indices: they win ties.
                if Crossing::of_plane(ray, &winner).is_some_and(|w| w.cmp_parameter(t) == Ordering::Greater) {
                    best.replace(t, 0.0, prim);
                }
            }
            Some(_) => best.replace(t, 0.0, prim),
            None => best.offer(ray, t, prim),
        }
    }
}

impl Geometry for Mixed {
    type Prep = (TrianglePrep, SpherePrep);

    fn len(&self) -> u32 {
        Geometry::len(&self.triangles).saturating_add(Geometry::len(&self.spheres)).min(u32::MAX - 1)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        let n = Geometry::len(&self.triangles);
        if prim < n { self.triangles.bounds(prim) } else { self.spheres.bounds(prim - n) }
    }

    fn prepare(&self, ray: &Ray) -> Self::Prep {
        (self.triangles.prepare(ray), self.spheres.prepare(ray))
    }

    #[inline]
    fn test(&self, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
        if let Some(corners) = self.triangles.get(prim as usize) {
            // `self` and not the triangles alone: the winner to compare with may be a sphere.
            triangle::test(self, prim, corners, ray, &prep.0, best);
        } else if let Some(t) = parameter(&self.spheres[prim as usize - self.triangles.len()], ray, &prep.1) {
            self.offer(ray, t, prim, best);
        }
    }

    fn round(&self, ray: &Ray, best: &Best) -> f32 {
        match best.prim() {
            Some(prim) if (prim as usize) < self.triangles.len() => self.triangles.round(ray, best),
            _ => self.spheres.round(ray, best),
        }
    }

    fn overlaps(&self, prim: u32, cell: &Cell) -> bool {
        let n = Geometry::len(&self.triangles);
        if prim < n { self.triangles.overlaps(prim, cell) } else { self.spheres.overlaps(prim - n, cell) }
    }

    #[inline]
    fn triangle(&self, prim: u32) -> Option<Triangle> {
        self.triangles.get(prim as usize).copied()
    }

    #[inline]
    fn sphere(&self, prim: u32) -> Option<Sphere> {
        self.spheres.get((prim as usize).checked_sub(self.triangles.len())?).copied()
    }
}
