//! Error against run time: pictures of more and more samples by several accelerators, and by other renderers.
//!
//! [`study`] renders a scene at 2, 4, 8, .. samples a pixel with every accelerator in turns, several times with seeds of
//! their own, and holds every picture against one reference. Accelerators that answer exactly cannot change a picture: it
//! is checked that theirs are equal to the bit, so their curves differ by a shift in time alone.
//!
//! Every picture is the mean of two halves A and B, rendered with independent seeds from half of the samples each. With
//! the reference R, and means over all pixels and channels of linear RGB:
//!
//! - MSE is the mean of `((A + B) / 2 - R)^2`, relMSE as [`crate::picture::metrics::Metrics::rel_mse`];
//! - the variance of the picture is the mean of `(A - B)^2 / 4`, which is unbiased as the halves are independent;
//! - bias² is what is left: `max(0, MSE - variance - the reference's own variance)`; see [`Bias`] for its error.

mod bits;
mod cost;
mod curve;
mod equal_time;
mod errors;
mod others;
mod own;
mod reference;
mod run;

pub use bits::Difference;
pub use cost::{Cost, Crossover, crossover};
pub use curve::{Clock, Curve, Point, Reach, Trial};
pub use equal_time::EqualTime;
pub use errors::{Bias, Errors, Interval};
pub use others::Other;
pub use reference::{Reference, Truth};
pub use run::{Study, study, study_of};

use crate::error::{Error, Result};
use crate::render::{Integrator, Settings};

/// What is rendered, how often, and against what.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// [`Integrator::Path`] or [`Integrator::Whitted`].
    pub integrator: Integrator,
    /// Columns of the pictures, above 0.
    pub width: u32,
    /// Rows, above 0.
    pub height: u32,
    /// Longest path in edges, above 0.
    pub max_depth: u32,
    /// Worker threads of our renderer; `None`: as many as there are cores. Other programs run on one.
    pub threads: Option<usize>,
    /// Same seed, same pictures of ours.
    pub seed: u64,
    /// Most samples a pixel, from 2; the numbers of samples are 2, 4, 8 and so on up to it.
    pub samples: u32,
    /// Independent pictures at every number of samples, at least 3: intervals come from how they scatter.
    pub replicates: u32,
    /// What the pictures are held against.
    pub truth: Truth,
    /// Other renderers to run.
    pub others: Vec<Other>,
    /// Also render what every curve can in so many seconds, build included.
    pub equal_time: Option<f64>,
}

impl Default for Options {
    /// Path tracing, 128 x 128 pixels, 2 to 64 samples three times, against our own picture of 1024 samples.
    fn default() -> Self {
        let Settings { max_depth, .. } = Settings::default();
        Self {
            integrator: Integrator::Path,
            width: 128,
            height: 128,
            max_depth,
            threads: None,
            seed: 0,
            samples: 64,
            replicates: 3,
            truth: Truth::Own(1024),
            others: Vec::new(),
            equal_time: None,
        }
    }
}

/// The reference's seeds lie this far from those of the pictures.
const APART: u64 = 1 << 40;

impl Options {
    /// Least number of replicates.
    pub const LEAST_REPLICATES: u32 = 3;
    /// Most samples a pixel, in two halves of as many as the sampler has points.
    pub const MOST_SAMPLES: u32 = 1 << 17;

    /// The numbers of samples, rising.
    pub fn levels(&self) -> Vec<u32> {
        (1..=17).map(|e| 1 << e).take_while(|&n| n <= self.samples).collect()
    }

    /// Seeds of the halves of replicate `replicate` at level `level`: all differ.
    fn seeds(&self, level: usize, replicate: u32) -> [u64; 2] {
        let picture = level as u64 * u64::from(self.replicates) + u64::from(replicate);
        let first = self.seed.wrapping_add(2 * picture);
        [first, first.wrapping_add(1)]
    }

    /// Seeds of the halves of the reference.
    fn reference_seeds(&self) -> [u64; 2] {
        [self.seed.wrapping_add(APART), self.seed.wrapping_add(APART + 1)]
    }

    /// Seeds of the halves of pictures of equal time.
    fn equal_time_seeds(&self) -> [u64; 2] {
        [self.seed.wrapping_add(2 * APART), self.seed.wrapping_add(2 * APART + 1)]
    }

    fn check(&self) -> Result<()> {
        let even = |n: u32| (2..=Self::MOST_SAMPLES).contains(&n) && n.is_multiple_of(2);
        if !(2..=Self::MOST_SAMPLES).contains(&self.samples) {
            let most = Self::MOST_SAMPLES;
            return Err(Error::invalid(format!("{} samples a pixel, wanted are 2 to {most}", self.samples)));
        }
        if self.replicates < Self::LEAST_REPLICATES {
            let (have, least) = (self.replicates, Self::LEAST_REPLICATES);
            return Err(Error::invalid(format!("{have} replicates, wanted are at least {least} for an interval")));
        }
        if let Truth::Own(n) = self.truth
            && !even(n)
        {
            let most = Self::MOST_SAMPLES;
            return Err(Error::invalid(format!("a reference of {n} samples, wanted are 2 to {most} and even")));
        }
        if !matches!(self.integrator, Integrator::Path | Integrator::Whitted) {
            let cause = format!("integrator {:?} has no error to speak of: path or whitted", self.integrator);
            return Err(Error::invalid(cause.to_lowercase()));
        }
        if let Some(seconds) = self.equal_time
            && !(seconds.is_finite() && seconds > 0.0)
        {
            return Err(Error::invalid(format!("pictures of {seconds} seconds, wanted is a finite time above 0")));
        }
        Ok(())
    }
}
