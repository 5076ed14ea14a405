//! Pictures of any scene that any other program made, against ours.

use super::images::{conclude_noisy, judge_deterministic};
use super::replicates::{Measured, Moments, Wanted, replicate};
use super::report::{CaseVerdict, Provenance, Renderer, Report, Test, TierVerdict};
use super::{Options, reseed};
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::picture::agreement::{self, DeterministicLimits, StatisticalLimits};
use crate::picture::{Picture, io};
use crate::render::Integrator;
use crate::scene::Scene;
use std::path::{Path, PathBuf};
use std::time::Instant;

/// The other program's pictures, and how ours are rendered to be compared with them.
#[derive(Clone, Debug)]
pub struct Theirs {
    /// One picture; or, for the path tracer, several of one size: independent renders with the same settings.
    pub images: Vec<PathBuf>,
    /// Renders whose mean a single picture with variance channels is, at least 2; their number tells how sure the variance
    /// is, and 2 takes it as little sure.
    pub renders: u32,
    /// [`Integrator::Whitted`] for pictures without noise, [`Integrator::Path`] for all others.
    pub integrator: Integrator,
    /// Samples along a pixel's side, above 0; for Whitted's method.
    pub grid: u32,
    /// Longest path in edges, as [`crate::render::Settings::max_depth`] counts them.
    pub max_depth: u32,
}

/// What is known of the noise of their picture.
enum Known {
    /// There is none.
    Exact(Picture),
    /// Mean and variance.
    Measured(Measured),
    /// Nothing: its variance is taken as 0.
    Unmeasured(Measured),
}

/// Renders `scene` with each of `accels`, in the size of their pictures, and compares.
///
/// A picture that differs, or has pixels that are not finite, is a failure in the report, not an error. Without accelerators
/// there is nothing in the report, which does not pass then.
///
/// # Errors
/// A picture cannot be read or they differ in size; there are several for Whitted's method, or none; the integrator is
/// neither of the two; an accelerator is unknown; a setting is out of range.
///
/// ```
/// use skipgrid::picture::io;
/// use skipgrid::render::{Integrator, Sampler, Settings, render};
/// use skipgrid::scene::{LoadOptions, load};
/// use skipgrid::validate::{Options, Theirs, against};
///
/// let scene = load("random:n=20", &LoadOptions::default())?;
/// // Stands for a picture of yours; `examples/validate_own.rs` has a renderer that owes nothing to ours.
/// let settings = Settings {
///     integrator: Integrator::Whitted,
///     sampler: Sampler::Regular(1),
///     width: 32,
///     height: 24,
///     ..Settings::default()
/// };
/// let mut picture = render(&scene, &scene.accel("brute")?, &settings, &|_, _| {})?.picture();
/// let file = std::env::temp_dir().join(format!("skipgrid-theirs-{}.exr", std::process::id()));
/// io::write(&file, &picture, &io::Attributes::default())?;
///
/// let max_depth = settings.max_depth;
/// let theirs = Theirs { images: vec![file.clone()], renders: 2, integrator: Integrator::Whitted, grid: 1, max_depth };
/// let accels = ["grid".to_string()];
/// assert!(against(&scene, &theirs, &accels, &Options::default())?.passed());
///
/// // One per cent too bright.
/// picture.pixels.iter_mut().flatten().for_each(|value| *value *= 1.01);
/// io::write(&file, &picture, &io::Attributes::default())?;
/// let report = against(&scene, &theirs, &accels, &Options::default())?;
/// assert!(!report.passed() && !report.entries[0].verdict.tiers[0].reasons.is_empty());
/// # std::fs::remove_file(&file).map_err(|error| skipgrid::Error::io(&file, error))?;
/// # Ok::<(), skipgrid::Error>(())
/// ```
pub fn against(scene: &Scene, theirs: &Theirs, accels: &[String], options: &Options) -> Result<Report> {
    options.check()?;
    let known = read(theirs)?;
    let sets = if matches!(known, Known::Measured(_)) { options.reseeds } else { 0 };
    let total = accels.len() + sets as usize;
    let mut report = Report::default();
    for spec in accels {
        options.tell(report.entries.len(), total, &format!("{} with {spec}", scene.name));
        let start = Instant::now();
        let accel = scene.accel(spec)?;
        let build_seconds = start.elapsed().as_secs_f64();
        let tier = compare(&known, scene, &*accel, theirs, options)?;
        let verdict = CaseVerdict { case: scene.name.clone(), tiers: vec![tier] };
        let entry = options.entry((spec, build_seconds), verdict, scene, &*accel)?;
        if options.stopped() {
            break;
        }
        if let (Known::Measured(measured), true) = (&known, report.entries.is_empty()) {
            let mut tell = |set: u32| {
                options.tell(accels.len() + set as usize - 1, total, &format!("{} reseeded, set {set}", scene.name));
            };
            let wanted = wanted(&measured.mean, theirs);
            report.reseeds = reseed::reseeds(&scene.name, measured, wanted, (scene, &*accel), options, &mut tell)?;
        }
        report.add(entry);
    }
    report.unfinished = total - report.entries.len() - report.reseeds.len();
    options.tell(total, total, "");
    Ok(report)
}

