//! Boxes around the packs of a leaf, in trees: eight are asked at once which of them a ray meets.
//!
//! A test of eight boxes takes half as long as that of one pack. So a leaf may hold thousands of primitives, and few of
//! them are listed in more than one.
//!
//! After T. Ize, "Robust BVH ray traversal", JCGT 2 (2013), section 3: rounding moves the crossing of a plane by a factor,
//! never across the ray's origin. Departs from it: both crossings are moved apart, so that the ray's end may be compared
//! with them as well, and rays whose origin is not exact, or almost parallel to a plane, are widened by a distance.
//!
//! **Why nothing is lost.** Boxes are exact, or rounded outwards; the plane of a box and the ray's origin are then exact
//! ([`Sight`](super::sight::Sight)), their difference, the inverse of the direction and the product are each off by a
//! factor of `1 + e` at most, and [`EARLY`] and [`LATE`] are further from 1 than all three. What is behind the origin stays
//! behind it: a ray that leaves a flat surface does not meet the surface's box. Where the origin is off by the `fuzz`, both
//! planes are moved apart by four times as much; where a component of the direction is below [`LEAST`] and was replaced by
//! it, by more than that moves the ray within the box.
//!
//! A box holds what its primitives have in the cell, padded where the cell cuts them off, as walks come no nearer to a cell
//! than that.

use super::frame::LEAST;
use super::lanes::{Lanes, Row, Vector};
use super::sight::Entry;
use crate::ray::greater;
use glam::Vec3A;

/// A box: its least and its greatest corner.
pub(super) type Bounds = [[f32; 3]; 2];

/// Boxes around up to eight packs, or groups of the next level.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Boxes {
    /// Least and greatest coordinates along each axis; a lane that holds none has them the wrong way round.
    pub planes: [[Row; 3]; 2],
    /// The first of the packs, less `inner`.
    pub first: u32,
    /// The first of the groups.
    pub below: u32,
    /// How many of the lanes, from the first on, are groups: the others are packs.
    pub inner: u32,
}

/// Crossings are moved by these factors: a product of three that are rounded is off by `3 e`, and these by `16 e` and their
/// own rounding.
const EARLY: f32 = 1.0 - 8.0 * f32::EPSILON;
const LATE: f32 = 1.0 + 8.0 * f32::EPSILON;

/// A ray as boxes see it, from the world's origin as packs do.
#[derive(Clone, Copy)]
pub(super) struct BoxRay<S> {
    /// The origin at or beyond its place along each axis, and at or before it.
    near: Vector<S>,
    far: Vector<S>,
    /// One over the components of the direction, less and more than it is.
    early: Vector<S>,
    late: Vector<S>,
    /// At or before the `p` of the ray's begin, at least 0.
    begin: S,
    /// Bit `a` is set if the ray moves backwards along axis `a`.
    octant: usize,
}

impl<S: Lanes> BoxRay<S> {
    /// The ray of an entry.
    #[inline(always)]
    pub fn new(entry: &Entry) -> Self {
        // More than the least component moves the ray, which is at most 10 long where it matters.
        const ASIDE: f32 = 16.0 * LEAST;
        let Entry { sight, inverse, sign, size, .. } = entry;
        // Twice the rounding of the sum with the origin.
        let aside = Vec3A::splat(ASIDE) + sight.origin.abs() * f32::EPSILON;
        let aside = Vec3A::select(size.cmple(Vec3A::splat(LEAST)), aside, Vec3A::ZERO) + 4.0 * sight.fuzz;
        let (aside, inverse) = (aside * sign, inverse * sign);
        Self {
            near: Vector::splat(sight.origin + aside),
            far: Vector::splat(sight.origin - aside),
            early: Vector::splat(inverse * EARLY),
            late: Vector::splat(inverse * LATE),
            begin: S::splat(greater(sight.begin[0], 0.0)),
            octant: sign.is_negative_bitmask() as usize,
        }
    }
}

impl Boxes {
    /// No boxes: lanes without one have it the wrong way round.
    pub const NONE: Boxes = Boxes {
        planes: [[Row([f32::INFINITY; 8]); 3], [Row([f32::NEG_INFINITY; 8]); 3]],
        first: 0,
        below: 0,
        inner: 0,
    };

    /// Boxes that every ray meets, of eight packs from `first` on, or as many as there are before `end`.
    pub fn around_all(first: usize, end: usize) -> Self {
        let mut boxes = Self { first: first as u32, ..Self::NONE };
        for lane in 0..8.min(end - first) {
            boxes.set(lane, &[[f32::NEG_INFINITY; 3], [f32::INFINITY; 3]]);
        }
        boxes
    }

    /// Sets the box of a lane.
    pub fn set(&mut self, lane: usize, bounds: &Bounds) {
        for (planes, corner) in self.planes.iter_mut().zip(bounds) {
            for (row, &x) in planes.iter_mut().zip(corner) {
                row.0[lane & 7] = x;
            }
        }
    }

