//! Pictures of exact accelerators are equal to the bit.

use crate::render::Film;

/// The first pixel in which two accelerators that promise exact answers gave other sums.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Difference {
    /// The accelerator that was rendered first, and the other one.
    pub between: [String; 2],
    /// Samples a pixel of the whole picture.
    pub samples: u32,
    /// Seed of the half.
    pub seed: u64,
    /// Column and row.
    pub pixel: (u32, u32),
    /// Pixels of that half that differ.
    pub count: usize,
}

impl std::fmt::Display for Difference {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { between: [a, b], samples, seed, pixel: (x, y), count } = self;
        write!(
            f,
            "{b} and {a} differ in {count} pixels at {samples} samples, seed {seed}; the first is in column {x}, row {y}"
        )
    }
}

/// Pixels in which the sums of two films of one size differ in a bit: how many, and column and row of the first.
pub(super) fn differing(a: &Film, b: &Film) -> Option<(usize, (u32, u32))> {
    let pairs = a.sum.iter().zip(&b.sum).enumerate();
    let mut others = pairs.filter(|(_, (a, b))| a.to_array().map(f64::to_bits) != b.to_array().map(f64::to_bits));
    let (first, _) = others.next()?;
    let columns = a.width.max(1) as usize;
    Some((1 + others.count(), ((first % columns) as u32, (first / columns) as u32)))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_bit_is_seen() {
        let a = Film::new(3, 2, 1).expect("six pixels");
        let mut b = a.clone();
        assert_eq!(differing(&a, &b), None);
        b.sum[4].z = f64::from_bits(1);
        b.sum[5].x = -0.0;
        assert_eq!(differing(&a, &b), Some((2, (1, 1))));
    }
}
