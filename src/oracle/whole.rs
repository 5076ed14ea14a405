//! Floating-point numbers as whole numbers, and the vector algebra on them.

use glam::Vec3;
use num_bigint::BigInt;

/// A whole number in which vectors are computed: [`BigInt`], or `i128` where everything fits.
pub(super) trait Whole: Ord + Default {
    /// `x / 2^exponent`, which is whole: `exponent` is at most that of [`Span::least`] for a span with `x` in it.
    fn scaled(x: f32, exponent: i32) -> Self;
    fn plus(&self, other: &Self) -> Self;
    fn minus(&self, other: &Self) -> Self;
    fn times(&self, other: &Self) -> Self;
    fn big(self) -> BigInt;
}

/// Both are written alike.
macro_rules! whole {
    ($($number:ty),*) => {$(
        impl Whole for $number {
            fn scaled(x: f32, exponent: i32) -> Self {
                let (mantissa, e) = parts(x);
                if mantissa == 0 { Self::default() } else { Self::from(mantissa) << (e - exponent) }
            }

            fn plus(&self, other: &Self) -> Self {
                self + other
            }

            fn minus(&self, other: &Self) -> Self {
                self - other
            }

            fn times(&self, other: &Self) -> Self {
                self * other
            }

            fn big(self) -> BigInt {
                self.into()
            }
        }
    )*};
}
whole!(i128, BigInt);

/// `x = mantissa * 2^exponent` with an odd mantissa below 2^24, or 0 and 0. `x` is finite.
pub(super) fn parts(x: f32) -> (i32, i32) {
    let bits = x.to_bits();
    let (field, fraction) = ((bits >> 23 & 0xff) as i32, (bits & 0x7f_ffff) as i32);
    let (mantissa, exponent) = if field == 0 { (fraction, -149) } else { (fraction | 1 << 23, field - 150) };
    if mantissa == 0 {
        return (0, 0);
    }
    let zeros = mantissa.trailing_zeros() as i32;
    let odd = mantissa >> zeros;
    (if bits >> 31 == 1 { -odd } else { odd }, exponent + zeros)
}

/// The bits that a set of numbers has, as powers of two.
#[derive(Clone, Copy, Debug)]
pub(super) struct Span {
    /// Every number is a multiple of two to this power. `i32::MAX` if all are zero.
    pub least: i32,
    /// Every number is less than two to this power in size.
    pub most: i32,
}

impl Span {
    /// The span of zeros.
    pub const EMPTY: Span = Span { least: i32::MAX, most: -149 };

    /// Of the components of finite vectors.
    pub fn of(vectors: &[Vec3]) -> Self {
        vectors.iter().flat_map(|v| v.to_array()).fold(Self::EMPTY, |span, x| span.with(x))
    }

    /// With one more finite number.
    pub fn with(self, x: f32) -> Self {
        let (mantissa, exponent) = parts(x);
        if mantissa == 0 {
            return self;
        }
        let bits = 32 - mantissa.unsigned_abs().leading_zeros() as i32;
        Self { least: self.least.min(exponent), most: self.most.max(exponent + bits) }
    }

    pub fn union(self, other: Self) -> Self {
        Self { least: self.least.min(other.least), most: self.most.max(other.most) }
    }

    /// The exponent by which the numbers become whole: 0 for zeros.
    pub fn exponent(self) -> i32 {
        if self.least == i32::MAX { 0 } else { self.least }
    }

    /// Bits of the greatest one, scaled by the exponent.
    pub fn bits(self) -> i32 {
        if self.least == i32::MAX { 0 } else { self.most - self.least }
    }
}

pub(super) fn scaled<T: Whole>(v: Vec3, exponent: i32) -> [T; 3] {
    v.to_array().map(|x| T::scaled(x, exponent))
}

pub(super) fn minus<T: Whole>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    [a[0].minus(&b[0]), a[1].minus(&b[1]), a[2].minus(&b[2])]
}

pub(super) fn dot<T: Whole>(a: &[T; 3], b: &[T; 3]) -> T {
    a[0].times(&b[0]).plus(&a[1].times(&b[1])).plus(&a[2].times(&b[2]))
}

pub(super) fn cross<T: Whole>(a: &[T; 3], b: &[T; 3]) -> [T; 3] {
    let component = |i: usize, j: usize| a[i].times(&b[j]).minus(&a[j].times(&b[i]));
    [component(1, 2), component(2, 0), component(0, 1)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_taken_apart_and_scaled() {
        for (x, expected) in [
            (0.0, (0, 0)),
            (-0.0, (0, 0)),
            (1.0, (1, 0)),
            (-6.0, (-3, 1)),
            (0.375, (3, -3)),
            (f32::from_bits(1), (1, -149)),
            (f32::from_bits(6), (3, -148)),
            (f32::MIN_POSITIVE, (1, -126)),
            (f32::MAX, ((1 << 24) - 1, 104)),
        ] {
            assert_eq!(parts(x), expected, "{x}");
        }
        let span = Span::of(&[Vec3::new(0.375, 0.0, -6.0)]);
        assert_eq!((span.exponent(), span.bits()), (-3, 6));
        assert_eq!(scaled::<i128>(Vec3::new(0.375, -0.0, -6.0), -3), [3, 0, -48]);
        assert_eq!(BigInt::scaled(-6.0, -149), BigInt::from(-6) << 149u32);
        assert_eq!((Span::EMPTY.exponent(), Span::EMPTY.bits()), (0, 0));
    }

    #[test]
    fn products_of_vectors_are_those_of_the_hand() {
        assert_eq!(cross(&[1i128, 2, 3], &[4, 5, 6]), [-3, 6, -3]);
        assert_eq!(dot(&[1i128, 2, 3], &[4, -5, 6]), 12);
    }
}
