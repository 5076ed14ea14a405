//! What the exact test costs in the same grid: time against plain tests, and how many tests need which stage.

use super::Options;
use super::plain::{MollerTrumbore32, MollerTrumbore64, PlainTriangles, Test, Woop32};
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::geometry::{Best, Geometry, Triangle, TrianglePrep, stages};
use crate::grid::{Grid, GridOptions};
use crate::measure::rounds::{median, readings};
use crate::measure::{Query, RayOptions, RaySet, ray_sets};
use crate::papers::report::{Cell, Table};
use crate::ray::{Aabb, Ray};
use crate::scene::{LoadOptions, SceneGeometry, load};
use std::hint::black_box;
use std::sync::atomic::{AtomicU64, Ordering};

/// The tests in the order of the tables; the second is the measure.
pub(super) const TESTS: [&str; 4] = ["exact", Woop32::NAME, MollerTrumbore32::NAME, MollerTrumbore64::NAME];

/// Index of the measure in [`TESTS`].
const WOOP: usize = 1;

/// One kind of rays through one scene.
pub(super) struct Cost {
    scene: String,
    triangles: u32,
    kind: &'static str,
    rays: u64,
    /// Nanoseconds a ray, median of the rounds, by test.
    nanoseconds: [f64; 4],
    /// Time against the measure in each round, by test, ascending.
    ratios: [Vec<f64>; 4],
    /// Fastest round against the measure's fastest, by test.
    fastest: [f64; 4],
    /// Rays with another primitive, or a hit instead of none or none instead of a hit, by test.
    differing: [u64; 4],
    tests: u64,
    /// Tests that go on to the second stage, and to the third.
    later: [u64; 2],
}

impl Cost {
    /// Median of the rounds' ratios of the exact test to the measure.
    pub fn ratio(&self) -> f64 {
        median(&mut self.ratios[0].clone())
    }
}

/// Measures one scene: camera, shadow and diffuse rays.
///
/// # Errors
/// It cannot be loaded, does not consist of triangles, or a grid exceeds its memory budget.
pub(super) fn measure(spec: &str, options: &Options) -> Result<Vec<Cost>> {
    let scene = load(spec, &LoadOptions::default())?;
    let SceneGeometry::Triangles(triangles) = &scene.geometry else {
        return Err(Error::invalid(format!("scene `{spec}` does not consist of triangles alone")));
    };
    let accels = grids(triangles)?;
    let counting = Counting { triangles, tests: AtomicU64::new(0), second: AtomicU64::new(0) };
    let counted = Grid::build(&counting, &GridOptions::default())?;
    let rays = RayOptions { width: options.size, height: options.size, ..RayOptions::default() };
    let mut costs = Vec::new();
    for set in ray_sets(&scene, &*accels[0], &rays)? {
        if set.rays.is_empty() {
            continue;
        }
        let rates = readings(accels.len(), options.rounds, |i| pass(&set, &*accels[i]));
        let before = (counting.tests.load(Ordering::Relaxed), counting.second.load(Ordering::Relaxed));
        let decisions = stages::decisions();
        pass(&set, &counted);
        let answers = |i: usize| set.rays.iter().map(move |ray| (ray, i)).map(|(ray, i)| prim(&*accels[i], ray));
        let differing = |i: usize| answers(0).zip(answers(i)).filter(|(a, b)| a != b).count() as u64;
        let against = |i: usize| {
            let mut ratios: Vec<f64> = rates[WOOP].iter().zip(&rates[i]).map(|(woop, rate)| woop / rate).collect();
            ratios.sort_unstable_by(f64::total_cmp);
            ratios
        };
        let best = |i: usize| rates[i].iter().copied().fold(0.0, f64::max);
        costs.push(Cost {
            scene: spec.to_string(),
            triangles: scene.primitive_count(),
            kind: set.kind.name(),
            rays: set.rays.len() as u64,
            nanoseconds: [0, 1, 2, 3].map(|i| 1e9 / median(&mut rates[i].clone()) / set.rays.len() as f64),
            ratios: [0, 1, 2, 3].map(against),
            fastest: [0, 1, 2, 3].map(|i| best(WOOP) / best(i)),
            differing: [0, 1, 2, 3].map(differing),
            tests: counting.tests.load(Ordering::Relaxed) - before.0,
            later: [counting.second.load(Ordering::Relaxed) - before.1, stages::decisions() - decisions],
        });
    }
    Ok(costs)
}

