//! Whether shadow voxels are worth building for a picture.

use super::{Integrator, Settings};
use crate::accel::PointShadows;
use crate::error::Result;
use crate::scene::Scene;
use glam::DVec3;

/// Shadow voxels for each primitive, in [`render`](super::render): many more than of a grid for tracing, for a voxel is
/// lit or dark only if all of it is.
pub const SHADOW_DENSITY: f64 = 16.0;

/// Rays to a light for each primitive from which on shadow voxels are likely to pay.
///
/// The bits of one light cost about 1 to 5 us a primitive and save 0 to 0.3 us a ray, as `skipgrid papers
/// shadow-voxels` shows: the balance lies between 10 and 200 rays, or nowhere where next to nothing is decided.
const RAYS: f64 = 64.0;

/// Share of decided voxels below which asking costs more than it saves.
const LEAST: f64 = 0.05;

/// Shadow voxels for point lights at `points` and so many `samples` of each pixel, where they are wanted or likely to
/// pay. Where they only are likely to and do not fit into memory, or turn out to know next to nothing, there are none.
///
/// # Errors
/// They are wanted and do not fit into memory.
pub(super) fn known(
    scene: &Scene,
    points: &[DVec3],
    settings: &Settings,
    samples: u32,
) -> Result<Option<Box<dyn PointShadows>>> {
    let shades = matches!(settings.integrator, Integrator::Path | Integrator::Whitted) && settings.max_depth > 1;
    let wanted = settings.shadow_voxels;
    if points.is_empty()
        || !shades
        || wanted == Some(false)
        || (wanted.is_none() && !pays(scene, points.len(), settings, samples))
    {
        return Ok(None);
    }
    match (scene.shadow_voxels(points, SHADOW_DENSITY), wanted) {
        (built, Some(_)) => built.map(Some),
        (built, None) => Ok(built.ok().filter(|shadows| shadows.decided() >= LEAST)),
    }
}

fn pays(scene: &Scene, lights: usize, settings: &Settings, samples: u32) -> bool {
    let (columns, rows) = settings.crop.map_or((settings.width, settings.height), |crop| (crop.width, crop.height));
    let samples = f64::from(columns) * f64::from(rows) * f64::from(samples);
    // Whitted's method connects a point with all lights, path tracing with one.
    let each = if settings.integrator == Integrator::Whitted { samples } else { samples / lights as f64 };
    each >= RAYS * f64::from(scene.primitive_count())
}
