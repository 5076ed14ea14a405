//! Sums and sums of squares for each pixel.

use crate::error::{Error, Result};
use crate::picture::Picture;
use glam::DVec3;

/// The samples of all pixels, summed.
#[derive(Clone, Debug, PartialEq)]
pub struct Film {
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Samples for each pixel.
    pub samples: u32,
    /// Sum of the samples, row by row from the top, linear RGB; `width * height` entries.
    pub sum: Vec<DVec3>,
    /// Sum of the squares of the samples, in the same order.
    pub sum_squares: Vec<DVec3>,
    /// What it took.
    pub stats: RenderStats,
}

/// Rays traced for a film; independent of the accelerator and of the number of threads.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RenderStats {
    /// Closest-hit rays from the eye.
    pub camera: u64,
    /// Any-hit rays towards lights.
    pub shadow: u64,
    /// Closest-hit rays from surfaces.
    pub bounce: u64,
    /// Rays towards lights that need not be traced, because shadow voxels knew their answer.
    pub spared: u64,
    /// Of the rays towards lights, those that shadow voxels let end early.
    pub shortened: u64,
    /// Samples that were not finite and count as black. Not 0 only where coordinates or colours come near the end of
    /// the range of their numbers.
    pub discarded: u64,
}

impl RenderStats {
    /// All rays.
    pub fn rays(&self) -> u64 {
        self.camera + self.shadow + self.bounce
    }
}

impl std::ops::AddAssign for RenderStats {
    fn add_assign(&mut self, other: Self) {
        self.camera += other.camera;
        self.shadow += other.shadow;
        self.bounce += other.bounce;
        self.spared += other.spared;
        self.shortened += other.shortened;
        self.discarded += other.discarded;
    }
}

impl Film {
    /// A film without light, of so many samples for each pixel.
    ///
    /// # Errors
    /// It does not fit into memory.
    pub fn new(width: u32, height: u32, samples: u32) -> Result<Self> {
        let stats = RenderStats::default();
        Ok(Self { width, height, samples, sum: black(width, height)?, sum_squares: black(width, height)?, stats })
    }

    /// The mean of the samples, rounded to f32; NaN for a film of none.
    pub fn picture(&self) -> Picture {
        let samples = f64::from(self.samples);
        self.map(|sum, _| sum / samples)
    }

    /// The estimated variance of the mean of the samples, for each channel.
    ///
    /// Takes the samples as independent. For low-discrepancy samples it is an upper bound by experience, not by proof;
    /// films of several seeds give an unbiased estimate. Never negative. A single sample has unknown variance: `inf`.
    pub fn variance_of_mean(&self) -> Picture {
        let samples = f64::from(self.samples);
        if self.samples < 2 {
            return self.map(|_, _| DVec3::INFINITY);
        }
        self.map(|sum, squares| ((squares - sum * sum / samples) / (samples * (samples - 1.0))).max(DVec3::ZERO))
    }

    /// Adds the samples of another film of the same part of the same picture: of another seed, or of other samples.
    /// Sums are rounded: only [`super::join`] gives the bits of one render.
    ///
    /// # Errors
    /// The films differ in size, or the samples are more than `u32` can count.
    pub fn merge(&mut self, other: &Film) -> Result<()> {
        if (self.width, self.height) != (other.width, other.height) {
            return Err(Error::invalid(format!(
                "a film of {}x{} pixels cannot take one of {}x{}",
                self.width, self.height, other.width, other.height
            )));
        }
        self.samples = self.samples.checked_add(other.samples).ok_or_else(|| {
            Error::invalid(format!("{} and {} samples are too many for one film", self.samples, other.samples))
        })?;
        self.sum.iter_mut().zip(&other.sum).for_each(|(a, b)| *a += *b);
        self.sum_squares.iter_mut().zip(&other.sum_squares).for_each(|(a, b)| *a += *b);
        self.stats += other.stats;
        Ok(())
    }

    fn map(&self, value: impl Fn(DVec3, DVec3) -> DVec3) -> Picture {
        let pixels = self.sum.iter().zip(&self.sum_squares).map(|(&a, &b)| value(a, b).as_vec3().to_array()).collect();
        Picture { width: self.width, height: self.height, pixels }
    }
}

/// Black pixels, or an error if they do not fit into memory.
fn black(width: u32, height: u32) -> Result<Vec<DVec3>> {
    let wanted = u64::from(width) * u64::from(height);
    let pixels = usize::try_from(wanted).unwrap_or(usize::MAX);
    let mut values = Vec::new();
    values.try_reserve_exact(pixels).map_err(|_| Error::TooLarge {
        what: format!("film of {width}x{height} pixels"),
        wanted: wanted.saturating_mul(2 * size_of::<DVec3>() as u64),
        allowed: isize::MAX as u64,
    })?;
    values.resize(pixels, DVec3::ZERO);
    Ok(values)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn film_of(samples: &[f64]) -> Film {
        let mut film = Film::new(1, 1, samples.len() as u32).expect("one pixel");
        film.sum[0] = DVec3::splat(samples.iter().sum());
        film.sum_squares[0] = DVec3::splat(samples.iter().map(|s| s * s).sum());
        film
    }

    #[test]
    fn mean_and_variance_of_four_samples() {
        let film = film_of(&[1.0, 2.0, 3.0, 6.0]);
        assert_eq!(film.picture().pixels[0], [3.0; 3]);
        // Sample variance (4 + 1 + 0 + 9) / 3, over 4.
        assert_eq!(film.variance_of_mean().pixels[0][0], (14.0 / 3.0 / 4.0) as f32);
        assert_eq!(film_of(&[1.0]).variance_of_mean().pixels[0][0], f32::INFINITY);
    }

    #[test]
    fn merged_films_equal_one_film_of_all_samples() {
        let mut film = film_of(&[1.0, 2.0]);
        film.merge(&film_of(&[3.0, 6.0])).expect("equal sizes");
        assert_eq!(film, film_of(&[1.0, 2.0, 3.0, 6.0]));
        assert!(film.merge(&Film::new(2, 1, 1).expect("two pixels")).is_err());
    }
}
