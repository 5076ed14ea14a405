//! Numbers `(p + s sqrt(q)) / a` of whole numbers: ray parameters without rounding.

use num_bigint::BigInt;
use std::cmp::Ordering;

/// `(rational + sign sqrt(square)) / denominator`, with `square >= 0` and `denominator > 0`.
#[derive(Clone, Debug)]
pub(super) struct Surd {
    rational: BigInt,
    /// -1, 0 or 1; 0 if `square` is.
    sign: i32,
    square: BigInt,
    denominator: BigInt,
}

impl Surd {
    /// `numerator / denominator * 2^shift`; `denominator` is not zero.
    pub fn ratio(numerator: BigInt, denominator: BigInt, shift: i32) -> Self {
        let (p, a) = if denominator < BigInt::ZERO { (-numerator, -denominator) } else { (numerator, denominator) };
        Self::new(p, 0, BigInt::ZERO, a, shift)
    }

    /// `(rational + sign sqrt(square)) / denominator * 2^shift`, the denominator above zero, the square not below.
    pub fn new(rational: BigInt, sign: i32, square: BigInt, denominator: BigInt, shift: i32) -> Self {
        debug_assert!(denominator > BigInt::ZERO && square >= BigInt::ZERO);
        let sign = if square == BigInt::ZERO { 0 } else { sign };
        if shift >= 0 {
            Self { rational: rational << shift, sign, square: square << (2 * shift), denominator }
        } else {
            Self { rational, sign, square, denominator: denominator << -shift }
        }
    }

    /// The order of two such numbers, found by squaring until no root is left.
    pub fn order(&self, other: &Self) -> Ordering {
        let difference = &self.rational * &other.denominator - &other.rational * &self.denominator;
        if self.sign == 0 && other.sign == 0 {
            return difference.cmp(&BigInt::ZERO);
        }
        let mine = &self.square * (&other.denominator * &other.denominator);
        let theirs = &other.square * (&self.denominator * &self.denominator);
        sign_of_sum(&difference, self.sign, &mine, -other.sign, &theirs)
    }

    /// The nearest f32, ties to even; infinite from half a unit beyond the greatest one on.
    pub fn to_f32(&self) -> f32 {
        // At most 24 bits: the f64 is exact, and too great where the f32 is.
        self.round(24, 149) as f32
    }

    /// The nearest f64, ties to even; infinite beyond the greatest one.
    pub fn to_f64(&self) -> f64 {
        self.round(53, 1074)
    }

    /// Rounded to `precision` bits, and to a multiple of `2^-finest`.
    fn round(&self, precision: i64, finest: i64) -> f64 {
        match sign_of_sum(&self.rational, self.sign, &self.square, 0, &BigInt::ZERO) {
            Ordering::Equal => return 0.0,
            Ordering::Less => {
                let negated = Self { rational: -&self.rational, sign: -self.sign, ..self.clone() };
                return -negated.round(precision, finest);
            }
            Ordering::Greater => {}
        }
        // Enough bits to see how great the number is. A difference of nearly equal terms takes more than one attempt.
        let mut scale = self.denominator.bits() as i64 + 64;
        let magnitude = loop {
            let bits = self.floor(scale).0.bits() as i64;
            if bits > 0 {
                break bits - scale;
            }
            scale *= 2;
        };
        // The number lies between 2^(magnitude - 1) and 2^magnitude. One bit more than asked for decides the half.
        let scale = (precision - magnitude).min(finest);
        let (mut mantissa, whole) = self.floor(scale + 1);
        let half = mantissa.bit(0);
        mantissa >>= 1;
        if half && (!whole || mantissa.bit(0)) {
            mantissa += 1;
        }
        let Ok(mantissa) = u64::try_from(mantissa) else { unreachable!("at most {precision} bits and a carry") };
        times_power(mantissa as f64, -scale)
    }

