//! Boxes around the packs of a leaf: eight are asked at once which of their packs a ray may meet.
//!
//! A test of eight boxes takes half as long as that of one pack. So a leaf may hold dozens of primitives, cells need not be
//! cut as finely, and fewer primitives are listed in more than one.
//!
//! **Why nothing is lost.** A box holds what its primitives have in the cell, padded by [`PADDING`] twice: once where the cell cuts them off, as
//! walks come as near to a cell as that, and once on all sides. The walk's ray at an `s` is off by less than `4 e` along each axis (see `frame`), and so is the
//! plane of a box with its rounding. Where the hit is at an `s` of at most 4, the computed crossing of a plane before it is at most `s + 12 e - 54 e
//! / |d|` with `|d| <= 1`, thus before it, and one behind it is behind it: the box is met, at that `s` as well.

use super::frame::PADDING;
use super::lanes::{Lanes, Row, Vector};

/// A box: its least and its greatest corner.
pub(super) type Bounds = [[f32; 3]; 2];

/// Boxes of eight packs that follow one another.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Boxes {
    /// Least and greatest coordinates along each axis; a lane that holds none has them the wrong way round.
    pub planes: [[Row; 3]; 2],
    /// The first of the packs.
    pub first: u32,
}

/// A ray as boxes see it, in a part's coordinates.
#[derive(Clone, Copy)]
pub(super) struct BoxRay<S> {
    origin: Vector<S>,
    /// One over the components of the direction.
    inverse: Vector<S>,
    /// For each axis, which of the planes come first: 1 if the ray moves backwards.
    side: [usize; 3],
}

impl<S: Lanes> BoxRay<S> {
    /// The ray from `origin`, `inverse` being one over the sizes of its direction's components and `sign` their signs.
    #[inline(always)]
    pub fn new(origin: &[f32; 3], inverse: &[f32; 3], sign: &[f32; 3]) -> Self {
        let mut signed = [0.0; 3];
        let mut side = [0; 3];
        for a in 0..3 {
            signed[a] = inverse[a] * sign[a];
            side[a] = usize::from(sign[a] < 0.0);
        }
        Self { origin: Vector::splat(origin), inverse: Vector::splat(&signed), side }
    }
}

impl Boxes {
    /// No boxes, of packs from `first` on.
    pub fn new(first: u32) -> Self {
        Self { planes: [[Row([f32::INFINITY; 8]); 3], [Row([f32::NEG_INFINITY; 8]); 3]], first }
    }

    /// Boxes that every ray meets, of eight packs from `first` on, or as many as there are before `end`.
    pub fn around_all(first: usize, end: usize) -> Self {
        let mut boxes = Self::new(first as u32);
        for lane in 0..8.min(end - first) {
            boxes.add(lane, &[[f32::NEG_INFINITY; 3], [f32::INFINITY; 3]]);
        }
        boxes
    }

    /// Puts a box around that of a lane and `bounds`.
    pub fn add(&mut self, lane: usize, [low, high]: &Bounds) {
        for a in 0..3 {
            let (least, most) = (&mut self.planes[0][a].0[lane & 7], low[a] - PADDING);
            *least = least.min(most);
            let (greatest, most) = (&mut self.planes[1][a].0[lane & 7], high[a] + PADDING);
            *greatest = greatest.max(most);
        }
    }

    /// Where the ray enters each box, and the boxes that it meets at an `s` of 0 to `end`.
    #[inline(always)]
    pub fn look<S: Lanes>(&self, ray: &BoxRay<S>, end: f32) -> (S, u32) {
        let [x, y, z] = ray.side;
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
        let (near, far) = (near.minus(&ray.origin), far.minus(&ray.origin));
        let enters = (near.x * ray.inverse.x).max(near.y * ray.inverse.y).max(near.z * ray.inverse.z);
        let leaves = (far.x * ray.inverse.x).min(far.y * ray.inverse.y).min(far.z * ray.inverse.z);
        let misses = leaves.less(enters.max(S::splat(0.0))) | S::splat(end).less(enters);
        (enters, !S::bits(misses) & 0xff)
    }
}

