//! Pixel by pixel: for pictures without noise that sample the same points.

use crate::picture::{Picture, metrics};

/// Pixels darker than this are compared as if they were this bright.
const DARK: f64 = 0.1;
/// The share for [`DeterministicVerdict::out1`].
pub(super) const ONE_PERCENT: f64 = 0.01;
/// The share for [`DeterministicVerdict::out01`].
pub(super) const TENTH_PERCENT: f64 = 0.001;

/// Largest values that pass.
///
/// The defaults come from pictures of POV-Ray in half-float EXR against an independent tracer in f64: all seeded
/// errors of 0.1 % in albedo, 0.005 pixels in position and 0.1 % of the shadow rays exceeded one of them.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize))]
pub struct DeterministicLimits {
    /// For [`DeterministicVerdict::out1`], share 0 to 1.
    pub out1: f64,
    /// For [`DeterministicVerdict::out01`], share 0 to 1.
    pub out01: f64,
    /// For [`DeterministicVerdict::trim`], linear RGB.
    pub trim: f64,
    /// For [`DeterministicVerdict::ratio`], share.
    pub ratio: f64,
}

impl Default for DeterministicLimits {
    fn default() -> Self {
        Self { out1: 5e-5, out01: 3e-3, trim: 1.5e-4, ratio: 3e-4 }
    }
}

impl DeterministicLimits {
    /// The defaults for a scene of which a share `out1_floor` (0 to 1) of pixels is known to differ because rays that
    /// graze an edge fall to either side in f32: three times that share passes.
    pub fn with_floor(out1_floor: f64) -> Self {
        let defaults = Self::default();
        Self { out1: defaults.out1.max(3.0 * out1_floor), ..defaults }
    }
}

/// What [`deterministic`] found. For each pixel, d is the largest channel difference and R the reference's largest
/// channel, but at least 0.1.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize))]
pub struct DeterministicVerdict {
    /// Share (0 to 1) of pixels with d > 0.01 R.
    pub out1: f64,
    /// Share (0 to 1) of pixels with d > 0.001 R.
    pub out01: f64,
    /// Root of the mean squared difference without the 2 % of pixels that differ most, linear RGB.
    pub trim: f64,
    /// Largest over the channels of |sum of ours / sum of theirs - 1|.
    pub ratio: f64,
    /// What was allowed.
    pub limits: DeterministicLimits,
    /// True if nothing was above its limit.
    pub passed: bool,
    /// One sentence for each thing that failed; one that says how close it was if nothing did.
    pub reasons: Vec<String>,
}

/// Compares `test` with `reference` pixel by pixel.
///
/// Pictures of different sizes, or with pixels that are not finite, fail with that reason; all numbers are then NaN.
/// Which faults exceed the usual limits is measured in docs/validation.md.
pub fn deterministic(test: &Picture, reference: &Picture, limits: DeterministicLimits) -> DeterministicVerdict {
    let nan = f64::NAN;
    let mut verdict =
        DeterministicVerdict { out1: nan, out01: nan, trim: nan, ratio: nan, limits, passed: false, reasons: vec![] };
    if let Err(error) = metrics::check(test, reference) {
        verdict.reasons.push(error.to_string());
        return verdict;
    }
    let pixels = test.pixels.len() as f64;
    let (mut above_1, mut above_01) = (0usize, 0usize);
    let mut squares = Vec::with_capacity(test.pixels.len());
    let mut sums = [[0.0f64; 2]; 3];
    for (a, b) in test.pixels.iter().zip(&reference.pixels) {
        let (a, b) = (a.map(f64::from), b.map(f64::from));
        let difference = [0, 1, 2].map(|c| (a[c] - b[c]).abs());
        above_1 += usize::from(is_off(a, b, ONE_PERCENT));
        above_01 += usize::from(is_off(a, b, TENTH_PERCENT));
        squares.push(difference.iter().map(|d| d * d).sum::<f64>());
        for c in 0..3 {
            sums[c][0] += a[c];
            sums[c][1] += b[c];
        }
    }
    verdict.out1 = above_1 as f64 / pixels;
    verdict.out01 = above_01 as f64 / pixels;
    verdict.trim = trimmed(squares);
    verdict.ratio = sums.iter().map(|s| (metrics::ratio(s[0], s[1]) - 1.0).abs()).fold(0.0, f64::max);
    verdict.judge();
    verdict
}

