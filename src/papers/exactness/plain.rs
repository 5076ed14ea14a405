//! Triangle tests that are not exact, over the same triangles: what the exact one is compared with.
//!
//! None of these is for anything else: they lose hits, find some that are not there, and name other primitives than exact
//! arithmetic does.

use crate::geometry::{Best, Geometry, Triangle};
use crate::ray::{Aabb, Ray};
use glam::{DVec3, Vec3};
use std::marker::PhantomData;

/// How a ray's parameter on a triangle is computed.
pub trait Test: Send + Sync + 'static {
    /// What the tests of one ray share.
    type Prep;

    /// Name in tables.
    const NAME: &'static str;

    /// Computes what all tests of `ray` share.
    fn prepare(ray: &Ray) -> Self::Prep;

    /// The parameter at which `ray` meets the triangle, or `None`; the range is not looked at.
    fn meet(corners: &Triangle, ray: &Ray, prep: &Self::Prep) -> Option<f64>;
}

/// Triangles with the test `T` instead of the exact one.
pub struct PlainTriangles<'a, T>(&'a [Triangle], PhantomData<T>);

impl<'a, T: Test> PlainTriangles<'a, T> {
    /// The same triangles, tested by `T`.
    pub fn new(triangles: &'a [Triangle]) -> Self {
        Self(triangles, PhantomData)
    }
}

impl<T: Test> Geometry for PlainTriangles<'_, T> {
    type Prep = T::Prep;

    #[inline]
    fn len(&self) -> u32 {
        Geometry::len(self.0)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        self.0.bounds(prim)
    }

    #[inline]
    fn prepare(&self, ray: &Ray) -> T::Prep {
        T::prepare(ray)
    }

    #[inline]
    fn test(&self, prim: u32, ray: &Ray, prep: &T::Prep, best: &mut Best) {
        if let Some(t) = T::meet(&self.0[prim as usize], ray, prep) {
            best.offer(ray, t, prim);
        }
    }

    /// Grids insert the same triangles into the same voxels.
    fn triangle(&self, prim: u32) -> Option<Triangle> {
        self.0.triangle(prim)
    }

    /// And leave the same copies out.
    fn fingerprint(&self, prim: u32) -> Option<[u32; 9]> {
        self.0.fingerprint(prim)
    }
}

/// Möller & Trumbore 1997, "Fast, minimum storage ray/triangle intersection", in f32, two-sided.
///
/// Departs from the paper: no epsilon, only a determinant of zero is parallel.
pub struct MollerTrumbore32;

impl Test for MollerTrumbore32 {
    type Prep = ();

    const NAME: &'static str = "Möller-Trumbore f32";

    #[inline]
    fn prepare(_: &Ray) {}

    #[inline]
    fn meet(&[a, b, c]: &Triangle, ray: &Ray, (): &()) -> Option<f64> {
        let (edge1, edge2) = (b - a, c - a);
        let p = ray.direction.cross(edge2);
        let determinant = edge1.dot(p);
        if determinant == 0.0 {
            return None;
        }
        let inverse = 1.0 / determinant;
        let s: Vec3 = ray.origin - a;
        let u = s.dot(p) * inverse;
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let q = s.cross(edge1);
        let v = ray.direction.dot(q) * inverse;
        if v < 0.0 || u + v > 1.0 {
            return None;
        }
        Some(f64::from(edge2.dot(q) * inverse))
    }
}

/// As [`MollerTrumbore32`], in f64.
pub struct MollerTrumbore64;

impl Test for MollerTrumbore64 {
    type Prep = (DVec3, DVec3);

    const NAME: &'static str = "Möller-Trumbore f64";

    #[inline]
    fn prepare(ray: &Ray) -> (DVec3, DVec3) {
        (ray.origin.as_dvec3(), ray.direction.as_dvec3())
    }

    #[inline]
    fn meet(corners: &Triangle, _: &Ray, (origin, direction): &(DVec3, DVec3)) -> Option<f64> {
        let [a, b, c] = corners.map(|corner| corner.as_dvec3());
        let (edge1, edge2) = (b - a, c - a);
        let p = direction.cross(edge2);
        let determinant = edge1.dot(p);
        if determinant == 0.0 {
            return None;
        }
        let inverse = 1.0 / determinant;
        let s = origin - a;
        let u = s.dot(p) * inverse;
        if !(0.0..=1.0).contains(&u) {
            return None;
        }
        let q = s.cross(edge1);
        let v = direction.dot(q) * inverse;
        if v < 0.0 || u + v > 1.0 {
            return None;
        }
        Some(edge2.dot(q) * inverse)
    }
}

