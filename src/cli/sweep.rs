//! `skipgrid sweep`: every option of the accelerators over its range.

mod forms;
mod plot;

use super::console::Console;
use super::input::{SceneArgs, note_camera, parse_size};
use super::outputs::{Forms, Outputs};
use super::{Outcome, interrupt};
use crate::error::Result;
use crate::measure::{RayOptions, Sweep, SweepOptions, matching, sweep};

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

/// Sweep resolution, skip method, least leap, mailbox and leaf size: time, work, bytes and builds of every setting
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// Accelerator, with options, or the beginning of names with a `*`; give it once for each; the first is the measure of all
    #[arg(long = "accel", value_name = "A", default_values = ["grid", "grid-*", "bsp", "nested"])]
    accels: Vec<String>,

    /// Voxels for each primitive
    #[arg(long, value_name = "F,F,..", value_delimiter = ',', default_values_t = SweepOptions::default().densities, value_parser = parse_density)]
    densities: Vec<f64>,

    /// Timed rounds
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,

    /// Film that camera rays go through
    #[arg(long, value_name = "WxH", default_value = "64x64", value_parser = parse_size)]
    size: (u32, u32),

    /// Most rays of a kind; of a larger film every so-many-th pixel is taken
    #[arg(long, value_name = "N", default_value_t = 65536, value_parser = clap::value_parser!(u32).range(1..))]
    max_rays: u32,

    /// Same seed, same rays
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    #[command(flatten)]
    outputs: Outputs,
}

/// Measures and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    args.outputs.check()?;
    let specs: Vec<String> = matching(&args.accels)?.iter().map(|accel| args.scene.spec(accel)).collect();
    let scene = args.scene.load(console)?;
    note_camera(&scene, console);
    let (width, height) = args.size;
    let rays = RayOptions { width, height, seed: args.seed, max_rays: args.max_rays as usize };
    let options = SweepOptions { densities: args.densities.clone(), rounds: args.rounds, rays };

    let bar = console.progress(1);
    let progress = |done: usize, all: usize, stage: &str| {
        bar.set_length(all as u64);
        bar.set_position(done as u64);
        bar.set_message(stage.to_string());
    };
    let result = sweep(&scene, &specs, &options, &progress, interrupt::request());
    bar.finish_and_clear();
    let result = result?;
    report(args, &result, console)?;
    Ok(match () {
        () if !result.identical() => Outcome::CheckFailed,
        () if result.interrupted => Outcome::Interrupted,
        () => Outcome::Done,
    })
}

fn report(args: &Args, result: &Sweep, console: &Console) -> Result<()> {
    for (spec, reason) in &result.left_out {
        console.note(format!("{spec} is left out: {reason}"));
    }
    let scene = &args.scene.scene;
    let forms = Forms {
        text: &|| forms::text(result, scene, args.rounds),
        csv: &|| forms::csv(result, scene),
        json: &|| forms::json(result, scene, args.rounds),
        svg: &|| plot::planes(result, scene, args.rounds).svg(),
    };
    args.outputs.write(&forms, console)
}

fn parse_density(text: &str) -> std::result::Result<f64, String> {
    match text.parse::<f64>() {
        Ok(value) if value.is_finite() && value > 0.0 => Ok(value),
        _ => Err("not a finite number above 0".into()),
    }
}
