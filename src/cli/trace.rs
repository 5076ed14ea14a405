//! `skipgrid trace`: a file of rays in, a file of hits out; or rays on the command line, and lines of text out.

use super::Outcome;
use super::console::Console;
use super::input::{self, DEFAULT_ACCEL, SceneArgs, check_extension, choose};
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::measure::npy;
use crate::picture::io::replace_file;
use crate::ray::Ray;
use crate::scene::{Scene, raw};
use glam::Vec3;
use rayon::prelude::*;
use std::path::{Path, PathBuf};
use std::time::Instant;

const DETAILS: &str = "\
Rays are a NumPy array of N x 8 little-endian f32: ox oy oz tmin dx dy dz tmax; or a .rays file. Directions need not be \
unit: t counts in their length. A ray that is not finite, has no direction or has tmin > tmax hits nothing.
Hits are N records [('t', '<f4'), ('prim', '<u4')]; a miss is inf and 0xffffffff. With --any: N bytes, 1 for a hit.
For each --ray a line is printed: t as a number and as bits, the primitive, and whether the question for any hit found one.

Examples:
  python3 -c \"import numpy as np; np.save('rays.npy', np.array([[0,0,-5,0, 0,0,1,np.inf]], '<f4'))\"
  skipgrid trace mesh.obj --rays rays.npy --hits hits.npy
  python3 -c \"import numpy as np; print(np.load('hits.npy'))\"
  skipgrid trace mesh.obj --ray \"0 0 -5  0 0 1\" --ray \"0 0 -5  0 0x80000000 1  0 inf\"";

/// Trace the rays of a file through a scene; rays and hits are NumPy arrays
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// The rays: .npy or .rays
    #[arg(long, value_name = "FILE", required_unless_present = "ray", requires = "hits")]
    rays: Option<PathBuf>,

    /// Where the hits go: .npy
    #[arg(long, value_name = "FILE", requires = "rays")]
    hits: Option<PathBuf>,

    /// A ray, instead of a file: decimal numbers, or the bits of f32 such as 0x3f800000; 0 and inf unless TMIN and TMAX are
    /// given. May be repeated
    #[arg(
        long,
        value_name = "OX OY OZ DX DY DZ [TMIN TMAX]",
        allow_hyphen_values = true,
        conflicts_with_all = ["rays", "hits", "any"],
        value_parser = parse_ray,
    )]
    ray: Vec<Ray>,

    /// Accelerator, with options; see `skipgrid list`
    #[arg(long, value_name = "A", default_value = DEFAULT_ACCEL)]
    accel: String,

    /// Ask only whether anything is hit
    #[arg(long)]
    any: bool,
}

/// Traces.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    match (&args.rays, &args.hits) {
        (Some(rays), Some(hits)) => trace_file(args, rays, hits, console)?,
        // The command line has one or the other.
        _ => trace_each(args, console)?,
    }
    Ok(Outcome::Done)
}

fn trace_each(args: &Args, console: &Console) -> Result<()> {
    let scene = args.scene.load(console)?;
    let accel = build(args, &scene, 2 * args.ray.len(), console)?;
    let mut text = String::new();
    for ray in &args.ray {
        let (hit, any) = (accel.closest_hit(ray), accel.any_hit(ray));
        let t = hit.map_or(f32::INFINITY, |hit| hit.t);
        let prim = hit.map_or("none".into(), |hit| hit.prim.to_string());
        text += &format!("t={t} bits={:#010x} prim={prim} any={any}\n", t.to_bits());
    }
    console.data(&text)
}

fn build(args: &Args, scene: &Scene, rays: usize, console: &Console) -> Result<Box<dyn Accel>> {
    let (spec, _) = choose(&args.scene.spec(&args.accel), scene, rays as f64)?;
    input::build(scene, &spec, console)
}

/// A ray from the words of an option's value.
fn parse_ray(text: &str) -> std::result::Result<Ray, String> {
    let numbers = text.split_whitespace().map(parse_number).collect::<std::result::Result<Vec<f32>, String>>()?;
    let (&[ox, oy, oz, dx, dy, dz], range) = numbers
        .split_first_chunk()
        .filter(|(_, range)| matches!(range.len(), 0 | 2))
        .ok_or_else(|| format!("{} numbers, where 6 or 8 make a ray", numbers.len()))?;
    let ray = Ray::new(Vec3::new(ox, oy, oz), Vec3::new(dx, dy, dz));
    Ok(if let &[t_min, t_max] = range { ray.with_range(t_min, t_max) } else { ray })
}

/// A decimal number, the nearest f32; or the bits of one.
fn parse_number(word: &str) -> std::result::Result<f32, String> {
    let number = match word.strip_prefix("0x") {
        // `from_str_radix` takes a sign, too.
        Some(digits) if digits.starts_with('+') => None,
        Some(digits) => u32::from_str_radix(digits, 16).ok().map(f32::from_bits),
        None => word.parse().ok(),
    };
    number.ok_or_else(|| format!("`{word}` is neither a decimal number nor the bits of an f32 such as 0x3f800000"))
}

fn trace_file(args: &Args, rays: &Path, hits: &Path, console: &Console) -> Result<()> {
    check_extension(hits, "an array of hits", "npy")?;
    let rays = read_rays(rays)?;
    let scene = args.scene.load(console)?;
    let accel = build(args, &scene, rays.len(), console)?;
    let accel: &dyn Accel = &*accel;

    let start = Instant::now();
    let mut bytes = Vec::new();
    // Writing to memory cannot fail.
    let (hit, written) = if args.any {
        let flags = each(&rays, console, |ray| accel.any_hit(ray));
        (flags.iter().filter(|&&flag| flag).count(), npy::write_flags(&mut bytes, &flags))
    } else {
        let hits = each(&rays, console, |ray| accel.closest_hit(ray));
        (hits.iter().flatten().count(), npy::write_hits(&mut bytes, &hits))
    };
    written.map_err(|error| Error::io(hits, error))?;
    let seconds = start.elapsed().as_secs_f64();
    replace_file(hits, &bytes)?;
    console.note(format!("{} rays, {hit} hit something, {seconds:.3} s", rays.len()));
    Ok(())
}

/// The answer to each ray, on all cores.
fn each<T: Send>(rays: &[Ray], console: &Console, answer: impl Fn(&Ray) -> T + Sync) -> Vec<T> {
    // Enough for all cores at a time.
    const AT_ONCE: usize = 1 << 18;
    let progress = console.progress("tracing");
    let mut answers = Vec::with_capacity(rays.len());
    for some in rays.chunks(AT_ONCE) {
        progress.at(answers.len() as u64, rays.len() as u64, "tracing");
        answers.par_extend(some.par_iter().map(&answer));
    }
    answers
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
