//! The path tracer, generic over the accelerator.
//!
//! [`render`] makes a [`Film`] of a scene with any [`Accel`]: the sums of all samples, which give the picture and its
//! variance. [`render_until`] can be interrupted, [`render_part`] makes some of the samples, for [`join`] to put
//! together.

mod check;
mod expected;
mod film;
mod frame;
mod integrator;
mod light;
mod sampler;
mod scatter;
mod shadows;
mod spawn;
mod sums;
mod texture;
mod tiles;
mod tracer;
mod view;

pub use check::omissions;
pub use film::{Film, RenderStats};
pub use shadows::SHADOW_DENSITY;
pub use sums::{join, nodes};

use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::ray::Ray;
use crate::scene::Scene;
use glam::DVec3;
use integrator::{features, path, whitted};
use sampler::{PixelSamples, Samples};
use std::ops::Range;
use std::sync::atomic::{AtomicBool, Ordering};
use tracer::{Stage, Tracer};

/// What is computed for each pixel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[cfg_attr(feature = "cli", derive(clap::ValueEnum))]
pub enum Integrator {
    /// Path tracing with next-event estimation and multiple importance sampling (Veach 1997, chapters 9 and 10);
    /// compared with Mitsuba's `path`.
    Path,
    /// Whitted 1980: point lights, mirrors and the full Fresnel split, no random numbers; compared with POV-Ray.
    Whitted,
    /// Ray parameter of the first hit along a unit direction, world units; 0 where nothing is hit.
    Depth,
    /// Shading normal turned towards the viewer, each component mapped from -1..1 to 0..1.
    Normal,
    /// A colour for each primitive index.
    Prim,
    /// Steps (red), tests (green) and leaps (blue) of the camera ray.
    Steps,
}

/// Where samples lie in a pixel and what random numbers are made of.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Sampler {
    /// The centres of an n x n grid in each pixel; `n * n` samples, n from 1 to 65535.
    Regular(u32),
    /// Owen-scrambled Sobol points (Burley 2020, "Practical Hash-based Owen Scrambling"), this many samples: 1 to 65536.
    Sobol(u32),
}

/// A part of the picture, pixels; `x..x + width`, `y..y + height`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Crop {
    /// First column.
    pub x: u32,
    /// First row.
    pub y: u32,
    /// Columns.
    pub width: u32,
    /// Rows.
    pub height: u32,
}

/// How to render.
#[derive(Clone, Debug, PartialEq)]
pub struct Settings {
    /// What is computed.
    pub integrator: Integrator,
    /// Columns of the whole picture, above 0.
    pub width: u32,
    /// Rows of the whole picture, above 0.
    pub height: u32,
    /// Only this part is rendered, which lies inside and is not empty; `None`: all.
    pub crop: Option<Crop>,
    /// Samples for each pixel.
    pub sampler: Sampler,
    /// Same seed, same picture, whatever the accelerator and the number of threads.
    pub seed: u64,
    /// Longest path in edges: 1 sees emission only, 2 adds direct light. 1 to 256 for [`Integrator::Whitted`], 1 to
    /// 65536 for the others.
    pub max_depth: u32,
    /// The edge of a path from which on Russian roulette may end it; only [`Integrator::Path`] asks.
    pub rr_depth: u32,
    /// Worker threads, 1 to 1024; `None`: as many as there are cores.
    pub threads: Option<usize>,
    /// Whether shadow rays to point and spot lights ask shadow voxels first, which changes no bit of the picture;
    /// `None`: where they are likely to pay.
    pub shadow_voxels: Option<bool>,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            integrator: Integrator::Path,
            width: 512,
            height: 512,
            crop: None,
            sampler: Sampler::Sobol(16),
            seed: 0,
            max_depth: 8,
            rr_depth: 5,
            threads: None,
            shadow_voxels: None,
        }
    }
}

