//! Errors against exact arithmetic, and the time of those who make them.

use super::Options;
use super::mix::{Case, cases};
use super::plain::{MollerTrumbore32, MollerTrumbore64, PlainTriangles, Test, Woop32};
use super::textbook::Textbook;
use crate::accel::{Accel, Hit};
use crate::error::Result;
use crate::geometry::{Geometry, Triangle};
use crate::grid::{Grid, GridOptions};
use crate::measure::rounds::{Pace, in_turns};
use crate::oracle::{Oracle, Truth};
use crate::papers::Watch;
use crate::papers::plot::{Plot, Scatter, Spot};
use crate::papers::report::{Cell, Table};
use crate::registry::{self, ENTRIES};
use rayon::prelude::*;
use std::hint::black_box;

/// Answers that exact arithmetic contradicts.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Faults {
    /// Nothing where there is something.
    pub missed: u64,
    /// Something where there is nothing.
    pub invented: u64,
    /// A primitive that is not among those hit first.
    pub other: u64,
    /// Largest error of `t` where the primitive is right, units in the last place of f32.
    pub ulps: f64,
}

impl Faults {
    fn all(&self) -> u64 {
        self.missed + self.invented + self.other
    }

    fn add(&mut self, truth: Option<&Truth>, hit: Option<Hit>) {
        match (truth, hit) {
            (None, None) => {}
            (Some(_), None) => self.missed += 1,
            (None, Some(_)) => self.invented += 1,
            (Some(truth), Some(hit)) if truth.prims.contains(&hit.prim) => self.ulps = self.ulps.max(truth.ulps(hit.t)),
            (Some(_), Some(_)) => self.other += 1,
        }
    }

    fn and(self, more: &Faults) -> Self {
        Self {
            missed: self.missed + more.missed,
            invented: self.invented + more.invented,
            other: self.other + more.other,
            ulps: self.ulps.max(more.ulps),
        }
    }
}

/// A grid's test and walk, or a peer.
#[derive(Clone, Copy, Debug, PartialEq)]
enum Contender {
    Grid { test: &'static str, accumulated: bool },
    Peer(&'static str),
}

const EXACT: &str = "exact";
const GRIDS: [&str; 4] = [EXACT, Woop32::NAME, MollerTrumbore32::NAME, MollerTrumbore64::NAME];

impl Contender {
    fn name(self) -> String {
        match self {
            Contender::Grid { test, accumulated: true } => format!("{test}, accumulated f32"),
            Contender::Grid { test, accumulated: false } => format!("{test}, recomputed f64"),
            Contender::Peer(name) => name.to_string(),
        }
    }

    fn build<'a>(self, triangles: &'a [Triangle]) -> Result<Box<dyn Accel + 'a>> {
        match self {
            Contender::Grid { test: EXACT, accumulated } => grid(triangles, accumulated),
            Contender::Grid { test: Woop32::NAME, accumulated } => plain::<Woop32>(triangles, accumulated),
            Contender::Grid { test: MollerTrumbore32::NAME, accumulated } => {
                plain::<MollerTrumbore32>(triangles, accumulated)
            }
            Contender::Grid { accumulated, .. } => plain::<MollerTrumbore64>(triangles, accumulated),
            Contender::Peer(name) => registry::build(name, triangles),
        }
    }
}

fn plain<'a, T: Test>(triangles: &'a [Triangle], accumulated: bool) -> Result<Box<dyn Accel + 'a>> {
    grid(PlainTriangles::<T>::new(triangles), accumulated)
}

fn grid<'a, G: Geometry + 'a>(geometry: G, accumulated: bool) -> Result<Box<dyn Accel + 'a>> {
    let grid = Grid::build(geometry, &GridOptions::default())?;
    Ok(if accumulated { Box::new(grid.with_walk::<Textbook>()) } else { Box::new(grid) })
}

/// What one contender made of the mix.
struct Row {
    contender: Contender,
    /// By case.
    faults: Vec<Faults>,
    /// On ordinary and on stiff rays.
    paces: [Pace; 2],
}

