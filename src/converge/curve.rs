//! One renderer's error over samples and seconds.

use super::cost::Cost;
use super::errors::{Bias, Errors, Interval, mean};
use super::reference::Reference;

/// What the seconds of a curve are.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Clock {
    /// Processor time of all threads together, where the system tells; else as [`Clock::Wall`].
    Processor,
    /// From beginning to end of another program, on one thread.
    Wall,
}

impl Clock {
    /// One word for tables.
    pub fn name(self) -> &'static str {
        match self {
            Clock::Processor => "processor",
            Clock::Wall => "wall",
        }
    }
}

/// One picture.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trial {
    /// Seconds before the first ray: building the accelerator; of another program its start and reading the scene, as far
    /// as it tells them apart.
    pub build: f64,
    /// Seconds of rendering.
    pub trace: f64,
    /// Seconds of wall time: of rendering with our accelerators, of everything with another program.
    pub wall: f64,
    /// How far it is from the reference.
    pub errors: Errors,
}

/// The pictures of one number of samples.
#[derive(Clone, Debug, PartialEq)]
pub struct Point {
    /// Samples a pixel.
    pub samples: u32,
    /// One for each replicate; one alone where there are no random numbers.
    pub trials: Vec<Trial>,
}

impl Point {
    fn mean(&self, value: impl Fn(&Trial) -> f64) -> f64 {
        mean(&self.trials.iter().map(value).collect::<Vec<_>>())
    }

    /// Seconds before the first ray.
    pub fn build(&self) -> f64 {
        self.mean(|t| t.build)
    }

    /// Seconds of rendering.
    pub fn trace(&self) -> f64 {
        self.mean(|t| t.trace)
    }

    /// Seconds of wall time; see [`Trial::wall`].
    pub fn wall(&self) -> f64 {
        self.mean(|t| t.wall)
    }

    /// Seconds in all.
    pub fn seconds(&self) -> f64 {
        self.mean(|t| t.build + t.trace)
    }

    /// Mean squared error.
    pub fn mse(&self) -> f64 {
        self.mean(|t| t.errors.mse)
    }

    /// 95 % confidence interval of the MSE; see [`Interval::of`].
    pub fn mse_interval(&self) -> Option<Interval> {
        Interval::of(&self.trials.iter().map(|t| t.errors.mse).collect::<Vec<_>>())
    }

    /// Relative mean squared error.
    pub fn rel_mse(&self) -> f64 {
        self.mean(|t| t.errors.rel_mse)
    }

    /// Variance by half buffers; `None` where there are no random numbers.
    pub fn variance(&self) -> Option<f64> {
        let all: Option<Vec<f64>> = self.trials.iter().map(|t| t.errors.variance).collect();
        all.map(|all| mean(&all))
    }

    /// Efficiency: 1 / (MSE * seconds), seconds in all.
    pub fn efficiency(&self) -> f64 {
        1.0 / (self.mse() * self.seconds())
    }

    /// What is left of the MSE without the noise of both sides.
    pub fn bias(&self, reference: &Reference) -> Bias {
        let rest: Vec<f64> = self.trials.iter().map(|t| t.errors.mse - t.errors.variance.unwrap_or(0.0)).collect();
        Bias::of(&rest, reference)
    }
}

/// When an error is reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Reach {
    /// Between samples that were rendered, or at the first of them.
    Measured {
        /// Samples a pixel, not whole.
        samples: f64,
        /// Seconds, build included.
        seconds: f64,
    },
    /// Beyond the last, if the variance goes on falling as 1 / samples.
    Extrapolated {
        /// Samples a pixel, not whole.
        samples: f64,
        /// Seconds, build included.
        seconds: f64,
    },
    /// Not with any number of samples: so much of the error is no noise.
    Never {
        /// bias² at the most samples.
        bias: f64,
    },
}

/// A renderer's points.
#[derive(Clone, Debug, PartialEq)]
pub struct Curve {
    /// Accelerator or program.
    pub name: String,
    /// What its seconds are.
    pub clock: Clock,
    /// Whether its pictures must equal those of all others of which this holds.
    pub exact: bool,
    /// Rising samples.
    pub points: Vec<Point>,
}

impl Curve {
    /// Seconds as a line over samples; `None` without a point.
    pub fn cost(&self) -> Option<Cost> {
        let build = self.points.first()?.build();
        Cost::fit(build, &self.points.iter().map(|p| (f64::from(p.samples), p.trace())).collect::<Vec<_>>())
    }

