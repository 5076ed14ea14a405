//! Whole numbers of any size that cost little as long as they are small.
//!
//! Lattices and other coordinates of few bits, which leave most ties, stay within 128 bits; what overflows goes on as a big
//! integer.

use num_bigint::{BigInt, Sign};
use std::cmp::Ordering;
use std::ops::{Add, Mul, Neg, Shl, Sub};

/// A whole number.
#[derive(Clone, Debug)]
pub(super) enum Number {
    Small(i128),
    Large(BigInt),
}

impl Number {
    pub const ZERO: Self = Self::Small(0);

    fn large(&self) -> BigInt {
        match self {
            Self::Small(x) => BigInt::from(*x),
            Self::Large(x) => x.clone(),
        }
    }

    /// The order of the number and zero.
    pub fn sign(&self) -> Ordering {
        match self {
            Self::Small(x) => x.cmp(&0),
            Self::Large(x) => match x.sign() {
                Sign::Minus => Ordering::Less,
                Sign::NoSign => Ordering::Equal,
                Sign::Plus => Ordering::Greater,
            },
        }
    }

    /// The order of two numbers.
    pub fn order(&self, other: &Self) -> Ordering {
        match (self, other) {
            (Self::Small(x), Self::Small(y)) => x.cmp(y),
            _ => self.large().cmp(&other.large()),
        }
    }
}

impl From<i64> for Number {
    fn from(x: i64) -> Self {
        Self::Small(x.into())
    }
}

macro_rules! operation {
    ($trait:ident, $method:ident, $checked:ident) => {
        impl $trait<&Number> for &Number {
            type Output = Number;
            fn $method(self, other: &Number) -> Number {
                if let (Number::Small(x), Number::Small(y)) = (self, other)
                    && let Some(z) = x.$checked(*y)
                {
                    return Number::Small(z);
                }
                Number::Large(self.large().$method(other.large()))
            }
        }
        impl $trait for Number {
            type Output = Number;
            fn $method(self, other: Number) -> Number {
                (&self).$method(&other)
            }
        }
    };
}
operation!(Add, add, checked_add);
operation!(Sub, sub, checked_sub);
operation!(Mul, mul, checked_mul);

impl Shl<u32> for &Number {
    type Output = Number;
    fn shl(self, by: u32) -> Number {
        match self {
            Number::Small(x) if by < 128 && (x << by) >> by == *x => Number::Small(x << by),
            _ => Number::Large(self.large() << by),
        }
    }
}

impl Neg for &Number {
    type Output = Number;
    fn neg(self) -> Number {
        &Number::ZERO - self
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_and_large_numbers_are_one_kind() {
        let seeds = [0, 1, -1, 7, -96, i64::MAX, i64::MIN].map(Number::from);
        let mut all: Vec<Number> = seeds.to_vec();
        for _ in 0..2 {
            let squares: Vec<Number> = all.iter().map(|x| x * x).chain(all.iter().map(|x| x << 65)).collect();
            all.extend(squares);
        }
        assert!(all.iter().any(|x| matches!(x, Number::Large(_))) && all.iter().any(|x| matches!(x, Number::Small(_))));
        for x in &all {
            let big = x.large();
            assert_eq!((-x).large(), -big.clone());
            assert_eq!(x.sign(), big.cmp(&BigInt::ZERO));
            assert_eq!((x << 70).large(), big.clone() << 70);
            for y in &all {
                let other = y.large();
                assert_eq!((x + y).large(), &big + &other);
                assert_eq!((x - y).large(), &big - &other);
                assert_eq!((x * y).large(), &big * &other);
                assert_eq!(x.order(y), big.cmp(&other));
            }
        }
    }
}
