//! `skipgrid render`: a picture of a scene.

use super::console::Console;
use super::info::left_out;
use super::input::{DEFAULT_ACCEL, SceneArgs, check_picture, choose, note_camera, parse_size};
use super::{Outcome, interrupt};
use crate::error::{Error, Result};
use crate::picture::io::{self, Attributes, PARTIAL};
use crate::render::{Crop, Film, Integrator, RenderStats, Sampler, Settings, Unfinished, render_until};
use crate::scene::Scene;
use std::path::{Path, PathBuf};
use std::time::Instant;

const DETAILS: &str = "\
What the command line does not say is taken from the scene file, then from the defaults: path, 512x512, 16 samples, \
depth 8. A picture depends on scene, integrator, size, sampler, samples, seed and depth, never on accelerator or threads.
If it is interrupted, the pixels that are finished go to OUT with `.partial` before its extension, and say so in the file.

Examples:
  skipgrid render cornell --spp 64 -o cornell.exr
  skipgrid render random:n=1000 --integrator steps --accel grid:density=4 -o steps.png
  skipgrid render room.glb --size 1920x1080 --crop 600,400,320,200 -o detail.png";

/// Render a picture: .exr (f32, with the settings as attributes), .png or .pfm
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// The picture: .exr, .png or .pfm
    #[arg(long = "output", short = 'o', value_name = "OUT")]
    out: PathBuf,

    /// Accelerator, with options; see `skipgrid list`
    #[arg(long, value_name = "A", default_value = DEFAULT_ACCEL)]
    accel: String,

    /// What is computed for each pixel
    #[arg(long, value_enum)]
    integrator: Option<IntegratorName>,

    /// Columns and rows of the whole picture
    #[arg(long, value_name = "WxH", value_parser = parse_size)]
    size: Option<(u32, u32)>,

    /// Samples for each pixel; a square number for the regular sampler
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    spp: Option<u32>,

    /// Where samples lie in a pixel: Owen-scrambled Sobol points (default for path) or a regular grid (for the rest)
    #[arg(long, value_enum)]
    sampler: Option<SamplerName>,

    /// Same seed, same picture
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// Longest path in edges: 1 sees emission only, 2 adds direct light
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..))]
    max_depth: Option<u32>,

    /// Render only these columns and rows of the whole picture
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_crop)]
    crop: Option<Crop>,

    /// Whether rays to point and spot lights ask shadow voxels first; no bit of the picture changes (auto: where there are
    /// many rays for each primitive and light)
    #[arg(long, value_enum, default_value_t)]
    shadow_voxels: Choice,

    /// Worker threads; default: as many as there are cores
    #[arg(long, value_name = "N", value_parser = clap::value_parser!(u32).range(1..=4096))]
    threads: Option<u32>,
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum IntegratorName {
    /// Path tracing with next-event estimation and multiple importance sampling
    Path,
    /// Whitted 1980: lights without extent, mirrors, full Fresnel split, no random numbers
    Whitted,
    /// Distance to the first hit
    Depth,
    /// Shading normal
    Normal,
    /// A colour for each primitive
    Prim,
    /// Heat map of the accelerator's work
    Steps,
}

impl IntegratorName {
    fn integrator(self) -> Integrator {
        match self {
            IntegratorName::Path => Integrator::Path,
            IntegratorName::Whitted => Integrator::Whitted,
            IntegratorName::Depth => Integrator::Depth,
            IntegratorName::Normal => Integrator::Normal,
            IntegratorName::Prim => Integrator::Prim,
            IntegratorName::Steps => Integrator::Steps,
        }
    }
}

#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum SamplerName {
    Sobol,
    Regular,
}

#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, clap::ValueEnum)]
enum Choice {
    #[default]
    Auto,
    On,
    Off,
}

impl Choice {
    fn wish(self) -> Option<bool> {
        match self {
            Choice::Auto => None,
            Choice::On => Some(true),
            Choice::Off => Some(false),
        }
    }
}

/// Renders and writes.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    check_picture(&args.out)?;
    let scene = args.scene.load(console)?;
    note_camera(&scene, console);
    let settings = settings(args, &scene)?;
    let (spec, choice) = choose(&args.scene.spec(&args.accel), &scene, settings.expected_rays(&scene))?;
    if let Some(choice) = choice {
        console.note(choice.reason());
        let left_out: Vec<String> = choice.left_out().into_iter().chain(left_out(&scene)).collect();
        console.note(format!("left out: {}", left_out.join("; ")));
    }
    let start = Instant::now();
    let accel = scene.accel(&spec)?;
    let build = start.elapsed().as_secs_f64();

    let bar = console.progress(1);
    bar.set_message("rendering");
    let start = Instant::now();
    let progress = |done: usize, all: usize| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
    };
    let rendered = render_until(&scene, &*accel, &settings, &progress, interrupt::request());
    bar.finish_and_clear();
    let Unfinished { film, finished } = rendered?;
    let seconds = start.elapsed().as_secs_f64();

    let attributes = attributes(&args.scene.scene, &spec, &settings);
    if finished < film.sum.len() as u64 {
        return keep_partial(&args.out, &film, finished, attributes, console);
    }
    io::write(&args.out, &film.picture(), &attributes)?;
    if film.stats.discarded > 0 {
        console.warn(format!("{} samples were not finite and count as black", film.stats.discarded));
    }
    let RenderStats { shadow, spared, shortened, .. } = film.stats;
    if spared + shortened > 0 {
        let share = |rays: u64| 100.0 * rays as f64 / (shadow + spared) as f64;
        let (spared, shortened) = (share(spared), share(shortened));
        console.note(format!("shadow voxels spared {spared:.1} % of the rays to lights, shortened {shortened:.1} %"));
    } else if shadow > 0 && args.shadow_voxels == Choice::Auto && scene.has_point_lights() {
        let primitives = scene.primitive_count();
        console.note(format!(
            "shadow voxels left out: {shadow} rays to lights are few for {primitives} primitives, or next to no voxel is \
             decided (--shadow-voxels on builds them)"
        ));
    }
    let rays = film.stats.rays() as f64 / 1e6;
    console.note(format!(
        "{}: build {:.1} ms, render {seconds:.3} s, {rays:.3} million rays, {:.2} Mrays/s",
        args.out.display(),
        build * 1e3,
        rays / seconds
    ));
    Ok(Outcome::Done)
}

