//! `skipgrid compare`: several accelerators on the same rays.

use super::Outcome;
use super::console::{Console, Format};
use super::document::measured;
use super::input::{ContenderArgs, RayArgs, bits, note_camera, parse_size};
use super::table::{Table, short};
use super::trace::read_rays;
use crate::accel::Hit;
use crate::error::Result;
use crate::measure::{Comparison, Difference, Query, Rounds, compare_with};
use serde_json::{Value, json};
use std::cell::Cell;
use std::path::PathBuf;

const DETAILS: &str = "\
Camera rays go through a random point of each pixel; shadow rays (any hit) from what they hit towards a light; diffuse \
rays (closest hit) from there in random directions and random order. All accelerators are asked for the closest hit and \
for any hit of every ray: the answers must be equal to the bit, else the exit code is 1. Accelerators that promise no \
exact answers (see `skipgrid list`) are held against the others, and how they differ is said without a failure. Then each \
traces the same rays in turns, on one thread; rates are by that thread's processor time, medians of the rounds, the spread is half their range. Ratios \
are against the first accelerator; above 1 means faster, larger or slower to build.

Examples:
  skipgrid compare random:n=10000
  skipgrid compare room.glb --accel grid --accel grid:density=8 --accel obvhs-cwbvh --format csv";

/// Compare accelerators on the same rays: identical answers, speed, work, memory, build time
#[derive(Debug, clap::Args)]
#[command(after_help = DETAILS)]
pub struct Args {
    #[command(flatten)]
    contenders: ContenderArgs,

    #[command(flatten)]
    traced: RayArgs,

    /// Film that camera rays go through
    #[arg(long, value_name = "WxH", default_value = "256x256", value_parser = parse_size)]
    size: (u32, u32),

    /// Use the rays of this .npy or .rays file instead, asked for their closest hit
    #[arg(long, value_name = "FILE")]
    rays: Option<PathBuf>,

    /// Form of the table
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// Compares and prints.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    let given = args.rays.as_deref().map(read_rays).transpose()?;
    let scene = args.contenders.scene.load(console)?;
    if given.is_none() {
        note_camera(&scene, console);
    }
    let specs = args.contenders.specs();
    let kinds = if given.is_some() { 1 } else { 3 };
    let rounds = Rounds { rounds: args.traced.rounds, rays: args.traced.of_film(args.size), given };

    let progress = console.progress("");
    let all = specs.len() as u64 + kinds * (work("checking", &rounds) + work("timing", &rounds));
    let (done, now) = (Cell::new(0), Cell::new(0));
    let result = compare_with(&scene, &specs, &rounds, &|stage| {
        done.set(done.get() + now.replace(work(stage, &rounds)));
        progress.at(done.get(), all, stage);
    })?;
    drop(progress);
    match args.format {
        Format::Text => console.data(&text(&result, args))?,
        Format::Json => console.json(&json(&result, args))?,
        Format::Csv => {
            console.data(&rates(&result, true).csv())?;
            verdict(&result).lines().for_each(|line| console.note(line));
        }
    }
    Ok(if result.identical() { Outcome::Done } else { Outcome::CheckFailed })
}

/// About how much a stage of [`compare_with`] has to do: passes over the rays, or a build.
fn work(stage: &str, rounds: &Rounds) -> u64 {
    match stage.split(' ').next() {
        // Closest hit, any hit, and one of them with counting.
        Some("checking") => 3,
        // One pass tells how often a reading repeats it.
        Some("timing") => 1 + u64::from(rounds.rounds),
        _ => 1,
    }
}

fn text(result: &Comparison, args: &Args) -> String {
    let mut out = format!(
        "skipgrid {}: {}, {} primitives\n{}; traced on one thread\nseed {}, {} rounds:",
        env!("CARGO_PKG_VERSION"),
        args.contenders.scene.scene,
        result.primitives,
        result.machine,
        args.traced.seed,
        result.rounds
    );
    for kind in &result.kinds {
        let share = if kind.rays == 0 { 0.0 } else { 100.0 * kind.hits as f64 / kind.rays as f64 };
        out += &format!(" {} {} rays ({share:.1} % hit),", kind.rays, kind.kind.name());
    }
    out.truncate(out.len() - 1);
    out += "\n\n";
    let mut builds = Table::new(&["<accelerator", "build ms", "ratio", "bytes", "ratio"]);
    for row in &result.rows {
        let bytes = row.build.memory.total();
        builds.row(vec![
            row.accel.clone(),
            short(row.build.milliseconds),
            short(row.build.milliseconds / result.rows[0].build.milliseconds),
            bytes.to_string(),
            short(bytes as f64 / result.rows[0].build.memory.total() as f64),
        ]);
    }
    out += &builds.text();
    out += "\n";
    out += &rates(result, false).text();
    out += "\n";
    for row in result.rows.iter().filter(|row| !row.described.is_empty()) {
        out += &format!("{}: {}\n", row.accel, row.described);
    }
    out += "\n";
    out + &verdict(result)
}

