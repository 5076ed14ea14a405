//! Our renderer with one accelerator, in halves and by processor time.

use super::Options;
use super::run::Shot;
use crate::accel::Accel;
use crate::error::Result;
use crate::measure::{process_seconds, wall_seconds};
use crate::render::{Film, Sampler, Settings, render_until};
use crate::scene::Scene;
use std::sync::atomic::AtomicBool;

/// Renders both halves of `samples`; `None` if it was told to stop.
///
/// Samples are Owen-scrambled Sobol points with every integrator, so that two seeds give independent pictures.
pub(super) fn halves(
    scene: &Scene,
    accel: &dyn Accel,
    options: &Options,
    samples: u32,
    seeds: [u64; 2],
    stop: &AtomicBool,
) -> Result<Option<(Shot, [Film; 2])>> {
    let settings = |seed| Settings {
        integrator: options.integrator,
        width: options.width,
        height: options.height,
        sampler: Sampler::Sobol(samples / 2),
        seed,
        max_depth: options.max_depth,
        threads: options.threads,
        ..Settings::default()
    };
    let pixels = u64::from(options.width) * u64::from(options.height);
    let (start, wall) = (process_seconds(), wall_seconds());
    let mut films = Vec::with_capacity(2);
    for seed in seeds {
        let rendered = render_until(scene, accel, &settings(seed), &|_, _| {}, stop)?;
        if rendered.finished < pixels {
            return Ok(None);
        }
        films.push(rendered.film);
    }
    // A clock that stands still between two readings would make a picture free.
    let trace = (process_seconds() - start).max(1e-9);
    let wall = (wall_seconds() - wall).max(1e-9);
    let [a, b] = [films.swap_remove(0), films.swap_remove(0)];
    let shot = Shot { halves: vec![a.picture(), b.picture()], build: 0.0, trace, wall };
    Ok(Some((shot, [a, b])))
}
