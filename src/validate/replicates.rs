//! Independent renders, reduced to their mean and the variance of that mean.

use super::Options;
use crate::accel::Accel;
use crate::error::Result;
use crate::picture::Picture;
use crate::picture::agreement::Estimate;
use crate::render::{Integrator, Sampler, Settings};
use crate::scene::Scene;

/// A picture that is known with its noise.
#[derive(Clone, Debug)]
pub(super) struct Measured {
    /// Mean of the renders.
    pub mean: Picture,
    /// Variance of that mean.
    pub variance: Picture,
    /// Number of renders.
    pub replicates: u32,
}

impl Measured {
    /// As the tests want it.
    pub fn estimate(&self) -> Estimate<'_> {
        Estimate { mean: &self.mean, variance: &self.variance, replicates: self.replicates }
    }
}

/// What our renders have to have in common with the pictures that they are compared with.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wanted {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Longest path in edges.
    pub max_depth: u32,
}

/// Path-traces the scene `options.replicates` times, with the seeds `first_seed`, `first_seed + 1`, and so on; gives the rays
/// that it took too.
pub(super) fn replicate(
    wanted: Wanted,
    first_seed: u64,
    scene: &Scene,
    accel: &dyn Accel,
    options: &Options,
) -> Result<(Measured, u64)> {
    let mut settings = Settings {
        integrator: Integrator::Path,
        width: wanted.width,
        height: wanted.height,
        sampler: Sampler::Sobol(options.spp),
        max_depth: wanted.max_depth,
        threads: options.threads,
        ..Settings::default()
    };
    let mut moments = Moments::default();
    let mut all_rays = 0;
    for seed in 0..u64::from(options.replicates) {
        settings.seed = first_seed + seed;
        let (picture, rays) = options.render(scene, accel, &settings)?;
        moments.add(&picture);
        all_rays += rays;
    }
    Ok((moments.reduce(wanted.width, wanted.height), all_rays))
}

/// Running mean and sum of squared deviations of each value. Source: Welford 1962, "Note on a method for calculating
/// corrected sums of squares and products".
#[derive(Default)]
pub(super) struct Moments {
    count: u32,
    values: Vec<[(f64, f64); 3]>,
}

impl Moments {
    /// Adds one render; all are of one size.
    pub fn add(&mut self, picture: &Picture) {
        self.values.resize(picture.pixels.len(), [(0.0, 0.0); 3]);
        self.count += 1;
        let count = f64::from(self.count);
        for (values, pixel) in self.values.iter_mut().zip(&picture.pixels) {
            for ((mean, squares), &value) in values.iter_mut().zip(pixel) {
                let before = f64::from(value) - *mean;
                *mean += before / count;
                *squares += before * (f64::from(value) - *mean);
            }
        }
    }

    /// The mean and the variance of the mean of at least two renders of this size.
    pub fn reduce(&self, width: u32, height: u32) -> Measured {
        let picture = |value: &dyn Fn(&(f64, f64)) -> f64| Picture {
            width,
            height,
            pixels: self.values.iter().map(|p| [0, 1, 2].map(|c| value(&p[c]) as f32)).collect(),
        };
        let count = f64::from(self.count);
        let divisor = (count - 1.0) * count;
        Measured { mean: picture(&|v| v.0), variance: picture(&|v| v.1 / divisor), replicates: self.count }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_three_pictures() {
        let mut moments = Moments::default();
        for value in [1.0, 2.0, 6.0f32] {
            moments.add(&Picture { width: 1, height: 1, pixels: vec![[value, 5.0, -value]] });
        }
        let found = moments.reduce(1, 1);
        assert_eq!((found.replicates, &found.mean.pixels), (3, &vec![[3.0, 5.0, -3.0]]));
        // Squared deviations 4 + 1 + 9, over 2 x 3.
        assert_eq!(found.variance.pixels, [[14.0 / 6.0, 0.0, 14.0 / 6.0]]);
    }
}
