//! The path tracer, generic over the accelerator.

mod film;
mod integrator;
mod sampler;

pub use film::Film;

use crate::accel::Accel;
use crate::error::Result;
use crate::scene::Scene;

/// What is computed for each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Integrator {
    /// Path tracing with next-event estimation and multiple importance sampling; compared with Mitsuba's `path`.
    Path,
    /// Whitted 1980: point lights, mirrors and the full Fresnel split, no random numbers; compared with POV-Ray.
    Whitted,
    /// Ray parameter of the first hit along a unit direction, world units; 0 where nothing is hit.
    Depth,
    /// Shading normal turned towards the viewer, each component mapped from -1..1 to 0..1.
    Normal,
    /// A colour for each primitive index.
    Prim,
    /// Steps (red), tests (green) and leaps (blue) of the camera ray.
    Steps,
}

/// Where samples lie in a pixel and what random numbers are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    /// The centres of an n x n grid in each pixel; `n * n` samples.
    Regular(u32),
    /// Owen-scrambled Sobol points, this many samples.
    Sobol(u32),
}

/// A part of the picture, pixels; `x..x + width`, `y..y + height`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// How to render.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// What is computed.
    pub integrator: Integrator,
    /// Columns of the whole picture.
    pub width: u32,
    /// Rows of the whole picture.
    pub height: u32,
    /// Only this part is rendered; `None`: all.
    pub crop: Option<Crop>,
    /// Samples for each pixel.
    pub sampler: Sampler,
    /// Same seed, same picture, whatever the accelerator and the number of threads.
    pub seed: u64,
    /// Longest path in edges: 1 sees emission only, 2 adds direct light.
    pub max_depth: u32,
    /// Bounce after which Russian roulette may end a path.
    pub rr_depth: u32,
    /// Worker threads; `None`: as many as there are cores.
    pub threads: Option<usize>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            integrator: Integrator::Path,
            width: 512,
            height: 512,
            crop: None,
            sampler: Sampler::Sobol(16),
            seed: 0,
            max_depth: 8,
            rr_depth: 5,
            threads: None,
        }
    }
}

/// Renders `scene`; calls `progress` with the number of finished and of all tiles, from any thread.
///
/// # Errors
/// A size or count is zero or beyond what memory allows; the crop lies outside the picture.
pub fn render<A: Accel + ?Sized>(
    _scene: &Scene,
    _accel: &A,
    _settings: &Settings,
    _progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Film> {
    unimplemented!()
}
