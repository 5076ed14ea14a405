//! The last stage in whole numbers, for rays and triangles whose coordinates 128 bits can hold.
//!
//! Every f32 is a whole number times a power of two. Where the coordinates of a ray and a triangle are so close in size
//! that, over a common power, products of three of them fit an `i128`, all predicates of [`super::exact`] are integer
//! arithmetic: some 50 ns, where expansions take ten times as long. That is so for nearly every triangle that is met in
//! practice, and above all for the small integers of lattices, which are the ones that leave most ties.

use super::Triangle;
use crate::ray::Ray;
use glam::Vec3;
use std::cmp::Ordering;

/// `mantissa * 2^exponent` exactly, the mantissa odd; `(0, i32::MAX)` for zero. `x` is finite.
pub(super) fn parts(x: f32) -> (i64, i32) {
    let bits = x.to_bits();
    let (fraction, biased) = (i64::from(bits & 0x7f_ffff), (bits >> 23 & 0xff) as i32);
    let (mantissa, exponent) = if biased == 0 { (fraction, -149) } else { (fraction | 1 << 23, biased - 150) };
    if mantissa == 0 {
        return (0, i32::MAX);
    }
    let zeros = mantissa.trailing_zeros();
    let mantissa = mantissa >> zeros;
    (if x.is_sign_negative() { -mantissa } else { mantissa }, exponent + zeros as i32)
}

/// `mantissa * 2^exponent` exactly, the mantissa odd; `(0, 0)` for zero. `x` is finite.
pub(super) fn parts_of_f64(x: f64) -> (i64, i32) {
    let bits = x.to_bits();
    let (fraction, biased) = ((bits & 0xf_ffff_ffff_ffff) as i64, (bits >> 52 & 0x7ff) as i32);
    let (mantissa, exponent) = if biased == 0 { (fraction, -1074) } else { (fraction | 1 << 52, biased - 1075) };
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros();
    let mantissa = mantissa >> zeros;
    (if x.is_sign_negative() { -mantissa } else { mantissa }, exponent + zeros as i32)
}

/// `2^exponent` exactly, the exponent in -1022..=1023. The standard library's powers promise no precision.
pub(super) fn power_of_two(exponent: i32) -> f64 {
    debug_assert!((-1022..=1023).contains(&exponent), "2^{exponent} is no normal f64");
    f64::from_bits(((1023 + exponent) as u64) << 52)
}

/// `vectors` as whole numbers of at most 61 bits over the power of two that is returned; `None` if they do not fit.
pub(super) fn whole<const N: usize>(vectors: [Vec3; N]) -> Option<([[i64; 3]; N], i32)> {
    let split = vectors.map(|v| v.to_array().map(parts));
    let exponent = split.iter().flatten().map(|&(_, exponent)| exponent).min().filter(|&e| e != i32::MAX)?;
    let mut fits = true;
    let numbers = split.map(|v| {
        v.map(|(mantissa, own)| {
            if mantissa == 0 {
                return 0;
            }
            // At most 24 bits in the mantissa.
            let shift = own - exponent;
            fits &= shift <= 37;
            if shift <= 37 { mantissa << shift } else { 0 }
        })
    });
    fits.then_some((numbers, exponent))
}

pub(super) fn subtract(p: [i64; 3], q: [i64; 3]) -> [i64; 3] {
    [p[0] - q[0], p[1] - q[1], p[2] - q[2]]
}

/// Bits of the greatest component.
pub(super) fn bits(v: &[i64; 3]) -> u32 {
    64 - (v[0].unsigned_abs() | v[1].unsigned_abs() | v[2].unsigned_abs()).leading_zeros()
}

/// `a . (b x c)`. The bits of the three vectors add up to 123 at most: six products, none beyond 2^123.
pub(super) fn triple(a: &[i64; 3], b: &[i64; 3], c: &[i64; 3]) -> i128 {
    let minor = |j: usize, k: usize| i128::from(b[j]) * i128::from(c[k]) - i128::from(b[k]) * i128::from(c[j]);
    i128::from(a[0]) * minor(1, 2) + i128::from(a[1]) * minor(2, 0) + i128::from(a[2]) * minor(0, 1)
}

/// A ray and a triangle in whole numbers.
pub(super) struct Whole {
    direction: [i64; 3],
    /// Corners as seen from the origin.
    corners: [[i64; 3]; 3],
    /// The parameter counts in 2 to this power.
    exponent: i32,
}