/// The same grid for each of [`TESTS`].
fn grids(triangles: &[Triangle]) -> Result<[Box<dyn Accel + '_>; 4]> {
    fn plain<'a, T: Test>(triangles: &'a [Triangle]) -> Result<Box<dyn Accel + 'a>> {
        Ok(Box::new(Grid::build(PlainTriangles::<T>::new(triangles), &GridOptions::default())?))
    }
    Ok([
        Box::new(Grid::build(triangles, &GridOptions::default())?),
        plain::<Woop32>(triangles)?,
        plain::<MollerTrumbore32>(triangles)?,
        plain::<MollerTrumbore64>(triangles)?,
    ])
}

fn prim(accel: &dyn Accel, ray: &Ray) -> Option<u32> {
    accel.closest_hit(ray).map(|hit| hit.prim)
}

/// Traces the set once.
fn pass(set: &RaySet, accel: &dyn Accel) {
    let answer = |ray: &Ray| match set.query {
        Query::Closest => prim(accel, ray).unwrap_or(0),
        Query::Any => u32::from(accel.any_hit(ray)),
    };
    black_box(set.rays.iter().map(answer).fold(0, |sum: u32, x| sum ^ x));
}

/// Triangles with the exact test that count how far it goes.
struct Counting<'a> {
    triangles: &'a [Triangle],
    tests: AtomicU64,
    second: AtomicU64,
}

impl Geometry for Counting<'_> {
    type Prep = TrianglePrep;

    fn len(&self) -> u32 {
        Geometry::len(self.triangles)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        self.triangles.bounds(prim)
    }

    fn prepare(&self, ray: &Ray) -> TrianglePrep {
        self.triangles.prepare(ray)
    }

    fn test(&self, prim: u32, ray: &Ray, prep: &TrianglePrep, best: &mut Best) {
        self.tests.fetch_add(1, Ordering::Relaxed);
        let passes = prep.passes(ray, &self.triangles[prim as usize]);
        self.second.fetch_add(u64::from(passes), Ordering::Relaxed);
        self.triangles.test(prim, ray, prep, best);
    }

    fn triangle(&self, prim: u32) -> Option<Triangle> {
        self.triangles.triangle(prim)
    }

    fn fingerprint(&self, prim: u32) -> Option<[u32; 9]> {
        self.triangles.fingerprint(prim)
    }
}

/// Time by test.
pub(super) fn time_table(costs: &[Cost]) -> Table {
    let mut table = Table::new(
        "cost",
        "Time in the same grid, against Woop's test in f32: median of the rounds' ratios, least, greatest, and ratio of the \
         fastest rounds",
        &[
            "<scene",
            "triangles",
            "<rays",
            "count",
            "<test",
            "ns/ray",
            "ratio",
            "least",
            "greatest",
            "fastest",
            "rays that differ",
        ],
    );
    for cost in costs {
        for (i, test) in TESTS.iter().enumerate() {
            let ratios = &cost.ratios[i];
            let cells: [Cell; 11] = [
                cost.scene.as_str().into(),
                cost.triangles.into(),
                cost.kind.into(),
                cost.rays.into(),
                (*test).into(),
                cost.nanoseconds[i].into(),
                median(&mut ratios.clone()).into(),
                ratios.first().copied().unwrap_or(f64::NAN).into(),
                ratios.last().copied().unwrap_or(f64::NAN).into(),
                cost.fastest[i].into(),
                cost.differing[i].into(),
            ];
            table.row(cells);
        }
    }
    table
}

/// Work of the exact test; independent of the machine.
pub(super) fn stage_table(costs: &[Cost]) -> Table {
    let mut table = Table::new(
        "stages",
        "How far the exact test goes: all tests in f32, some on to f64, few on to exact arithmetic",
        &["<scene", "<rays", "tests/ray", "on to f64 %", "on to exact, per million", "exact a ray, per million"],
    );
    for cost in costs {
        let share = |n: u64, of: u64| n as f64 / of as f64;
        let cells: [Cell; 6] = [
            cost.scene.as_str().into(),
            cost.kind.into(),
            share(cost.tests, cost.rays).into(),
            (100.0 * share(cost.later[0], cost.tests)).into(),
            (1e6 * share(cost.later[1], cost.tests)).into(),
            (1e6 * share(cost.later[1], cost.rays)).into(),
        ];
        table.row(cells);
    }
    table
}

/// Geometric mean of the exact test's ratios; NaN if there is none.
pub(super) fn mean_ratio(costs: &[Cost]) -> f64 {
    (costs.iter().map(|cost| cost.ratio().ln()).sum::<f64>() / costs.len() as f64).exp()
}
