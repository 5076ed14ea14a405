//! One scene with one accelerator against the stored pictures.

use super::manifest::{Case, Mitsuba, PovRay};
use super::replicates::{Measured, Wanted, replicate};
use super::report::{CaseVerdict, Pictures, Provenance, Renderer, Test, TierVerdict};
use super::{Options, sha256};
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::picture::agreement::{self, DeterministicLimits, StatisticalLimits};
use crate::picture::{Picture, flip, io, metrics};
use crate::render::{Integrator, Sampler, Settings};
use crate::scene::Scene;
use std::path::Path;
use std::time::Instant;

/// Renders `scene` as `case` says and compares the pictures with the stored ones.
///
/// `scene` need not come from the case's file: a scene or an accelerator with a fault must fail, and can be tried here.
/// Never fails to return: whatever keeps a comparison from being made is the reason of a failed verdict.
pub fn check_case(case: &Case, scene: &Scene, accel: &dyn Accel, options: &Options) -> CaseVerdict {
    let mut tiers = Vec::new();
    if let Some(povray) = &case.povray {
        tiers.push(against_povray(povray, scene, accel, options));
    }
    if let Some(mitsuba) = &case.mitsuba {
        tiers.push(against_mitsuba(mitsuba, scene, accel, options));
    }
    CaseVerdict { case: case.name.clone(), tiers }
}

fn against_povray(stored: &PovRay, scene: &Scene, accel: &dyn Accel, options: &Options) -> TierVerdict {
    let provenance = Provenance {
        version: stored.version.clone(),
        command: stored.command.clone(),
        seconds: Some(stored.seconds),
        tolerance_reason: stored.tolerance_reason.clone(),
    };
    let verdict = TierVerdict::new(Renderer::PovRay, provenance);
    let usual = DeterministicLimits::with_floor(stored.out1_floor);
    let how = (stored.grid, stored.max_depth, DeterministicLimits { trim: stored.trim.unwrap_or(usual.trim), ..usual });
    let outcome = io::read(&stored.image).and_then(|theirs| {
        check_digest(&stored.image, "pixels", &theirs, &stored.sha256)?;
        judge_deterministic(verdict.clone(), how, scene, accel, &theirs, options)
    });
    outcome.unwrap_or_else(|error| verdict.failed(&error))
}

/// Renders by Whitted's method, with samples along a pixel's side, longest path and limits, and compares pixel by pixel.
pub(super) fn judge_deterministic(
    mut verdict: TierVerdict,
    (grid, max_depth, limits): (u32, u32, DeterministicLimits),
    scene: &Scene,
    accel: &dyn Accel,
    theirs: &Picture,
    options: &Options,
) -> Result<TierVerdict> {
    let settings = Settings {
        integrator: Integrator::Whitted,
        width: theirs.width,
        height: theirs.height,
        sampler: Sampler::Regular(grid),
        max_depth,
        threads: options.threads,
        ..Settings::default()
    };
    let start = Instant::now();
    let (ours, rays) = options.render(scene, accel, &settings)?;
    verdict.rays = rays;
    verdict.seconds = start.elapsed().as_secs_f64();
    let test = agreement::deterministic(&ours, theirs, limits);
    (verdict.passed, verdict.reasons) = (test.passed, test.reasons.clone());
    let [most, theirs_most] = [&ours, theirs].map(|p| p.pixels.iter().flatten().copied().fold(0.0, f32::max));
    if !test.passed && theirs_most == 1.0 && most > 1.0 {
        verdict.reasons.push(format!("theirs ends at 1 while ours reaches {most}: PNG cuts off what EXR and PFM keep"));
    }
    verdict.test = Some(Test::Deterministic(test));
    verdict.samples = u64::from(grid).pow(2);
    conclude(&mut verdict, &ours, theirs);
    if options.keep_pictures {
        let map = agreement::above_limits(&ours, theirs).ok();
        verdict.pictures = Some(Pictures { ours, theirs: theirs.clone(), map });
    }
    Ok(verdict)
}

fn against_mitsuba(stored: &Mitsuba, scene: &Scene, accel: &dyn Accel, options: &Options) -> TierVerdict {
    let provenance = Provenance {
        version: stored.version.clone(),
        command: stored.command.clone(),
        seconds: Some(stored.seconds),
        tolerance_reason: stored.tolerance_reason.clone(),
    };
    let mut verdict = TierVerdict::new(Renderer::Mitsuba, provenance);
    let start = Instant::now();
    let outcome =
        read_estimate(stored).and_then(|theirs| Ok((replicate(wanted(stored), 1, scene, accel, options)?, theirs)));
    verdict.seconds = start.elapsed().as_secs_f64();
    let ((ours, rays), theirs) = match outcome {
        Err(error) => return verdict.failed(&error),
        Ok(both) => both,
    };
    let test = agreement::statistical(ours.estimate(), theirs.estimate(), StatisticalLimits::default());
    (verdict.passed, verdict.reasons) = (test.passed, test.reasons.clone());
    verdict.test = Some(Test::Statistical(test));
    verdict.samples = u64::from(options.replicates) * u64::from(options.spp);
    verdict.rays = rays;
    conclude_noisy(&mut verdict, &ours, &theirs, options);
    verdict
}

/// What our renders share with Mitsuba's.
pub(super) fn wanted(stored: &Mitsuba) -> Wanted {
    Wanted { width: stored.width, height: stored.height, max_depth: stored.max_depth }
}

/// Mean and variance of the mean, after a check of digests and size.
pub(super) fn read_estimate(stored: &Mitsuba) -> Result<Measured> {
    let (mean, variance) = io::read_with_variance(&stored.image)?;
    check_digest(&stored.image, "pixels", &mean, &stored.sha256)?;
    if let Some(expected) = &stored.variance_sha256 {
        check_digest(&stored.image, "variances", &variance, expected)?;
    }
    if (mean.width, mean.height) != (stored.width, stored.height) {
        let (w, h) = (mean.width, mean.height);
        let cause = format!("picture is {w} x {h}, the manifest says {} x {}", stored.width, stored.height);
        return Err(Error::malformed(&stored.image, cause));
    }
    Ok(Measured { mean, variance, replicates: stored.replicates })
}

fn check_digest(image: &Path, what: &str, picture: &Picture, expected: &str) -> Result<()> {
    let found = sha256::of_pixels(picture);
    if found == expected {
        return Ok(());
    }
    let cause = format!("the stored {what} were changed: their SHA-256 is {found}, the manifest says {expected}");
    Err(Error::malformed(image, cause))
}

/// As [`conclude`] for pictures with noise, and keeps them.
pub(super) fn conclude_noisy(verdict: &mut TierVerdict, ours: &Measured, theirs: &Measured, options: &Options) {
    conclude(verdict, &ours.mean, &theirs.mean);
    if options.keep_pictures {
        let map = agreement::z_map(ours.estimate(), theirs.estimate()).ok();
        verdict.pictures = Some(Pictures { ours: ours.mean.clone(), theirs: theirs.mean.clone(), map });
    }
}

/// Adds what does not decide the verdict: size, distances, digest.
fn conclude(verdict: &mut TierVerdict, ours: &Picture, theirs: &Picture) {
    verdict.size = (theirs.width, theirs.height);
    verdict.metrics = metrics::compare(ours, theirs).ok();
    verdict.flip = flip::compare(ours, theirs).ok().map(|map| map.mean());
    verdict.ours_sha256 = sha256::of_pixels(ours);
}