impl Whole {
    /// `None` if 128 bits do not hold what is to be computed, or a coordinate is not finite.
    pub fn new(ray: &Ray, corners: &Triangle) -> Option<Self> {
        let [a, b, c] = *corners;
        if !(a.is_finite() && b.is_finite() && c.is_finite()) {
            return None;
        }
        let ([origin, a, b, c], place) = whole([ray.origin, a, b, c])?;
        let ([direction], pace) = whole([ray.direction])?;
        let corners = [a, b, c].map(|p| subtract(p, origin));
        // Differences of numbers below 2^62 fit; an edge is a difference of those, within 2^63.
        let reach = corners.iter().map(bits).max().unwrap_or(0);
        let edge = (0..3).map(|i| bits(&subtract(corners[(i + 1) % 3], corners[i]))).max().unwrap_or(0);
        let fits = bits(&direction) + edge + reach.max(edge) <= 123 && reach + 2 * edge <= 123;
        fits.then_some(Self { direction, corners, exponent: place - pace })
    }

    /// Sign of the edge function opposite to corner `i`: `d . ((to - from) x from)`.
    pub fn side(&self, i: usize) -> i32 {
        let (from, to) = (&self.corners[(i + 1) % 3], &self.corners[(i + 2) % 3]);
        triple(&self.direction, &subtract(*to, *from), from).signum() as i32
    }

    /// Where the ray's line meets the triangle's plane; `None` if the triangle is degenerate or parallel to the ray.
    pub fn of_plane(&self) -> Option<Quotient> {
        let [a, b, c] = &self.corners;
        let (ab, ac) = (subtract(*b, *a), subtract(*c, *a));
        let (numerator, denominator) = (triple(a, &ab, &ac), triple(&self.direction, &ab, &ac));
        let exponent = self.exponent;
        match denominator.signum() {
            0 => None,
            1 => Some(Quotient { numerator, denominator, exponent }),
            _ => Some(Quotient { numerator: -numerator, denominator: -denominator, exponent }),
        }
    }
}

/// `numerator / denominator * 2^exponent`, the denominator above zero; both below 2^126.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quotient {
    pub numerator: i128,
    pub denominator: i128,
    pub exponent: i32,
}

impl Quotient {
    /// The quotient, within 2^-51 of itself: two conversions and a division. The power of two is exact.
    pub fn estimate(&self) -> f64 {
        self.numerator as f64 / self.denominator as f64 * power_of_two(self.exponent)
    }

    /// Compares with another quotient.
    pub fn cmp_quotient(&self, other: &Self) -> Ordering {
        let ours = Product::new(self.numerator, other.denominator, self.exponent);
        ours.cmp_product(&Product::new(other.numerator, self.denominator, other.exponent))
    }

    /// Compares with a finite number.
    pub fn cmp_finite(&self, t: f64) -> Ordering {
        let (mantissa, power) = parts_of_f64(t);
        let theirs = Product::new(mantissa.into(), self.denominator, power);
        Product::new(self.numerator, 1, self.exponent).cmp_product(&theirs)
    }
}

/// `sign * (high * 2^128 + low) * 2^exponent`.
struct Product {
    sign: i32,
    high: u128,
    low: u128,
    exponent: i32,
}

impl Product {
    fn new(a: i128, b: i128, exponent: i32) -> Self {
        const HALF: u128 = u64::MAX as u128;
        let sign = (a.signum() * b.signum()) as i32;
        let (a, b) = (a.unsigned_abs(), b.unsigned_abs());
        let ((a1, a0), (b1, b0)) = ((a >> 64, a & HALF), (b >> 64, b & HALF));
        let (least, left, right) = (a0 * b0, a1 * b0, a0 * b1);
        // Three numbers below 2^64: no overflow.
        let middle = (least >> 64) + (left & HALF) + (right & HALF);
        let high = a1 * b1 + (left >> 64) + (right >> 64) + (middle >> 64);
        Self { sign, high, low: least & HALF | middle << 64, exponent }
    }

    /// Number of bits.
    fn length(&self) -> i32 {
        256 - if self.high != 0 { self.high.leading_zeros() } else { 128 + self.low.leading_zeros() } as i32
    }

    /// The digits times `2^by`; nothing is lost.
    fn shifted(&self, by: u32) -> (u128, u128) {
        match by {
            0 => (self.high, self.low),
            1..128 => (self.high << by | self.low >> (128 - by), self.low << by),
            _ => (self.low << (by - 128), 0),
        }
    }

