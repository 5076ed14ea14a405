//! Triangles that share corners through indices.

use super::triangle;
use super::{Best, Geometry, Triangle, TrianglePrep};
use crate::error::{Error, Result};
use crate::ray::{Aabb, Ray};
use glam::Vec3;

/// Triangles given by indices into a list of corners; answers as a list of [`Triangle`] would, with less memory.
///
/// Owns its lists by default and borrows them as `IndexedTriangles<&[Vec3], &[[u32; 3]]>`. A triangle with a corner that is not
/// finite is never hit.
#[derive(Clone, Copy, Debug, Default)]
pub struct IndexedTriangles<P = Vec<Vec3>, T = Vec<[u32; 3]>> {
    positions: P,
    triangles: T,
}

impl<P: AsRef<[Vec3]>, T: AsRef<[[u32; 3]]>> IndexedTriangles<P, T> {
    /// Corners in world units, and three indices of corners for each triangle.
    ///
    /// # Errors
    /// A triangle refers to a corner that does not exist, or there are more than 2^32 - 2 triangles.
    pub fn new(positions: P, triangles: T) -> Result<Self> {
        let (count, listed) = (positions.as_ref().len(), triangles.as_ref());
        if listed.len() > (u32::MAX - 1) as usize {
            return Err(Error::invalid(format!(
                "{} triangles, at most {} can be told apart",
                listed.len(),
                u32::MAX - 1
            )));
        }
        for (i, corners) in listed.iter().enumerate() {
            if let Some(index) = corners.iter().find(|&&index| index as usize >= count) {
                return Err(Error::invalid(format!("triangle {i} refers to corner {index} of {count}")));
            }
        }
        Ok(Self { positions, triangles })
    }

    /// All corners, world units.
    pub fn positions(&self) -> &[Vec3] {
        self.positions.as_ref()
    }

    /// Three indices of corners for each triangle.
    pub fn triangles(&self) -> &[[u32; 3]] {
        self.triangles.as_ref()
    }

    #[inline]
    fn corners(&self, prim: u32) -> Triangle {
        let positions = self.positions.as_ref();
        self.triangles.as_ref()[prim as usize].map(|index| positions[index as usize])
    }
}

impl<P: AsRef<[Vec3]> + Send + Sync, T: AsRef<[[u32; 3]]> + Send + Sync> Geometry for IndexedTriangles<P, T> {
    type Prep = TrianglePrep;

    #[inline]
    fn len(&self) -> u32 {
        u32::try_from(self.triangles().len()).unwrap_or(u32::MAX - 1)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        Aabb::of_points(&self.corners(prim))
    }

    #[inline]
    fn prepare(&self, ray: &Ray) -> TrianglePrep {
        TrianglePrep::new(ray)
    }

    #[inline]
    fn test(&self, prim: u32, ray: &Ray, prep: &TrianglePrep, best: &mut Best) {
        triangle::test(self, prim, &self.corners(prim), ray, prep, best);
    }

    fn confirm(&self, prim: u32, ray: &Ray, prep: &TrianglePrep, best: &mut Best) {
        triangle::confirm(self, prim, &self.corners(prim), ray, prep, best);
    }

    fn locate(&self, prim: u32, ray: &Ray) -> Option<(f64, f64)> {
        triangle::locate(&self.corners(prim), ray)
    }

    fn round(&self, ray: &Ray, best: &Best) -> f32 {
        match best.prim() {
            Some(prim) => triangle::round(&self.corners(prim), ray, best),
            None => best.t() as f32,
        }
    }

    #[inline]
    fn triangle(&self, prim: u32) -> Option<Triangle> {
        Some(self.corners(prim))
    }

    fn fingerprint(&self, prim: u32) -> Option<[u32; 9]> {
        Some(triangle::fingerprint(&self.corners(prim)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn answers_as_plain_triangles_do() {
        let positions = [Vec3::ZERO, Vec3::X, Vec3::Y, Vec3::ONE];
        let indices = [[0, 1, 2], [3, 2, 1]];
        let set = IndexedTriangles::new(&positions[..], &indices[..]).expect("indices in range");
        let plain: Vec<Triangle> = indices.iter().map(|t| t.map(|i: u32| positions[i as usize])).collect();
        let mut hits = 0;
        for i in 0..100 {
            let target = Vec3::new(0.013 * i as f32 - 0.1, 0.3, 0.2);
            let ray = Ray::new(Vec3::new(0.25, 0.25, 2.0), target - Vec3::new(0.25, 0.25, 2.0));
            let (mut ours, mut theirs) = (Best::NONE, Best::NONE);
            let preps = [set.prepare(&ray), plain.prepare(&ray)];
            for prim in 0..2 {
                set.test(prim, &ray, &preps[0], &mut ours);
                plain.test(prim, &ray, &preps[1], &mut theirs);
            }
            assert_eq!(ours, theirs);
            if ours.is_hit() {
                hits += 1;
                assert_eq!(set.round(&ray, &ours), plain.round(&ray, &theirs));
            }
        }
        assert!(hits > 20, "{hits} of 100 rays hit");
    }

    #[test]
    fn indices_are_checked() {
        let error = IndexedTriangles::new(vec![Vec3::ZERO; 2], vec![[0, 1, 1], [0, 2, 1]]).expect_err("corner 2 of 2");
        assert_eq!(error.to_string(), "triangle 1 refers to corner 2 of 2");
    }
}
