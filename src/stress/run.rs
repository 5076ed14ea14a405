//! Runs cases: builds, asks, judges, times.

use super::ask::{Asked, ask, survive};
use super::cases::{Case, Selection, Stage};
use super::contender::Contender;
use super::judge::Tally;
use super::report::{CaseResult, Outcome, Row, Study, WalkResult};
use super::time::times;
use super::walks::study;
use crate::accel::Accel;
use crate::geometry::Geometry;
use crate::measure::Machine;
use crate::oracle::{Oracle, Primitive, Truth};
use crate::ray::Ray;
use crate::scene::{SceneGeometry, with_geometry};
use rayon::prelude::*;
use std::time::{Duration, Instant};

/// How to run.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Options {
    /// Rays of each case, unless the case allows fewer only.
    pub rays: u64,
    /// Timed rounds; 0: no times.
    pub rounds: u32,
}

impl Default for Options {
    fn default() -> Self {
        Self { rays: 20_000, rounds: 3 }
    }
}

/// Rays that are in memory at once, with their exact answers.
const CHUNK: u64 = 8192;
/// Indices in the tie sets of a chunk, at worst.
const MOST_TIES: u64 = 1 << 22;

/// An accelerator on a case, while it runs.
struct Running<'a> {
    contender: &'a Contender,
    accel: Box<dyn Accel>,
    tally: Tally,
    spent: Duration,
}

/// Most rays of each kind in a case of the voxel walks: they and the exact sequence visit every voxel.
const MOST_WALKS: u64 = 1500;

/// Runs every case with every contender that suits it, and the voxel walks. `progress` is called with the cases done, all
/// cases, and a few words.
pub fn run(
    selection: &Selection,
    contenders: &[Contender],
    options: &Options,
    progress: &dyn Fn(usize, usize, &str),
) -> Study {
    let (cases, all) = (&selection.cases, selection.cases.len() + selection.walks.len());
    let results = cases
        .iter()
        .enumerate()
        .map(|(done, case)| {
            progress(done, all, case.name);
            run_case(case, contenders, options, &|stage| progress(done, all, &format!("{}: {stage}", case.name)))
        })
        .collect();
    let walks = selection
        .walks
        .iter()
        .enumerate()
        .map(|(done, &case)| {
            progress(cases.len() + done, all, case.name);
            let rows = study(case, options.rays.min(MOST_WALKS) as usize);
            WalkResult { case, rows }
        })
        .collect();
    Study { results, walks, rays: options.rays, rounds: options.rounds, machine: Machine::this() }
}

fn run_case(case: &'static Case, contenders: &[Contender], options: &Options, progress: &dyn Fn(&str)) -> CaseResult {
    let start = Instant::now();
    let stage = case.stage();
    let primitives = primitives(&stage.geometry);
    let count = primitives.len() as u64;
    let oracle = Oracle::new(primitives);
    let rays = case.rays(options.rays);
    let mut result = CaseResult { case, primitives: count, rays, hits: 0, ties: 0, seconds: 0.0, rows: Vec::new() };

    // Positions in `result.rows` and what runs there.
    let mut running: Vec<(usize, Running)> = Vec::new();
    for contender in contenders.iter().filter(|contender| contender.suits(&stage.geometry)) {
        progress(&contender.name);
        let outcome = match survive(|| {
            contender.admit(&stage.geometry)?;
            contender.build(&stage.geometry, case.resolution)
        }) {
            Ok(Ok(accel)) => {
                running.push((
                    result.rows.len(),
                    Running { contender, accel, tally: Tally::default(), spent: Duration::ZERO },
                ));
                Outcome::Traced { tally: Tally::default(), times: None }
            }
            Ok(Err(error)) => Outcome::Refused(error.to_string()),
            Err(message) => Outcome::Panicked(message),
        };
        result.rows.push(Row { accel: contender.name.clone(), exact: contender.exact, outcome });
    }

    let most_work = 1_000_000 + 64 * count;
    // Far above what any ray should take, brute force included, yet all accelerators come to an end.
    let patience = Duration::from_secs(120) + Duration::from_micros((2500 + count) * rays);
    let step = (MOST_TIES / count.max(1)).clamp(16, CHUNK);
    for from in (0..rays).step_by(step as usize) {
        let chunk: Vec<Ray> = (from..rays.min(from + step)).map(|i| stage.ray(i)).collect();
        progress(&format!("{from} of {rays} rays, exact"));
        let truth: Vec<Option<Truth>> = chunk.par_iter().map(|ray| oracle.closest(ray)).collect();
        result.hits += truth.iter().flatten().count() as u64;
        result.ties += truth.iter().flatten().filter(|truth| truth.prims.len() > 1).count() as u64;
        let mut first: Option<Vec<Asked>> = None;
        for (_, runner) in &mut running {
            progress(&format!("{from} of {rays} rays, {}", runner.contender.name));
            let (begin, left) = (Instant::now(), patience.saturating_sub(runner.spent));
            let asked = ask(&*runner.accel, &chunk, left);
            runner.spent += begin.elapsed();
            for (i, (ray, asked)) in chunk.iter().zip(&asked).enumerate() {
                let first = first.as_ref().filter(|_| runner.contender.exact).map(|first| &first[i]);
                runner.tally.judge((from + i as u64, ray), asked, truth[i].as_ref(), first, most_work);
            }
            if runner.contender.exact && first.is_none() {
                first = Some(asked);
            }
        }
    }

    for (place, runner) in running {
        progress(&format!("timing {}", runner.contender.name));
        let times = if runner.tally.panics + runner.tally.untraced > 0 || options.rounds == 0 {
            None
        } else {
            time(case, &stage, &runner, rays, options.rounds)
        };
        result.rows[place].outcome = Outcome::Traced { tally: runner.tally, times };
    }
    result.seconds = start.elapsed().as_secs_f64();
    result
}

fn time(case: &Case, stage: &Stage, runner: &Running, rays: u64, rounds: u32) -> Option<super::Times> {
    if !stage.has_other_scene() {
        return times(stage, &*runner.accel, &*runner.accel, rays, rounds);
    }
    let other = survive(|| runner.contender.build(stage.ordinary(), case.resolution)).ok()?.ok()?;
    times(stage, &*runner.accel, &*other, rays, rounds)
}

/// The primitives as the oracle takes them.
fn primitives(geometry: &SceneGeometry) -> Vec<Primitive> {
    with_geometry!(*geometry, g => {
        let of = |prim| match (g.triangle(prim), g.sphere(prim)) {
            (Some(corners), _) => Primitive::Triangle(corners),
            (_, Some(sphere)) => Primitive::Sphere { centre: sphere.centre, radius: sphere.radius },
            (None, None) => unreachable!("the catalogue has triangles and spheres only"),
        };
        (0..Geometry::len(g)).map(of).collect()
    })
}