/// Renders `scene`; calls `progress` with the number of finished and of all tiles, from any thread.
///
/// The film is equal to the bit for every number of threads, every accelerator that answers exactly, and every crop
/// that contains a pixel. What an integrator leaves out of a scene, [`omissions`] says.
///
/// # Errors
/// A size or count is zero or beyond what memory allows; the crop lies outside the picture; `max_depth` is 0, or above
/// 256 for [`Integrator::Whitted`] and 65536 for the others; the camera has no view; a material or texture is out of its
/// stated range; shadow voxels are asked for and do not fit into memory.
///
/// ```
/// use skipgrid::render::{Integrator, Sampler, Settings, render};
/// use skipgrid::scene::{LoadOptions, load};
///
/// let scene = load("cornell", &LoadOptions::default())?;
/// let settings = Settings { width: 16, height: 12, sampler: Sampler::Sobol(4), ..Settings::default() };
/// let film = render(&scene, &scene.accel("grid")?, &settings, &|_, _| {})?;
/// let picture = film.picture();
/// assert_eq!((picture.width, picture.height, film.samples), (16, 12, 4));
/// assert!(film.variance_of_mean().pixels.iter().flatten().all(|v| *v >= 0.0));
///
/// // Every exact accelerator gives the same bits.
/// let again = render(&scene, &scene.accel("brute")?, &settings, &|_, _| {})?;
/// assert_eq!(again.picture(), picture);
///
/// // Work instead of light: steps, tests and leaps of the camera rays.
/// let work = Settings { integrator: Integrator::Steps, sampler: Sampler::Regular(1), ..settings };
/// assert!(render(&scene, &scene.accel("grid")?, &work, &|_, _| {})?.picture().pixels.iter().any(|p| p[0] > 0.0));
/// # Ok::<(), skipgrid::Error>(())
/// ```
pub fn render<A: Accel + ?Sized>(
    scene: &Scene,
    accel: &A,
    settings: &Settings,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Film> {
    Ok(render_until(scene, accel, settings, progress, &AtomicBool::new(false))?.film)
}

/// A film that may have been left before its end.
#[derive(Clone, Debug, PartialEq)]
pub struct Unfinished {
    /// The film; pixels that are not finished are black. [`Film::samples`] is that of the finished ones.
    pub film: Film,
    /// Pixels with all their samples.
    pub finished: u64,
}

/// As [`render`], but ends soon after `stop` has become true. Pixels that have all their samples then are kept, to the bit
/// as in the whole film.
///
/// # Errors
/// As [`render`].
pub fn render_until<A: Accel + ?Sized>(
    scene: &Scene,
    accel: &A,
    settings: &Settings,
    progress: &(dyn Fn(usize, usize) + Sync),
    stop: &AtomicBool,
) -> Result<Unfinished> {
    let total = settings.sampler.samples();
    // One node: the root. Without samples there is none, and an error.
    let mut rendered = render_nodes(scene, accel, settings, nodes(0..total, total), progress, stop)?;
    Ok(rendered.swap_remove(0))
}

/// Finds out whether `settings` can be followed.
///
/// # Errors
/// As [`render`], of the settings alone.
pub fn check_settings(settings: &Settings) -> Result<()> {
    check::settings(settings, 1).map(|_| ())
}

/// Some samples of each pixel, summed so that they and the others make the picture: ranges of samples, each with its film.
pub type Part = Vec<(Range<u32>, Film)>;

/// The `samples` (of all that the settings ask for) of each pixel: a film for each of their [`nodes`]. [`join`] makes
/// one film of the parts of all samples, equal to the bit to that of [`render`].
///
/// # Errors
/// As [`render`]; or the range is empty or has samples that the settings lack.
pub fn render_part<A: Accel + ?Sized>(
    scene: &Scene,
    accel: &A,
    settings: &Settings,
    samples: Range<u32>,
    progress: &(dyn Fn(usize, usize) + Sync),
) -> Result<Part> {
    let total = settings.sampler.samples();
    if samples.is_empty() || samples.end > total {
        let Range { start, end } = samples;
        return Err(Error::invalid(format!("samples {start}..{end} of 0..{total}: none, or beyond the last one")));
    }
    let nodes = nodes(samples, total);
    let rendered = render_nodes(scene, accel, settings, nodes.clone(), progress, &AtomicBool::new(false))?;
    Ok(nodes.into_iter().zip(rendered.into_iter().map(|one| one.film)).collect())
}

/// A film of each of `nodes`.
fn render_nodes<A: Accel + ?Sized>(
    scene: &Scene,
    accel: &A,
    settings: &Settings,
    nodes: Vec<Range<u32>>,
    progress: &(dyn Fn(usize, usize) + Sync),
    stop: &AtomicBool,
) -> Result<Vec<Unfinished>> {
    let area = check::settings(settings, nodes.len())?;
    check::scene(scene)?;
    let bounds = accel.bounds();
    let lights = light::Lights::new(scene, &bounds);
    let samples = nodes.iter().map(|node| node.end - node.start).sum();
    let shadows = shadows::known(scene, lights.points(), settings, samples)?;
    let stage = Stage {
        scene,
        lights,
        shadows,
        spawner: spawn::Spawner::new(&bounds),
        max_depth: settings.max_depth,
        rr_depth: settings.rr_depth,
    };
    let job = Job { stage: &stage, accel, settings, area, nodes, progress, stop };
    match settings.integrator {
        Integrator::Path => job.run(|tracer, ray, samples| path::radiance(tracer, ray, samples, path::Share::Power)),
        Integrator::Whitted => job.run(|tracer, ray, _| whitted::radiance(tracer, &ray)),
        Integrator::Depth => job.run(|tracer, ray, _| features::depth(tracer, &ray)),
        Integrator::Normal => job.run(|tracer, ray, _| features::normal(tracer, &ray)),
        Integrator::Prim => job.run(|tracer, ray, _| features::prim(tracer, &ray)),
        Integrator::Steps => job.run(|tracer, ray, _| features::steps(tracer, &ray)),
    }
}

/// One picture to make, checked.
struct Job<'a, A: ?Sized> {
    stage: &'a Stage<'a>,
    accel: &'a A,
    settings: &'a Settings,
    area: Crop,
    nodes: Vec<Range<u32>>,
    progress: &'a (dyn Fn(usize, usize) + Sync),
    stop: &'a AtomicBool,
}

