//! HDR-FLIP: FLIP of pictures beyond the range of 0 to 1, as the worst over the exposures at which one may look at them.
//!
//! Source: Andersson, Nilsson, Shirley & Akenine-Möller 2021, "Visualizing Errors in Rendered High Dynamic Range Images".
//! The range of exposures follows from the reference alone (its section 3.2): from the one that shows its brightest pixel
//! just below white to the one that shows its median so. Tone mapper: the fit of ACES by Narkowicz, as in the paper. What
//! the paper leaves open is as in the authors' own program: the upper one of two medians, a median of at least 2^-23.

use super::{ErrorMap, Seen, Size, check, errors};
use crate::error::Result;
use crate::picture::Picture;

/// The tone mapper's `(a x + b) x` over `(c x + d) x + e`, its exposure of 0.6 multiplied into `x`.
const NUMERATOR: [f64; 2] = [0.6 * 0.6 * 2.51, 0.6 * 0.03];
const DENOMINATOR: [f64; 3] = [0.6 * 0.6 * 2.43, 0.6 * 0.59, 0.14];
/// The tone-mapped value that counts as just below white (t in the paper).
const NEARLY_WHITE: f64 = 0.85;
/// Luminances below this are taken as this where exposures are chosen: the spacing of f32 at 1.
const LEAST_LUMINANCE: f64 = 1.0 / (1u32 << 23) as f64;

/// The exposures at which two pictures are compared, evenly spaced.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Exposures {
    /// The first, in stops (powers of two by which radiance is multiplied).
    pub start: f64,
    /// The last, in stops; not below `start`.
    pub stop: f64,
    /// How many, at least 2.
    pub count: u32,
}

impl Exposures {
    /// Those that the paper chooses for `reference`, whose pixels are finite; negative values count as 0.
    pub fn of(reference: &Picture) -> Self {
        let luminance = |p: &[f32; 3]| {
            let [r, g, b] = p.map(|v| f64::from(v.max(0.0)));
            0.2126 * r + 0.7152 * g + 0.0722 * b
        };
        let mut luminances: Vec<f64> = reference.pixels.iter().map(luminance).collect();
        let median = match luminances.len() {
            0 => 0.0,
            n => *luminances.select_nth_unstable_by(n / 2, f64::total_cmp).1,
        };
        let largest = luminances.iter().copied().fold(0.0, f64::max);
        let white = nearly_white();
        let [start, stop] = [largest, median].map(|l| (white / l.max(LEAST_LUMINANCE)).log2());
        // At most 151 stops lie between the largest f32 and the floor.
        Self { start, stop, count: ((stop - start).ceil() as u32).max(2) }
    }

    /// Exposure `i`, in stops; `i` from 0 to `count - 1`.
    pub fn stops(&self, i: u32) -> f64 {
        self.start + (self.stop - self.start) * f64::from(i) / f64::from(self.count - 1)
    }
}

/// What HDR-FLIP found.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The largest error of each pixel over all exposures.
    pub map: ErrorMap,
    /// The exposure that gave it, row by row from the top: the first of several, an index below `exposures.count`.
    pub worst: Vec<u32>,
    /// All exposures.
    pub exposures: Exposures,
}

/// Compares `test` with `reference` at every exposure of [`Exposures::of`]; `progress` is told how many of how many are done.
///
/// Negative values, which the paper does not know, count as 0. Cost: that of [`super::compare`] for each exposure.
///
/// # Errors
/// As [`super::compare`].
pub fn compare(test: &Picture, reference: &Picture, progress: &dyn Fn(u32, u32)) -> Result<Comparison> {
    check(test, reference)?;
    let exposures = Exposures::of(reference);
    let size = Size::of(test);
    let (mut largest, mut worst) = (vec![-1.0f32; test.pixels.len()], vec![0; test.pixels.len()]);
    for i in 0..exposures.count {
        progress(i, exposures.count);
        let factor = exposures.stops(i).exp2();
        let shown = |p: &[f32; 3]| p.map(|v| tone_mapped(f64::from(v).max(0.0) * factor));
        let [a, b] = [reference, test].map(|p| Seen::new(p.pixels.iter().map(shown), size));
        for ((error, largest), worst) in errors(&a, &b).into_iter().zip(&mut largest).zip(&mut worst) {
            if error > *largest {
                (*largest, *worst) = (error, i);
            }
        }
    }
    progress(exposures.count, exposures.count);
    Ok(Comparison { map: ErrorMap { width: test.width, height: test.height, errors: largest }, worst, exposures })
}

/// Radiance of at least 0 to 0 and more; what is above 1 is white.
fn tone_mapped(x: f64) -> f64 {
    let ([a, b], [c, d, e]) = (NUMERATOR, DENOMINATOR);
    // Written so that the largest values do not overflow: f32 at 2^128 times 2^24 squared fits in f64.
    (a * x + b) * x / ((c * x + d) * x + e)
}

/// The radiance that the tone mapper shows as [`NEARLY_WHITE`]: the larger root of its quadratic equation.
fn nearly_white() -> f64 {
    let ([a, b], [c, d, e], t) = (NUMERATOR, DENOMINATOR, NEARLY_WHITE);
    let (a, b, c) = (a - t * c, b - t * d, -t * e);
    let half = -0.5 * b / a;
    half + (half * half - c / a).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn exposures_follow_from_the_largest_and_the_median() {
        assert!((tone_mapped(nearly_white()) - 0.85).abs() < 1e-12);
        let grey = |v: f32| [v; 3];
        let mut picture = Picture::new(4, 1);
        picture.pixels = vec![grey(8.0), grey(0.0), grey(1.0), grey(0.25)];
        let exposures = Exposures::of(&picture);
        let white = nearly_white().log2();
        assert!((exposures.start - (white - 3.0)).abs() < 1e-6 && (exposures.stop - white).abs() < 1e-6);
        assert_eq!((exposures.count, exposures.stops(0), exposures.stops(2)), (3, exposures.start, exposures.stop));
        // Nothing to choose from: two equal exposures.
        let black = Exposures::of(&Picture::new(2, 2));
        assert_eq!((black.count, black.start), (2, black.stop));
    }

    #[test]
    fn the_worst_exposure_shows_the_difference() {
        // One bright and many dim pixels: what differs among the dim ones shows at long exposures, and at the longest less, where both
        // are near white. flip-evaluator 1.7, asked for one exposure at a time, finds 0.4499 at number 13, 0.4125 and 0.3869 beside it.
        let mut reference = Picture { pixels: vec![[0.01; 3]; 64], ..Picture::new(8, 8) };
        reference.pixels[0] = [1000.0; 3];
        let mut test = reference.clone();
        test.pixels[63] = [0.02; 3];
        let found = compare(&test, &reference, &|_, _| {}).expect("comparable");
        assert_eq!((found.worst[63], found.exposures.count), (13, 17));
        assert!((found.map.errors[63] - 0.4499).abs() < 1e-4 && found.map.errors[0] < found.map.errors[63]);
        let same = compare(&test, &test, &|_, _| {}).expect("comparable");
        assert_eq!((same.map.mean(), same.worst[63]), (0.0, 0));
        assert_eq!(tone_mapped(f64::from(f32::MAX) * 2f64.powi(24)).round(), 1.0);
    }
}
