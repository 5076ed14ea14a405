//! Arguments that several verbs share, and how they are read.

use super::console::Console;
use crate::auto::Choice;
use crate::error::{Error, Result};
use crate::registry;
use crate::render::{Sampler, Settings};
use crate::scene::{CameraSource, LoadOptions, Scene, load};
use std::path::Path;

/// The accelerator that verbs use unless told otherwise.
pub const DEFAULT_ACCEL: &str = "auto";

/// The accelerators that are compared and validated unless told otherwise.
pub use crate::validate::DEFAULT_ACCELERATORS as DEFAULT_ACCELS;

/// Which scene, and how it is read.
#[derive(Clone, Debug, clap::Args)]
pub struct SceneArgs {
    /// A .toml, .gltf, .glb, .obj, .vox, .npy, .tri or .sph file, or a scene made by formula such as `random:n=10000`
    pub scene: String,

    /// Drop primitives with coordinates that are not finite, with a warning, instead of refusing the file
    #[arg(long)]
    pub drop_invalid: bool,

    /// Most memory that a grid may take, in bytes or with K, M, G, T (powers of 1024), such as 4G
    #[arg(long, value_name = "BYTES", value_parser = parse_bytes)]
    pub memory_budget: Option<u64>,
}

impl SceneArgs {
    /// Reads the scene and prints what is odd about it.
    ///
    /// # Errors
    /// As [`load`].
    pub fn load(&self, console: &Console) -> Result<Scene> {
        let scene = load(&self.scene, &LoadOptions { drop_invalid: self.drop_invalid, ..LoadOptions::default() })?;
        for warning in &scene.warnings {
            console.warn(warning);
        }
        for note in &scene.notes {
            console.note(note);
        }
        Ok(scene)
    }

    /// `accel` with the memory budget as its option, where it has one and does not set it itself.
    pub fn spec(&self, accel: &str) -> String {
        match self.memory_budget {
            Some(bytes) => registry::with_default(accel, "memory", &bytes.to_string()),
            None => accel.to_string(),
        }
    }
}

/// What `spec` stands for if it is `auto`, with so many `rays` to come, and why; the same specification otherwise.
///
/// # Errors
/// As [`Scene::choose`].
pub fn choose(spec: &str, scene: &Scene, rays: f64) -> Result<(String, Option<Choice>)> {
    let spec = registry::with_default(spec, "rays", &rays.to_string());
    Ok(match scene.choose(&spec)? {
        Some((chosen, choice)) => (chosen, Some(choice)),
        None => (spec, None),
    })
}

/// Rays that `render` is likely to send if it is told nothing.
pub fn usual_rays(scene: &Scene) -> f64 {
    let (wish, default) = (&scene.defaults, Settings::default());
    let (width, height) = wish.size.unwrap_or((default.width, default.height));
    let sampler = wish.spp.map_or(default.sampler, Sampler::Sobol);
    let max_depth = wish.max_depth.unwrap_or(default.max_depth);
    Settings { width, height, sampler, max_depth, ..default }.expected_rays(scene)
}

/// Says which camera was chosen if the file has none, in the words of a scene file.
pub fn note_camera(scene: &Scene, console: &Console) {
    let camera = &scene.camera;
    if camera.source == CameraSource::Framed {
        let [origin, target, up] = [camera.origin, camera.target, camera.up].map(|v| v.to_array());
        let yfov = camera.yfov;
        console.note(format!(
            "no camera in the scene, framed: origin = {origin:?}, target = {target:?}, up = {up:?}, yfov = {yfov:?}"
        ));
    }
}

/// Finds out before the work whether the picture `out` could be written after it.
///
/// # Errors
/// The extension is no picture format, or the folder is missing.
pub fn check_picture(out: &Path) -> Result<()> {
    let extension = out.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !["exr", "png", "pfm"].contains(&extension.as_str()) {
        let cause = format!("extension `{extension}` is no picture format: .exr, .png or .pfm");
        return Err(Error::malformed(out, cause));
    }
    check_folder(out)
}

/// Finds out whether the folder that the file `out` goes to exists.
///
/// # Errors
/// It does not.
pub fn check_folder(out: &Path) -> Result<()> {
    let folder = out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match std::fs::metadata(folder) {
        Ok(meta) if meta.is_dir() => Ok(()),
        Ok(_) => Err(Error::io(folder, std::io::ErrorKind::NotADirectory.into())),
        Err(error) => Err(Error::io(folder, error)),
    }
}

/// `WIDTHxHEIGHT`, both at least 1.
pub fn parse_size(text: &str) -> std::result::Result<(u32, u32), String> {
    let parts = text.split_once(['x', 'X']).map(|(w, h)| (w.parse::<u32>(), h.parse::<u32>()));
    match parts {
        Some((Ok(width), Ok(height))) if width > 0 && height > 0 => Ok((width, height)),
        _ => Err("not of the form WIDTHxHEIGHT with both at least 1, such as 640x480".into()),
    }
}

/// As the option `memory=` of an accelerator.
fn parse_bytes(text: &str) -> std::result::Result<u64, String> {
    registry::parse_bytes(text).ok_or_else(|| "not a number of bytes with an optional K, M, G or T".to_string())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn sizes_are_parsed_or_refused() {
        assert_eq!(parse_size("640x480"), Ok((640, 480)));
        for bad in ["640", "0x4", "4x0", "-1x4", "4x4x4", "x", ""] {
            assert!(parse_size(bad).is_err(), "{bad}");
        }
    }

    #[test]
    fn the_budget_becomes_an_option_only_where_there_is_one() {
        let args = SceneArgs { scene: String::new(), drop_invalid: false, memory_budget: Some(1024) };
        assert_eq!(args.spec("brute"), "brute");
        assert_eq!(args.spec("grid"), "grid:memory=1024");
        assert_eq!(args.spec("grid:density=2"), "grid:density=2,memory=1024");
        assert_eq!(args.spec("grid:memory=5"), "grid:memory=5");
        assert_eq!(args.spec("grid-dsz:density=2"), "grid-dsz:density=2,memory=1024");
    }
}
