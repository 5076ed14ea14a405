//! `skipgrid plan`: a picture as a list of commands, each of which renders a shard of it.

use super::Outcome;
use super::console::Console;
use super::input::{check_picture, note_camera, parse_size};
use super::picture::{PictureArgs, quoted};
use crate::error::{Error, Result};
use crate::shards::{self, Job, Place};
use std::path::{Path, PathBuf};

const DETAILS: &str = "\
Standard output is one shell command a line. They may run in any order, anywhere and more than once: what is there already is \
not made again. `skipgrid merge` then makes the picture, equal to the bit to that of `skipgrid render`. docs/shards.md says more.

Examples:
  skipgrid plan cornell --spp 256 --tile-size 128x128 --samples-per-shard 64 --shards-in parts -o cornell.exr > plan.txt
  parallel --joblog log < plan.txt
  skipgrid merge parts -o cornell.exr";

/// Print the commands that render a picture in shards, one a line, for any runner of commands
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(flatten)]
    picture: PictureArgs,

    /// Columns and rows of a tile; default: the whole picture
    #[arg(long, value_name = "WxH", value_parser = parse_size, conflicts_with = "tiles")]
    tile_size: Option<(u32, u32)>,

    /// Into how many columns and rows of tiles the picture is cut
    #[arg(long, value_name = "NxM", value_parser = parse_size)]
    tiles: Option<(u32, u32)>,

    /// Samples of each pixel that a shard takes; powers of two make the smallest files; default: all
    #[arg(long, value_name = "K", value_parser = clap::value_parser!(u32).range(1..))]
    samples_per_shard: Option<u32>,

    /// The folder of the shards, which the commands make
    #[arg(long, value_name = "FOLDER")]
    shards_in: PathBuf,

    /// The picture that the shards will make: .exr, .png or .pfm
    #[arg(long = "output", short = 'o', value_name = "OUT")]
    out: PathBuf,
}

/// Prints the plan.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    check_picture(&args.out)?;
    let picture = &args.picture;
    let scene = picture.scene.load(console)?;
    note_camera(&scene, console);
    let settings = picture.settings(&scene.defaults, &scene.name)?;
    crate::render::check_settings(&settings)?;
    let spec = picture.accelerator(&scene, &settings, console)?;
    let job = picture.job(&spec, &settings, shards::scene_digest(&scene))?;
    let (width, height) = (job.area.width, job.area.height);
    let tile = match (args.tile_size, args.tiles) {
        (Some(size), _) => size,
        (None, Some((columns, rows))) => (width.div_ceil(columns), height.div_ceil(rows)),
        (None, None) => (width, height),
    };
    let places = shards::places(job.area, tile, args.samples_per_shard.unwrap_or(job.total), job.total)?;
    for place in &places {
        shards::check_size(place, job.total)?;
    }
    let mut extra = Vec::new();
    if let Some(threads) = picture.threads {
        extra.extend(["--threads".to_string(), threads.to_string()]);
    }
    if let Some(on) = picture.shadow_voxels.wish() {
        extra.extend(["--shadow-voxels".to_string(), if on { "on" } else { "off" }.to_string()]);
    }
    let lines: Vec<String> =
        places.iter().map(|place| line(&job, place, &extra, &args.shards_in)).collect::<Result<_>>()?;
    console.data(&(lines.join("\n") + "\n"))?;
    let merge = quoted(&[&program(), "merge", text(&args.shards_in)?, "-o", text(&args.out)?])?;
    console.note(format!("{} shards; when they are there: {merge}", places.len()));
    Ok(Outcome::Done)
}

/// The command that renders the shard at `place` into `folder`.
pub fn line(job: &Job, place: &Place, extra: &[String], folder: &Path) -> Result<String> {
    let (tile, file) = (shards::text_of(&place.tile), folder.join(place.file_name(job)));
    let samples = format!("{}..{}", place.samples.start, place.samples.end);
    let mut words: Vec<&str> = extra.iter().map(String::as_str).collect();
    words.extend(["--tile", &tile, "--samples", &samples, "--scene-hash", &job.scene, "-o", text(&file)?]);
    Ok(format!("{} {} {}", quoted(&[&program(), "shard"])?, job.arguments, quoted(&words)?))
}

/// The program as it was called.
fn program() -> String {
    std::env::args().next().unwrap_or_else(|| "skipgrid".into())
}

fn text(path: &Path) -> Result<&str> {
    path.to_str().ok_or_else(|| Error::malformed(path, "is not UTF-8, which a plan is"))
}
