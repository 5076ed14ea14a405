//! How many rays a picture is likely to take.

use super::{Integrator, Settings};
use crate::scene::Scene;

/// Edges of a path beyond which few go on: most leave the scene or are ended by then.
const USUAL_DEPTH: u32 = 4;

impl Settings {
    /// Rays that a picture of `scene` is likely to take: one for each sample, and for each further edge of a path one
    /// to a light (one to each in Whitted's method) and one onwards, for four edges at most.
    ///
    /// An estimate within a factor of two or three, for decisions that depend on orders of magnitude.
    pub fn expected_rays(&self, scene: &Scene) -> f64 {
        let (width, height) = self.crop.map_or((self.width, self.height), |crop| (crop.width, crop.height));
        let samples = f64::from(width) * f64::from(height) * f64::from(self.sampler.samples());
        let edges = f64::from(self.max_depth.clamp(1, USUAL_DEPTH) - 1);
        let each = match self.integrator {
            Integrator::Path => 1.0 + 2.0 * edges,
            Integrator::Whitted => 1.0 + (1.0 + scene.lights.len() as f64) * edges,
            _ => 1.0,
        };
        samples * each
    }
}

#[cfg(test)]
mod tests {
    use super::super::{Crop, Sampler};
    use super::*;

    #[test]
    fn rays_are_counted_by_the_sample() {
        let scene = crate::scene::load("cornell", &Default::default()).expect("made by formula");
        let settings =
            Settings { width: 10, height: 20, sampler: Sampler::Sobol(4), max_depth: 2, ..Settings::default() };
        assert_eq!(settings.expected_rays(&scene), 200.0 * 4.0 * 3.0);
        let crop = Some(Crop { x: 0, y: 0, width: 5, height: 5 });
        let settings = Settings { crop, integrator: Integrator::Depth, ..settings };
        assert_eq!(settings.expected_rays(&scene), 100.0);
    }
}
