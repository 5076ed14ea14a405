//! Where a ray crosses the planes between voxels: a rounded parameter for speed, the exact order of any two for truth.
//!
//! Plane `k` of an axis with `n` voxels between `lo` and `hi` lies at `((n - k) lo + k hi) / n`, so a ray crosses it at
//! `t = N / D` with `N = (n - k) lo + k hi - n o` and `D = n d`. With f32 inputs and `n <= 4096` the three terms of `N` and
//! `D` have at most 24 + 13 bits each: all four are exact in f64. They are multiples of 2^-149 below 2^140, so the products
//! that [`Lines::order`] forms are multiples of 2^-298 below 2^284: neither they nor their rounding errors leave f64's range.
//!
//! Error of [`Time::t`], with u = 2^-53: by two exact sums, `N = s + e + f` with `s` the rounded sum of all three terms, `f`
//! its rounding error and `e` that of the sum of the first two, `|e| <= u |r|` where `r` is that sum. If `r` and `n o` are
//! within a factor of two of each other, their difference `s` is exact, so `f = 0` and `N = s + e` is rounded once. If not,
//! `|s| >= |r| / 2`, so `e` is at most 2u of `s`, and rounding `f + e` first costs a few u^2 only. Either way the rounded `N`
//! is off by `u + 4u^2` relative, so its sign is right and 0 means 0; the division adds another u: 2^-52 in all, with
//! less than 2^-102 above it.

use crate::geometry::expansion::{Expansion, two_sum};
use crate::ray::{Aabb, Ray};
use std::cmp::Ordering;

/// Stands for infinity: crossings lie below 2^292 (a multiple of 2^-149 below 2^143 over another).
const FAR: f64 = 1e300;

/// Two parameters that differ by more than this times the sum of their magnitudes are surely in order: twice their errors,
/// which covers the rounding of the comparison itself.
const CLOSE: f64 = 1.0 / (1u64 << 51) as f64;

/// A parameter of the ray: a rounded one, and what it stands for exactly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Time {
    /// Within 2^-52 of the exact value, relative; exact if it was given.
    pub t: f64,
    at: At,
}

/// What a [`Time`] is exactly.
#[derive(Clone, Copy, Debug)]
enum At {
    /// `t` itself.
    Given,
    /// The crossing of this plane of this axis.
    Plane { axis: usize, plane: u32 },
}

impl Time {
    /// Later than every crossing.
    pub const NEVER: Time = Time { t: FAR, at: At::Given };

    /// An end of the ray's range.
    pub fn given(t: f32) -> Self {
        Self { t: f64::from(t).clamp(-FAR, FAR), at: At::Given }
    }

    /// The axis whose plane is crossed, if any is.
    pub fn axis(&self) -> Option<usize> {
        match self.at {
            At::Given => None,
            At::Plane { axis, .. } => Some(axis),
        }
    }
}

/// A ray and the planes of a grid along one axis. All values are exact.
#[derive(Clone, Copy, Debug)]
struct Line {
    /// The faces of the grid.
    lo: f64,
    hi: f64,
    /// Voxels.
    n: f64,
    /// `n` times the ray's origin.
    start: f64,
    /// `n` times the ray's direction.
    rate: f64,
}

impl Line {
    /// `N` of the plane, exactly: the sum of the three.
    #[inline]
    fn numerator(&self, plane: u32) -> [f64; 3] {
        let k = f64::from(plane);
        let (position, e) = two_sum((self.n - k) * self.lo, k * self.hi);
        let (gap, f) = two_sum(position, -self.start);
        [e, f, gap]
    }

    /// `N` rounded: how far the plane lies before the origin, times `n`. The sign is exact.
    #[inline]
    fn gap(&self, plane: u32) -> f64 {
        let [e, f, gap] = self.numerator(plane);
        gap + (f + e)
    }
}

/// A ray and the planes of a grid.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lines([Line; 3]);

impl Lines {
    /// `ray` comes from [`Ray::intake`], `bounds` is finite and not empty, `resolution` at most 4096.
    pub fn new(bounds: &Aabb, resolution: [u32; 3], ray: &Ray) -> Self {
        Self([0, 1, 2].map(|axis| {
            let n = f64::from(resolution[axis]);
            Line {
                lo: f64::from(bounds.min[axis]),
                hi: f64::from(bounds.max[axis]),
                n,
                start: n * f64::from(ray.origin[axis]),
                rate: n * f64::from(ray.direction[axis]),
            }
        }))
    }

