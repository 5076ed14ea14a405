//! Amanatides & Woo 1987, last section: starting points for Newton's method in the voxels, on the patches of the teapot.

mod claims;
mod tables;

use super::plot::{Line, Lines, Plot};
use super::report::Report;
use super::trace::{Asked, Cost, Origin, ask, costs, pass, record, thinned};
use super::{Watch, rising};
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::geometry::bezier::{self, BezierPatches, Method, Tally};
use crate::geometry::{Geometry, Triangle};
use crate::measure::Machine;
use crate::measure::rounds::{in_turns, median};
use crate::ray::{Aabb, Cell, Ray};
use crate::registry;
use crate::scene::{Scene, SceneGeometry, procedural};
use std::sync::Arc;
use std::time::Instant;

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Rows and columns of the picture, above 0.
    pub size: u32,
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Voxels on each axis.
    pub grids: Vec<u32>,
    /// Steps along each edge of a patch of the tessellated teapots.
    pub meshes: Vec<u32>,
}

/// How tests begin and go on: name, option of the grid, method.
const WAYS: [(&str, &str, Method); 3] = [
    ("Newton, seed of the voxel", "voxel", Method::Newton),
    ("Newton, middle of the patch", "fixed", Method::Newton),
    ("subdivision alone", "fixed", Method::Subdivision),
];

/// Most hits that Newton's method alone is tried on.
const MOST_TRIED: usize = 20_000;

/// One way at one subdivision.
struct Row {
    cost: Cost,
    tally: Tally,
    build_ms: f64,
    references: u64,
}

/// Newton's method alone from one kind of starting point, over all hits.
#[derive(Clone, Copy, Default)]
struct Tries {
    hits: u64,
    iterations: u64,
    failures: u64,
}

impl Tries {
    fn mean(&self) -> f64 {
        self.iterations as f64 / (self.hits - self.failures) as f64
    }

    fn failed(&self) -> f64 {
        self.failures as f64 / self.hits as f64
    }
}

/// One subdivision.
struct Point {
    grid: u32,
    rows: Vec<Row>,
    /// From the voxel's seed, from the middle.
    alone: [Tries; 2],
}

/// A tessellated teapot, or the patches themselves, asked for the same camera rays.
struct Form {
    name: String,
    primitives: u64,
    bytes: u64,
    build_ms: f64,
    nanoseconds: f64,
    /// Mean and median distance of depths, and the share of rays of which only one of the two hits.
    error: [f64; 2],
    differ: f64,
}

/// Measures everything.
///
/// # Errors
/// No subdivision or one out of range, no round; a grid beyond its memory budget; the picture's size is 0.
pub fn run(options: &Options, watch: &Watch) -> Result<Report> {
    let grids = rising(&options.grids);
    if grids.is_empty() || options.rounds == 0 {
        let cause = format!("nothing to measure: {} subdivisions, {} rounds", grids.len(), options.rounds);
        return Err(Error::invalid(cause));
    }
    let scene = Scene::new(procedural::parse("teapot-patches")?)?;
    let SceneGeometry::Patches(patches) = &scene.geometry else { unreachable!("the scene is one of patches") };
    let asked = record(&scene, &scene.accel("grid:seeds=fixed")?, options.size)?;
    let stages = grids.len() + 1;
    let mut points = Vec::new();
    for (i, &grid) in grids.iter().enumerate() {
        watch(i, stages, &format!("{grid} voxels an axis"));
        points.push(point(patches, &asked, grid, options)?);
    }
    watch(grids.len(), stages, "tessellations");
    // The subdivision at which seeds are fastest stands for the patches.
    let best = points.iter().min_by(|a, b| a.rows[0].cost.seconds.total_cmp(&b.rows[0].cost.seconds));
    let forms = forms(&scene, patches, &asked, best.map_or(grids[0], |p| p.grid), options)?;
    Ok(report(options, &asked, &points, &forms))
}

