//! Runs the benchmark, scene by scene.

use super::catalogue::{BenchScene, Source};
use super::study::{KINDS, SceneResult, Study};
use crate::error::{Error, Result};
use crate::measure::{Built, Machine, RayKind, RayOptions, contest, ray_sets};
use crate::ray::Aabb;
use crate::scene::{Camera, CameraSource, LoadOptions, Scene, load};
use crate::stress::Contender;
use std::path::PathBuf;
use std::sync::atomic::{AtomicBool, Ordering};

/// What to measure.
#[derive(Clone, Debug)]
pub struct Options {
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Most rays of a kind, at least 1: the film of the camera rays is the largest square with no more pixels.
    pub rays: u32,
    /// Same seed, same rays.
    pub seed: u64,
    /// Samples a pixel of the images whose times are computed.
    pub spp: Vec<u32>,
    /// Kinds of rays, of [`KINDS`]; none: all.
    pub kinds: Vec<RayKind>,
    /// What others are held against; those that do not run have no column.
    pub anchors: Vec<String>,
    /// Scenes of the catalogue with more primitives are left out unless named.
    pub most_primitives: u32,
    /// The folder of the scenes that are files.
    pub shared: PathBuf,
}

/// Measures `contenders` on `scenes`. Calls `progress` before each stage with the number of scenes done and a few words; ends
/// early, between scenes, once `stop` is set.
///
/// A scene of the catalogue that is too large or whose file is missing is left out, with the reason in the result; so is
/// an accelerator on a scene that it cannot be built over.
///
/// # Errors
/// There is nothing to measure; a scene cannot be loaded.
pub fn run(
    scenes: &[BenchScene],
    contenders: &[Contender],
    options: &Options,
    progress: &dyn Fn(usize, &str),
    stop: &AtomicBool,
) -> Result<Study> {
    let kinds: Vec<RayKind> =
        KINDS.into_iter().filter(|kind| options.kinds.is_empty() || options.kinds.contains(kind)).collect();
    if contenders.is_empty() || options.rounds == 0 || options.rays == 0 {
        let (accels, rounds, rays) = (contenders.len(), options.rounds, options.rays);
        return Err(Error::invalid(format!("nothing to measure: {accels} accelerators, {rounds} rounds, {rays} rays")));
    }
    let runs = |anchor: &&String| contenders.iter().any(|contender| contender.name == **anchor);
    let anchors = options.anchors.iter().filter(runs).cloned().collect();
    let options = Options { kinds, anchors, ..options.clone() };
    let mut study =
        Study { machine: Machine::this(), options, scenes: Vec::new(), left_out: Vec::new(), interrupted: false };
    for (i, scene) in scenes.iter().enumerate() {
        if stop.load(Ordering::SeqCst) {
            study.interrupted = true;
            break;
        }
        let report = |stage: &str| progress(i, &format!("{}: {stage}", scene.name));
        report("loading");
        match obstacle(scene, &study.options) {
            Some(reason) => study.left_out.push((scene.name.clone(), reason)),
            None => match measure(scene, contenders, &study.options, &report)? {
                Ok(result) => study.scenes.push(result),
                Err(reason) => study.left_out.push((scene.name.clone(), reason)),
            },
        }
    }
    Ok(study)
}

/// Why a scene is left out, if so.
fn obstacle(scene: &BenchScene, options: &Options) -> Option<String> {
    if scene.primitives > options.most_primitives && !scene.named {
        let (has, most) = (scene.primitives, options.most_primitives);
        return Some(format!("{has} primitives, at most {most} are measured unless the scene is named"));
    }
    let Source::File(path) = scene.source else { return None };
    let path = options.shared.join(path);
    (!path.is_file()).then(|| format!("no file {}", path.display()))
}

/// One scene; the inner error says why nothing could be measured.
fn measure(
    scene: &BenchScene,
    contenders: &[Contender],
    options: &Options,
    report: &dyn Fn(&str),
) -> Result<std::result::Result<SceneResult, String>> {
    let spec = scene.spec(&options.shared);
    let mut loaded = load(&spec, &LoadOptions::default())?;
    if let Some(view) = &scene.view {
        loaded.camera = view.camera();
    }
    let (built, refused) = build(&loaded, contenders, report);
    // Rays come from where an exact accelerator hits, so that all runs have the same.
    let Some(first) = built.iter().find(|b| b.exact).or(built.first()) else {
        let (accel, cause) = refused.first().map_or(("", ""), |(accel, cause)| (accel, cause));
        return Ok(Err(format!("no accelerator can be built, {accel}: {cause}")));
    };
    approach(&mut loaded.camera, &first.accel.bounds());
    // The largest square, so that neighbours are as alike as in a picture.
    let side = options.rays.isqrt().max(1);
    let film = RayOptions { width: side, height: side, seed: options.seed, max_rays: options.rays as usize };
    let mut sets = ray_sets(&loaded, &*first.accel, &film)?;
    sets.retain(|set| options.kinds.contains(&set.kind));
    let comparison = contest(&loaded, &built, &sets, options.rounds, report)?;
    Ok(Ok(SceneResult { name: scene.name.clone(), class: scene.class, spec, comparison, refused }))
}

/// Brings a framed camera so near that most of its rays meet something: at most 0.8 of the diagonal of `bounds` away
/// from their middle, which it looks at; so it stays outside.
fn approach(camera: &mut Camera, bounds: &Aabb) {
    let (away, most) = (camera.origin - camera.target, 0.8 * f64::from(bounds.extent().length()));
    if camera.source == CameraSource::Framed && away.length() > most && most > 0.0 {
        camera.origin = camera.target + most * away.normalize();
    }
}

/// Why an accelerator is not built that takes other primitives only.
pub const UNSUITED: &str = "not for such primitives";

/// Those that can be built, and why the others cannot.
fn build(scene: &Scene, contenders: &[Contender], report: &dyn Fn(&str)) -> (Vec<Built>, Vec<(String, String)>) {
    let (mut built, mut refused) = (Vec::new(), Vec::new());
    for contender in contenders {
        if !contender.suits(&scene.geometry) {
            refused.push((contender.name.clone(), UNSUITED.to_string()));
            continue;
        }
        report(&format!("building {}", contender.name));
        let make = || contender.build(&scene.geometry, None);
        let made = contender.admit(&scene.geometry).and_then(|()| Built::new(&contender.name, contender.exact, make));
        match made {
            Ok(b) => built.push(b),
            Err(error) => refused.push((contender.name.clone(), error.to_string())),
        }
    }
    (built, refused)
}
