//! `skipgrid trace`: a file of rays in, a file of hits out.

use super::Outcome;
use super::console::Console;
use super::input::{DEFAULT_ACCEL, SceneArgs, check_folder};
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::measure::npy;
use crate::picture::io::replace_file;
use crate::ray::Ray;
use crate::scene::raw;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Instant;

const DETAILS: &str = "\
Rays are a NumPy array of N x 8 little-endian f32: ox oy oz tmin dx dy dz tmax; or a .rays file. Directions need not be \
unit: t counts in their length. A ray that is not finite, has no direction or has tmin > tmax hits nothing.
Hits are N records [('t', '<f4'), ('prim', '<u4')]; a miss is inf and 0xffffffff. With --any: N bytes, 1 for a hit.

Example:
  python3 -c \"import numpy as np; np.save('rays.npy', np.array([[0,0,-5,0, 0,0,1,np.inf]], '<f4'))\"
  skipgrid trace mesh.obj --rays rays.npy --hits hits.npy
  python3 -c \"import numpy as np; print(np.load('hits.npy'))\"";

/// Trace the rays of a file through a scene; rays and hits are NumPy arrays
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// The rays: .npy or .rays
    #[arg(long, value_name = "FILE")]
    rays: PathBuf,

    /// Where the hits go: .npy
    #[arg(long, value_name = "FILE")]
    hits: PathBuf,

    /// Accelerator, with options; see `skipgrid list`
    #[arg(long, value_name = "A", default_value = DEFAULT_ACCEL)]
    accel: String,

    /// Ask only whether anything is hit
    #[arg(long)]
    any: bool,
}

/// Traces.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    check_folder(&args.hits)?;
    let rays = read_rays(&args.rays)?;
    let scene = args.scene.load(console)?;
    let accel = scene.accel(&args.scene.spec(&args.accel))?;
    let accel: &dyn Accel = &*accel;

    let start = Instant::now();
    let mut bytes = Vec::new();
    // Writing to memory cannot fail.
    let (hit, written) = if args.any {
        let flags: Vec<bool> = rays.par_iter().map(|ray| accel.any_hit(ray)).collect();
        (flags.iter().filter(|&&flag| flag).count(), npy::write_flags(&mut bytes, &flags))
    } else {
        let hits: Vec<_> = rays.par_iter().map(|ray| accel.closest_hit(ray)).collect();
        (hits.iter().flatten().count(), npy::write_hits(&mut bytes, &hits))
    };
    written.map_err(|error| Error::io(&args.hits, error))?;
    let seconds = start.elapsed().as_secs_f64();
    replace_file(&args.hits, &bytes)?;
    console.note(format!("{} rays, {hit} hit something, {seconds:.3} s", rays.len()));
    Ok(Outcome::Done)
}

/// Reads .npy or .rays, by extension.
pub fn read_rays(path: &Path) -> Result<Vec<Ray>> {
    match path.extension().and_then(|e| e.to_str()) {
        Some("npy") => npy::read_rays(path),
        Some("rays") => raw::read_rays(path),
        other => Err(Error::malformed(
            path,
            format!("extension `{}` is no format of rays: .npy or .rays", other.unwrap_or_default()),
        )),
    }
}