    /// The whole part of `self * 2^scale`, and whether that is all of it. `self` is above zero.
    fn floor(&self, scale: i64) -> (BigInt, bool) {
        let (mut p, mut q, mut a) = (self.rational.clone(), self.square.clone(), self.denominator.clone());
        if scale >= 0 {
            p <<= scale;
            q <<= 2 * scale;
        } else {
            a <<= -scale;
        }
        // The whole part of (p + y) / a is that of (p + floor(y)) / a, whatever y is.
        let (root, whole) = if self.sign == 0 {
            (BigInt::ZERO, true)
        } else {
            let root = q.sqrt();
            let whole = &root * &root == q;
            (
                if self.sign > 0 {
                    root
                } else if whole {
                    -root
                } else {
                    -root - 1
                },
                whole,
            )
        };
        let sum = p + root;
        let quotient = &sum / &a;
        let whole = whole && &quotient * &a == sum;
        (quotient, whole)
    }
}

/// `x * 2^power`; the product is an f64, or too great for one.
fn times_power(x: f64, power: i64) -> f64 {
    // Powers of two within the range of normal numbers, one after the other; the result is exact, so is each product.
    let (mut x, mut left) = (x, power.clamp(-4000, 4000));
    while left != 0 {
        let step = left.clamp(-1000, 1000);
        x *= f64::from_bits(((1023 + step) as u64) << 52);
        left -= step;
    }
    x
}