/// True if the largest difference of a channel is above `share` of the reference's largest channel, `b`.
pub(super) fn is_off(a: [f64; 3], b: [f64; 3], share: f64) -> bool {
    let largest = (0..3).map(|c| (a[c] - b[c]).abs()).fold(0.0, f64::max);
    largest > share * b.into_iter().fold(DARK, f64::max)
}

/// Root mean square of a channel without the worst fiftieth of the pixels; `squares` has a sum of three for each.
fn trimmed(mut squares: Vec<f64>) -> f64 {
    squares.sort_by(f64::total_cmp);
    let kept = squares.len() - squares.len() / 50;
    (squares[..kept].iter().sum::<f64>() / (3.0 * kept as f64)).sqrt()
}

impl DeterministicVerdict {
    fn judge(&mut self) {
        let limits = self.limits;
        let rules = [
            (self.out1, limits.out1, "share of pixels off by more than 1 %"),
            (self.out01, limits.out01, "share of pixels off by more than 0.1 %"),
            (self.trim, limits.trim, "RMSE without the worst 2 % of pixels"),
            (self.ratio, limits.ratio, "deviation of a channel's mean"),
        ];
        for (value, limit, what) in rules {
            if value.is_nan() || value > limit {
                self.reasons.push(format!("{what} is {value:.3e}, allowed is {limit:.3e}"));
            }
        }
        self.passed = self.reasons.is_empty();
        if self.passed {
            let closest = rules.into_iter().max_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
            self.reasons.extend(closest.map(|(value, limit, what)| {
                format!("all within limits; the closest, {what}, is {value:.3e} of {limit:.3e}")
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn picture() -> Picture {
        let mut picture = Picture::new(100, 100);
        for (i, pixel) in picture.pixels.iter_mut().enumerate() {
            *pixel = [0.2 + (i % 100) as f32 / 200.0, 0.3, (i / 100) as f32 / 100.0];
        }
        picture
    }

    #[test]
    fn known_values() {
        let reference = picture();
        let mut test = reference.clone();
        // A hundred pixels off by 0.1 in green: within the trimmed 2 %.
        test.pixels.iter_mut().take(100).for_each(|p| p[1] += 0.1);
        let verdict = deterministic(&test, &reference, DeterministicLimits::default());
        assert_eq!((verdict.out1, verdict.out01, verdict.trim), (0.01, 0.01, 0.0));
        assert!((verdict.ratio - 10.0 / 3000.0).abs() < 1e-7, "{verdict:?}");
        assert!(!verdict.passed);
        assert_eq!(verdict.reasons.len(), 3, "{:?}", verdict.reasons);
    }

    #[test]
    fn equal_pictures_and_half_rounding_pass_and_a_thousandth_fails() {
        let reference = picture();
        let equal = deterministic(&reference, &reference, DeterministicLimits::default());
        assert!(equal.passed && equal.trim == 0.0, "{equal:?}");
        let scaled = |f: f32| {
            let mut test = reference.clone();
            test.pixels.iter_mut().flatten().for_each(|v| *v *= f);
            deterministic(&test, &reference, DeterministicLimits::default())
        };
        assert!(scaled(1.0 + 1.2e-4).passed);
        let off = scaled(1.001);
        assert!(!off.passed && off.reasons.iter().any(|r| r.contains("mean")), "{off:?}");
    }

    #[test]
    fn floors_widen_one_limit_only() {
        let limits = DeterministicLimits::with_floor(2e-4);
        assert_eq!(limits, DeterministicLimits { out1: 3.0 * 2e-4, ..DeterministicLimits::default() });
        assert_eq!(DeterministicLimits::with_floor(0.0), DeterministicLimits::default());
    }

    #[test]
    fn nan_and_sizes_fail_with_a_reason() {
        let mut test = picture();
        test.pixels[9][2] = f32::NAN;
        for (a, b, word) in [
            (&test, &picture(), "not finite"),
            (&picture(), &test, "not finite"),
            (&picture(), &Picture::new(3, 3), "3 x 3"),
        ] {
            let verdict = deterministic(a, b, DeterministicLimits::default());
            assert!(!verdict.passed && verdict.reasons[0].contains(word), "{:?}", verdict.reasons);
        }
    }
}
