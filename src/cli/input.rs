//! Arguments that several verbs share, and how they are read.

use super::console::Console;
use crate::accel::Accel;
use crate::auto::Choice;
use crate::error::{Error, Result};
use crate::measure::RayOptions;
use crate::picture::io;
use crate::ray::Ray;
use crate::registry;
use crate::render::{Integrator, Sampler, Settings};
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
        if Path::new(&self.scene).is_dir() {
            return Err(Error::malformed(&self.scene, "is a folder and no regular file, as a scene is"));
        }
        let loading = console.progress(format!("loading {}", self.scene));
        let scene = load(&self.scene, &LoadOptions { drop_invalid: self.drop_invalid, ..LoadOptions::default() })?;
        drop(loading);
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

/// Which accelerators are measured, and on which scene.
#[derive(Clone, Debug, clap::Args)]
pub struct ContenderArgs {
    #[command(flatten)]
    pub scene: SceneArgs,

    /// Accelerator, with options; give it once for each; the first is the measure of the others
    #[arg(long = "accel", value_name = "A", default_values = DEFAULT_ACCELS)]
    accels: Vec<String>,
}

impl ContenderArgs {
    /// Their specifications, with the memory budget.
    pub fn specs(&self) -> Vec<String> {
        self.accels.iter().map(|accel| self.scene.spec(accel)).collect()
    }
}

/// Which rays are traced, and how often, where accelerators are measured on a scene.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct RayArgs {
    /// Timed rounds
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1_000_000))]
    pub rounds: u32,

    /// Most rays of a kind; of a larger film every so-many-th pixel is taken
    #[arg(long, value_name = "N", default_value_t = 65536, value_parser = clap::value_parser!(u32).range(1..))]
    max_rays: u32,

    /// Same seed, same rays
    #[arg(long, value_name = "N", default_value_t = 0)]
    pub seed: u64,
}

impl RayArgs {
    /// The rays through a film of this size.
    pub fn of_film(&self, (width, height): (u32, u32)) -> RayOptions {
        RayOptions { width, height, seed: self.seed, max_rays: self.max_rays as usize }
    }
}

/// The integrators whose pictures other renderers make, too.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
pub enum Method {
    /// Path tracing
    Path,
    /// Whitted 1980
    Whitted,
}

impl Method {
    /// What is asked for, else what the scene wishes, else path tracing.
    pub fn or_wish(asked: Option<Self>, wish: Option<&str>) -> Integrator {
        match asked {
            Some(Method::Path) => Integrator::Path,
            Some(Method::Whitted) => Integrator::Whitted,
            None if wish == Some("whitted") => Integrator::Whitted,
            None => Integrator::Path,
        }
    }
}

/// Builds the accelerator.
///
/// # Errors
/// As [`Scene::accel`].
pub fn build(scene: &Scene, spec: &str, console: &Console) -> Result<Box<dyn Accel>> {
    let _building = console.progress(format!("building {spec}"));
    scene.accel(spec)
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
/// The extension is no picture format; else as [`check_file`].
pub fn check_picture(out: &Path) -> Result<()> {
    let extension = out.extension().and_then(|e| e.to_str()).unwrap_or_default().to_ascii_lowercase();
    if !["exr", "png", "pfm"].contains(&extension.as_str()) {
        let cause = format!("extension `{extension}` is no picture format: .exr, .png or .pfm");
        return Err(Error::malformed(out, cause));
    }
    check_file(out)
}

/// As [`check_picture`], for a file of any form but with one of these extensions.
///
/// # Errors
/// It has another one; else as [`check_file`].
pub fn check_extension(out: &Path, what: &str, extension: &str) -> Result<()> {
    if !out.extension().is_some_and(|e| e.eq_ignore_ascii_case(extension)) {
        return Err(Error::malformed(out, format!("the name of {what} ends in .{extension}")));
    }
    check_file(out)
}

/// Finds out before the work whether the file `out` could be written after it.
///
/// # Errors
/// Its folder is missing or cannot be written to, or there is something under its name that is no regular file.
pub fn check_file(out: &Path) -> Result<()> {
    check_parent(out)?;
    io::check_replaceable(out)
}

/// Finds out before the work whether files could be written into the folder `folder` after it, which may be missing.
///
/// # Errors
/// It is no folder, or cannot be made.
pub fn check_folder(folder: &Path) -> Result<()> {
    match std::fs::metadata(folder) {
        Ok(meta) if meta.is_dir() => Ok(()),
        Ok(_) => Err(Error::malformed(folder, "is no folder for pictures")),
        Err(_) => check_parent(folder),
    }
}

/// Finds out whether the folder that `out` goes to exists.
fn check_parent(out: &Path) -> Result<()> {
    let folder = out.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    match std::fs::metadata(folder) {
        Ok(meta) if meta.is_dir() => Ok(()),
        Ok(_) => Err(Error::io(folder, std::io::ErrorKind::NotADirectory.into())),
        Err(error) => Err(Error::io(folder, error)),
    }
}

/// The bits of a ray, eight hexadecimal numbers in the order of ray files.
pub fn bits(ray: &Ray) -> Vec<String> {
    let (o, d) = (ray.origin, ray.direction);
    [o.x, o.y, o.z, ray.t_min, d.x, d.y, d.z, ray.t_max].map(|x| format!("{:08x}", x.to_bits())).to_vec()
}

/// A finite number above 0.
pub fn parse_positive(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("not a finite number above 0".into()),
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