impl<A: Accel + ?Sized> Job<'_, A> {
    /// Makes it, a film for each node: `radiance` says what a camera ray brings back.
    fn run(&self, radiance: impl Fn(&mut Tracer<A>, Ray, &Samples) -> DVec3 + Sync) -> Result<Vec<Unfinished>> {
        let Settings { width, height, sampler, seed, threads, .. } = *self.settings;
        let view = view::View::new(&self.stage.scene.camera, width, height)?;
        let sums = |tracer: &mut Tracer<A>, node: &Range<u32>, x: u32, y: u32| {
            let pixel = PixelSamples::new(sampler, seed, x, y);
            sums::of(node.clone(), &mut |index| {
                if self.stop.load(Ordering::Relaxed) {
                    return None;
                }
                let samples = pixel.sample(index);
                let [dx, dy] = samples.offset();
                let ray = view.ray(f64::from(x) + dx, f64::from(y) + dy);
                let value = radiance(tracer, ray, &samples);
                if !value.is_finite() {
                    tracer.stats.discarded += 1;
                    return Some(DVec3::ZERO);
                }
                Some(value)
            })
        };
        let film = |(i, node): (usize, &Range<u32>)| {
            let tile = |part: Crop, pixels: &mut Vec<tiles::Sums>| {
                let mut tracer = Tracer::new(self.stage, self.accel);
                let rows = part.y..part.y + part.height;
                let all = rows.flat_map(|y| (part.x..part.x + part.width).map(move |x| (x, y)));
                pixels.extend(all.map_while(|(x, y)| sums(&mut tracer, node, x, y)));
                tracer.stats
            };
            let progress = |done: usize, all: usize| (self.progress)(i * all + done, self.nodes.len() * all);
            tiles::film(self.area, node.end - node.start, threads, &progress, &tile)
        };
        self.nodes.iter().enumerate().map(film).collect()
    }
}
