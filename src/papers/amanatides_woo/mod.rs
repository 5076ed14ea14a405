//! Amanatides & Woo 1987: tests per ray with and without rayID, time against subdivision, operations per step.

mod claims;
mod published;
mod tables;

use super::plot::{Line, Lines, Plot};
use super::report::Report;
use super::trace::{Asked, Cost, check, costs, pass, record, settings, thinned};
use super::{Watch, rising};
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::measure::Machine;
use crate::measure::rounds::in_turns;
use crate::render::render;
use crate::scene::{Scene, procedural};
use published::{PUBLISHED, Published};

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Rows and columns of the pictures, above 0.
    pub size: u32,
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Subdivisions of each axis to sweep over.
    pub grids: Vec<u32>,
}

/// One scene at one subdivision.
struct Point {
    subdivision: u32,
    objects_per_voxel: f64,
    off: Cost,
    on: Cost,
}

impl Point {
    fn tests(&self) -> [f64; 2] {
        [self.off, self.on].map(|c| c.per_ray(c.counts.tests))
    }

    /// Tests without rayID over those with it.
    fn gain(&self) -> f64 {
        self.off.counts.tests as f64 / self.on.counts.tests.max(1) as f64
    }
}

/// One scene at all subdivisions, coarsest first.
struct Sweep {
    published: &'static Published,
    rays: usize,
    points: Vec<Point>,
    /// Rendering with every object tested for every ray: seconds for the whole, and for tracing alone.
    naive: [f64; 2],
    wrong: u64,
}

impl Sweep {
    /// Tracing's share of the time of naive rendering, 0 to 1.
    fn tracing_share(&self) -> f64 {
        self.naive[1] / self.naive[0]
    }
}

/// Measures everything.
///
/// # Errors
/// No subdivision or one out of range; a grid beyond its memory budget; the picture's size is 0.
pub fn run(options: &Options, watch: &Watch) -> Result<Report> {
    if options.grids.is_empty() || options.rounds == 0 {
        let (grids, rounds) = (options.grids.len(), options.rounds);
        return Err(Error::invalid(format!("nothing to measure: {grids} subdivisions, {rounds} rounds")));
    }
    let grids = rising(&options.grids);
    let mut sweeps = Vec::new();
    for (i, published) in PUBLISHED.iter().enumerate() {
        watch(i, PUBLISHED.len(), published.scene);
        sweeps.push(sweep(published, &grids, options)?);
    }
    Ok(report(options, &grids, &sweeps))
}

fn sweep(published: &'static Published, grids: &[u32], options: &Options) -> Result<Sweep> {
    let scene = Scene::new(procedural::parse(published.scene)?)?;
    let spec = |n: u32, mailbox: &str| format!("grid:resolution={n},mailbox={mailbox}");
    let asked = record(&scene, &scene.accel(&spec(published.subdivision, "off"))?, options.size)?;
    let mut points = Vec::new();
    for n in rising(&[grids, &[published.subdivision]].concat()) {
        let [off, on] = [scene.accel(&spec(n, "off"))?, scene.accel(&spec(n, "on"))?];
        let references = off.memory().references / size_of::<u32>() as u64;
        let cost = costs(&asked, &[&*off, &*on], options.rounds);
        let voxels = f64::from(n).powi(3);
        let objects_per_voxel = references as f64 / voxels;
        points.push(Point { subdivision: n, objects_per_voxel, off: cost[0], on: cost[1] });
    }
    let (naive, wrong) = naive(&scene, &asked, options)?;
    let wrong = points.iter().map(|p| p.off.wrong + p.on.wrong).sum::<u64>() + wrong;
    Ok(Sweep { published, rays: asked.len(), points, naive, wrong })
}

/// Seconds for a small picture by brute force, and for tracing its rays alone; and the number of wrong answers.
fn naive(scene: &Scene, asked: &[Asked], options: &Options) -> Result<([f64; 2], u64)> {
    let brute = scene.accel("brute")?;
    let size = options.size.min(64);
    let few = record(scene, &brute, size)?;
    // Checked before: the render can fail only as it did in `record`.
    let passes = in_turns(2, options.rounds, |i| match i {
        0 => drop(render(scene, &*brute, &settings(size), &|_, _| {})),
        _ => pass(&few, &*brute),
    });
    let wrong = check(&thinned(asked, 4096), &*brute).1;
    Ok(([1.0 / passes[0].per_second, 1.0 / passes[1].per_second], wrong))
}

fn report(options: &Options, grids: &[u32], sweeps: &[Sweep]) -> Report {
    Report {
        paper: "amanatides-woo",
        title: "Amanatides & Woo 1987, \"A Fast Voxel Traversal Algorithm for Ray Tracing\"",
        machine: Machine::this(),
        settings: vec![
            ("size", format!("{0} x {0} pixels, one sample each", options.size)),
            ("rounds", options.rounds.to_string()),
            ("grids", grids.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")),
        ],
        notes: [
            "What the paper's objects are is unknown; ours are spheres of random size at random places, one in four a \
             mirror, with one light and shadows. The counts of objects and the subdivisions are the paper's.",
            "The paper's figures are second-hand: a later document repeats its table. Its times are minutes for \
             512 x 512 pixels on a machine of 1987.",
            "Time is that of tracing all rays of the picture (camera, shadow and mirror rays, recorded once) on one \
             thread, without shading: median of interleaved rounds.",
            "The paper's gain from rayID comes with sloppy insertion by bounding box; our insertion is exact, so there \
             are fewer tests to save.",
            "The initialisation is not printed in the paper, only the sums 33 (ray starts inside) to 40 (outside).",
        ]
        .map(String::from)
        .to_vec(),
        claims: claims::judge(sweeps),
        tables: vec![
            tables::comparison(sweeps),
            tables::subdivisions(sweeps),
            tables::naive(sweeps),
            tables::operations(),
        ],
        plot: plot(sweeps),
        wrong: sweeps.iter().map(|s| s.wrong).sum(),
    }
}

fn plot(sweeps: &[Sweep]) -> Plot {
    let line = |s: &Sweep| Line {
        name: format!("{} objects", s.published.objects),
        points: s.points.iter().map(|p| (f64::from(p.subdivision), p.off.nanoseconds())).collect(),
    };
    Plot::Lines(Lines {
        title: "Time against subdivision".into(),
        subtitle: "Amanatides & Woo 1987, figure 3, on random spheres; plain grid without rayID, one thread".into(),
        x: "voxels on each axis".into(),
        y: "nanoseconds a ray".into(),
        lines: sweeps.iter().map(line).collect(),
    })
}
