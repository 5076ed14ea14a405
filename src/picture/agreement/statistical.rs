//! Tile by tile: for pictures with noise, each known as a mean and the variance of that mean.

use crate::picture::{Picture, metrics};
use statrs::distribution::{ChiSquared, ContinuousCDF, Normal, StudentsT};

/// Pixels along a tile's side; tiles at the right and lower border may be smaller.
pub const TILE: usize = 8;
/// A difference of this share of the reference's mean counts as noise: storage and single precision.
const MODEL_TOLERANCE: f64 = 5e-4;
/// Keeps the standard error of black tiles above zero.
const LEAST_VARIANCE: f64 = 1e-14;
/// Student's t is taken as normal from here on.
const MANY_DEGREES: f64 = 1e6;
/// p-values below this are taken as this, about 37 standard deviations.
const LEAST_P: f64 = 1e-300;

/// A picture as the mean of independent renders, and how sure it is.
#[derive(Clone, Copy, Debug)]
pub struct Estimate<'a> {
    /// Mean of the renders, linear RGB; finite.
    pub mean: &'a Picture,
    /// Variance of that mean, of the same size: the variance over the renders, divided by their number. Finite, not negative.
    pub variance: &'a Picture,
    /// Number of renders, at least 2.
    pub replicates: u32,
}

/// Probabilities below which a test fails.
#[derive(Clone, Copy, Debug, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize))]
pub struct StatisticalLimits {
    /// For [`StatisticalVerdict::chi2_p`], 0 to 1.
    pub chi2: f64,
    /// For [`StatisticalVerdict::max_p`], 0 to 1.
    pub max: f64,
    /// For [`StatisticalVerdict::global_p`], 0 to 1.
    pub global: f64,
}

impl Default for StatisticalLimits {
    fn default() -> Self {
        Self { chi2: 1e-4, max: 1e-3, global: 1e-3 }
    }
}

/// What [`statistical`] found.
#[derive(Clone, Debug, PartialEq)]
#[cfg_attr(feature = "scene", derive(serde::Serialize))]
pub struct StatisticalVerdict {
    /// Number of tiles.
    pub tiles: usize,
    /// Sum over the tiles of the squared standard deviations by which the means over all channels differ.
    pub chi2: f64,
    /// Probability that [`StatisticalVerdict::chi2`] is at least this by chance.
    pub chi2_p: f64,
    /// Probability that the worst of all tiles and channels is at least this bad by chance.
    pub max_p: f64,
    /// Column and row of the first pixel of that tile.
    pub max_at: (u32, u32),
    /// Probability that the worst channel of the whole picture is at least this bad by chance.
    pub global_p: f64,
    /// Ours over theirs, sum of all values.
    pub mean_ratio: f64,
    /// What was allowed.
    pub limits: StatisticalLimits,
    /// True if no probability was below its limit.
    pub passed: bool,
    /// One sentence for each thing that failed; one that says how close it was if nothing did.
    pub reasons: Vec<String>,
}

/// Compares two estimates of the same picture by tiles of [`TILE`] x [`TILE`] pixels.
///
/// The difference of two tile means is put over its standard error, to which `MODEL_TOLERANCE` is added, and judged
/// by Student's t with the degrees of freedom of Welch and Satterthwaite. Pixels are taken as independent. The mean
/// over the three channels takes them as fully correlated, which can only make its variance too large.
///
/// Estimates of different sizes, with a pixel that is not finite, a negative variance or fewer than two renders fail
/// with that reason; all numbers are then NaN. Heavy-tailed noise (caustics of small lights) is beyond this test.
///
/// Source: Welch 1947, "The generalization of Student's problem when several different population variances are
/// involved". Which faults exceed the usual limits is measured in docs/validation.md.
pub fn statistical(test: Estimate, reference: Estimate, limits: StatisticalLimits) -> StatisticalVerdict {
    let nan = f64::NAN;
    let mut verdict = StatisticalVerdict {
        tiles: 0,
        chi2: nan,
        chi2_p: nan,
        max_p: nan,
        max_at: (0, 0),
        global_p: nan,
        mean_ratio: nan,
        limits,
        passed: false,
        reasons: vec![],
    };
    if let Some(reason) = unusable(&test, &reference) {
        verdict.reasons.push(reason);
        return verdict;
    }
    let (mut chi2, mut least_p) = (0.0, 1.0);
    let mut whole = Pair::default();
    each_tile(&test, &reference, |at, tile| {
        whole.join(tile);
        verdict.tiles += 1;
        chi2 += deviations(tile.p(Channel::All)).powi(2);
        for c in 0..3 {
            let p = tile.p(Channel::One(c));
            if p < least_p {
                (least_p, verdict.max_at) = (p, at);
            }
        }
    });
    let tests = (3 * verdict.tiles) as f64;
    verdict.chi2 = chi2;
    verdict.chi2_p = chi_squared_tail(chi2, verdict.tiles as f64);
    // 1 - (1 - p)^n without cancellation.
    verdict.max_p = -((-least_p).ln_1p() * tests).exp_m1();
    verdict.global_p = (0..3).map(|c| whole.p(Channel::One(c)) * 3.0).fold(1.0, f64::min);
    let total = |side: &Side| side.mean.iter().sum::<f64>();
    verdict.mean_ratio = metrics::ratio(total(&whole.test), total(&whole.reference));
    verdict.judge();
    verdict
}

