//! `skipgrid sweep`: every option of the accelerators over its range.

mod forms;
mod plot;

use super::console::Console;
use super::input::{RayArgs, SceneArgs, note_camera, parse_positive, parse_size};
use super::outputs::{Extent, Forms, Outputs};
use super::{Outcome, interrupt};
use crate::error::Result;
use crate::measure::{Sweep, SweepOptions, matching, sweep};
use std::path::PathBuf;

const DETAILS: &str = "\
Swept are, where an accelerator has the option and --accel does not set it: density (voxels for each primitive), threshold (the \
least distance worth a leap: 1, 2, 3, 5, 8, 16), mailbox (off, on) and leaf (the longest list that is not split: 1, 2, 4, .. 32). One is \
swept while the others keep their defaults.

Rays are those of `skipgrid compare`. All settings must answer all of them equally to the bit, else the exit code is 1. The settings \
of one option trace in turns, with their accelerator as it was asked for (the default) and with the first accelerator of all, on one \
thread; times are by its processor time, medians of the rounds, the spread is half their range. The best \
settings are timed once more at the end. A setting that cannot be built is left out, and it is said why.

Examples:
  skipgrid sweep flakes --svg flakes.svg
  skipgrid sweep room.glb --accel grid --accel nested --densities 0.5,2,8
  skipgrid sweep bunny.obj --accel 'grid*' --rounds 9 --format csv";

/// Sweep the options of accelerators over their ranges: time, work, bytes and builds of every setting
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// Accelerator, with options, or the beginning of names with a `*`; give it once for each; the first is the measure of all
    #[arg(long = "accel", value_name = "A", default_values = ["grid", "grid-*", "bsp", "nested"])]
    accels: Vec<String>,

    /// Voxels for each primitive
    #[arg(long, value_name = "F,F,..", value_delimiter = ',', default_values_t = SweepOptions::default().densities, value_parser = parse_positive)]
    densities: Vec<f64>,

    #[command(flatten)]
    traced: RayArgs,

    /// Film that camera rays go through
    #[arg(long, value_name = "WxH", default_value = "64x64", value_parser = parse_size)]
    size: (u32, u32),

    #[command(flatten)]
    outputs: Outputs,

    /// Where the plot goes
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,
}

/// Measures and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    args.outputs.check(args.svg.as_deref())?;
    let specs: Vec<String> = matching(&args.accels)?.iter().map(|accel| args.scene.spec(accel)).collect();
    let scene = args.scene.load(console)?;
    note_camera(&scene, console);
    let (rounds, rays) = (args.traced.rounds, args.traced.of_film(args.size));
    let options = SweepOptions { densities: args.densities.clone(), rounds, rays };

    let progress = console.progress("");
    let watch = |done: usize, all: usize, stage: &str| progress.at(done as u64, all as u64, stage);
    let result = sweep(&scene, &specs, &options, &watch, interrupt::request())?;
    drop(progress);
    report(args, &result, console)?;
    Ok(Outcome::of(result.identical(), result.interrupted))
}

fn report(args: &Args, result: &Sweep, console: &Console) -> Result<()> {
    for (spec, reason) in &result.left_out {
        console.note(format!("{spec} is left out: {reason}"));
    }
    let (scene, rounds) = (&args.scene.scene, args.traced.rounds);
    let forms = Forms {
        text: &|| forms::text(result, scene, rounds),
        csv: &|| forms::csv(result, scene),
        json: &|| forms::json(result, scene, rounds),
        shown: (args.svg.as_deref(), &|| plot::planes(result, scene, rounds).svg()),
    };
    args.outputs.write(&forms, Extent::of(result.interrupted, !result.settings.is_empty()), console)
}