/// Woop, Benthin & Wald 2013, "Watertight ray/triangle intersection", appendix A, in f32, two-sided.
///
/// Departs from the paper: an edge function of zero is not computed again in f64 (it is watertight without, but not always
/// right about a ray through an edge), and the order of the axes is not swapped for the winding, which two sides do not need.
pub struct Woop32;

/// The paper's constants of a ray: the axis of its greatest component and the shear.
pub struct Shear {
    z: usize,
    x_by_z: f32,
    y_by_z: f32,
    one_by_z: f32,
}

impl Test for Woop32 {
    type Prep = Shear;

    const NAME: &'static str = "Woop f32";

    #[inline]
    fn prepare(ray: &Ray) -> Shear {
        let d = ray.direction.to_array();
        let size = ray.direction.abs();
        let z = if size.x >= size.y && size.x >= size.z { 0 } else { 1 + usize::from(size.z > size.y) };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        Shear { z, x_by_z: d[x] / d[z], y_by_z: d[y] / d[z], one_by_z: 1.0 / d[z] }
    }

    #[inline]
    fn meet(corners: &Triangle, ray: &Ray, shear: &Shear) -> Option<f64> {
        // As in the exact test: the branch goes the same way for all tests of a ray, and no index is checked.
        match shear.z {
            0 => shear.meet::<1, 2, 0>(ray.origin, corners),
            1 => shear.meet::<2, 0, 1>(ray.origin, corners),
            _ => shear.meet::<0, 1, 2>(ray.origin, corners),
        }
    }
}

impl Shear {
    #[inline(always)]
    fn meet<const X: usize, const Y: usize, const Z: usize>(&self, origin: Vec3, corners: &Triangle) -> Option<f64> {
        let origin: &[f32; 3] = origin.as_ref();
        let shear = |corner: &Vec3| {
            let corner: &[f32; 3] = corner.as_ref();
            let z = corner[Z] - origin[Z];
            ((corner[X] - origin[X]) - self.x_by_z * z, (corner[Y] - origin[Y]) - self.y_by_z * z, z)
        };
        let ((ax, ay, az), (bx, by, bz), (cx, cy, cz)) = (shear(&corners[0]), shear(&corners[1]), shear(&corners[2]));
        let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
        if (u < 0.0 || v < 0.0 || w < 0.0) && (u > 0.0 || v > 0.0 || w > 0.0) {
            return None;
        }
        let determinant = u + v + w;
        if determinant == 0.0 {
            return None;
        }
        let scaled = self.one_by_z * (u * az + v * bz + w * cz);
        Some(f64::from(scaled / determinant))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::{Accel, BruteForce};

    /// Small whole numbers, exact in f32: all tests agree with the exact one, ends and both sides included.
    #[test]
    fn all_agree_where_nothing_is_rounded() {
        fn hits<T: Test>(triangles: &[Triangle], rays: &[Ray]) -> Vec<Option<(u32, f32)>> {
            let accel = BruteForce::new(PlainTriangles::<T>::new(triangles));
            rays.iter().map(|ray| accel.closest_hit(ray).map(|hit| (hit.prim, hit.t))).collect()
        }
        let triangles = [4.0, 2.0, 8.0].map(|z| [Vec3::Z * z, Vec3::new(4.0, 0.0, z), Vec3::new(0.0, 4.0, z)]);
        let mut rays = Vec::new();
        for (x, y) in [(1.0, 1.0), (2.0, 1.0), (3.0, 3.0), (-1.0, 1.0)] {
            for (from, up) in [(0.0, 1.0), (16.0, -2.0), (16.0, 2.0), (3.0, 0.5)] {
                let ray = Ray::new(Vec3::new(x, y, from), Vec3::new(0.0, 0.0, up));
                rays.extend([ray, ray.with_range(4.0, 7.0), ray.with_range(-8.0, 2.0)]);
            }
            rays.push(Ray::new(Vec3::new(x, y, 4.0), Vec3::X));
        }
        let exact = BruteForce::new(&triangles[..]);
        let truth: Vec<_> = rays.iter().map(|ray| exact.closest_hit(ray).map(|hit| (hit.prim, hit.t))).collect();
        assert!(truth.iter().flatten().count() > 10);
        assert_eq!(hits::<MollerTrumbore32>(&triangles, &rays), truth);
        assert_eq!(hits::<MollerTrumbore64>(&triangles, &rays), truth);
        assert_eq!(hits::<Woop32>(&triangles, &rays), truth);
    }
}
