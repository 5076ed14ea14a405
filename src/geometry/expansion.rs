//! Exact sums and products of f64 values, held as sums of f64 values that do not overlap.
//!
//! Source: Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", 1997,
//! sections 2.1 to 2.4. Departs from it: products are split after Veltkamp and not made by a fused multiply-add, which
//! is a library call on processors that the compiler may not assume to have one.
//!
//! Results are exact if nothing overflows and every rounding error is representable. The callers' values come from f32
//! inputs, multiples of 2^-149 below 2^128: products of three differences are multiples of 2^-447 below 2^390, of six
//! multiples of 2^-894 below 2^780. Rounding errors are multiples of the same powers, so both conditions hold for
//! every finite input.

/// The sum and its rounding error: `a + b` exactly.
#[inline]
pub(crate) fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

/// Two parts of at most 26 bits each: `a` exactly.
#[inline]
fn split(a: f64) -> (f64, f64) {
    const FACTOR: f64 = 134_217_729.0; // 2^27 + 1
    let c = FACTOR * a;
    let high = c - (c - a);
    (high, a - high)
}

/// The product and its rounding error: `a * b` exactly.
#[inline]
pub(crate) fn two_product(a: f64, b: f64) -> (f64, f64) {
    let product = a * b;
    let ((a1, a0), (b1, b0)) = (split(a), split(b));
    (product, a0 * b0 - (((product - a1 * b1) - a0 * b1) - a1 * b0))
}

/// A difference of two inputs, exactly: the rounding error, then the rounded difference.
pub(crate) type Difference = [f64; 2];

/// `a - b` exactly.
#[inline]
pub(crate) fn difference(a: f32, b: f32) -> Difference {
    let (value, error) = two_sum(f64::from(a), -f64::from(b));
    [error, value]
}

/// A number as the sum of its terms: nonzero, none adjacent to the next in Shewchuk's sense, the least first.
#[derive(Clone, Debug, Default)]
pub(crate) struct Expansion {
    terms: Vec<f64>,
}

impl Expansion {
    /// Zero, with room for what three factors of like size usually need.
    pub fn zero() -> Self {
        Self { terms: Vec::with_capacity(12) }
    }

    /// `integer * scale` exactly; `scale` is a power of two, and `integer` below 2^127.
    pub fn of_integer(integer: i128, scale: f64) -> Self {
        let mut sum = Self::zero();
        let mut rest = integer;
        while rest != 0 {
            // The nearest f64 leaves a rest of 2^-53 of the whole: three rounds at most.
            let head = rest as f64;
            rest -= head as i128;
            sum.add(head * scale);
        }
        sum
    }

    /// The terms, least first; empty for zero.
    pub fn terms(&self) -> &[f64] {
        &self.terms
    }

    /// Adds `x` (Shewchuk's Grow-Expansion with zeros left out).
    #[inline]
    pub fn add(&mut self, x: f64) {
        let (mut carry, mut kept) = (x, 0);
        for i in 0..self.terms.len() {
            let (sum, error) = two_sum(carry, self.terms[i]);
            if error != 0.0 {
                self.terms[kept] = error;
                kept += 1;
            }
            carry = sum;
        }
        self.terms.truncate(kept);
        if carry != 0.0 {
            self.terms.push(carry);
        }
    }

    /// Adds `factor * (sum of a) * (sum of b)`; `factor` is 1 or -1.
    #[inline]
    pub fn add_product(&mut self, factor: f64, a: &[f64], b: &[f64]) {
        for &x in a.iter().filter(|&&x| x != 0.0) {
            for &y in b.iter().filter(|&&y| y != 0.0) {
                let (product, error) = two_product(factor * x, y);
                if error != 0.0 {
                    self.add(error);
                }
                self.add(product);
            }
        }
    }

    /// Turns the sign.
    pub fn negate(&mut self) {
        self.terms.iter_mut().for_each(|x| *x = -*x);
    }

    /// -1, 0 or 1; the greatest term outweighs all others together.
    pub fn sign(&self) -> i32 {
        match self.terms.last() {
            Some(x) if *x > 0.0 => 1,
            Some(_) => -1,
            None => 0,
        }
    }

    /// The value with a relative error of at most 2^-50.
    ///
    /// Each term is at most half of the next one's last bit, so partial sums are at most twice their last term, the
    /// rounding errors `2^-53 * 2 |term|` add up to `2^-51 |last|` at most, and `|value| >= |last| / 2`.
    pub fn estimate(&self) -> f64 {
        self.terms.iter().sum()
    }
}