fn point(patches: &Arc<BezierPatches>, asked: &[Asked], grid: u32, options: &Options) -> Result<Point> {
    let mut accels = Vec::new();
    let mut rows = Vec::new();
    for (_, seeds, method) in WAYS {
        let spec = format!("grid:resolution={grid},seeds={seeds}");
        let set = Arc::new(patches.as_ref().clone().with_method(method));
        let start = Instant::now();
        let accel = registry::build(&spec, set.clone())?;
        let build_ms = start.elapsed().as_secs_f64() * 1e3;
        // Counted apart, so that the timed ones count nothing.
        let counter = Arc::new(bezier::Watch::default());
        let watched = registry::build(&spec, Arc::new(set.as_ref().clone().watched(counter.clone())))?;
        pass(asked, &watched);
        rows.push((counter.tally(), build_ms, accel.memory().references));
        accels.push(accel);
    }
    let contenders: Vec<&dyn Accel> = accels.iter().map(|a| &**a).collect();
    let costs = costs(asked, &contenders, options.rounds);
    let row = |(cost, (tally, build_ms, references))| Row { cost, tally, build_ms, references };
    let alone = alone(patches, asked, &*accels[1], grid);
    Ok(Point { grid, rows: costs.into_iter().zip(rows).map(row).collect(), alone })
}

/// Newton's method alone on the patches that camera rays hit, in a grid of `grid` voxels an axis.
fn alone(patches: &BezierPatches, asked: &[Asked], accel: &dyn Accel, grid: u32) -> [Tries; 2] {
    let mut tries = [Tries::default(); 2];
    for Asked { ray, .. } in thinned(&primary(asked), MOST_TRIED) {
        let Some(hit) = accel.closest_hit(&ray) else { continue };
        let Some(root) = patches.locate(hit.prim, &ray, hit.t) else { continue };
        let cell = cell(&accel.bounds(), grid, &ray, hit.t);
        let seed = patches.seed(hit.prim, &cell).map_or((0.5, 0.5), |seed| seed.start());
        for (tries, start) in tries.iter_mut().zip([seed, (0.5, 0.5)]) {
            let (found, iterations) = patches.newton(hit.prim, &ray, start);
            tries.hits += 1;
            match found {
                Some((u, v)) if (u - root.0).abs() < 1e-6 && (v - root.1).abs() < 1e-6 => {
                    tries.iterations += u64::from(iterations);
                }
                _ => tries.failures += 1,
            }
        }
    }
    tries
}

fn primary(asked: &[Asked]) -> Vec<Asked> {
    asked.iter().filter(|a| a.origin == Origin::Primary).copied().collect()
}

/// The voxel that holds a hit, of a grid over `bounds`.
fn cell(bounds: &Aabb, grid: u32, ray: &Ray, t: f32) -> Cell {
    let (min, size) = (bounds.min.as_dvec3(), bounds.extent().as_dvec3() / f64::from(grid));
    let voxel = ((ray.at(f64::from(t)) - min) / size).floor();
    // A little wider: the hit is rounded.
    let padding = size * 1e-3;
    Cell { min: min + voxel * size - padding, max: min + (voxel + 1.0) * size + padding }
}

