//! One scene with one accelerator against the stored pictures.

use super::manifest::{Case, Mitsuba, PovRay};
use super::report::{CaseVerdict, Pictures, Provenance, Renderer, Test, TierVerdict};
use super::{Options, sha256};
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::picture::tiles::{self, DeterministicLimits, Estimate, StatisticalLimits};
use crate::picture::{Picture, flip, io, metrics};
use crate::render::{Integrator, Sampler, Settings, render};
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
        seconds: stored.seconds,
        tolerance_reason: stored.tolerance_reason.clone(),
    };
    let mut verdict = TierVerdict::new(Renderer::PovRay, provenance);
    let start = Instant::now();
    let outcome = io::read(&stored.image).and_then(|theirs| {
        check_digest(&stored.image, "pixels", &theirs, &stored.sha256)?;
        let settings = Settings {
            integrator: Integrator::Whitted,
            width: theirs.width,
            height: theirs.height,
            sampler: Sampler::Regular(stored.grid),
            max_depth: stored.max_depth,
            threads: options.threads,
            ..Settings::default()
        };
        let ours = render(scene, accel, &settings, &|_, _| {})?.picture();
        Ok((ours, theirs))
    });
    verdict.seconds = start.elapsed().as_secs_f64();
    match outcome {
        Err(error) => verdict.fail(&error),
        Ok((ours, theirs)) => {
            let usual = DeterministicLimits::with_floor(stored.out1_floor);
            let limits = DeterministicLimits { trim: stored.trim.unwrap_or(usual.trim), ..usual };
            let test = tiles::deterministic(&ours, &theirs, limits);
            (verdict.passed, verdict.reasons) = (test.passed, test.reasons.clone());
            verdict.test = Some(Test::Deterministic(test));
            verdict.samples = u64::from(stored.grid).pow(2);
            conclude(&mut verdict, ours, theirs, options);
        }
    }
    verdict
}

fn against_mitsuba(stored: &Mitsuba, scene: &Scene, accel: &dyn Accel, options: &Options) -> TierVerdict {
    let provenance = Provenance {
        version: stored.version.clone(),
        command: stored.command.clone(),
        seconds: stored.seconds,
        tolerance_reason: stored.tolerance_reason.clone(),
    };
    let mut verdict = TierVerdict::new(Renderer::Mitsuba, provenance);
    let start = Instant::now();
    let outcome = read_estimate(stored).and_then(|theirs| Ok((replicate(stored, scene, accel, options)?, theirs)));
    verdict.seconds = start.elapsed().as_secs_f64();
    match outcome {
        Err(error) => verdict.fail(&error),
        Ok((ours, theirs)) => {
            let estimate = |side, replicates| {
                let (mean, variance): &(Picture, Picture) = side;
                Estimate { mean, variance, replicates }
            };
            let (a, b) = (estimate(&ours, options.replicates), estimate(&theirs, stored.replicates));
            let test = tiles::statistical(a, b, StatisticalLimits::default());
            (verdict.passed, verdict.reasons) = (test.passed, test.reasons.clone());
            verdict.test = Some(Test::Statistical(test));
            verdict.samples = u64::from(options.replicates) * u64::from(options.spp);
            conclude(&mut verdict, ours.0, theirs.0, options);
        }
    }
    verdict
}

/// Mean and variance of the mean, after a check of digests and size.
fn read_estimate(stored: &Mitsuba) -> Result<(Picture, Picture)> {
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
    Ok((mean, variance))
}

fn check_digest(image: &Path, what: &str, picture: &Picture, expected: &str) -> Result<()> {
    let found = sha256::of_pixels(picture);
    if found == expected {
        return Ok(());
    }
    let cause = format!("the stored {what} were changed: their SHA-256 is {found}, the manifest says {expected}");
    Err(Error::malformed(image, cause))
}

/// Renders with seeds 1, 2, .. and reduces to the mean and the variance of the mean.
fn replicate(stored: &Mitsuba, scene: &Scene, accel: &dyn Accel, options: &Options) -> Result<(Picture, Picture)> {
    let mut settings = Settings {
        integrator: Integrator::Path,
        width: stored.width,
        height: stored.height,
        sampler: Sampler::Sobol(options.spp),
        max_depth: stored.max_depth,
        threads: options.threads,
        ..Settings::default()
    };
    let mut moments = Moments::default();
    for seed in 1..=options.replicates {
        settings.seed = u64::from(seed);
        moments.add(&render(scene, accel, &settings, &|_, _| {})?.picture());
    }
    Ok(moments.reduce(stored.width, stored.height))
}

/// Running mean and sum of squared deviations of each value. Source: Welford 1962, "Note on a method for calculating
/// corrected sums of squares and products".
#[derive(Default)]
struct Moments {
    count: f64,
    values: Vec<[(f64, f64); 3]>,
}

impl Moments {
    fn add(&mut self, picture: &Picture) {
        self.values.resize(picture.pixels.len(), [(0.0, 0.0); 3]);
        self.count += 1.0;
        for (values, pixel) in self.values.iter_mut().zip(&picture.pixels) {
            for ((mean, squares), &value) in values.iter_mut().zip(pixel) {
                let before = f64::from(value) - *mean;
                *mean += before / self.count;
                *squares += before * (f64::from(value) - *mean);
            }
        }
    }

    /// The mean and the variance of the mean.
    fn reduce(&self, width: u32, height: u32) -> (Picture, Picture) {
        let picture = |value: &dyn Fn(&(f64, f64)) -> f64| Picture {
            width,
            height,
            pixels: self.values.iter().map(|p| [0, 1, 2].map(|c| value(&p[c]) as f32)).collect(),
        };
        let divisor = (self.count - 1.0) * self.count;
        (picture(&|v| v.0), picture(&|v| v.1 / divisor))
    }
}

/// Adds what does not decide the verdict: distances, digest, pictures.
fn conclude(verdict: &mut TierVerdict, ours: Picture, theirs: Picture, options: &Options) {
    verdict.size = (theirs.width, theirs.height);
    verdict.metrics = metrics::compare(&ours, &theirs).ok();
    verdict.flip = flip::compare(&ours, &theirs).ok().map(|map| map.mean());
    verdict.ours_sha256 = sha256::of_pixels(&ours);
    if options.keep_pictures {
        verdict.pictures = Some(Pictures { ours, theirs });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn moments_of_three_pictures() {
        let mut moments = Moments::default();
        for value in [1.0, 2.0, 6.0f32] {
            moments.add(&Picture { width: 1, height: 1, pixels: vec![[value, 5.0, -value]] });
        }
        let (mean, variance) = moments.reduce(1, 1);
        assert_eq!(mean.pixels, [[3.0, 5.0, -3.0]]);
        // Squared deviations 4 + 1 + 9, over 2 x 3.
        assert_eq!(variance.pixels, [[14.0 / 6.0, 0.0, 14.0 / 6.0]]);
    }
}
