//! Triangles and spheres in one index space; used only when a scene has both.

use super::{Best, Geometry, Sphere, SpherePrep, Triangle, TrianglePrep, sphere, triangle};
use crate::ray::{Aabb, Cell, Ray};

/// Triangles first, then spheres: sphere `i` has index `triangles.len() + i`.
///
/// Triangles and spheres are ordered as exact numbers: a quotient against a root of a quadratic equation. At most 2^32 - 2
/// primitives can be told apart; those beyond are never hit.
#[derive(Clone, Debug, Default)]
pub struct Mixed {
    /// Primitives `0..triangles.len()`.
    pub triangles: Vec<Triangle>,
    /// The primitives after the triangles.
    pub spheres: Vec<Sphere>,
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
        } else {
            let (triangles, spheres) = prep;
            let ball = &self.spheres[prim as usize - self.triangles.len()];
            sphere::test(self, prim, ball, ray, (spheres, &triangles.decided), best);
        }
    }

    fn confirm(&self, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
        match self.triangles.get(prim as usize) {
            Some(corners) => triangle::confirm(self, prim, corners, ray, &prep.0, best),
            None => self.test(prim, ray, prep, best),
        }
    }

    fn locate(&self, prim: u32, ray: &Ray) -> Option<(f64, f64)> {
        triangle::locate(self.triangles.get(prim as usize)?, ray)
    }

    fn round(&self, ray: &Ray, best: &Best) -> f32 {
        match best.prim() {
            Some(prim) => match (self.triangle(prim), self.sphere(prim)) {
                (Some(corners), _) => triangle::round(&corners, ray, best),
                (None, Some(ball)) => sphere::round(&ball, ray, best),
                (None, None) => unreachable!("a winner is one of the primitives"),
            },
            None => best.t() as f32,
        }
    }

    fn overlaps(&self, prim: u32, cell: &Cell) -> bool {
        let n = Geometry::len(&self.triangles);
        if prim < n { self.triangles.overlaps(prim, cell) } else { self.spheres.overlaps(prim - n, cell) }
    }

    fn fingerprint(&self, prim: u32) -> Option<[u32; 9]> {
        let n = Geometry::len(&self.triangles);
        if prim < n { self.triangles.fingerprint(prim) } else { self.spheres.fingerprint(prim - n) }
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