/// The patches in a grid of `grid` voxels an axis, and tessellated teapots in grids by default.
fn forms(
    scene: &Scene,
    patches: &Arc<BezierPatches>,
    asked: &[Asked],
    grid: u32,
    options: &Options,
) -> Result<Vec<Form>> {
    let rays: Vec<Ray> = primary(asked).iter().map(|a| a.ray).collect();
    let mut forms = Vec::new();
    let mut accels: Vec<Box<dyn Accel>> = Vec::new();
    let mut truth: Vec<Option<f32>> = Vec::new();
    let specs = std::iter::once(None).chain(options.meshes.iter().map(|&n| Some(n)));
    for steps in specs {
        let tessellated = steps.map(|n| Scene::new(procedural::parse(&format!("teapot:n={n}"))?)).transpose()?;
        let (scene, spec) = match &tessellated {
            Some(scene) => (scene, "grid".to_string()),
            None => (scene, format!("grid:resolution={grid}")),
        };
        let start = Instant::now();
        let accel = scene.accel(&spec)?;
        let build_ms = start.elapsed().as_secs_f64() * 1e3;
        let depths: Vec<Option<f32>> = rays.iter().map(|ray| accel.closest_hit(ray).map(|hit| hit.t)).collect();
        if truth.is_empty() {
            truth.clone_from(&depths);
        }
        let pairs = || truth.iter().zip(&depths);
        let mut apart: Vec<f64> =
            pairs().filter_map(|(a, b)| Some((f64::from((*a)?) - f64::from((*b)?)).abs())).collect();
        let primitives = u64::from(scene.primitive_count());
        let own = if steps.is_some() { primitives * size_of::<Triangle>() as u64 } else { patches.bytes() };
        let name = steps.map_or_else(|| format!("patches, {grid} voxels an axis"), |n| format!("{n} steps an edge"));
        forms.push(Form {
            name,
            primitives,
            bytes: own + accel.memory().total(),
            build_ms,
            nanoseconds: f64::NAN,
            error: [apart.iter().sum::<f64>() / apart.len() as f64, median(&mut apart)],
            differ: pairs().filter(|(a, b)| a.is_some() != b.is_some()).count() as f64 / rays.len() as f64,
        });
        accels.push(accel);
    }
    // The answers of each are not compared: they are different shapes.
    let questions = ask(&rays, &*accels[0]);
    let paces = in_turns(accels.len(), options.rounds, |i| pass(&questions, &*accels[i]));
    for (form, pace) in forms.iter_mut().zip(paces) {
        form.nanoseconds = 1e9 / pace.per_second / rays.len() as f64;
    }
    Ok(forms)
}

fn report(options: &Options, asked: &[Asked], points: &[Point], forms: &[Form]) -> Report {
    let list = |numbers: &mut dyn Iterator<Item = u32>| numbers.map(|n| n.to_string()).collect::<Vec<_>>().join(", ");
    Report {
        paper: "newton-seeds",
        title: "Amanatides & Woo 1987, last section: starting points for Newton's method in the voxels",
        machine: Machine::this(),
        settings: vec![
            ("scene", "teapot-patches: 32 bicubic patches".to_string()),
            ("size", format!("{0} x {0} pixels, one sample each, {1} rays with shadows", options.size, asked.len())),
            ("rounds", options.rounds.to_string()),
            ("grids", list(&mut points.iter().map(|p| p.grid))),
            ("tessellations", list(&mut options.meshes.iter().copied())),
        ],
        notes: [
            "The paper proposes the starting points and has no numbers. Our voxels keep beside the starting point the part \
             of the patch that lies in them, so that a root can be shown to be the only one.",
            "The first table is of tests that find the least root for certain, whatever the start: Newton's method runs \
             only where there is one root at most, and parts of which that is not certain are halved. Answers are the \
             same to the bit.",
            "The second table is of Newton's method alone, as the paper means it, on the patch that a camera ray hits: a \
             failure does not converge within 12 iterations, or to another root.",
            "Time is that of tracing all rays of the picture, recorded once, on one thread, without shading: median of \
             interleaved rounds. Tests that are counted are not timed.",
            "Subdivision alone halves down to 2^-30 of the patch and polishes the root at the end.",
            "Depth errors of the tessellated teapots are differences from the patches' along the same camera rays, world \
             units; the pot is 3.15 high.",
        ]
        .map(String::from)
        .to_vec(),
        claims: claims::judge(points),
        tables: vec![tables::tests(points), tables::alone(points), tables::forms(forms)],
        plot: plot(points),
        wrong: points.iter().flat_map(|p| &p.rows).map(|row| row.cost.wrong).sum(),
    }
}

fn plot(points: &[Point]) -> Plot {
    let line = |(way, (name, ..)): (usize, &(&str, &str, Method))| Line {
        name: (*name).to_string(),
        points: points.iter().map(|p| (f64::from(p.grid), p.rows[way].cost.nanoseconds())).collect(),
    };
    Plot::Lines(Lines {
        title: "Where a patch test begins".into(),
        subtitle: "Amanatides & Woo 1987, last section, on the teapot's 32 bicubic patches; plain grid, one thread"
            .into(),
        x: "voxels on each axis".into(),
        y: "nanoseconds a ray".into(),
        lines: WAYS.iter().enumerate().map(line).collect(),
    })
}