/// Calls `found` with the column and row of the first pixel of each tile, row by row, and its sums.
pub(super) fn each_tile(test: &Estimate, reference: &Estimate, mut found: impl FnMut((u32, u32), &Pair)) {
    let (width, height) = (test.mean.width as usize, test.mean.height as usize);
    for y in (0..height).step_by(TILE) {
        for x in (0..width).step_by(TILE) {
            let mut tile = Pair::default();
            for row in y..(y + TILE).min(height) {
                for i in row * width + x..row * width + (x + TILE).min(width) {
                    tile.add(test, reference, i);
                }
            }
            found((x as u32, y as u32), &tile);
        }
    }
}

/// Why the two cannot be compared.
pub(super) fn unusable(test: &Estimate, reference: &Estimate) -> Option<String> {
    for (side, who) in [(test, "ours"), (reference, "theirs")] {
        if let Err(error) = metrics::check(side.variance, side.mean) {
            return Some(format!("{who}, variance against mean: {error}"));
        }
        if side.variance.pixels.iter().flatten().any(|v| *v < 0.0) {
            return Some(format!("{who} has a negative variance"));
        }
        if side.replicates < 2 {
            return Some(format!("{who} has {} renders, wanted are at least 2", side.replicates));
        }
    }
    metrics::check(test.mean, reference.mean).err().map(|error| error.to_string())
}

#[derive(Clone, Copy)]
enum Channel {
    One(usize),
    /// The mean of the three.
    All,
}

/// Sums over the pixels of a tile for one side.
#[derive(Default)]
struct Side {
    pixels: f64,
    mean: [f64; 3],
    variance: [f64; 3],
    /// Squares of the pixels' variances over their degrees of freedom.
    spread: [f64; 3],
    all_variance: f64,
    all_spread: f64,
}

impl Side {
    fn add(&mut self, estimate: &Estimate, i: usize) {
        let freedom = f64::from(estimate.replicates - 1);
        let variance = estimate.variance.pixels[i].map(f64::from);
        self.pixels += 1.0;
        for (c, v) in variance.into_iter().enumerate() {
            self.mean[c] += f64::from(estimate.mean.pixels[i][c]);
            self.variance[c] += v;
            self.spread[c] += v.powi(2) / freedom;
        }
        let all = (variance.iter().map(|v| v.sqrt()).sum::<f64>() / 3.0).powi(2);
        self.all_variance += all;
        self.all_spread += all.powi(2) / freedom;
    }

    fn join(&mut self, other: &Side) {
        self.pixels += other.pixels;
        for c in 0..3 {
            self.mean[c] += other.mean[c];
            self.variance[c] += other.variance[c];
            self.spread[c] += other.spread[c];
        }
        self.all_variance += other.all_variance;
        self.all_spread += other.all_spread;
    }

    /// Mean, its variance, and the square of that over its degrees of freedom.
    fn estimate(&self, channel: Channel) -> (f64, f64, f64) {
        let (mean, variance, spread) = match channel {
            Channel::One(c) => (self.mean[c], self.variance[c], self.spread[c]),
            Channel::All => (self.mean.iter().sum::<f64>() / 3.0, self.all_variance, self.all_spread),
        };
        (mean / self.pixels, variance / self.pixels.powi(2), spread / self.pixels.powi(4))
    }
}

/// The sums of both sides.
#[derive(Default)]
pub(super) struct Pair {
    test: Side,
    reference: Side,
}

