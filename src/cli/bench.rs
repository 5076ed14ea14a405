//! `skipgrid bench`: every accelerator on a fixed list of scenes.

mod forms;

use super::Outcome;
use super::console::{Console, Format};
use super::document::document;
use super::interrupt;
use super::outputs::{Extent, Forms, Outputs};
use super::table::Table;
use crate::bench::{ANCHORS, BenchScene, Options, Study, bars, run as run_scenes, select, usual};
use crate::error::{Error, Result};
use crate::measure::RayKind;
use crate::registry::did_you_mean;
use crate::stress::{contenders, spelled_out};
use serde_json::json;
use std::path::PathBuf;

const DETAILS: &str = "\
Rays are those of `skipgrid compare`: camera rays through a random point of each pixel, from what they hit shadow rays (any \
hit) towards a light and diffuse rays in random order. Every accelerator answers all of them, and those that promise exact \
answers must agree to the bit, else the exit code is 1; of the others it is said on how many rays they differ. Then they \
trace in turns on one thread; rates are by its processor time, medians of the rounds, the spread is half their range. Builds \
use all cores; their cost is the processor time of all threads together. Images are computed, not rendered: build, then \
camera and shadow rays for 512 x 512 pixels at the measured rates.

The whole list takes long; five accelerators with --rays 4096 --rounds 3 took 37 seconds. The folder of the scenes that are files \
is `../shared/scenes` unless SKIPGRID_SHARED or --shared says otherwise; missing ones are left out.

Examples:
  skipgrid bench --rays 4096 --rounds 3
  skipgrid bench sphere-clouds bunny --accel grid --accel obvhs-cwbvh --format csv
  skipgrid bench --csv bench.csv --json bench.json --svg bench.svg";

/// Measure every accelerator on a fixed list of scenes: speed, work, builds, memory, time to an image
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    /// Scenes or classes of the list (see --list), files, or scenes made by formula; default: the whole list
    #[arg(value_name = "SCENE")]
    scenes: Vec<String>,

    /// Accelerator, with options; give it once for each; `all`: every option of every one; default: those of the registry
    /// but a few, with some of their settings
    #[arg(long = "accel", value_name = "A")]
    accels: Vec<String>,

    /// Kind of rays; give it once for each; default: all
    #[arg(long = "kind", value_name = "K", value_enum)]
    kinds: Vec<Kind>,

    /// Timed rounds
    #[arg(long, value_name = "N", default_value_t = 5, value_parser = clap::value_parser!(u32).range(1..=1000))]
    rounds: u32,

    /// Most rays of a kind; the camera's film is the largest square of so many pixels
    #[arg(long, value_name = "N", default_value_t = 65536, value_parser = clap::value_parser!(u32).range(1..=1 << 24))]
    rays: u32,

    /// Same seed, same rays
    #[arg(long, value_name = "N", default_value_t = 0)]
    seed: u64,

    /// Samples a pixel of the images whose times are computed
    #[arg(long, value_name = "N,N,..", value_delimiter = ',', default_values_t = [1, 64], value_parser = clap::value_parser!(u32).range(1..=1 << 20))]
    spp: Vec<u32>,

    /// What speeds are held against; give it once for each
    #[arg(long = "anchor", value_name = "A", default_values = ANCHORS)]
    anchors: Vec<String>,

    /// Whose figures are judged, if it is measured
    #[arg(long, value_name = "A", default_value = "nested")]
    subject: String,

    /// Leave out larger scenes of the list, unless they are named
    #[arg(long, value_name = "N", default_value_t = 500_000)]
    max_primitives: u32,

    /// The folder whose `scenes` has the scenes of the list that are files
    #[arg(long, value_name = "DIR", env = "SKIPGRID_SHARED", default_value = "../shared")]
    shared: PathBuf,

    #[command(flatten)]
    outputs: Outputs,

    /// Where the plot goes
    #[arg(long, value_name = "FILE")]
    svg: Option<PathBuf>,

    /// List the chosen scenes and accelerators and do nothing
    #[arg(long)]
    list: bool,
}

/// Kinds of rays on the command line.
#[derive(Clone, Copy, Debug, PartialEq, Eq, clap::ValueEnum)]
enum Kind {
    /// From the eye
    #[value(alias = "primary")]
    Camera,
    /// From what those hit towards a light; asked for any hit
    Shadow,
    /// From there in random directions
    Diffuse,
}

