//! Rendered pictures against those of POV-Ray and Mitsuba in `reference/`, and against any others of any scene.
//!
//! [`run`] renders every scene of a manifest with every accelerator asked for. POV-Ray's pictures have no noise and are
//! compared pixel by pixel; Mitsuba's are compared tile by tile within the noise of both sides. The stored pictures are
//! checked against their digests first, and the pictures of all accelerators must be equal to the bit. [`against`] does the
//! same with pictures that the user has of a scene of his own.

pub mod images;
pub mod manifest;
mod replicates;
mod report;
mod reseed;
pub mod sha256;
mod steps;
mod theirs;

pub use images::check_case;
pub use manifest::{Case, Manifest};
pub use report::{CaseVerdict, Entry, Environment, Pictures, Provenance, Renderer, Report, Test, TierVerdict};
pub use reseed::Reseed;
pub use steps::Steps;
pub use theirs::{Theirs, against};

use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::picture::Picture;
use crate::render::{Settings, render_until};
use crate::scene::{self, LoadOptions, Scene};
use std::path::Path;
use std::sync::atomic::{AtomicBool, Ordering};
use std::time::Instant;

/// The accelerators that are validated if none is named.
pub const DEFAULT_ACCELERATORS: [&str; 2] = ["grid", "obvhs-cwbvh"];

/// Called with the number of finished and of all checks, and what is done next.
pub type Progress<'a> = &'a (dyn Fn(usize, usize, &str) + Sync);

/// How to validate.
#[derive(Clone, Copy)]
pub struct Options<'a> {
    /// Worker threads, 1 to 1024; `None`: as many as there are cores.
    pub threads: Option<usize>,
    /// Independent renders of ours against Mitsuba's mean, at least 2.
    pub replicates: u32,
    /// Samples for each pixel in each of them, above 0. With 8 renders of 32, 1 % more albedo fails in all twelve
    /// reference scenes, 0.3 % in seven whatever the seed; docs/validation.md has the table.
    pub spp: u32,
    /// The comparisons within noise are repeated with so many further sets of renders, see [`Reseed`]; 0: they are not.
    pub reseeds: u32,
    /// Keep pictures in the report, for [`Report::html`] and [`Report::write_pictures`].
    pub keep_pictures: bool,
    /// Count the steps of each pixel's camera ray too, see [`Entry::steps`]: one more render for each scene and accelerator.
    pub count_steps: bool,
    /// Told how far the work is.
    pub progress: Option<Progress<'a>>,
    /// Once it is true no comparison is begun and the one under way is dropped; see [`Report::unfinished`].
    pub stop: Option<&'a AtomicBool>,
}

impl Default for Options<'_> {
    fn default() -> Self {
        Self {
            threads: None,
            replicates: 8,
            spp: 32,
            reseeds: 0,
            keep_pictures: false,
            count_steps: false,
            progress: None,
            stop: None,
        }
    }
}

impl Options<'_> {
    /// Refuses what cannot be rendered.
    fn check(&self) -> Result<()> {
        if self.replicates < 2 || self.spp == 0 {
            let Options { replicates, spp, .. } = self;
            return Err(Error::invalid(format!("{replicates} renders of {spp} samples, wanted are at least 2 of 1")));
        }
        Ok(())
    }

    fn stopped(&self) -> bool {
        self.stop.is_some_and(|stop| stop.load(Ordering::Relaxed))
    }

    /// Our picture, black where the work was stopped, and the rays that it took.
    fn render(&self, scene: &Scene, accel: &dyn Accel, settings: &Settings) -> Result<(Picture, u64)> {
        let never = AtomicBool::new(false);
        let film = render_until(scene, accel, settings, &|_, _| {}, self.stop.unwrap_or(&never))?.film;
        Ok((film.picture(), film.stats.rays()))
    }

    /// What an accelerator gave for a scene, with its steps if they are wanted.
    fn entry(
        &self,
        (spec, build_seconds): (&str, f64),
        verdict: CaseVerdict,
        scene: &Scene,
        accel: &dyn Accel,
    ) -> Result<Entry> {
        let size = verdict.tiers.iter().map(|t| t.size).find(|&size| size != (0, 0));
        let steps = match size.filter(|_| self.count_steps) {
            Some(size) => Some(steps::count(size, scene, accel, self)?),
            None => None,
        };
        Ok(Entry { accel: spec.into(), build_seconds, verdict, steps })
    }

    fn tell(&self, done: usize, all: usize, next: &str) {
        if let Some(progress) = self.progress {
            progress(done, all, next);
        }
    }
}

/// Validates `cases` of the manifest (all if empty) with the accelerators that `accels` specify
/// ([`DEFAULT_ACCELERATORS`] if empty).
///
/// A picture that differs, is damaged or was tampered with is a failure in the report, not an error.
///
/// # Errors
/// The manifest or a scene cannot be read, a case or accelerator is unknown, or a number in `options` is out of range.
pub fn run(manifest: impl AsRef<Path>, cases: &[String], accels: &[String], options: &Options) -> Result<Report> {
    options.check()?;
    let manifest = Manifest::read(manifest)?;
    let cases = manifest.select(cases)?;
    let defaults = DEFAULT_ACCELERATORS.map(String::from);
    let accels = if accels.is_empty() { &defaults[..] } else { accels };
    let noisy = cases.iter().filter(|case| case.mitsuba.is_some()).count();
    let mut total = cases.len() * accels.len() + noisy * options.reseeds as usize;
    let mut report = Report::default();
    'cases: for case in cases {
        let path = case.scene.to_str().ok_or_else(|| Error::malformed(&case.scene, "path is no Unicode text"))?;
        if case.optional && !case.scene.exists() {
            report.left_out.push(format!("{}: there is no {path}", case.name));
            total -= accels.len() + if case.mitsuba.is_some() { options.reseeds as usize } else { 0 };
            continue;
        }
        let scene = scene::load(path, &LoadOptions::default())?;
        for (i, spec) in accels.iter().enumerate() {
            let done = |report: &Report| report.entries.len() + report.reseeds.len();
            options.tell(done(&report), total, &format!("{} with {spec}", case.name));
            let start = Instant::now();
            let accel = scene.accel(spec)?;
            let build_seconds = start.elapsed().as_secs_f64();
            let verdict = check_case(case, &scene, &*accel, options);
            let entry = options.entry((spec, build_seconds), verdict, &scene, &*accel)?;
            if options.stopped() {
                break 'cases;
            }
            report.add(entry);
            // Pictures do not depend on the accelerator.
            if let Some(stored) = case.mitsuba.as_ref().filter(|_| i == 0 && options.reseeds > 0) {
                let Ok(theirs) = images::read_estimate(stored) else {
                    // A damaged reference is in the verdict already.
                    total -= options.reseeds as usize;
                    continue;
                };
                let before = done(&report);
                let mut tell = |set: u32| {
                    options.tell(before + set as usize - 1, total, &format!("{} reseeded, set {set}", case.name));
                };
                let wanted = images::wanted(stored);
                let sets = reseed::reseeds(&case.name, &theirs, wanted, (&scene, &*accel), options, &mut tell)?;
                report.reseeds.extend(sets);
                if options.stopped() {
                    break 'cases;
                }
            }
        }
    }
    report.unfinished = total - report.entries.len() - report.reseeds.len();
    options.tell(total, total, "");
    Ok(report)
}
