//! Distances between two pictures.

use super::Picture;
use crate::error::{Error, Result};

/// Pixels that are not finite.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize))]
pub struct NonFinite {
    /// How many pixels have a channel that is NaN or infinite.
    pub count: usize,
    /// Of these, how many have a channel that is NaN.
    pub nan: usize,
    /// Column and row of the first of them.
    pub first: Option<(u32, u32)>,
}

impl NonFinite {
    /// Counts them.
    pub fn of(picture: &Picture) -> Self {
        let columns = picture.width.max(1) as usize;
        let mut found = Self::default();
        for (i, pixel) in picture.pixels.iter().enumerate().filter(|(_, p)| !p.iter().all(|v| v.is_finite())) {
            found.count += 1;
            found.nan += usize::from(pixel.iter().any(|v| v.is_nan()));
            found.first = found.first.or(Some(((i % columns) as u32, (i / columns) as u32)));
        }
        found
    }

    /// A sentence about `picture` if there is any such pixel.
    pub fn complaint(&self, picture: &str) -> Option<String> {
        let (x, y) = self.first?;
        let Self { count, nan, .. } = self;
        Some(format!(
            "{picture} has {count} pixels that are not finite ({nan} of them NaN), the first in column {x}, row {y}"
        ))
    }
}

/// How far a picture is from its reference. Linear RGB; means are over all pixels and channels.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize))]
pub struct Metrics {
    /// Mean of `(a - b)^2`.
    pub mse: f64,
    /// Root of [`Metrics::mse`].
    pub rmse: f64,
    /// Mean of `(a - b)^2 / (b + 0.01)^2`: "MRSE" of pbrt-v4's imgtool; what our tables call relMSE.
    pub rel_mse: f64,
    /// Mean of `(a - b)^2 / (b^2 + 0.01)`: the form of Rousselle et al. 2011, "Adaptive sampling and reconstruction
    /// using greedy error minimization".
    pub rel_mse_rousselle: f64,
    /// Mean of `|a - b|`.
    pub mae: f64,
    /// Largest `|a - b|`.
    pub max: f64,
    /// Column and row of [`Metrics::max`], the first if there are several.
    pub max_at: (u32, u32),
    /// `10 log10(1 / mse)`, decibel for a peak of 1; infinite for equal pictures.
    pub psnr: f64,
    /// Share (0 to 1) of pixels whose largest channel difference is above 1 % of the larger of the two pixels' largest
    /// channels, the latter being at least 1e-3.
    pub above_1_percent: f64,
    /// The same with 0.1 %.
    pub above_01_percent: f64,
    /// Share (0 to 1) of pixels of which any channel differs at all; -0 equals 0.
    pub differing: f64,
    /// Sum of all values of the picture over that of the reference; 1 if the sums are equal, infinite if that of the
    /// reference alone is 0.
    pub mean_ratio: f64,
}

/// Compares `test` (`a` in the formulas of [`Metrics`]) with `reference` (`b`). Sums are f64.
///
/// # Errors
/// The sizes differ, the pictures are empty, or a pixel is not finite: NaN is never "equal".
pub fn compare(test: &Picture, reference: &Picture) -> Result<Metrics> {
    check(test, reference)?;
    let mut sums = Sums::default();
    for (i, (a, b)) in test.pixels.iter().zip(&reference.pixels).enumerate() {
        sums.add(i, a.map(f64::from), b.map(f64::from));
    }
    let pixels = test.pixels.len() as f64;
    let mean = |sum: f64| sum / (3.0 * pixels);
    let mse = mean(sums.square);
    let columns = test.width as usize;
    Ok(Metrics {
        mse,
        rmse: mse.sqrt(),
        rel_mse: mean(sums.relative),
        rel_mse_rousselle: mean(sums.rousselle),
        mae: mean(sums.absolute),
        max: sums.max,
        max_at: ((sums.max_at % columns) as u32, (sums.max_at / columns) as u32),
        psnr: -10.0 * mse.log10(),
        above_1_percent: sums.above_1 as f64 / pixels,
        above_01_percent: sums.above_01 as f64 / pixels,
        differing: sums.differing as f64 / pixels,
        mean_ratio: ratio(sums.test, sums.reference),
    })
}

/// Refuses pictures that cannot be compared.
pub(super) fn check(test: &Picture, reference: &Picture) -> Result<()> {
    let sizes = [test, reference].map(|p| (p.width, p.height));
    let [a, b] = sizes;
    if a != b || test.pixels.len() != reference.pixels.len() {
        return Err(Error::invalid(format!("picture is {} x {}, its reference {} x {}", a.0, a.1, b.0, b.1)));
    }
    if test.pixels.is_empty() || test.pixels.len() as u64 != u64::from(a.0) * u64::from(a.1) {
        return Err(Error::invalid(format!("picture of {} x {} has {} pixels", a.0, a.1, test.pixels.len())));
    }
    let complaint =
        NonFinite::of(test).complaint("picture").or_else(|| NonFinite::of(reference).complaint("reference"));
    complaint.map_or(Ok(()), |cause| Err(Error::invalid(cause)))
}