    fn cmp_product(&self, other: &Self) -> Ordering {
        if self.sign != other.sign || self.sign == 0 {
            return self.sign.cmp(&other.sign);
        }
        // Where the first bits stand alike, the shift to a common exponent is no longer than the difference in length.
        let sizes = (self.length() + self.exponent).cmp(&(other.length() + other.exponent)).then_with(|| {
            let gap = self.exponent - other.exponent;
            let (ours, theirs) = (gap.max(0) as u32, (-gap).max(0) as u32);
            self.shifted(ours).cmp(&other.shifted(theirs))
        });
        if self.sign > 0 { sizes } else { sizes.reverse() }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_taken_apart_exactly() {
        for x in [1.0, -1.5, 0.1, -3e38, 1e-45, f32::MIN_POSITIVE, f32::MAX, 16_777_215.0, -96.0] {
            let (mantissa, exponent) = parts(x);
            assert_eq!(mantissa as f64 * power_of_two(exponent), f64::from(x), "{x}");
            assert_eq!(mantissa & 1, 1, "{x}");
        }
        assert_eq!((parts(0.0).0, parts(-0.0).0), (0, 0));
        for x in [1.0, -1.5, 0.1, -3e300, f64::MIN_POSITIVE, f64::MAX, -96.0] {
            let (mantissa, exponent) = parts_of_f64(x);
            assert_eq!(mantissa as f64 * power_of_two(exponent), x, "{x}");
            assert_eq!(mantissa & 1, 1, "{x}");
        }
        assert_eq!([-1022, -1, 0, 1, 1023].map(power_of_two), [f64::MIN_POSITIVE, 0.5, 1.0, 2.0, 8.98846567431158e307]);
        assert_eq!((parts_of_f64(5e-324), parts_of_f64(-0.0)), ((1, -1074), (0, 0)));
        assert!(whole([Vec3::new(1.0, 1e-20, 0.0)]).is_none());
        assert_eq!(whole([Vec3::new(1.5, -3.0, 0.0)]), Some(([[3, -6, 0]], -1)));
    }

    #[test]
    fn products_of_256_bits_are_compared_as_numbers() {
        let big = (1i128 << 126) - 1;
        let of = |a, b, e| Product::new(a, b, e);
        assert_eq!(of(big, big, 0).cmp_product(&of(big, big - 1, 0)), Ordering::Greater);
        assert_eq!(of(-big, big, 0).cmp_product(&of(-big, big - 1, 0)), Ordering::Less);
        // (2^126 - 1)^2 = 2^252 - 2^127 + 1
        let square = of(big, big, 0);
        assert_eq!((square.high, square.low), ((1 << 124) - 1, (1 << 127) + 1));
        assert_eq!(of(3, 5, 200).cmp_product(&of(15 << 100, 1, 100)), Ordering::Equal);
        assert_eq!(of(3, 5, 200).cmp_product(&of((15 << 100) + 1, 1, 100)), Ordering::Less);
        assert_eq!(of(0, 5, 200).cmp_product(&of(0, -7, -200)), Ordering::Equal);
        assert_eq!(of(1, 1, -276).cmp_product(&of(1, 1, 276)), Ordering::Less);
        assert_eq!(of(1, 1, -1).cmp_product(&of(-1, 1, 1)), Ordering::Greater);
    }

    #[test]
    fn quotients_are_compared_with_numbers() {
        let third = Quotient { numerator: 1, denominator: 3, exponent: 0 };
        assert_eq!(third.cmp_finite(1.0 / 3.0), Ordering::Greater); // the nearest f64 lies below
        assert_eq!(third.cmp_finite((1.0f64 / 3.0).next_up()), Ordering::Less);
        assert_eq!(third.cmp_finite(-1.0), Ordering::Greater);
        let same = Quotient { numerator: 1 << 100, denominator: 3 << 90, exponent: -10 };
        assert_eq!(third.cmp_quotient(&same), Ordering::Equal);
        assert_eq!(Quotient { numerator: -3, denominator: 4, exponent: 5 }.cmp_finite(-24.0), Ordering::Equal);
        assert_eq!(Quotient { numerator: 0, denominator: 4, exponent: 5 }.cmp_finite(-0.0), Ordering::Equal);
    }
}