    /// The same from one replicate alone.
    pub fn cost_of(&self, replicate: usize) -> Option<Cost> {
        let trial = |p: &Point| p.trials.get(replicate).map(|t| (f64::from(p.samples), t.trace));
        let build = self.points.first()?.trials.get(replicate)?.build;
        Cost::fit(build, &self.points.iter().map(trial).collect::<Option<Vec<_>>>()?)
    }

    /// The exponent with which the MSE falls over samples, less the reference's noise: -1 for independent samples. By least
    /// squares of the logarithms; `None` where fewer than two points are above that noise.
    pub fn slope(&self, reference: &Reference) -> Option<f64> {
        let noise = reference.variance.unwrap_or(0.0);
        let logs = self.points.iter().map(|p| (f64::from(p.samples).ln(), (p.mse() - noise).ln()));
        let logs: Vec<(f64, f64)> = logs.filter(|(_, y)| y.is_finite()).collect();
        let n = logs.len() as f64;
        let centre = logs.iter().fold((0.0, 0.0), |sum, p| (sum.0 + p.0 / n, sum.1 + p.1 / n));
        let product = logs.iter().map(|p| (p.0 - centre.0) * (p.1 - centre.1)).sum::<f64>();
        let square = logs.iter().map(|p| (p.0 - centre.0).powi(2)).sum::<f64>();
        (logs.len() > 1).then(|| product / square)
    }

    /// When the MSE, less the reference's own noise, comes down to `target`. Between two points it is taken as a power of
    /// the samples; seconds are those of [`Curve::cost`].
    pub fn reaches(&self, target: f64, reference: &Reference) -> Option<Reach> {
        let cost = self.cost()?;
        let noise = reference.variance.unwrap_or(0.0);
        // Noise may be estimated too high; what is at or below it is below every target.
        let errors: Vec<(f64, f64)> =
            self.points.iter().map(|p| (f64::from(p.samples), (p.mse() - noise).max(f64::MIN_POSITIVE))).collect();
        if let Some(i) = errors.iter().position(|(_, e)| *e <= target) {
            let (n, e) = errors[i];
            let samples = match i.checked_sub(1).map(|before| errors[before]) {
                Some((n0, e0)) => n0 * (n / n0).powf((e0 / target).ln() / (e0 / e).ln()),
                None => n,
            };
            return Some(Reach::Measured { samples, seconds: cost.seconds(samples) });
        }
        let last = self.points.last()?;
        let bias = last.bias(reference);
        let floor = if bias.is_significant() { bias.square } else { 0.0 };
        Some(match last.variance() {
            Some(variance) if target > floor => {
                let samples = variance * f64::from(last.samples) / (target - floor);
                Reach::Extrapolated { samples, seconds: cost.seconds(samples) }
            }
            _ => Reach::Never { bias: bias.square },
        })
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::picture::Picture;

    fn curve(bias: f64) -> Curve {
        let point = |samples: u32| {
            let n = f64::from(samples);
            let errors = Errors { mse: 1.0 / n + bias, rel_mse: 0.0, variance: Some(1.0 / n) };
            Point { samples, trials: vec![Trial { build: 1.0, trace: n, wall: n, errors }; 3] }
        };
        let points = [2, 4, 8].map(point).to_vec();
        Curve { name: "c".into(), clock: Clock::Processor, exact: true, points }
    }

    #[test]
    fn targets_are_met_where_closed_forms_say() {
        let reference = Reference::of(Picture::new(1, 1), None);
        let near = |reach: Option<Reach>, measured: bool, n: f64| match reach {
            Some(Reach::Measured { samples, seconds }) if measured => {
                assert!((samples - n).abs() < 1e-9 && (seconds - n - 1.0).abs() < 1e-9, "{samples} {seconds}");
            }
            Some(Reach::Extrapolated { samples, seconds }) if !measured => {
                assert!((samples - n).abs() < 1e-9 && (seconds - n - 1.0).abs() < 1e-9, "{samples} {seconds}");
            }
            other => panic!("{other:?}"),
        };
        near(curve(0.0).reaches(0.9, &reference), true, 2.0);
        near(curve(0.0).reaches(1.0 / 5.0, &reference), true, 5.0);
        near(curve(0.0).reaches(1.0 / 32.0, &reference), false, 32.0);
        near(curve(0.01).reaches(0.01 + 1.0 / 32.0, &reference), false, 32.0);
        let never = curve(0.01).reaches(0.009, &reference);
        assert!(matches!(never, Some(Reach::Never { bias }) if (bias - 0.01).abs() < 1e-12), "{never:?}");
        assert!((curve(0.0).slope(&reference).expect("three points") + 1.0).abs() < 1e-12);
    }
}