impl Pair {
    fn add(&mut self, test: &Estimate, reference: &Estimate, i: usize) {
        self.test.add(test, i);
        self.reference.add(reference, i);
    }

    fn join(&mut self, other: &Pair) {
        self.test.join(&other.test);
        self.reference.join(&other.reference);
    }

    /// Standard deviations by which the means over all channels differ, above 0 where that of the test is greater.
    pub(super) fn z(&self) -> f64 {
        let [test, reference] = [&self.test, &self.reference].map(|side| side.estimate(Channel::All).0);
        deviations(self.p(Channel::All)).copysign(test - reference)
    }

    /// Probability that the means differ at least so much by chance, both directions.
    fn p(&self, channel: Channel) -> f64 {
        let (mean_t, variance_t, spread_t) = self.test.estimate(channel);
        let (mean_r, variance_r, spread_r) = self.reference.estimate(channel);
        // The tolerance is known for sure: it adds variance and no uncertainty of it.
        let variance = variance_t + variance_r + (MODEL_TOLERANCE * mean_r).powi(2) + LEAST_VARIANCE;
        let t = (mean_t - mean_r).abs() / variance.sqrt();
        two_sided(t, variance.powi(2) / (spread_t + spread_r))
    }
}

/// Probability of a t beyond `t` on either side; one that is not finite gives 0, the verdict "different".
fn two_sided(t: f64, freedom: f64) -> f64 {
    if !t.is_finite() {
        return 0.0;
    }
    let tail = if freedom < MANY_DEGREES {
        StudentsT::new(0.0, 1.0, freedom).map(|d| d.sf(t))
    } else {
        Ok(Normal::standard().sf(t))
    };
    let p = 2.0 * tail.unwrap_or(0.0);
    if p.is_nan() { 0.0 } else { p.clamp(0.0, 1.0) }
}

/// Standard deviations of a normal that are as unlikely as `p`, both directions.
fn deviations(p: f64) -> f64 {
    -Normal::standard().inverse_cdf(p.clamp(LEAST_P, 1.0) / 2.0)
}

/// Probability of a chi-squared of at least `chi2`.
fn chi_squared_tail(chi2: f64, freedom: f64) -> f64 {
    ChiSquared::new(freedom).map_or(0.0, |d| d.sf(chi2))
}