    /// Where the ray enters each box, and the boxes that it meets from its begin to a `p` of `end`.
    #[inline(always)]
    pub fn look<S: Lanes>(&self, ray: &BoxRay<S>, end: f32) -> (S, u32) {
        let [x, y, z] = [ray.octant, ray.octant >> 1, ray.octant >> 2];
        // Which planes come first.
        let near = Vector {
            x: S::of(&self.planes[x & 1][0]),
            y: S::of(&self.planes[y & 1][1]),
            z: S::of(&self.planes[z & 1][2]),
        };
        let far = Vector {
            x: S::of(&self.planes[!x & 1][0]),
            y: S::of(&self.planes[!y & 1][1]),
            z: S::of(&self.planes[!z & 1][2]),
        };
        let (near, far) = (near.minus(&ray.near), far.minus(&ray.far));
        let enters = (near.x * ray.early.x).max(near.y * ray.early.y).max(near.z * ray.early.z);
        let leaves = (far.x * ray.late.x).min(far.y * ray.late.y).min(far.z * ray.late.z);
        let misses = leaves.less(enters.max(ray.begin)) | S::splat(end).less(enters);
        (enters, !S::bits(misses) & 0xff)
    }
}

#[cfg(test)]
mod tests {
    use super::super::frame::{Frame, Start};
    use super::super::lanes::Portable;
    #[cfg(target_arch = "x86_64")]
    use super::super::simd::Isa;
    use super::*;
    use crate::geometry::tests::Random;
    use crate::ray::{Aabb, Ray};
    use glam::Vec3;

    /// The least box of f32 around a point known to f64: flat where it is one.
    fn around(point: glam::DVec3) -> Bounds {
        let end = |x: f64, sign: f32| {
            let near = (x as f32) * sign;
            sign * if f64::from(near) < x * f64::from(sign) { near.next_up() } else { near }
        };
        [-1.0, 1.0].map(|sign| point.to_array().map(|x| end(x, sign)))
    }

    #[test]
    fn boxes_around_points_of_a_ray_are_met() {
        let mut random = Random::new(32);
        let frame = Frame::new(&Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE });
        let (mut met, mut others, mut rays) = (0, 0, 0);
        for round in 0..40_000 {
            let mut direction = random.in_cube();
            if round % 3 == 0 {
                direction[round % 7 % 3] *= [0.0, 1e-9, 1e-30][round % 5 % 3];
            }
            let distance = [0.0, 0.5, 3.0, 60.0, 1e5][random.next() as usize % 5];
            let origin = random.in_cube() * 0.9 - direction * distance;
            let begin = if round % 11 == 0 { f32::NEG_INFINITY } else { 0.0 };
            let ray = Ray::new(origin, direction).with_range(begin, f32::INFINITY);
            let Some(ray) = ray.intake() else { continue };
            let Start::Inside(entry) = frame.enter(&ray, None) else { continue };
            rays += 1;
            let mut boxes = Boxes::NONE;
            let mut expected = 0;
            for lane in 0..8 {
                let t = f64::from(distance) + f64::from(random.unit()) * if begin < 0.0 { -1.0 } else { 1.0 };
                let point = ray.at(t);
                if lane < 6 && point.abs().max_element() <= 1.0 && distance < 1e4 {
                    expected |= 1 << lane;
                    boxes.set(lane, &around(point));
                } else {
                    boxes.set(lane, &around(point + random.in_cube().as_dvec3() * 0.5));
                    others += 1;
                }
            }
            // The part is as large as the world.
            assert_eq!(frame.scale, 1.0 / 2.0);
            for row in boxes.planes.iter_mut().flatten() {
                row.0 = row.0.map(|x| 0.5 * x);
            }
            let seen = BoxRay::<Portable>::new(&entry);
            let (enters, found) = boxes.look(&seen, entry.sight.end[1]);
            assert_eq!(found & expected, expected, "{ray:?}");
            met += (found & !expected).count_ones();
            #[cfg(target_arch = "x86_64")]
            if let Isa::Avx2(present) = Isa::detect() {
                let there = super::super::simd::avx2::boxes(present, &boxes, &entry, entry.sight.end[1]);
                assert_eq!(there, (enters.row(), found));
            }
        }
        assert!(rays > 10_000 && 10 * met < others, "{met} of {others} boxes elsewhere are met by {rays} rays");
    }

    #[test]
    fn a_flat_box_is_not_met_by_a_ray_that_leaves_it() {
        let mut random = Random::new(33);
        let frame = Frame::new(&Aabb { min: Vec3::NEG_ONE, max: Vec3::ONE });
        for _ in 0..2000 {
            let floor = random.in_cube().y * 0.5;
            let origin = Vec3::new(0.3, floor.next_up(), 0.1);
            let direction = random.in_cube() + Vec3::Y * 1.001;
            let ray = Ray::new(origin, direction).intake().expect("a ray");
            let Start::Inside(entry) = frame.enter(&ray, None) else { panic!("{ray:?} begins inside") };
            let mut boxes = Boxes::NONE;
            for lane in 0..8 {
                let height = 0.5 * if lane == 7 { origin.y } else { floor };
                boxes.set(lane, &[[-0.5, height, -0.5], [0.5, height, 0.5]]);
            }
            let (_, met) = boxes.look(&BoxRay::<Portable>::new(&entry), f32::INFINITY);
            assert_eq!(met, 0x80, "only the one that the ray begins on: {ray:?}");
        }
    }
}
