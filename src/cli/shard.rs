//! `skipgrid shard`: some samples of some pixels of a picture.

use super::Outcome;
use super::console::Console;
use super::input::{build, check_file};
use super::picture::{PictureArgs, parse_crop};
use crate::error::{Error, Result};
use crate::render::{Crop, RenderStats, render_part};
use crate::shards::{self, Job, Place, Shard};
use std::ops::Range;
use std::path::{Path, PathBuf};

const DETAILS: &str = "\
`skipgrid plan` prints these commands. The options are those of `render` for the whole picture; --spp is the number of all \
samples, of which --samples are made here. A whole shard of the same picture under the name OUT is left as it is, and the \
command is done; a damaged one is made anew. The file appears whole or not at all.

Examples:
  skipgrid shard cornell --spp 16 --tile 0,0,256,512 --samples 0..8 -o parts/a.shard.exr
  skipgrid shard cornell --spp 16 --tile 0,0,256,512 --samples 8..16 -o parts/b.shard.exr";

/// Render a shard of a picture: exact sums of some samples of some pixels, for `skipgrid merge`
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(flatten)]
    picture: PictureArgs,

    /// The pixels, counted in the whole picture
    #[arg(long, value_name = "X,Y,W,H", value_parser = parse_crop)]
    tile: Crop,

    /// The samples of each, the first one counted and the last one not; samples count from 0
    #[arg(long, value_name = "A..B", value_parser = parse_range)]
    samples: Range<u32>,

    /// Refuse a scene with another digest than this, which `skipgrid plan` writes
    #[arg(long, value_name = "HASH")]
    scene_hash: Option<String>,

    /// The shard: its name ends in .shard.exr; its folder is made if it is missing
    #[arg(long = "output", short = 'o', value_name = "OUT")]
    out: PathBuf,
}

/// Renders and writes, unless it is there.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    let Args { picture, tile, samples, .. } = args;
    let ending = format!(".{}", shards::EXTENSION);
    if !args.out.file_name().is_some_and(|name| name.to_string_lossy().ends_with(&ending)) {
        return Err(Error::malformed(&args.out, format!("the name of a shard ends in {ending}")));
    }
    let place = Place { tile: *tile, samples: samples.clone() };
    if let (Some(hash), true) = (&args.scene_hash, picture.is_complete()) {
        // The scene need not be read to know the job.
        let settings = picture.settings(&Default::default(), &picture.scene.scene)?;
        let job = picture.job(&picture.scene.spec(&picture.accel), &settings, hash.clone())?;
        if is_there(&args.out, &job, &place, console) {
            return Ok(Outcome::Done);
        }
    }
    let scene = picture.scene.load(console)?;
    let digest = shards::scene_digest(&scene);
    if let Some(hash) = args.scene_hash.as_ref().filter(|hash| **hash != digest) {
        let cause = format!("is not the scene that was planned: its digest is {digest}, not {hash}");
        return Err(Error::malformed(&picture.scene.scene, cause));
    }
    let whole = picture.settings(&scene.defaults, &scene.name)?;
    let spec = picture.accelerator(&scene, &whole, console)?;
    let job = picture.job(&spec, &whole, digest)?;
    check_place(&job, &place)?;
    if !picture.is_complete() && is_there(&args.out, &job, &place, console) {
        return Ok(Outcome::Done);
    }
    if let Some(folder) = args.out.parent().filter(|folder| !folder.as_os_str().is_empty()) {
        std::fs::create_dir_all(folder).map_err(|error| Error::io(folder, error))?;
    }
    check_file(&args.out)?;
    let accel = build(&scene, &spec, console)?;
    let progress = console.progress("rendering");
    let watch = |done: usize, all: usize| progress.at(done as u64, all as u64, "rendering");
    let settings = crate::render::Settings { crop: Some(*tile), ..whole };
    let part = render_part(&scene, &*accel, &settings, samples.clone(), &watch)?;
    drop(progress);
    let mut rays = RenderStats::default();
    part.iter().for_each(|(_, film)| rays += film.stats);
    shards::write(&args.out, &Shard { job, place: place.clone(), part })?;
    console.note(format!("{}: {place}, {:.3} million rays", args.out.display(), rays.rays() as f64 / 1e6));
    Ok(Outcome::Done)
}

/// Whether a whole shard of this place is there, which is said; also what is wrong with another one.
fn is_there(out: &Path, job: &Job, place: &Place, console: &Console) -> bool {
    let there = shards::label(out);
    match &there {
        Ok((found, at)) if (found, at) == (job, place) => {
            console.note(format!("{}: is there already", out.display()));
            return true;
        }
        Ok((found, at)) => {
            let other = job.difference(found).unwrap_or_else(|| format!("it is {at}"));
            console.warn(format!("{}: is of another shard and will be replaced: {other}", out.display()));
        }
        // Most often it is not there; what else is wrong with the name, writing will tell.
        Err(Error::Io { .. }) => {}
        Err(error) => console.warn(format!("{error}; it will be made anew")),
    }
    false
}

/// Checks that the place lies in the picture, and that its file can be read again.
fn check_place(job: &Job, place: &Place) -> Result<()> {
    let inside = |start: u32, length: u32, from: u32, all: u32| {
        start >= from && u64::from(start) + u64::from(length) <= u64::from(from) + u64::from(all)
    };
    let (tile, area) = (&place.tile, &job.area);
    if !(inside(tile.x, tile.width, area.x, area.width) && inside(tile.y, tile.height, area.y, area.height)) {
        return Err(Error::invalid(format!(
            "--tile {} leaves the picture, which is {}",
            shards::text_of(tile),
            shards::text_of(area)
        )));
    }
    if place.samples.end > job.total {
        let Range { start, end } = place.samples;
        return Err(Error::invalid(format!("--samples {start}..{end} are beyond the {} of --spp", job.total)));
    }
    shards::check_size(place, job.total)
}

fn parse_range(text: &str) -> std::result::Result<Range<u32>, String> {
    shards::parse_range(text).ok_or_else(|| "not of the form A..B with A below B, such as 0..16".to_string())
}