/// One row for each ray kind and accelerator; with the build's cost if `flat`.
fn rates(result: &Comparison, flat: bool) -> Table {
    let mut columns =
        vec!["<rays", "<accelerator", "Mrays/s", "spread %", "ratio", "steps/ray", "leaps/ray", "tests/ray"];
    if flat {
        columns.extend(["build ms", "bytes", "count", "hits"]);
    }
    let mut table = Table::new(&columns);
    for (k, kind) in result.kinds.iter().enumerate() {
        for row in &result.rows {
            let mut cells = vec![kind.kind.name().to_string(), row.accel.clone()];
            match row.rates[k] {
                Some(rate) => {
                    let first = result.rows[0].rates[k].map_or(f64::NAN, |first| first.rays_per_second);
                    cells.push(short(rate.rays_per_second / 1e6));
                    cells.push(format!("{:.1}", 100.0 * rate.spread));
                    cells.push(short(rate.rays_per_second / first));
                    cells.extend([rate.steps_per_ray(), rate.leaps_per_ray(), rate.tests_per_ray()].map(short));
                }
                None => cells.extend(std::iter::repeat_n("-".to_string(), 6)),
            }
            if flat {
                let build = &row.build;
                cells.extend([short(build.milliseconds), build.memory.total().to_string()]);
                cells.extend([kind.rays.to_string(), kind.hits.to_string()]);
            }
            table.row(cells);
        }
    }
    table
}

fn verdict(result: &Comparison) -> String {
    let mut out = identity(result);
    let first = &result.rows[result.truth].accel;
    let others = result.rows.iter().enumerate().filter(|(i, row)| !row.exact && *i != result.truth);
    for (_, row) in others {
        let d = &row.deviations;
        out += &format!(
            "{}, which promises no exact answers, against {first} on {} rays: {} missed, {} hits where nothing is, {} other \
             primitives, {} other bits of t, {} other answers to any hit alone\n",
            row.accel,
            result.rays(),
            d.missed,
            d.extra,
            d.primitive,
            d.parameter,
            d.other
        );
    }
    out
}

/// Whether those that promise exact answers agree, in words.
pub(super) fn identity(result: &Comparison) -> String {
    let first = &result.rows[result.truth].accel;
    match &result.difference {
        None => {
            let exact: Vec<&str> = result.rows.iter().filter(|row| row.exact).map(|row| row.accel.as_str()).collect();
            let (names, rays) = (exact.join(", "), result.rays());
            match exact.len() {
                0 => "none of the accelerators promises exact answers\n".to_string(),
                1 if result.rows.len() > 1 => format!("{names} alone promises exact answers\n"),
                _ => format!(
                    "identical hits: {names} gave the same primitive and the same bits of t on all {rays} rays, and any hit \
                     agrees\n"
                ),
            }
        }
        Some(d) => {
            let (other, answer) = (&d.other.0, answer(&d.other.1));
            format!(
                "DIFFERENT HITS: {} answers differ from those of {first}; the first is the {} of {} ray {}\n\
                 ray bits (ox oy oz tmin dx dy dz tmax): {}\n{first}: {}\n{other}: {answer}\n",
                result.differing,
                d.query,
                d.kind.name(),
                d.index,
                bits(&d.ray).join(" "),
                self::answer(&Ok(d.first.1)),
            )
        }
    }
}

fn answer(answer: &std::result::Result<Option<Hit>, bool>) -> String {
    match answer {
        Ok(Some(hit)) => format!("primitive {}, t = {:?} (bits {:08x})", hit.prim, hit.t, hit.t.to_bits()),
        Ok(None) => "nothing".to_string(),
        Err(flag) => format!("any hit: {flag}"),
    }
}

fn json(result: &Comparison, args: &Args) -> Value {
    let kinds: Vec<Value> = result
        .kinds
        .iter()
        .map(|k| {
            let query = if k.query == Query::Any { "any hit" } else { "closest hit" };
            json!({ "kind": k.kind.name(), "query": query, "rays": k.rays, "hits": k.hits })
        })
        .collect();
    let rows: Vec<Value> = result
        .rows
        .iter()
        .map(|row| {
            let memory = &row.build.memory;
            let rates: Vec<Value> = row
                .rates
                .iter()
                .enumerate()
                .map(|(k, rate)| {
                    let (Some(rate), Some(first)) = (rate, result.rows[0].rates[k]) else { return Value::Null };
                    json!({
                        "kind": result.kinds[k].kind.name(),
                        "rays_per_second": rate.rays_per_second,
                        "spread": rate.spread,
                        "ratio": rate.rays_per_second / first.rays_per_second,
                        "steps": rate.counts.steps,
                        "leaps": rate.counts.leaps,
                        "tests": rate.counts.tests,
                    })
                })
                .collect();
            json!({
                "accelerator": row.accel,
                "described": row.described,
                "exact": row.exact,
                "deviations": {
                    "missed": row.deviations.missed,
                    "extra": row.deviations.extra,
                    "primitive": row.deviations.primitive,
                    "parameter": row.deviations.parameter,
                    "other": row.deviations.other,
                },
                "build_ms": row.build.milliseconds,
                "bytes": {
                    "structure": memory.structure,
                    "references": memory.references,
                    "tables": memory.tables,
                    "total": memory.total(),
                },
                "rates": rates,
            })
        })
        .collect();
    let body = json!({
        "scene": args.contenders.scene.scene,
        "primitives": result.primitives,
        "seed": args.traced.seed,
        "rounds": result.rounds,
        "rays": kinds,
        "accelerators": rows,
        "identical": result.identical(),
        "truth": result.rows[result.truth].accel,
        "rays_checked": result.rays(),
        "differing": result.differing,
        "difference": result.difference.as_ref().map(difference),
    });
    measured("skipgrid.compare/1", &result.machine, body)
}

/// The first difference.
pub(super) fn difference(d: &Difference) -> Value {
    json!({
        "kind": d.kind.name(),
        "index": d.index,
        "query": d.query,
        "ray_bits": bits(&d.ray),
        "first": { "accelerator": d.first.0, "answer": answer(&Ok(d.first.1)) },
        "other": { "accelerator": d.other.0, "answer": answer(&d.other.1) },
    })
}
