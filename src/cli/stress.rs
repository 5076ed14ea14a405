//! `skipgrid stress`: every accelerator on hard cases, against exact arithmetic.

mod forms;

use super::Outcome;
use super::console::{Console, Format};
use super::document::document;
use super::outputs::{Extent, Forms, Outputs};
use super::table::Table;
use crate::error::Result;
use crate::stress::cases::{FAMILIES, Selection, select};
use crate::stress::{Options, contenders, page, run as run_cases};
use serde_json::json;
use std::path::PathBuf;

const DETAILS: &str = "\
Each case is a scene and rays that are hard to get right, made from a seed. Every accelerator is asked for the closest hit \
and for any hit of each ray, in four ways, and judged by exact arithmetic: hits missed, false hits, wrong primitives (of \
several at the least t the one with the least index is right), errors of t in units in the last place, answers that \
contradict each other, panics, endless walks. Then the first rays of the case are timed in turns with ordinary rays over \
the same scene.

CASE is a name or the beginning of names and a star. The exit code is 1 if an accelerator that promises exact answers \
gives a wrong one; accelerators that bring a primitive test of their own are there to be compared with. Times do not decide.

Examples:
  skipgrid stress
  skipgrid stress 'wt_*' --rays 1000000 --accel grid --accel obvhs-cwbvh
  skipgrid stress --accel all --html stress.html --csv stress.csv";

/// Run every accelerator on cases that are hard to get right, against exact arithmetic
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    /// Names of cases, or their beginnings and `*`; default: all
    #[arg(value_name = "CASE")]
    cases: Vec<String>,

    /// Accelerator, with options; give it once for each; `all`: every option; default: every walk and method, and the peers
    #[arg(long = "accel", value_name = "A")]
    accels: Vec<String>,

    /// Rays of each case; some cases allow fewer only
    #[arg(long, value_name = "N", default_value_t = 20_000, value_parser = clap::value_parser!(u64).range(1..=100_000_000))]
    rays: u64,

    /// Timed rounds; 0: no times
    #[arg(long, value_name = "N", default_value_t = 3, value_parser = clap::value_parser!(u32).range(..=1000))]
    rounds: u32,

    #[command(flatten)]
    outputs: Outputs,

    /// Where a self-contained HTML page goes
    #[arg(long, value_name = "FILE")]
    html: Option<PathBuf>,

    /// List the cases and do nothing
    #[arg(long)]
    list: bool,
}

/// Runs and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    let selection = select(&args.cases)?;
    if args.list {
        list(args.outputs.format, &selection, console)?;
        return Ok(Outcome::Done);
    }
    args.outputs.check(args.html.as_deref())?;
    let contenders = contenders(&args.accels)?;
    let progress = console.progress("");
    let watch = |done: usize, all: usize, stage: &str| progress.at(done as u64, all as u64, stage);
    // Panics of accelerators are counted, not printed.
    let hook = std::panic::take_hook();
    std::panic::set_hook(Box::new(|_| {}));
    let study = run_cases(&selection, &contenders, &Options { rays: args.rays, rounds: args.rounds }, &watch);
    std::panic::set_hook(hook);
    drop(progress);

    let forms = Forms {
        text: &|| forms::text(&study),
        csv: &|| forms::csv(&study),
        json: &|| forms::json(&study),
        shown: (args.html.as_deref(), &|| page(&study)),
    };
    // An interrupt ends the program before it comes here.
    args.outputs.write(&forms, Extent::Whole, console)?;
    Ok(if study.passed() { Outcome::Done } else { Outcome::CheckFailed })
}

/// Prints the table of the chosen cases.
fn list(format: Format, selection: &Selection, console: &Console) -> Result<()> {
    let family = |name: &str| FAMILIES.iter().find(|f| f.cases.iter().any(|c| c.name == name)).map_or("", |f| f.name);
    if format == Format::Json {
        let cases = selection
            .cases
            .iter()
            .map(|c| json!({ "family": family(c.name), "case": c.name, "summary": c.summary, "must_hit": c.must_hit }));
        let walks =
            selection.walks.iter().map(|c| json!({ "family": "walks", "case": c.name, "resolution": c.resolution }));
        let all: Vec<_> = cases.chain(walks).collect();
        return console.json(&document("skipgrid.stress-list/1", json!({ "cases": all })));
    }
    let mut table = Table::new(&["<family", "<case", "<summary", "<rays"]);
    for case in &selection.cases {
        let rays = case.most_rays.map_or(String::new(), |(most, reason)| format!("at most {most}: {reason}"));
        table.row([family(case.name), case.name, case.summary, &rays].map(String::from).to_vec());
    }
    for case in &selection.walks {
        let [x, y, z] = case.resolution;
        let summary = format!("voxels that walks visit in a grid of {x} x {y} x {z}, against the exact sequence");
        table.row(["walks".into(), case.name.into(), summary, "at most 1500 of each kind".into()].to_vec());
    }
    console.data(&if format == Format::Csv { table.csv() } else { table.text() })
}