/// `a . (b x c)` exactly.
pub(crate) fn triple(a: &[Difference; 3], b: &[Difference; 3], c: &[Difference; 3]) -> Expansion {
    let mut sum = Expansion::zero();
    let mut minor = Expansion::zero();
    for (i, component) in a.iter().enumerate() {
        let (j, k) = ((i + 1) % 3, (i + 2) % 3);
        minor.terms.clear();
        minor.add_product(1.0, &b[j], &c[k]);
        minor.add_product(-1.0, &b[k], &c[j]);
        sum.add_product(1.0, component, minor.terms());
    }
    sum
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::whole::power_of_two;

    /// xorshift64*: seeded numbers for tests.
    fn next(state: &mut u64) -> u64 {
        *state ^= *state >> 12;
        *state ^= *state << 25;
        *state ^= *state >> 27;
        state.wrapping_mul(0x2545_F491_4F6C_DD1D)
    }

    /// The value if all terms are integers that fit.
    fn integer(e: &Expansion) -> i128 {
        e.terms().iter().map(|&x| x as i128).sum()
    }

    #[test]
    fn products_and_sums_equal_integers() {
        let mut state = 7;
        for _ in 0..if cfg!(miri) { 200 } else { 20_000 } {
            // 60-bit factors in two terms each: products need up to 120 bits.
            let mut draw = || {
                let n = (next(&mut state) >> 4) as i64 - (1 << 59);
                let head = n as f64;
                (i128::from(n), [(n - head as i64) as f64, head])
            };
            let ((a, ea), (b, eb), (c, ec), (d, ed)) = (draw(), draw(), draw(), draw());
            let mut e = Expansion::zero();
            e.add_product(1.0, &ea, &eb);
            assert_eq!(integer(&e), a * b, "{a} * {b}");
            e.add_product(-1.0, &ec, &ed);
            let exact = a * b - c * d;
            assert_eq!(integer(&e), exact, "{a} * {b} - {c} * {d}");
            assert_eq!(e.sign(), exact.signum() as i32);
            assert!((e.estimate() - exact as f64).abs() <= exact.abs() as f64 * 2f64.powi(-49));
            for x in [-(a as f64), c as f64, 1.0, -1.0] {
                e.add(x);
            }
            assert_eq!(integer(&e), exact - (a as f64) as i128 + (c as f64) as i128);
        }
    }

    #[test]
    fn triple_products_equal_integers() {
        let mut state = 11;
        for round in 0..if cfg!(miri) { 200 } else { 20_000 } {
            // Small ranges make zeros and cancellation common; large ones need 3 * 25 bits and more.
            let bits = [2, 5, 23][round % 3];
            let mut v = || {
                [(); 3].map(|()| {
                    let n = (next(&mut state) % (2 << bits)) as i128 - (1 << bits);
                    (n, difference(n as f32, 0.0))
                })
            };
            let (a, b, c) = (v(), v(), v());
            let [x, y, z] = [a, b, c].map(|p| p.map(|(n, _)| n));
            let exact = x[0] * (y[1] * z[2] - y[2] * z[1])
                + x[1] * (y[2] * z[0] - y[0] * z[2])
                + x[2] * (y[0] * z[1] - y[1] * z[0]);
            let [x, y, z] = [a, b, c].map(|p| p.map(|(_, d)| d));
            let e = triple(&x, &y, &z);
            assert_eq!(integer(&e), exact);
            assert_eq!(e.sign(), exact.signum() as i32);
        }
    }

    #[test]
    fn extremes_are_exact() {
        let (tiny, huge) = (f32::from_bits(1), f32::MAX);
        // (huge - tiny) - huge + tiny = 0 although the difference spans 277 bits.
        let mut e = Expansion::zero();
        difference(huge, tiny).iter().for_each(|&x| e.add(x));
        e.add(-f64::from(huge));
        assert_eq!(e.terms(), [-f64::from(tiny)]);
        e.add(f64::from(tiny));
        assert_eq!(e.sign(), 0);
        // tiny^6 and huge^6 do not leave the range; (huge^3 + tiny^3) (huge^3 - tiny^3) - huge^6 = -tiny^6.
        let cube = |x: f32| {
            let mut square = Expansion::zero();
            square.add_product(1.0, &[f64::from(x)], &[f64::from(x)]);
            let mut cube = Expansion::zero();
            cube.add_product(1.0, square.terms(), &[f64::from(x)]);
            cube
        };
        let (big, small) = (cube(huge), cube(tiny));
        let (mut plus, mut minus) = (big.clone(), big.clone());
        small.terms().iter().for_each(|&x| plus.add(x));
        small.terms().iter().for_each(|&x| minus.add(-x));
        let mut e = Expansion::zero();
        e.add_product(1.0, plus.terms(), minus.terms());
        e.add_product(-1.0, big.terms(), big.terms());
        assert_eq!(e.terms(), [-power_of_two(-894)]);
    }
}
