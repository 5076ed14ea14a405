//! What is checked before a picture is begun, so that nothing needs checking while it is made.

use super::light::has_area_lights;
use super::sampler::SOBOL_LIMIT;
use super::{Crop, Integrator, Sampler, Settings};
use crate::accel::half_the_memory;
use crate::error::{Error, Result};
use crate::scene::{Bsdf, Scene};

/// Most pixels of a film: 2^28, such as 16384 x 16384.
const MAX_PIXELS: u64 = 1 << 28;

/// Two sums of three f64 for each pixel.
const PIXEL_BYTES: u64 = 48;

/// Longest path of the recursive integrator, as POV-Ray's.
const MAX_DEPTH_WHITTED: u32 = 256;

/// Longest path of the path tracer.
const MAX_DEPTH_PATH: u32 = 1 << 16;

/// Most worker threads.
const MAX_THREADS: usize = 1024;

/// The part of the picture to render, if the settings can be followed with so many `films` at once.
pub(super) fn settings(settings: &Settings, films: usize) -> Result<Crop> {
    let (width, height) = (settings.width, settings.height);
    if width == 0 || height == 0 {
        return Err(Error::invalid(format!("picture size is {width}x{height}, both must be above 0")));
    }
    let area = settings.crop.unwrap_or(Crop { x: 0, y: 0, width, height });
    let inside =
        |start: u32, length: u32, whole: u32| length > 0 && start.checked_add(length).is_some_and(|end| end <= whole);
    if !(inside(area.x, area.width, width) && inside(area.y, area.height, height)) {
        return Err(Error::invalid(format!(
            "crop of {}x{} pixels at ({}, {}) is empty or leaves the picture of {width}x{height}",
            area.width, area.height, area.x, area.y
        )));
    }
    let pixels = u64::from(area.width) * u64::from(area.height);
    let wanted = pixels.saturating_mul(PIXEL_BYTES).saturating_mul(films as u64);
    let allowed = half_the_memory().min(MAX_PIXELS * PIXEL_BYTES);
    if wanted > allowed {
        let what = format!("film of {}x{} pixels", area.width, area.height);
        return Err(Error::TooLarge { what, wanted, allowed });
    }
    match settings.sampler {
        Sampler::Regular(n) if n == 0 || n.checked_mul(n).is_none() => {
            return Err(Error::invalid(format!("regular sub-grid of {n}x{n} samples, allowed are 1 to 65535")));
        }
        Sampler::Sobol(n) if n == 0 || n > SOBOL_LIMIT => {
            return Err(Error::invalid(format!("{n} samples for each pixel, allowed are 1 to {SOBOL_LIMIT}")));
        }
        _ => {}
    }
    let longest = match settings.integrator {
        Integrator::Whitted => MAX_DEPTH_WHITTED,
        _ => MAX_DEPTH_PATH,
    };
    if settings.max_depth == 0 || settings.max_depth > longest {
        return Err(Error::invalid(format!("max_depth is {}, allowed are 1 to {longest}", settings.max_depth)));
    }
    if let Some(threads) = settings.threads
        && (threads == 0 || threads > MAX_THREADS)
    {
        return Err(Error::invalid(format!("{threads} threads, allowed are 1 to {MAX_THREADS}")));
    }
    Ok(area)
}

/// Checks what materials and textures must promise to be looked up without checks.
pub(super) fn scene(scene: &Scene) -> Result<()> {
    for (i, texture) in scene.textures.iter().enumerate() {
        let (width, height, texels) = (texture.width, texture.height, texture.texels.len());
        if u64::from(width) * u64::from(height) != texels as u64 || texels == 0 {
            let name = &texture.name;
            return Err(Error::invalid(format!("texture {i} `{name}`: {texels} texels for {width}x{height}")));
        }
    }
    for (i, material) in scene.materials.iter().enumerate() {
        let cause = match material.bsdf {
            Bsdf::Lambert { texture: Some(t), .. } if t as usize >= scene.textures.len() => {
                format!("refers to texture {t} of {}", scene.textures.len())
            }
            Bsdf::Dielectric { ior } if !(ior > 0.0 && ior.is_finite()) => {
                format!("index of refraction is {ior}, must be above 0 and finite")
            }
            Bsdf::Conductor { alpha, .. } if !(alpha > 0.0 && alpha <= 1.0) => {
                format!("roughness is {alpha}, must be above 0 and at most 1")
            }
            _ => continue,
        };
        return Err(Error::invalid(format!("material {i} `{}`: {cause}", material.name)));
    }
    let materials = scene.materials.len();
    let used = scene.meshes.iter().map(|m| m.material).chain(scene.sphere_materials.iter().copied());
    let voxels = scene.voxels().and_then(|v| v.materials().iter().max()).and_then(|byte| byte.checked_sub(1));
    let used = used.chain(voxels.map(u32::from));
    let used = used.chain(scene.patch_materials.iter().copied());
    match used.max() {
        Some(m) if m as usize >= materials => Err(Error::invalid(format!("material {m} of {materials} is in use"))),
        _ => Ok(()),
    }
}

/// What the integrator leaves out of this scene, one sentence each.
pub fn omissions(scene: &Scene, integrator: Integrator) -> Vec<String> {
    let mut sentences = Vec::new();
    if integrator == Integrator::Whitted {
        let mut add = |found: bool, sentence: &str| {
            if found {
                sentences.push(sentence.to_owned());
            }
        };
        add(has_area_lights(scene), "whitted: emissive primitives are seen but light nothing");
        add(scene.environment.max_element() > 0.0, "whitted: the environment is seen but lights nothing");
        let rough = |m: &crate::scene::Material| matches!(m.bsdf, Bsdf::Conductor { .. });
        add(scene.materials.iter().any(rough), "whitted: rough conductors show lights only, no reflections");
    }
    sentences
}
