//! The last stage: signs, order and range decided in exact arithmetic.
//!
//! With `A`, `B`, `C` the corners as seen from the origin, a ray meets a triangle if `U = d . ((C - B) x B)`,
//! `V = d . ((A - C) x C)` and `W = d . ((B - A) x A)` are all `>= 0` or all `<= 0` and `d . n` is not 0, where
//! `n = (B - A) x (C - A)`; it does so at `t = (A . n) / (d . n)`. All of these are polynomials of degree 3 in the
//! inputs, and [`super::expansion`] evaluates them without error.

use super::Triangle;
use super::expansion::{Difference, Expansion, difference, triple};
use crate::ray::Ray;
use glam::Vec3;
use std::cmp::Ordering;

/// Relative error of [`Crossing::estimate`]: 2^-50 for each of numerator and denominator, 2^-53 for the division.
const ESTIMATE_ERROR: f64 = 1.0 / (1u64 << 48) as f64;

/// `p - q` exactly.
fn subtract(p: Vec3, q: Vec3) -> [Difference; 3] {
    [difference(p.x, q.x), difference(p.y, q.y), difference(p.z, q.z)]
}

/// The exact parameter of a ray on the plane of a triangle, as a quotient.
#[derive(Clone, Debug)]
pub(crate) struct Crossing {
    numerator: Expansion,
    /// Above zero.
    denominator: Expansion,
}

impl Crossing {
    /// Where the ray's line meets the closed triangle, whatever the range; `None` if it does not, or the triangle is
    /// degenerate, parallel to the ray or not finite.
    pub fn of_triangle(ray: &Ray, corners: &Triangle) -> Option<Self> {
        let crossing = Self::of_plane(ray, corners)?;
        let d = subtract(ray.direction, Vec3::ZERO);
        let mut signs = (false, false);
        for i in 0..3 {
            // (C - B) x B is B's moment about the origin along the edge from B to C.
            let (from, to) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
            let sign = triple(&d, &subtract(to, from), &subtract(from, ray.origin)).sign();
            signs = (signs.0 || sign < 0, signs.1 || sign > 0);
        }
        (signs != (true, true)).then_some(crossing)
    }

    /// Where the ray's line meets the triangle's plane; `None` if the triangle is degenerate, parallel to the ray or
    /// not finite.
    pub fn of_plane(ray: &Ray, corners: &Triangle) -> Option<Self> {
        let [a, b, c] = *corners;
        if !(a.is_finite() && b.is_finite() && c.is_finite()) {
            return None;
        }
        let (ab, ac) = (subtract(b, a), subtract(c, a));
        let mut denominator = triple(&subtract(ray.direction, Vec3::ZERO), &ab, &ac);
        let sign = denominator.sign();
        if sign == 0 {
            return None;
        }
        let mut numerator = triple(&subtract(a, ray.origin), &ab, &ac);
        if sign < 0 {
            numerator.negate();
            denominator.negate();
        }
        Some(Self { numerator, denominator })
    }

    /// The quotient and a bound on its error.
    pub fn estimate(&self) -> (f64, f64) {
        let t = self.numerator.estimate() / self.denominator.estimate();
        (t, t.abs() * ESTIMATE_ERROR)
    }

    /// Compares with `t`, a multiple of 2^-620 below 2^400 or infinite, so that no product leaves f64's range.
    pub fn cmp_parameter(&self, t: f64) -> Ordering {
        if t.is_infinite() {
            return 0f64.total_cmp(&t);
        }
        let mut gap = self.numerator.clone();
        gap.add_product(-1.0, &[t], self.denominator.terms());
        gap.sign().cmp(&0)
    }

    /// Compares with another crossing.
    pub fn cmp_crossing(&self, other: &Self) -> Ordering {
        let mut gap = Expansion::zero();
        gap.add_product(1.0, self.numerator.terms(), other.denominator.terms());
        gap.add_product(-1.0, other.numerator.terms(), self.denominator.terms());
        gap.sign().cmp(&0)
    }

    /// True if the parameter lies in the ray's range, ends included.
    pub fn in_range(&self, ray: &Ray) -> bool {
        self.cmp_parameter(f64::from(ray.t_min)).is_ge() && self.cmp_parameter(f64::from(ray.t_max)).is_le()
    }