/// All pictures are read before anything is rendered.
fn read(theirs: &Theirs) -> Result<Known> {
    let [first, rest @ ..] = &theirs.images[..] else { return Err(Error::invalid("no picture to compare with")) };
    match theirs.integrator {
        Integrator::Whitted if rest.is_empty() => return Ok(Known::Exact(io::read(first)?)),
        Integrator::Whitted => {
            let count = theirs.images.len();
            return Err(Error::invalid(format!(
                "{count} pictures for Whitted's method, which has no noise: wanted is one"
            )));
        }
        Integrator::Path => {}
        other => return Err(Error::invalid(format!("pictures of the integrator {other:?} cannot be compared"))),
    }
    if rest.is_empty() {
        return read_one(first, theirs.renders);
    }
    let mut moments = Moments::default();
    let picture = io::read(first)?;
    moments.add(&picture);
    for path in rest {
        let other = io::read(path)?;
        let sizes = [&picture, &other].map(|p| (p.width, p.height));
        if sizes[0] != sizes[1] {
            let [(w, h), (x, y)] = sizes;
            return Err(Error::malformed(path, format!("picture is {x} x {y}, {} is {w} x {h}", first.display())));
        }
        moments.add(&other);
    }
    Ok(Known::Measured(moments.reduce(picture.width, picture.height)))
}

/// With the variance if the file has one.
fn read_one(path: &Path, replicates: u32) -> Result<Known> {
    let is_exr = path.extension().is_some_and(|e| e.eq_ignore_ascii_case("exr"));
    if is_exr && io::has_variance(path)? {
        let (mean, variance) = io::read_with_variance(path)?;
        return Ok(Known::Measured(Measured { mean, variance, replicates }));
    }
    let mean = io::read(path)?;
    let variance = Picture::new(mean.width, mean.height);
    Ok(Known::Unmeasured(Measured { mean, variance, replicates }))
}

fn wanted(picture: &Picture, theirs: &Theirs) -> Wanted {
    Wanted { width: picture.width, height: picture.height, max_depth: theirs.max_depth }
}

fn compare(known: &Known, scene: &Scene, accel: &dyn Accel, theirs: &Theirs, options: &Options) -> Result<TierVerdict> {
    let mut verdict = TierVerdict::new(Renderer::Other, provenance(theirs));
    let start = Instant::now();
    let (ours, rays) = match known {
        Known::Exact(picture) => {
            let limits = DeterministicLimits::default();
            return judge_deterministic(
                verdict,
                (theirs.grid, theirs.max_depth, limits),
                scene,
                accel,
                picture,
                options,
            );
        }
        Known::Measured(measured) | Known::Unmeasured(measured) => {
            replicate(wanted(&measured.mean, theirs), 1, scene, accel, options)?
        }
    };
    verdict.seconds = start.elapsed().as_secs_f64();
    if let Known::Measured(measured) | Known::Unmeasured(measured) = known {
        let test = agreement::statistical(ours.estimate(), measured.estimate(), StatisticalLimits::default());
        (verdict.passed, verdict.reasons) = (test.passed, test.reasons.clone());
        if matches!(known, Known::Unmeasured(_)) {
            verdict.reasons.push(unmeasured(test.passed).into());
        }
        verdict.test = Some(Test::Statistical(test));
        verdict.samples = u64::from(options.replicates) * u64::from(options.spp);
        verdict.rays = rays;
        conclude_noisy(&mut verdict, &ours, measured, options);
    }
    Ok(verdict)
}

/// What a comparison with a picture of unknown noise says.
fn unmeasured(passed: bool) -> &'static str {
    match passed {
        true => {
            "theirs is one picture of unknown noise, taken as none: it agrees within the noise of ours alone, so it would \
             agree all the more if its own were known; how small a fault would show, its noise decides"
        }
        false => {
            "theirs is one picture of unknown noise, taken as none: what differs may be its noise or a fault, and nothing \
             here can tell; two or more independent renders of it, or its variance, would"
        }
    }
}

fn provenance(theirs: &Theirs) -> Provenance {
    let names: Vec<String> = theirs.images.iter().map(|path| path.display().to_string()).collect();
    Provenance { version: names.join(", "), command: "not known".into(), seconds: None, tolerance_reason: None }
}
