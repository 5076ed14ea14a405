//! Time as a straight line over samples, and where two such lines cross.

/// Seconds of a picture: `fixed + per_sample * samples`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cost {
    /// Seconds that do not depend on samples: the build, and what rendering takes before its first sample.
    pub fixed: f64,
    /// Seconds for each sample a pixel.
    pub per_sample: f64,
}

impl Cost {
    /// The build and a line through (samples, seconds of tracing), by least squares of relative errors: a point counts by
    /// the inverse square of its samples. A line that starts below 0 is replaced by one that starts there, and one that falls
    /// by a level one: neither of both is ever below 0.
    ///
    /// `None` without a point of at least one sample.
    pub fn fit(build: f64, points: &[(f64, f64)]) -> Option<Self> {
        let usable = || points.iter().filter(|(n, s)| *n >= 1.0 && s.is_finite());
        // Divided by the samples: seconds / n = start / n + slope, a line over 1 / n.
        let (mut count, mut x1, mut y1, mut xx, mut xy) = (0.0, 0.0, 0.0, 0.0, 0.0);
        for &(n, seconds) in usable() {
            let (x, y) = (1.0 / n, seconds / n);
            count += 1.0;
            x1 += x;
            y1 += y;
            xx += x * x;
            xy += x * y;
        }
        if count == 0.0 {
            return None;
        }
        let spread = count * xx - x1 * x1;
        let start = if spread > 1e-12 * xx { ((count * xy - x1 * y1) / spread).max(0.0) } else { 0.0 };
        let per_sample = (y1 - start * x1) / count;
        Some(match per_sample >= 0.0 {
            true => Self { fixed: build + start, per_sample },
            false => Self { fixed: build + xy / xx, per_sample: 0.0 },
        })
    }

    /// Seconds of a picture of so many samples a pixel.
    pub fn seconds(&self, samples: f64) -> f64 {
        self.fixed + self.per_sample * samples
    }

    /// Samples a pixel in so many seconds; negative where even the fixed part takes longer, NaN where nothing tells what a
    /// sample takes.
    pub fn samples(&self, seconds: f64) -> f64 {
        if self.per_sample > 0.0 { (seconds - self.fixed) / self.per_sample } else { f64::NAN }
    }
}

/// Which of two is faster at how many samples a pixel.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Crossover {
    /// One of them at every number of samples from 1: the first (0) or the second (1).
    Never {
        /// 0 or 1.
        faster: usize,
    },
    /// One up to this number of samples, the other beyond.
    At {
        /// Samples a pixel, above 1; not whole.
        samples: f64,
        /// Who is faster beyond: 0 or 1. The other one is faster before.
        beyond: usize,
    },
    /// Both take the same time.
    Equal,
}

/// `samples = (B2 - B1) / (c1 - c2)`, from B + c samples of both; lines that cross below one sample do not cross for any
/// picture.
pub fn crossover(first: &Cost, second: &Cost) -> Crossover {
    if first == second {
        return Crossover::Equal;
    }
    let beyond = usize::from(match first.per_sample == second.per_sample {
        true => second.fixed < first.fixed,
        false => second.per_sample < first.per_sample,
    });
    let samples = (second.fixed - first.fixed) / (first.per_sample - second.per_sample);
    if samples > 1.0 && samples.is_finite() {
        Crossover::At { samples, beyond }
    } else {
        Crossover::Never { faster: beyond }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_line_is_found_again() {
        let line = |n: f64| (n, 0.25 + 0.125 * n);
        let cost = Cost::fit(1.0, &[2.0, 4.0, 8.0, 64.0].map(line)).expect("points");
        assert!((cost.fixed - 1.25).abs() < 1e-12 && (cost.per_sample - 0.125).abs() < 1e-12, "{cost:?}");
        assert!((cost.seconds(10.0) - 2.5).abs() < 1e-12 && (cost.samples(2.5) - 10.0).abs() < 1e-9);
        // One that would start below 0 starts there: the mean of the slopes is left.
        let cost = Cost::fit(0.0, &[(2.0, 1.0), (4.0, 4.0)]).expect("points");
        assert_eq!(cost, Cost { fixed: 0.0, per_sample: 0.75 });
        assert_eq!(Cost::fit(0.5, &[(4.0, 2.0)]), Some(Cost { fixed: 0.5, per_sample: 0.5 }));
        assert_eq!(Cost::fit(0.5, &[]), None);
        // Half the time for twice the samples: the level by weights 1/4 and 1/16.
        let cost = Cost::fit(0.0, &[(2.0, 2.0), (4.0, 1.0)]).expect("points");
        assert!((cost.fixed - 1.8).abs() < 1e-12 && cost.per_sample == 0.0 && cost.samples(5.0).is_nan(), "{cost:?}");
    }
}