    /// The nearest f32, ties to even; `inf` or `-inf` from the middle of the greatest f32 and 2^128 on; never -0.
    pub fn round(&self) -> f32 {
        // 2^128 stands for the infinities here: it is what f32 would have next.
        let wide = |x: f32| if x.is_infinite() { 2f64.powi(128).copysign(f64::from(x)) } else { f64::from(x) };
        let mut nearest = self.estimate().0 as f32;
        loop {
            let (below, above) = (nearest.next_down(), nearest.next_up());
            // At a middle itself the value with the even last bit wins.
            let odd = nearest.to_bits() & 1 == 1;
            // Middles of neighbours are multiples of 2^-150 with 25 bits: exact in f64.
            let middle = |x: f32, y: f32| (wide(x) + wide(y)) / 2.0;
            if nearest > f32::NEG_INFINITY && self.lies(Ordering::Less, middle(below, nearest), odd) {
                nearest = below;
            } else if nearest < f32::INFINITY && self.lies(Ordering::Greater, middle(nearest, above), odd) {
                nearest = above;
            } else {
                return nearest + 0.0; // -0 becomes 0
            }
        }
    }

    /// True if the parameter is on the given side of `t`, or at `t` where that counts too.
    fn lies(&self, side: Ordering, t: f64, or_at: bool) -> bool {
        let order = self.cmp_parameter(t);
        order == side || (or_at && order == Ordering::Equal)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fixed(numerator: f64, denominator: f64) -> Crossing {
        let of = |x| {
            let mut e = Expansion::zero();
            e.add(x);
            e
        };
        Crossing { numerator: of(numerator), denominator: of(denominator) }
    }

    #[test]
    fn rounding_agrees_with_hardware_where_the_quotient_is_exact() {
        let least = f64::from(f32::from_bits(1));
        let max = f64::from(f32::MAX);
        let beyond = max + 2f64.powi(103); // midway to 2^128: ties to even, which is infinity
        for t in [
            0.0,
            1.0,
            -1.0,
            0.1,
            -0.1,
            least,
            0.5 * least,
            0.75 * least,
            1.5 * least,
            2.5 * least,
            -0.5 * least,
            max,
            beyond,
            -beyond,
            beyond.next_down(),
            1e39,
            -1e300,
            16_777_217.0,
            16_777_219.0,
            -33_554_434.0,
            f64::from(f32::MIN_POSITIVE).next_down(),
        ] {
            assert_eq!(fixed(t, 1.0).round().to_bits(), (t as f32 + 0.0).to_bits(), "{t:e}");
        }
        assert_eq!(fixed(1.0, 3.0).round(), 1.0 / 3.0);
    }

    #[test]
    fn rounding_sees_what_the_estimate_cannot() {
        // 1 + 2^-24 is midway between 1 and its successor; 2^-200 more or less decides.
        for (tail, expected) in [(-2f64.powi(-200), 1.0), (0.0, 1.0), (2f64.powi(-200), 1.0 + f32::EPSILON)] {
            let mut crossing = fixed(1.0 + 2f64.powi(-24), 1.0);
            crossing.numerator.add(tail);
            assert_eq!(crossing.round(), expected, "{tail:e}");
        }
    }

    #[test]
    fn order_is_that_of_the_quotients() {
        let third = fixed(1.0, 3.0);
        assert_eq!(third.cmp_crossing(&fixed(2.0, 6.0)), Ordering::Equal);
        assert_eq!(third.cmp_crossing(&fixed(2f64.powi(60) + 512.0, 3.0 * 2f64.powi(60))), Ordering::Less);
        assert_eq!(third.cmp_parameter(1.0 / 3.0), Ordering::Greater); // the nearest f64 lies below
        assert_eq!(third.cmp_parameter(f64::INFINITY), Ordering::Less);
        assert_eq!(third.cmp_parameter(f64::NEG_INFINITY), Ordering::Greater);
        assert_eq!(fixed(0.0, 3.0).cmp_parameter(-0.0), Ordering::Equal);
    }
}
