//! How far a picture in two halves is from its reference, and what part of that is noise.

use super::reference::Reference;
use crate::error::{Error, Result};
use crate::picture::{Picture, metrics};
use statrs::distribution::{ContinuousCDF, StudentsT};

/// Errors of one picture; see the [module](super) for their definitions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Errors {
    /// Mean squared error.
    pub mse: f64,
    /// The same relative to the reference.
    pub rel_mse: f64,
    /// Variance of the picture by its halves; `None` for a picture without random numbers.
    pub variance: Option<f64>,
}

impl Errors {
    /// Of the mean of `halves`, one or two pictures, against `reference`; and that mean.
    ///
    /// # Errors
    /// The sizes differ, or a pixel is not finite.
    pub fn of(halves: &[Picture], reference: &Reference) -> Result<(Self, Picture)> {
        let (picture, variance) = match halves {
            [one] => (one.clone(), None),
            [a, b] => {
                let (picture, variances) = mean_and_variance(a, b)?;
                (picture, Some(mean(&variances)))
            }
            _ => return Err(Error::invalid(format!("a picture of {} parts, wanted are one or two", halves.len()))),
        };
        let distance = metrics::compare(&picture, &reference.picture)?;
        Ok((Self { mse: distance.mse, rel_mse: distance.rel_mse, variance }, picture))
    }
}

/// The mean of two halves, and for each pixel its estimated variance, mean of the channels.
pub(super) fn mean_and_variance(a: &Picture, b: &Picture) -> Result<(Picture, Vec<f64>)> {
    // For its checks alone.
    metrics::compare(a, b)?;
    let pairs = || a.pixels.iter().zip(&b.pixels);
    let middle = |a: f32, b: f32| ((f64::from(a) + f64::from(b)) / 2.0) as f32;
    let pixels = pairs().map(|(a, b)| [0, 1, 2].map(|c| middle(a[c], b[c]))).collect();
    let square = |a: f32, b: f32| (f64::from(a) - f64::from(b)).powi(2) / 4.0;
    let variances = pairs().map(|(a, b)| (0..3).map(|c| square(a[c], b[c])).sum::<f64>() / 3.0).collect();
    Ok((Picture { width: a.width, height: a.height, pixels }, variances))
}

/// Systematic error that is left when noise is taken off the MSE.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Bias {
    /// bias²: `max(0, MSE - variance - variance of the reference)`, means over the replicates before the maximum is taken.
    pub square: f64,
    /// Half of the 95 % confidence interval of that difference: from the scatter of the replicates (Student's t) and from the
    /// noise of the reference, which all pictures share (normal). A bias² below this is no evidence of any.
    pub error: f64,
}

impl Bias {
    /// Of the picture whose replicates have these differences of MSE and variance.
    pub(super) fn of(rest: &[f64], reference: &Reference) -> Self {
        let square = (mean(rest) - reference.variance.unwrap_or(0.0)).max(0.0);
        let scatter = quantile(rest.len()).map_or(0.0, |q| q * standard_error(rest));
        Self { square, error: scatter.hypot(1.96 * reference.variance_error) }
    }

    /// True if there is evidence of it.
    pub fn is_significant(&self) -> bool {
        self.square > self.error
    }
}

/// Of Student's distribution for the 95 % interval of a mean of `count` values; `None` for fewer than two.
fn quantile(count: usize) -> Option<f64> {
    let freedom = count.checked_sub(1).filter(|f| *f > 0)?;
    Some(StudentsT::new(0.0, 1.0, freedom as f64).ok()?.inverse_cdf(0.975))
}

/// Ends of a 95 % confidence interval.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Interval {
    /// Lower end, above 0.
    pub low: f64,
    /// Upper end.
    pub high: f64,
}

impl Interval {
    /// Student's t interval for the mean of the logarithms of `values`, put back into their unit; `None` for fewer than two
    /// values, or if one is not above 0.
    pub fn of(values: &[f64]) -> Option<Self> {
        let logs: Vec<f64> = values.iter().map(|v| v.ln()).collect();
        let quantile = quantile(logs.len()).filter(|_| logs.iter().all(|l| l.is_finite()))?;
        let (centre, half) = (mean(&logs), quantile * standard_error(&logs));
        Some(Self { low: (centre - half).exp(), high: (centre + half).exp() })
    }
}

/// NaN if there is none.
pub(super) fn mean(values: &[f64]) -> f64 {
    values.iter().sum::<f64>() / values.len() as f64
}

/// Of the mean of `values`; 0 for fewer than two.
pub(super) fn standard_error(values: &[f64]) -> f64 {
    let n = values.len() as f64;
    if values.len() < 2 {
        return 0.0;
    }
    let centre = mean(values);
    (values.iter().map(|v| (v - centre).powi(2)).sum::<f64>() / (n - 1.0) / n).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;

    fn grey(values: &[f32]) -> Picture {
        Picture { width: values.len() as u32, height: 1, pixels: values.iter().map(|&v| [v; 3]).collect() }
    }

    #[test]
    fn errors_of_two_halves_by_hand() {
        let reference = Reference::of(grey(&[1.0, 2.0]), None);
        let halves = [grey(&[1.0, 4.0]), grey(&[2.0, 2.0])];
        // Mean 1.5 and 3; squares of the distances 0.25 and 1; of the differences, over 4, 0.25 and 1.
        let (errors, picture) = Errors::of(&halves, &reference).expect("comparable");
        assert_eq!(picture, grey(&[1.5, 3.0]));
        assert_eq!((errors.mse, errors.variance), (0.625, Some(0.625)));
        let (errors, _) = Errors::of(&halves[..1], &reference).expect("comparable");
        assert_eq!((errors.mse, errors.variance), (2.0, None));
        assert!(Errors::of(&[], &reference).is_err());
        assert!(Errors::of(&[grey(&[1.0])], &reference).is_err());
    }

    #[test]
    fn intervals_are_students() {
        // exp of 0, 1, 2: mean 1, standard error 1/sqrt 3, quantile for two degrees of freedom 4.302653.
        let interval = Interval::of(&[1.0, 1f64.exp(), 2f64.exp()]).expect("three values");
        let half = 4.302_652_729_7 / 3f64.sqrt();
        assert!((interval.low.ln() - (1.0 - half)).abs() < 1e-6 && (interval.high.ln() - (1.0 + half)).abs() < 1e-6);
        assert_eq!(Interval::of(&[1.0]), None);
        assert_eq!(Interval::of(&[1.0, 0.0, 1.0]), None);
    }
}