/// Sorts places in `members`, the lower halves of `order`, so that any eight from a multiple of eight on are near one another, and any 64 from a
/// multiple of 64 on. The upper halves are of no meaning.
pub(super) fn sort(order: &mut [u64], members: &[Bounds]) {
    if order.len() <= 8 {
        return;
    }
    // Twice the middle: nothing to divide.
    let middle = |place: u64, a: usize| {
        let [low, high] = &members[place as u32 as usize];
        low[a] + high[a]
    };
    let (mut least, mut greatest) = ([f32::INFINITY; 3], [f32::NEG_INFINITY; 3]);
    for &place in &*order {
        for a in 0..3 {
            let middle = middle(place, a);
            least[a] = least[a].min(middle);
            greatest[a] = greatest[a].max(middle);
        }
    }
    let long = |a: usize| greatest[a] - least[a];
    let axis = if long(0) >= long(1) && long(0) >= long(2) { 0 } else { 1 + usize::from(long(2) > long(1)) };
    // Half of them, in whole packs.
    let half = order.len().div_ceil(2).next_multiple_of(if order.len() > 64 { 64 } else { 8 });
    if half >= order.len() {
        return;
    }
    for place in &mut *order {
        let bits = middle(*place, axis).to_bits();
        // Ascending as the numbers are.
        let key = if bits >> 31 != 0 { !bits } else { bits | 1 << 31 };
        *place = u64::from(key) << 32 | u64::from(*place as u32);
    }
    order.select_nth_unstable(half);
    let (before, behind) = order.split_at_mut(half);
    sort(before, members);
    sort(behind, members);
}

#[cfg(test)]
mod tests {
    use super::super::lanes::Portable;
    #[cfg(target_arch = "x86_64")]
    use super::super::simd::Isa;
    use super::*;
    use crate::geometry::tests::Random;

    #[test]
    fn eight_in_a_row_are_near_one_another() {
        let mut random = Random::new(31);
        for count in [1_usize, 8, 9, 20, 64, 65, 130, 1000] {
            let members: Vec<Bounds> = (0..count).map(|_| [random.in_cube().to_array(); 2]).collect();
            let mut order: Vec<u64> = (0..count as u64).collect();
            sort(&mut order, &members);
            let places: Vec<u32> = order.iter().map(|&place| place as u32).collect();
            let mut all = places.clone();
            all.sort_unstable();
            assert!(all.iter().copied().eq(0..count as u32), "all of {count} are there, once");
            let spread = |places: &[u32]| -> f32 {
                let of = |&i: &u32| glam::Vec3::from_array(members[i as usize][0]);
                let most = places.iter().map(of).fold(glam::Vec3::MIN, glam::Vec3::max);
                let least = places.iter().map(of).fold(glam::Vec3::MAX, glam::Vec3::min);
                (most - least).element_sum()
            };
            if count >= 64 {
                let sorted: f32 = places.chunks(8).map(spread).sum();
                let given: f32 = (0..count as u32).collect::<Vec<_>>().chunks(8).map(spread).sum();
                assert!(sorted < 0.75 * given, "{count}: {sorted} of {given}");
            }
        }
    }

    #[test]
    fn boxes_that_a_ray_meets_are_found_and_few_others() {
        let mut random = Random::new(32);
        let (mut met, mut others) = (0, 0);
        for round in 0..20_000 {
            let mut direction = random.in_cube();
            if round % 3 == 0 {
                direction[round % 7 % 3] *= 1e-9;
            }
            direction *= 0.9 / direction.abs().max_element();
            let s = random.unit() * 2.0;
            let size = direction.abs().map(|d| d.max(super::super::frame::LEAST));
            let sign = direction.map(|d| 1.0_f32.copysign(d));
            // A point of the ray, rounded; boxes are around it, or begin at it, or are elsewhere.
            let target = random.in_cube();
            let origin = target - direction * s;
            let mut boxes = Boxes::new(7);
            let mut expected = 0;
            for lane in 0..8 {
                let spread = random.in_cube().abs() * [0.0, 1e-6, 0.1][lane % 3];
                let aside = if lane > 5 { random.in_cube() * 3.0 } else { glam::Vec3::ZERO };
                let (low, high) = if round % 2 == 0 { (target, target + spread) } else { (target - spread, target) };
                boxes.add(lane, &[(low + aside).to_array(), (high + aside).to_array()]);
                expected |= u32::from(aside == glam::Vec3::ZERO) << lane;
            }
            let ray = [origin, size.map(|x| 1.0 / x), sign].map(|v| v.to_array());
            let seen = BoxRay::<Portable>::new(&ray[0], &ray[1], &ray[2]);
            let (enters, found) = boxes.look(&seen, 4.0);
            assert_eq!(found & expected, expected, "from {origin} along {direction} at {s}");
            (met, others) = (met + (found & 0xc0).count_ones(), others + 2);
            // Nothing begins before the ray, or behind its end.
            assert_eq!(boxes.look(&seen, -0.1).1, 0);
            #[cfg(target_arch = "x86_64")]
            if let Isa::Avx2(present) = Isa::detect() {
                let there = super::super::simd::avx2::boxes(present, &boxes, &ray, 4.0);
                assert_eq!(there, (enters.row(), found));
            }
        }
        assert!(10 * met < 3 * others, "{met} of {others} boxes elsewhere are met");
    }
}
