//! Triangles and spheres in one index space; used only when a scene has both.

use super::{Best, Geometry, Sphere, SpherePrep, Triangle, TrianglePrep};
use crate::ray::{Aabb, Cell, Ray};

/// Triangles first, then spheres: sphere `i` has index `triangles.len() + i`.
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
        Geometry::len(&self.triangles) + Geometry::len(&self.spheres)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        let n = Geometry::len(&self.triangles);
        if prim < n { self.triangles.bounds(prim) } else { self.spheres.bounds(prim - n) }
    }

    fn prepare(&self, ray: &Ray) -> Self::Prep {
        (self.triangles.prepare(ray), self.spheres.prepare(ray))
    }

    fn test(&self, _prim: u32, _ray: &Ray, _prep: &Self::Prep, _best: &mut Best) {
        unimplemented!("lands with the exact tests")
    }

    fn overlaps(&self, prim: u32, cell: &Cell) -> bool {
        let n = Geometry::len(&self.triangles);
        if prim < n { self.triangles.overlaps(prim, cell) } else { self.spheres.overlaps(prim - n, cell) }
    }

    fn triangle(&self, prim: u32) -> Option<Triangle> {
        self.triangles.get(prim as usize).copied()
    }
}
