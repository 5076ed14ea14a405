//! `skipgrid render`: a picture of a scene.

use super::console::Console;
use super::input::{build, check_picture, note_camera};
use super::outputs::partial;
use super::picture::{Choice, PictureArgs};
use super::{Outcome, interrupt};
use crate::error::Result;
use crate::picture::io::{self, Attributes, PARTIAL};
use crate::render::{Film, RenderStats, Unfinished, render_until};
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
    picture: PictureArgs,

    /// The picture: .exr, .png or .pfm
    #[arg(long = "output", short = 'o', value_name = "OUT")]
    out: PathBuf,
}

/// Renders and writes.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    check_picture(&args.out)?;
    let picture = &args.picture;
    let scene = picture.scene.load(console)?;
    note_camera(&scene, console);
    let settings = picture.settings(&scene.defaults, &scene.name)?;
    let spec = picture.accelerator(&scene, &settings, console)?;
    let start = Instant::now();
    let accel = build(&scene, &spec, console)?;
    let build = start.elapsed().as_secs_f64();

    let progress = console.progress("rendering");
    let start = Instant::now();
    let watch = |done: usize, all: usize| progress.at(done as u64, all as u64, "rendering");
    let rendered = render_until(&scene, &*accel, &settings, &watch, interrupt::request())?;
    drop(progress);
    let Unfinished { film, finished } = rendered;
    let seconds = start.elapsed().as_secs_f64();

    let attributes = picture.attributes(&spec, &settings);
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
    } else if shadow > 0 && picture.shadow_voxels == Choice::Auto && scene.has_point_lights() {
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
    let file = partial(out);
    let (pixels, samples) = (film.sum.len(), film.samples);
    let state = format!("{finished} of {pixels} pixels have all their {samples} samples, the others are black");
    io::write(&file, &film.picture(), &attributes.with(PARTIAL, &state))?;
    console.note(format!("{}: {state}", file.display()));
    Ok(Outcome::Interrupted)
}