/// The sign of `x + u sqrt(p) + v sqrt(q)`; `u` and `v` are -1, 0 or 1, `p` and `q` not below zero.
fn sign_of_sum(x: &BigInt, u: i32, p: &BigInt, v: i32, q: &BigInt) -> Ordering {
    let zero = BigInt::ZERO;
    let of = |s: i32, square: &BigInt| if *square == zero { 0 } else { s };
    let (u, v) = (of(u, p), of(v, q));
    // The sign of the roots' sum: of the greater one if they differ.
    let roots = match (u, v) {
        (0, v) => v.cmp(&0),
        (u, 0) => u.cmp(&0),
        (u, v) if u == v => u.cmp(&0),
        (u, _) => {
            if u > 0 {
                p.cmp(q)
            } else {
                q.cmp(p)
            }
        }
    };
    let rational = x.cmp(&zero);
    if rational == roots || roots.is_eq() {
        return rational;
    }
    if rational.is_eq() {
        return roots;
    }
    // Opposite signs: the greater square wins, x^2 against p + q + 2 u v sqrt(p q).
    let rest = x * x - if u == 0 { &zero } else { p } - if v == 0 { &zero } else { q };
    let squares = if u * v == 0 { rest.cmp(&zero) } else { sign_of_sum(&rest, -u * v, &(p * q * 4), 0, &zero) };
    if rational.is_gt() { squares } else { squares.reverse() }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn surd(p: i64, s: i32, q: i64, a: i64) -> Surd {
        Surd::new(p.into(), s, q.into(), a.into(), 0)
    }

    #[test]
    fn order_agrees_with_floating_point_and_finds_equal_ones() {
        // Differences of such small numbers are far above 1e-9 unless they are zero.
        let all: Vec<Surd> = (-3..=3)
            .flat_map(|p| (-1..=1).flat_map(move |s| (0..=9).map(move |q| (p, s, q))))
            .flat_map(|(p, s, q)| [1, 2, 3].map(|a| surd(p, s, q, a)))
            .collect();
        let value = |x: &Surd| {
            let part = |b: &BigInt| i64::try_from(b).unwrap() as f64;
            (part(&x.rational) + f64::from(x.sign) * part(&x.square).sqrt()) / part(&x.denominator)
        };
        let mut equal = 0;
        for x in &all {
            for y in &all {
                let difference = value(x) - value(y);
                let expected = if difference.abs() < 1e-9 { Ordering::Equal } else { difference.total_cmp(&0.0) };
                assert_eq!(x.order(y), expected, "{x:?} {y:?}");
                equal += usize::from(expected.is_eq());
            }
        }
        assert!(equal > 2 * all.len(), "{equal} pairs are equal");
    }

    #[test]
    fn order_sees_differences_beyond_all_rounding() {
        // sqrt(n^2 + 1) is above n by 1 / (2 n), at n = 2^500.
        let n: BigInt = BigInt::from(1) << 500;
        let near = Surd::new(BigInt::ZERO, 1, &n * &n + 1, 1.into(), 0);
        let whole = Surd::ratio(n.clone(), 1.into(), 0);
        assert_eq!(near.order(&whole), Ordering::Greater);
        let same = Surd::new(BigInt::ZERO, 1, &n * &n, 1.into(), 0);
        assert_eq!(same.order(&whole), Ordering::Equal);
        // Two roots against each other: sqrt(n^2 + 1) - 1 and sqrt(n^2 - 1).
        let below = Surd::new(BigInt::ZERO, 1, &n * &n - 1, 1.into(), 0);
        let less = Surd::new((-1).into(), 1, &n * &n + 1, 1.into(), 0);
        assert_eq!(less.order(&below), Ordering::Less);
        // And rounding sees it, too: n - sqrt(n^2 - 1) is just above 2^-501.
        let tiny = Surd::new(n.clone(), -1, &n * &n - 1, 1.into(), 0);
        assert_eq!(tiny.to_f64(), 2f64.powi(-501));
        assert_eq!(tiny.order(&Surd::ratio(1.into(), 1.into(), -501)), Ordering::Greater);
    }

    #[test]
    fn quotients_round_as_the_hardware_rounds_them() {
        // IEEE division of whole numbers below 2^53 is correctly rounded, to f64; and to f32 below 2^24.
        let mut state = 1u64;
        let mut next = || {
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            state >> 11
        };
        for _ in 0..5000 {
            let (shift, p, a) = (next() % 40, next(), next());
            let (p, a) = (p >> shift, (a >> (next() % 50)) | 1);
            let x = Surd::ratio(p.into(), a.into(), 0);
            assert_eq!(x.to_f64(), p as f64 / a as f64, "{p} / {a}");
            let (p, a) = ((p >> 29) as i64, (a >> 29 | 1) as i64);
            let x = Surd::ratio((-p).into(), a.into(), 0);
            assert_eq!(x.to_f32(), -(p as f32) / a as f32, "-{p} / {a}");
        }
    }

    #[test]
    fn ties_limits_and_roots_round_correctly() {
        let power = |p: u64, shift: i32| Surd::ratio(p.into(), 1.into(), shift);
        // Halfway between neighbours: to the even one; a hair beyond: away.
        assert_eq!(power((1 << 24) + 1, 0).to_f32(), 16_777_216.0);
        assert_eq!(power((1 << 24) + 3, 0).to_f32(), 16_777_220.0);
        let hair = Surd::new(((1 << 24) + 1).into(), 1, 1.into(), BigInt::from(1), 0);
        assert_eq!(hair.to_f32(), 16_777_218.0);
        let above = Surd::ratio((BigInt::from((1u64 << 24) + 1) << 600) + 1, BigInt::from(1) << 600, 0);
        assert_eq!(above.to_f32(), 16_777_218.0);
        let below = Surd::ratio((BigInt::from((1u64 << 24) + 3) << 600) - 1, BigInt::from(1) << 600, 0);
        assert_eq!(below.to_f32(), 16_777_218.0);
        // The ends of the range: half of the least is a tie with 0, the greatest ends half a unit beyond.
        assert_eq!(power(1, -150).to_f32(), 0.0);
        assert_eq!(power(3, -151).to_f32(), f32::from_bits(1));
        assert_eq!(power(3, -150).to_f32(), f32::from_bits(2));
        assert_eq!(power((1 << 25) - 1, 103).to_f32(), f32::INFINITY);
        assert_eq!(power((1 << 26) - 3, 102).to_f32(), f32::MAX);
        assert_eq!(power(1, -1075).to_f64(), 0.0);
        assert_eq!(power(3, -1075).to_f64(), f64::from_bits(2));
        assert_eq!(power(1, 1024).to_f64(), f64::INFINITY);
        assert_eq!(power(1, 5000).to_f32(), f32::INFINITY);
        assert_eq!(power(1, -5000).to_f64(), 0.0);
        // Roots: the f64 root of a small number is correctly rounded, too.
        for q in 0..2000 {
            assert_eq!(surd(0, 1, q, 1).to_f64(), (q as f64).sqrt());
            assert_eq!(surd(0, -1, q, 1).to_f64(), -(q as f64).sqrt());
        }
    }
}
