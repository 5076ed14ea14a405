//! A few f64 at a time, in portable code: what is asked of them is rare.

use std::ops::{Add, Div, Mul, Sub};

/// `N` numbers.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wide<const N: usize>(pub [f64; N]);

impl<const N: usize> Wide<N> {
    /// The same number `N` times.
    #[inline(always)]
    pub fn splat(x: f64) -> Self {
        Self([x; N])
    }

    #[inline(always)]
    fn zip(self, other: Self, f: impl Fn(f64, f64) -> f64) -> Self {
        let mut all = self.0;
        for i in 0..N {
            all[i] = f(self.0[i], other.0[i]);
        }
        Self(all)
    }

    /// Without the sign.
    #[inline(always)]
    pub fn abs(self) -> Self {
        self.zip(self, |a, _| a.abs())
    }

    /// The lesser one of each.
    #[inline(always)]
    pub fn min(self, other: Self) -> Self {
        self.zip(other, |a, b| if a < b { a } else { b })
    }

    /// The greater one of each.
    #[inline(always)]
    pub fn max(self, other: Self) -> Self {
        self.zip(other, |a, b| if a > b { a } else { b })
    }
}

macro_rules! operator {
    ($($trait:ident $method:ident $op:tt),*) => {$(
        impl<const N: usize> $trait for Wide<N> {
            type Output = Self;
            #[inline(always)]
            fn $method(self, other: Self) -> Self { self.zip(other, |a, b| a $op b) }
        }
    )*};
}
operator!(Add add +, Sub sub -, Mul mul *, Div div /);

/// The difference of vectors.
#[inline(always)]
pub(super) fn minus<const N: usize>(a: [Wide<N>; 3], b: [Wide<N>; 3]) -> [Wide<N>; 3] {
    [a[0] - b[0], a[1] - b[1], a[2] - b[2]]
}

/// Their cross product.
#[inline(always)]
pub(super) fn cross<const N: usize>(a: [Wide<N>; 3], b: [Wide<N>; 3]) -> [Wide<N>; 3] {
    [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]]
}

/// Their scalar product.
#[inline(always)]
pub(super) fn dot<const N: usize>(a: [Wide<N>; 3], b: [Wide<N>; 3]) -> Wide<N> {
    a[0] * b[0] + a[1] * b[1] + a[2] * b[2]
}