impl From<Kind> for RayKind {
    fn from(kind: Kind) -> Self {
        match kind {
            Kind::Camera => RayKind::Camera,
            Kind::Shadow => RayKind::Shadow,
            Kind::Diffuse => RayKind::Diffuse,
        }
    }
}

/// Measures and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    let scenes = select(&args.scenes)?;
    let specs = specs(args);
    let contenders = contenders(&specs)?;
    if args.list {
        list(args, &scenes, &specs, console)?;
        return Ok(Outcome::Done);
    }
    known(args, &specs)?;
    args.outputs.check(args.svg.as_deref())?;
    let options = Options {
        rounds: args.rounds,
        rays: args.rays,
        seed: args.seed,
        spp: args.spp.clone(),
        kinds: args.kinds.iter().map(|kind| RayKind::from(*kind)).collect(),
        anchors: args.anchors.clone(),
        most_primitives: args.max_primitives,
        shared: args.shared.join("scenes"),
    };
    let progress = console.progress("");
    let watch = |done: usize, stage: &str| progress.at(done as u64, scenes.len() as u64, stage);
    let study = run_scenes(&scenes, &contenders, &options, &watch, interrupt::request())?;
    drop(progress);
    report(args, &study, console)?;
    Ok(Outcome::of(study.identical(), study.interrupted))
}

/// The accelerators that are asked for, each once.
fn specs(args: &Args) -> Vec<String> {
    let mut specs = if args.accels.is_empty() { usual() } else { spelled_out(&args.accels) };
    let mut seen = std::collections::HashSet::new();
    specs.retain(|spec| seen.insert(spec.clone()));
    specs
}

/// Refuses an anchor or a subject that is none of `specs`, but for the usual ones, which need not be measured.
fn known(args: &Args, specs: &[String]) -> Result<()> {
    let usual = |name: &&String| ANCHORS.contains(&name.as_str()) || *name == "nested";
    let asked = args.anchors.iter().map(|a| ("--anchor", a)).chain([("--subject", &args.subject)]);
    let mut unknown = asked.filter(|(_, name)| !usual(name) && !specs.contains(name));
    let Some((option, name)) = unknown.next() else { return Ok(()) };
    let names: Vec<&str> = specs.iter().map(String::as_str).collect();
    let hint = did_you_mean(&names, name, 3);
    Err(Error::invalid(format!("{option} {name}: is not among the accelerators that are measured{hint}")))
}

fn report(args: &Args, study: &Study, console: &Console) -> Result<()> {
    for (scene, reason) in &study.left_out {
        console.note(format!("{scene} is left out: {reason}"));
    }
    if study.scenes.is_empty() && !study.interrupted {
        return Err(Error::invalid("no scene is left to measure"));
    }
    let forms = Forms {
        text: &|| forms::text(study, &args.subject),
        csv: &|| forms::csv(study),
        json: &|| forms::json(study, &args.subject),
        shown: (args.svg.as_deref(), &|| bars(study).svg()),
    };
    args.outputs.write(&forms, Extent::of(study.interrupted, !study.scenes.is_empty()), console)
}

/// Prints what would be measured.
fn list(args: &Args, scenes: &[BenchScene], specs: &[String], console: &Console) -> Result<()> {
    let folder = args.shared.join("scenes");
    if args.outputs.format == Format::Json {
        let scene = |s: &BenchScene| json!({ "scene": s.name, "class": s.class.name(), "primitives": s.primitives, "specification": s.spec(&folder) });
        let scenes: Vec<_> = scenes.iter().map(scene).collect();
        let body = json!({ "scenes": scenes, "accelerators": specs });
        return console.json(&document("skipgrid.bench-list/1", body));
    }
    let mut table = Table::new(&["<scene", "<class", "primitives", "<specification"]);
    for scene in scenes {
        let primitives = if scene.primitives == 0 { "-".into() } else { scene.primitives.to_string() };
        table.row(vec![scene.name.clone(), scene.class.name().into(), primitives, scene.spec(&folder)]);
    }
    if args.outputs.format == Format::Csv {
        return console.data(&table.csv());
    }
    console.data(&format!("{}\naccelerators: {}\n", table.text(), specs.join(", ")))
}
