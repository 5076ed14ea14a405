//! What pictures are held against, and how noisy it is itself.

use super::errors::{mean, mean_and_variance, standard_error};
use crate::error::{Error, Result};
use crate::picture::{Picture, io, metrics::NonFinite};
use std::path::{Path, PathBuf};

/// Where a reference comes from.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Truth {
    /// A file; an EXR file with channels `variance.R`, `variance.G` and `variance.B` tells its own noise.
    File(PathBuf),
    /// Our own picture of so many samples a pixel, even, with seeds that no other picture has.
    Own(u32),
}

/// A reference and its noise.
#[derive(Clone, Debug, PartialEq)]
pub struct Reference {
    /// The picture.
    pub picture: Picture,
    /// Its variance, mean over pixels and channels; `None` where nothing tells: its noise then counts as bias.
    pub variance: Option<f64>,
    /// Standard error of the difference between the squared noise that this picture has and [`Reference::variance`].
    pub variance_error: f64,
}

impl Reference {
    /// `picture` with the estimated variance of each pixel, mean of its channels, if that is known by many degrees of
    /// freedom.
    ///
    /// The squared noise of a normal pixel scatters by sqrt 2 of its variance; pixels are taken as independent, the channels
    /// of one as equal.
    pub fn of(picture: Picture, variances: Option<&[f64]>) -> Self {
        let variance = variances.map(mean);
        let squares = variances.map_or(0.0, |v| v.iter().map(|v| 2.0 * v * v).sum());
        let variance_error = f64::sqrt(squares) / picture.pixels.len().max(1) as f64;
        Self { picture, variance, variance_error }
    }

    /// The mean of two independent halves.
    ///
    /// Noise and its estimate have the same distribution here and do not depend on each other, so that their difference has
    /// twice the variance of the estimate.
    ///
    /// # Errors
    /// The halves differ in size, or a pixel is not finite.
    pub fn of_halves(a: &Picture, b: &Picture) -> Result<Self> {
        let (picture, variances) = mean_and_variance(a, b)?;
        let variance_error = 2f64.sqrt() * standard_error(&variances);
        Ok(Self { picture, variance: Some(mean(&variances)), variance_error })
    }

    /// Reads a file.
    ///
    /// # Errors
    /// As [`io::read`]; a pixel is not finite.
    pub fn read(path: &Path) -> Result<Self> {
        let finite = |picture: &Picture, what: &str| match NonFinite::of(picture).complaint(what) {
            Some(cause) => Err(Error::malformed(path, cause)),
            None => Ok(()),
        };
        let picture = io::read(path)?;
        finite(&picture, "the reference")?;
        let exr = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
        let variances = exr.then(|| io::read_with_variance(path).ok()).flatten();
        let Some((picture, variances)) = variances else { return Ok(Self::of(picture, None)) };
        finite(&variances, "the reference's variance")?;
        let variances: Vec<f64> =
            variances.pixels.iter().map(|p| p.iter().map(|&v| f64::from(v)).sum::<f64>() / 3.0).collect();
        Ok(Self::of(picture, Some(&variances)))
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn noise_of_halves_is_that_of_their_mean() {
        let grey = |values: &[f32]| Picture {
            width: values.len() as u32,
            height: 1,
            pixels: values.iter().map(|&v| [v; 3]).collect(),
        };
        let reference = Reference::of_halves(&grey(&[1.0, 3.0]), &grey(&[3.0, 7.0])).expect("two halves");
        assert_eq!(reference.picture, grey(&[2.0, 5.0]));
        // (1 + 4) / 2; their standard error is 1.5.
        assert_eq!(reference.variance, Some(2.5));
        assert!((reference.variance_error - 1.5 * 2f64.sqrt()).abs() < 1e-12);
        let known = Reference::of(grey(&[0.0, 0.0]), Some(&[3.0, 4.0]));
        assert_eq!((known.variance, known.variance_error), (Some(3.5), 50f64.sqrt() / 2.0));
        assert_eq!(Reference::of(grey(&[0.0]), None).variance, None);
    }
}