    /// Whether the ray moves up an axis, down, or not at all: `Greater`, `Less`, `Equal`.
    #[inline]
    pub fn sense(&self, axis: usize) -> Ordering {
        let rate = self.0[axis].rate;
        if rate > 0.0 {
            Ordering::Greater
        } else if rate < 0.0 {
            Ordering::Less
        } else {
            Ordering::Equal
        }
    }

    /// Where the ray crosses a plane of an axis along which it moves.
    #[inline]
    pub fn crossing(&self, axis: usize, plane: u32) -> Time {
        let line = &self.0[axis];
        // + 0.0: a crossing at the origin is at 0, not at -0.
        Time { t: line.gap(plane) / line.rate + 0.0, at: At::Plane { axis, plane } }
    }

    /// The exact order of two parameters.
    #[inline]
    pub fn order(&self, a: &Time, b: &Time) -> Ordering {
        let gap = a.t - b.t;
        if gap.abs() > CLOSE * (a.t.abs() + b.t.abs()) {
            return if gap < 0.0 { Ordering::Less } else { Ordering::Greater };
        }
        self.order_exactly(a, b)
    }

    #[cold]
    fn order_exactly(&self, a: &Time, b: &Time) -> Ordering {
        match (a.at, b.at) {
            (At::Given, At::Given) => a.t.partial_cmp(&b.t).unwrap_or(Ordering::Equal), // neither is NaN
            (At::Given, At::Plane { axis, plane }) => self.order_parameter(axis, plane, a.t).reverse(),
            (At::Plane { axis, plane }, At::Given) => self.order_parameter(axis, plane, b.t),
            (At::Plane { axis: i, plane: k }, At::Plane { axis: j, plane: m }) => {
                // N_i / D_i - N_j / D_j has the sign of N_i D_j - N_j D_i, turned once for each denominator below 0.
                let (a, b) = (&self.0[i], &self.0[j]);
                let mut difference = Expansion::zero();
                difference.add_product(1.0, &a.numerator(k), &[b.rate]);
                difference.add_product(-1.0, &b.numerator(m), &[a.rate]);
                turned(difference.sign(), (a.rate < 0.0) != (b.rate < 0.0))
            }
        }
    }

    /// The order of a crossing and a parameter that is an f32 or [`FAR`] away, which is not compared here.
    fn order_parameter(&self, axis: usize, plane: u32, t: f64) -> Ordering {
        let line = &self.0[axis];
        let mut difference = Expansion::zero();
        line.numerator(plane).iter().for_each(|&term| difference.add(term));
        difference.add_product(-1.0, &[t], &[line.rate]);
        turned(difference.sign(), line.rate < 0.0)
    }

    /// The voxel of an axis in which the ray is at `time`, a parameter at which it is in the grid. A voxel holds its lower
    /// face, the last one its upper face too.
    pub fn voxel(&self, axis: usize, time: &Time) -> u32 {
        let line = &self.0[axis];
        let n = line.n as u32; // 1 to 4096
        let below = |plane: u32| match self.sense(axis) {
            Ordering::Equal => line.gap(plane) <= 0.0,
            Ordering::Greater => self.order(&self.crossing(axis, plane), time).is_le(),
            Ordering::Less => self.order(&self.crossing(axis, plane), time).is_ge(),
        };
        // Planes `1..n` lie below the point up to some plane and above from there on: that one's number is the voxel's.
        let position = (line.start + time.t * line.rate - line.n * line.lo) / (line.hi - line.lo);
        let guess = (position as u32).min(n - 1); // `as` saturates, NaN becomes 0
        if (guess == 0 || below(guess)) && (guess + 1 == n || !below(guess + 1)) {
            return guess;
        }
        let (mut low, mut high) = (0, n);
        while high - low > 1 {
            let middle = low.midpoint(high);
            if below(middle) { low = middle } else { high = middle }
        }
        low
    }
}

/// The sign as an order, reversed if `turn`.
fn turned(sign: i32, turn: bool) -> Ordering {
    if turn { 0.cmp(&sign) } else { sign.cmp(&0) }
}