/// `a / b`, and 1 for two zeros.
pub(super) fn ratio(a: f64, b: f64) -> f64 {
    if a == b { 1.0 } else { a / b }
}

#[derive(Default)]
struct Sums {
    square: f64,
    relative: f64,
    rousselle: f64,
    absolute: f64,
    test: f64,
    reference: f64,
    max: f64,
    max_at: usize,
    above_1: usize,
    above_01: usize,
    differing: usize,
}

impl Sums {
    fn add(&mut self, i: usize, a: [f64; 3], b: [f64; 3]) {
        let mut largest = 0.0f64;
        for (a, b) in a.into_iter().zip(b) {
            let d = a - b;
            self.square += d * d;
            self.relative += (d / (b + 0.01)).powi(2);
            self.rousselle += d * d / (b * b + 0.01);
            self.absolute += d.abs();
            self.test += a;
            self.reference += b;
            largest = largest.max(d.abs());
        }
        if largest > self.max {
            (self.max, self.max_at) = (largest, i);
        }
        let scale = a.into_iter().chain(b).fold(1e-3, f64::max);
        self.above_1 += usize::from(largest > 0.01 * scale);
        self.above_01 += usize::from(largest > 0.001 * scale);
        self.differing += usize::from(largest > 0.0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture(pixels: &[[f32; 3]]) -> Picture {
        Picture { width: pixels.len() as u32, height: 1, pixels: pixels.to_vec() }
    }

    #[test]
    fn closed_forms_of_a_small_pair() {
        let b = picture(&[[0.5; 3], [0.25; 3], [0.0; 3], [1.0; 3]]);
        let a = picture(&[[0.5, 0.5, 0.75], [0.25; 3], [0.0; 3], [1.0, 1.0, 0.995]]);
        let m = compare(&a, &b).expect("comparable");
        let (d, e) = (0.25f64, f64::from(1.0f32 - 0.995f32));
        let close = |x: f64, y: f64| assert!((x - y).abs() <= 1e-12 * y.abs(), "{x} is not {y}");
        close(m.mse, (d * d + e * e) / 12.0);
        close(m.rmse, m.mse.sqrt());
        close(m.mae, (d + e) / 12.0);
        close(m.rel_mse, ((d / 0.51).powi(2) + (e / 1.01).powi(2)) / 12.0);
        close(m.rel_mse_rousselle, (d * d / 0.26 + e * e / 1.01) / 12.0);
        close(m.psnr, 10.0 * (1.0 / m.mse).log10());
        close(m.mean_ratio, (5.25 + d - e) / 5.25);
        assert_eq!((m.max, m.max_at), (0.25, (0, 0)));
        assert_eq!((m.above_1_percent, m.above_01_percent, m.differing), (0.25, 0.5, 0.5));
    }

    #[test]
    fn equal_pictures_have_no_distance_and_black_ones_a_ratio_of_one() {
        let m = compare(&picture(&[[0.0; 3]]), &picture(&[[0.0; 3]])).expect("comparable");
        assert_eq!((m.mse, m.max, m.mean_ratio, m.above_01_percent), (0.0, 0.0, 1.0, 0.0));
        assert_eq!(m.psnr, f64::INFINITY);
    }

    #[test]
    fn what_is_not_finite_or_of_another_size_is_refused() {
        let good = picture(&[[1.0; 3], [2.0; 3]]);
        let bad = picture(&[[1.0; 3], [1.0, f32::NAN, 1.0]]);
        for (a, b, who) in [(&bad, &good, "picture has 1"), (&good, &bad, "reference has 1"), (&bad, &bad, "picture")] {
            let message = compare(a, b).expect_err("NaN").to_string();
            assert!(message.contains(who) && message.contains("column 1, row 0"), "{message}");
        }
        let worse = picture(&[[f32::INFINITY, 0.0, f32::NAN], [f32::NEG_INFINITY, 1.0, 1.0]]);
        assert_eq!(NonFinite::of(&worse), NonFinite { count: 2, nan: 1, first: Some((0, 0)) });
        assert_eq!(NonFinite::of(&good), NonFinite::default());
        assert!(compare(&good, &picture(&[[1.0; 3]])).is_err());
        assert!(compare(&Picture::new(0, 0), &Picture::new(0, 0)).is_err());
    }
}
