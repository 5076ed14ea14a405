//! Whether shadow voxels are worth building for a picture.

use super::{Integrator, Settings};
use crate::accel::PointShadows;
use crate::error::Result;
use crate::scene::Scene;
use glam::DVec3;

/// Rays to a light for each primitive from which on shadow voxels are likely to pay.
///
/// The bits of one light cost about 1 to 5 us a primitive, and spare 0.02 to 0.2 us a ray where they spare anything, as
/// `skipgrid papers shadow-voxels` shows: the balance lies between 6 and 100 rays, or nowhere where no ray is spared.
const RAYS: f64 = 32.0;

/// Shadow voxels for point lights at `points`, where they are wanted or likely to pay. Where they only are likely to and do not
/// fit into memory, there are none.
///
/// # Errors
/// They are wanted and do not fit into memory.
pub(super) fn known(scene: &Scene, points: &[DVec3], settings: &Settings) -> Result<Option<Box<dyn PointShadows>>> {
    let shades = matches!(settings.integrator, Integrator::Path | Integrator::Whitted) && settings.max_depth > 1;
    if points.is_empty() || !shades {
        return Ok(None);
    }
    match settings.shadow_voxels {
        Some(false) => Ok(None),
        Some(true) => scene.shadow_voxels(points).map(Some),
        None if pays(scene, points.len(), settings) => Ok(scene.shadow_voxels(points).ok()),
        None => Ok(None),
    }
}

fn pays(scene: &Scene, lights: usize, settings: &Settings) -> bool {
    let (columns, rows) = settings.crop.map_or((settings.width, settings.height), |crop| (crop.width, crop.height));
    let samples = f64::from(columns) * f64::from(rows) * f64::from(settings.sampler.samples());
    // Whitted's method connects a point with all lights, path tracing with one.
    let each = if settings.integrator == Integrator::Whitted { samples } else { samples / lights as f64 };
    each >= RAYS * f64::from(scene.primitive_count())
}