impl StatisticalVerdict {
    fn judge(&mut self) {
        let (x, y) = self.max_at;
        let rules = [
            (self.chi2_p, self.limits.chi2, format!("of the tiles' chi-squared {:.1} of {}", self.chi2, self.tiles)),
            (self.max_p, self.limits.max, format!("of the worst tile, at column {x}, row {y},")),
            (self.global_p, self.limits.global, format!("of the whole picture's mean, ratio {:.5},", self.mean_ratio)),
        ];
        for (p, limit, what) in &rules {
            if p.is_nan() || p < limit {
                self.reasons.push(format!("probability {what} is {p:.1e}, least allowed is {limit:.0e}"));
            }
        }
        self.passed = self.reasons.is_empty();
        if self.passed {
            let closest = rules.iter().min_by(|a, b| (a.0 / a.1).total_cmp(&(b.0 / b.1)));
            self.reasons.extend(closest.map(|(p, limit, what)| {
                format!("agrees within noise; the closest, the probability {what} is {p:.2}, least allowed {limit:.0e}")
            }));
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::agreement::noise::uniform;

    /// Mean and variance of the mean of `replicates` renders whose samples are uniform around a ramp.
    fn estimate(seed: u64, replicates: u32, noise: f64, factor: f64) -> (Picture, Picture) {
        let (width, height) = (60, 44);
        let mut state = seed;
        let (mut mean, mut variance) = (Picture::new(width, height), Picture::new(width, height));
        let k = f64::from(replicates);
        for (i, (m, v)) in mean.pixels.iter_mut().zip(&mut variance.pixels).enumerate() {
            let truth = factor * (0.2 + (i % 60) as f64 / 100.0);
            let samples: Vec<f64> = (0..replicates).map(|_| (uniform(&mut state) - 0.5) * noise).collect();
            let average = samples.iter().sum::<f64>() / k;
            let spread = samples.iter().map(|s| (s - average).powi(2)).sum::<f64>() / (k - 1.0) / k;
            // One noise in all channels, as in a grey scene.
            *m = [(truth + average) as f32; 3];
            *v = [spread as f32; 3];
        }
        (mean, variance)
    }

    fn verdict(ours: &(Picture, Picture), k: u32, theirs: &(Picture, Picture), n: u32) -> StatisticalVerdict {
        let side = |(mean, variance), replicates| Estimate { mean, variance, replicates };
        let (ours, theirs) = ((&ours.0, &ours.1), (&theirs.0, &theirs.1));
        statistical(side(ours, k), side(theirs, n), StatisticalLimits::default())
    }

    #[test]
    fn distributions_match_printed_tables() {
        // Two-sided 5 % points of Student's t, and the 5 % point of chi-squared with 10 degrees of freedom.
        for (freedom, t) in [(1.0, 12.7062), (10.0, 2.228139), (f64::INFINITY, 1.959964)] {
            assert!((two_sided(t, freedom) - 0.05).abs() < 1e-6, "{freedom}: {}", two_sided(t, freedom));
        }
        assert!((chi_squared_tail(18.307038, 10.0) - 0.05).abs() < 1e-8);
        assert!((deviations(0.05) - 1.959964).abs() < 1e-6);
        assert!(deviations(0.0) > 36.0 && deviations(0.0).is_finite());
        assert_eq!(two_sided(f64::NAN, 3.0), 0.0);
    }

    #[test]
    fn equal_scenes_pass_at_the_stated_rate() {
        let theirs = estimate(1000, 16, 0.2, 1.0);
        let mut below = 0;
        for seed in 0..200 {
            let (ours, theirs) = (estimate(2 * seed, 8, 0.4, 1.0), estimate(2 * seed + 1, 16, 0.2, 1.0));
            let verdict = verdict(&ours, 8, &theirs, 16);
            assert_eq!(verdict.tiles, 48);
            assert!(verdict.passed, "seed {seed}: {:?}", verdict.reasons);
            below += usize::from(verdict.chi2_p < 0.1);
        }
        // 20 expected of 200 at 10 %; four standard deviations of the binomial are 17.
        assert!((3..=37).contains(&below), "{below}");
        let shifted = verdict(&estimate(7, 8, 0.4, 1.01), 8, &theirs, 16);
        assert!(!shifted.passed && shifted.global_p < 1e-5 && (shifted.mean_ratio - 1.01).abs() < 1e-3, "{shifted:?}");
    }

    #[test]
    fn one_wrong_tile_is_found() {
        let theirs = estimate(1, 16, 0.2, 1.0);
        let mut ours = estimate(2, 8, 0.4, 1.0);
        for y in 16..24 {
            for x in 32..40 {
                ours.0.pixels[y * 60 + x][1] += 0.06;
            }
        }
        let verdict = verdict(&ours, 8, &theirs, 16);
        assert!(!verdict.passed && verdict.max_p < 1e-3, "{verdict:?}");
        assert_eq!(verdict.max_at, (32, 16));
    }

    #[test]
    fn pictures_without_noise_pass_within_the_tolerance() {
        let theirs = estimate(1, 2, 0.0, 1.0);
        assert!(verdict(&theirs, 2, &theirs, 2).passed);
        let near = estimate(1, 2, 0.0, 1.0 + 3e-4);
        assert!(verdict(&near, 2, &theirs, 2).passed);
        assert!(!verdict(&estimate(1, 2, 0.0, 1.005), 2, &theirs, 2).passed);
        let black = (Picture::new(9, 9), Picture::new(9, 9));
        assert!(verdict(&black, 2, &black, 2).passed);
    }

    #[test]
    fn what_cannot_be_judged_fails_with_a_reason() {
        let good = estimate(1, 8, 0.1, 1.0);
        let mut nan = good.clone();
        nan.0.pixels[3][0] = f32::NAN;
        let mut infinite = good.clone();
        infinite.1.pixels[3][0] = f32::INFINITY;
        let mut negative = good.clone();
        negative.1.pixels[3][0] = -1.0;
        let small = (Picture::new(3, 3), Picture::new(3, 3));
        for (bad, word) in [(&nan, "not finite"), (&infinite, "not finite"), (&negative, "negative"), (&small, "3 x 3")]
        {
            for verdict in [verdict(bad, 8, &good, 8), verdict(&good, 8, bad, 8)] {
                assert!(!verdict.passed && verdict.reasons[0].contains(word), "{:?}", verdict.reasons);
            }
        }
        assert!(verdict(&good, 1, &good, 8).reasons[0].contains("1 renders"));
    }
}