/// Writes the pixels that are finished beside `out`, which stays as it is.
fn keep_partial(out: &Path, film: &Film, finished: u64, attributes: Attributes, console: &Console) -> Result<Outcome> {
    if finished == 0 {
        console.note(format!("{}: no pixel was finished, nothing is written", out.display()));
        return Ok(Outcome::Interrupted);
    }
    // The name was checked to have an extension.
    let extension = out.extension().unwrap_or_default().to_string_lossy();
    let file = out.with_extension(format!("partial.{extension}"));
    let (pixels, samples) = (film.sum.len(), film.samples);
    let state = format!("{finished} of {pixels} pixels have all their {samples} samples, the others are black");
    io::write(&file, &film.picture(), &attributes.with(PARTIAL, &state))?;
    console.note(format!("{}: {state}", file.display()));
    Ok(Outcome::Interrupted)
}

/// The command line, then the scene's wishes, then the defaults.
fn settings(args: &Args, scene: &Scene) -> Result<Settings> {
    let wish = &scene.defaults;
    let default = Settings::default();
    let integrator = match (&args.integrator, wish.integrator.as_deref()) {
        (Some(name), _) => name.integrator(),
        (None, Some(name)) => <IntegratorName as clap::ValueEnum>::from_str(name, true)
            .map_err(|_| Error::invalid(format!("{}: integrator `{name}` is unknown", scene.name)))?
            .integrator(),
        (None, None) => default.integrator,
    };
    let regular = match args.sampler {
        Some(name) => name == SamplerName::Regular,
        None => integrator != Integrator::Path,
    };
    let sampler = match (regular, args.spp) {
        (true, None) => Sampler::Regular(wish.spp.unwrap_or(1).isqrt().max(1)),
        (true, Some(spp)) if spp.isqrt().pow(2) == spp => Sampler::Regular(spp.isqrt()),
        (true, Some(spp)) => {
            let cause =
                format!("--spp {spp} is no square number, which the regular sampler needs, such as 1, 4, 9, 16");
            return Err(Error::invalid(cause));
        }
        (false, spp) => Sampler::Sobol(spp.or(wish.spp).unwrap_or(16)),
    };
    let (width, height) = args.size.or(wish.size).unwrap_or((default.width, default.height));
    Ok(Settings {
        integrator,
        width,
        height,
        crop: args.crop,
        sampler,
        seed: args.seed,
        max_depth: args.max_depth.or(wish.max_depth).unwrap_or(default.max_depth),
        threads: args.threads.map(|n| n as usize),
        shadow_voxels: args.shadow_voxels.wish(),
        ..default
    })
}

/// Everything that the picture depends on, and the accelerator; no clock and no host, so that the same command writes
/// the same bytes.
fn attributes(scene: &str, accel: &str, settings: &Settings) -> Attributes {
    let sampler = match settings.sampler {
        Sampler::Regular(n) => format!("regular {n}x{n}"),
        Sampler::Sobol(n) => format!("sobol {n}"),
    };
    let mut attributes = Attributes::default()
        .with("renderer", concat!("skipgrid ", env!("CARGO_PKG_VERSION")))
        .with("scene", scene)
        .with("accelerator", accel)
        .with("integrator", format!("{:?}", settings.integrator).to_lowercase())
        .with("size", format!("{}x{}", settings.width, settings.height))
        .with("sampler", sampler)
        .with("seed", settings.seed.to_string())
        .with("maxDepth", settings.max_depth.to_string())
        .with("rrDepth", settings.rr_depth.to_string());
    if let Some(Crop { x, y, width, height }) = settings.crop {
        attributes = attributes.with("crop", format!("{x},{y},{width},{height}"));
    }
    attributes
}

/// `X,Y,W,H`, width and height at least 1.
fn parse_crop(text: &str) -> std::result::Result<Crop, String> {
    let numbers: Option<Vec<u32>> = text.split(',').map(|n| n.trim().parse().ok()).collect();
    match numbers.as_deref() {
        Some(&[x, y, width, height]) if width > 0 && height > 0 => Ok(Crop { x, y, width, height }),
        _ => Err("not of the form X,Y,WIDTH,HEIGHT in pixels, such as 10,20,64,48".into()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn crops_are_parsed_or_refused() {
        assert_eq!(parse_crop("1,2,3,4"), Ok(Crop { x: 1, y: 2, width: 3, height: 4 }));
        for bad in ["", "1,2,3", "1,2,0,4", "-1,2,3,4", "1,2,3,4,5"] {
            assert!(parse_crop(bad).is_err(), "{bad}");
        }
    }
}