/// The whole mix.
pub(super) struct Study {
    cases: Vec<Case>,
    rows: Vec<Row>,
    /// Peers that cannot be had here or not on these scenes, with the cause.
    pub absent: Vec<String>,
    /// Answers of our grid that differ from exact arithmetic in any way.
    pub wrong: u64,
}

/// Judges and times everybody.
///
/// # Errors
/// A grid exceeds its memory budget.
pub(super) fn measure(options: &Options, watch: &Watch, done: usize, all: usize) -> Result<Study> {
    let cases = cases(options.rays);
    let grids = GRIDS.iter().flat_map(|&test| [true, false].map(|accumulated| Contender::Grid { test, accumulated }));
    let mut contenders: Vec<Contender> = grids.collect();
    contenders.extend(ENTRIES.iter().filter(|e| !e.exact && options.peers).map(|e| Contender::Peer(e.name)));
    let (mut rows, mut absent, mut built): (Vec<Row>, Vec<String>, Vec<Vec<Box<dyn Accel + '_>>>) = Default::default();
    watch(done, all, "exact arithmetic");
    let truths: Vec<Vec<Option<Truth>>> = cases.iter().map(truths).collect();
    let mut wrong = 0;
    for contender in contenders {
        let accels: Result<Vec<_>> = cases.iter().map(|case| contender.build(&case.triangles)).collect();
        let accels = match (accels, contender) {
            (Ok(accels), _) => accels,
            (Err(error), Contender::Grid { .. }) => return Err(error),
            (Err(error), Contender::Peer(_)) => {
                absent.push(error.to_string());
                continue;
            }
        };
        let answers = cases.iter().zip(&truths).zip(&accels);
        let faults = answers.clone().map(|((case, truths), accel)| judge(case, truths, &**accel)).collect();
        if contender == (Contender::Grid { test: EXACT, accumulated: false }) {
            wrong = answers.map(|((case, truths), accel)| inexact(case, truths, &**accel)).sum();
        }
        rows.push(Row { contender, faults, paces: [Pace { per_second: 0.0, spread: 0.0 }; 2] });
        built.push(accels);
    }
    for (kind, stiff) in [false, true].into_iter().enumerate() {
        watch(done + 1 + kind, all, if stiff { "stiff rays" } else { "ordinary rays" });
        let paces = in_turns(rows.len(), options.rounds, |i| {
            let mine = cases.iter().zip(&built[i]).filter(|(case, _)| case.stiff == stiff);
            mine.for_each(|(case, accel)| pass(case, &**accel));
        });
        rows.iter_mut().zip(paces).for_each(|(row, pace)| row.paces[kind] = pace);
    }
    drop(built);
    Ok(Study { cases, rows, absent, wrong })
}

fn truths(case: &Case) -> Vec<Option<Truth>> {
    let oracle = Oracle::of_triangles(&case.triangles);
    case.rays.par_iter().map(|ray| oracle.closest(ray)).collect()
}

fn judge(case: &Case, truths: &[Option<Truth>], accel: &dyn Accel) -> Faults {
    let mut faults = Faults::default();
    for (ray, truth) in case.rays.iter().zip(truths) {
        faults.add(truth.as_ref(), accel.closest_hit(ray));
    }
    faults
}

/// Answers that are not the first of the primitives hit first, or not the exact parameter rounded, or not agreed by any hit.
fn inexact(case: &Case, truths: &[Option<Truth>], accel: &dyn Accel) -> u64 {
    let right = |ray, truth: &Option<Truth>| {
        let expected = truth.as_ref().map(|truth| (truth.prims[0], truth.nearest.to_bits()));
        let found = accel.closest_hit(ray).map(|hit| (hit.prim, hit.t.to_bits()));
        found == expected && accel.any_hit(ray) == expected.is_some()
    };
    case.rays.iter().zip(truths).filter(|(ray, truth)| !right(ray, truth)).count() as u64
}

fn pass(case: &Case, accel: &dyn Accel) {
    let prims = case.rays.iter().filter_map(|ray| accel.closest_hit(ray)).map(|hit| hit.prim);
    black_box(prims.fold(0, |sum: u32, prim| sum ^ prim));
}

impl Study {
    fn rays(&self, stiff: Option<bool>) -> f64 {
        let mine = self.cases.iter().filter(|case| stiff.is_none_or(|stiff| case.stiff == stiff));
        mine.map(|case| case.rays.len() as f64).sum()
    }

    /// Nanoseconds for each ray: ordinary, stiff, all.
    fn nanoseconds(&self, row: &Row) -> [f64; 3] {
        let [ordinary, stiff] = row.paces.map(|pace| 1e9 / pace.per_second);
        [ordinary / self.rays(Some(false)), stiff / self.rays(Some(true)), (ordinary + stiff) / self.rays(None)]
    }

    fn faults(&self, row: &Row) -> Faults {
        row.faults.iter().fold(Faults::default(), Faults::and)
    }

    fn per_million(&self, n: u64) -> f64 {
        1e6 * n as f64 / self.rays(None)
    }

    /// Errors of the grid with `test` and the given walk; `None` if there was none.
    pub fn errors(&self, test: &str, accumulated: bool) -> Option<u64> {
        let is =
            |c: Contender| matches!(c, Contender::Grid { test: t, accumulated: a } if t == test && a == accumulated);
        self.rows.iter().find(|row| is(row.contender)).map(|row| self.faults(row).all())
    }

    /// Everybody on the whole mix.
    pub fn table(&self) -> Table {
        let mut table = Table::new(
            "errors",
            "Errors against exact arithmetic per million rays of the mix, and time: an error is a hit missed, a hit invented or \
             another primitive than those hit first",
            &[
                "<test and walk",
                "missed",
                "invented",
                "other primitive",
                "errors",
                "t error ulp",
                "ns/ray",
                "ns/ray ordinary",
                "ns/ray stiff",
                "spread %",
            ],
        );
        for row in &self.rows {
            let (faults, [ordinary, stiff, all]) = (self.faults(row), self.nanoseconds(row));
            let spread = row.paces.iter().map(|pace| pace.spread).fold(0.0, f64::max);
            let cells: [Cell; 10] = [
                row.contender.name().into(),
                self.per_million(faults.missed).into(),
                self.per_million(faults.invented).into(),
                self.per_million(faults.other).into(),
                self.per_million(faults.all()).into(),
                faults.ulps.into(),
                all.into(),
                ordinary.into(),
                stiff.into(),
                (100.0 * spread).into(),
            ];
            table.row(cells);
        }
        table
    }

    /// Everybody on each case.
    pub fn case_table(&self) -> Table {
        let mut table = Table::new(
            "cases",
            "The same, case by case, in rays",
            &["<case", "rays", "<test and walk", "missed", "invented", "other primitive", "t error ulp"],
        );
        for (i, case) in self.cases.iter().enumerate() {
            for row in &self.rows {
                let faults = &row.faults[i];
                let cells: [Cell; 7] = [
                    case.name.into(),
                    (case.rays.len() as u64).into(),
                    row.contender.name().into(),
                    faults.missed.into(),
                    faults.invented.into(),
                    faults.other.into(),
                    faults.ulps.into(),
                ];
                table.row(cells);
            }
        }
        table
    }

    /// Errors across, time upwards.
    pub fn plot(&self) -> Plot {
        let spot = |row: &Row| {
            let errors = self.per_million(self.faults(row).all());
            let series = match row.contender {
                Contender::Grid { accumulated: true, .. } => 0,
                Contender::Grid { accumulated: false, .. } => 1,
                Contender::Peer(_) => 2,
            };
            Spot { name: row.contender.name(), series, x: errors, y: self.nanoseconds(row)[2] }
        };
        Plot::Scatter(Scatter {
            title: "What errors cost, and what none costs".into(),
            subtitle: format!("{} rays, most of them aimed where f32 fails; one thread", self.rays(None)),
            x: "errors per million rays against exact arithmetic".into(),
            y: "ns/ray".into(),
            series: ["grid, textbook walk", "grid, our walk", "other ray tracers"].map(String::from).to_vec(),
            spots: self.rows.iter().map(spot).collect(),
        })
    }
}
