//! How much work an accelerator does for the camera ray of each pixel.

use super::Options;
use crate::accel::Accel;
use crate::error::Result;
use crate::picture::Picture;
use crate::render::{Integrator, Sampler, Settings};
use crate::scene::Scene;
use serde::Serialize;

/// Counts for one ray through the middle of each pixel; independent of the machine.
#[derive(Clone, Debug, Serialize)]
pub struct Steps {
    /// Voxels or nodes visited, mean over the pixels; 0 for accelerators that cannot count them.
    pub steps: f64,
    /// Primitive tests, mean over the pixels.
    pub tests: f64,
    /// Leaps over several voxels, mean over the pixels.
    pub leaps: f64,
    /// Voxels or nodes visited, for the pixel with the most.
    pub most_steps: f32,
    /// Primitive tests, for the pixel with the most.
    pub most_tests: f32,
    /// Voxels or nodes visited (red), primitive tests (green), leaps (blue).
    #[serde(skip)]
    pub picture: Picture,
}

/// Counts them for a picture of this size.
pub(super) fn count((width, height): (u32, u32), scene: &Scene, accel: &dyn Accel, options: &Options) -> Result<Steps> {
    let settings = Settings {
        integrator: Integrator::Steps,
        width,
        height,
        sampler: Sampler::Regular(1),
        threads: options.threads,
        ..Settings::default()
    };
    let (picture, _) = options.render(scene, accel, &settings)?;
    let mean = |c: usize| picture.pixels.iter().map(|p| f64::from(p[c])).sum::<f64>() / picture.pixels.len() as f64;
    let most = |c: usize| picture.pixels.iter().map(|p| p[c]).fold(0.0, f32::max);
    Ok(Steps { steps: mean(0), tests: mean(1), leaps: mean(2), most_steps: most(0), most_tests: most(1), picture })
}
