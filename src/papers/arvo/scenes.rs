//! The walks as accelerators of real scenes.

use super::Options;
use crate::accel::{Accel, Memory, Probe};
use crate::bsp::{Bsp, BspOptions, Choice};
use crate::error::Result;
use crate::geometry::Geometry;
use crate::measure::rounds::build;
use crate::papers::report::{Cell, Table};
use crate::papers::trace::{Asked, Cost, Origin, costs, record, thinned};
use crate::ray::Ray;
use crate::scene::{LoadOptions, Scene, load, with_geometry};

/// One scene under all accelerators.
pub(super) struct Measured {
    scene: String,
    primitives: u32,
    rays: u64,
    entries: Vec<Entry>,
}

struct Entry {
    accel: String,
    milliseconds: f64,
    memory: Memory,
    cost: Cost,
    /// Leaves a ray, where it is known.
    leaves: f64,
}

impl Measured {
    pub fn wrong(&self) -> u64 {
        self.entries.iter().map(|e| e.cost.wrong).sum()
    }
}

pub(super) fn measure(spec: &str, specs: &[String], options: &Options) -> Result<Measured> {
    let scene = load(spec, &LoadOptions::default())?;
    let built = specs.iter().map(|name| build(&scene, name)).collect::<Result<Vec<_>>>()?;
    let accels: Vec<&dyn Accel> = built.iter().map(|(accel, _)| &**accel).collect();
    let asked = thinned(&record(&scene, accels[0], options.size)?, options.most);
    let costs = costs(&asked, &accels, options.rounds);
    let mut entries = Vec::new();
    for ((name, (accel, milliseconds)), cost) in specs.iter().zip(&built).zip(costs) {
        let leaves = leaves(&scene, name, &asked)?;
        let (accel, memory) = (name.clone(), accel.memory());
        entries.push(Entry { accel, milliseconds: *milliseconds, memory, cost, leaves });
    }
    Ok(Measured { scene: spec.to_string(), primitives: scene.primitive_count(), rays: asked.len() as u64, entries })
}

/// Counts leaves.
#[derive(Default)]
struct Leaves(u64);

impl Probe for Leaves {
    fn leaf(&mut self) {
        self.0 += 1;
    }
}

/// Leaves a ray of the trees without options but planes and walk; the walks all visit the same. NaN for others.
fn leaves(scene: &Scene, spec: &str, asked: &[Asked]) -> Result<f64> {
    let (name, options) = spec.split_once(':').unwrap_or((spec, ""));
    let (key, value) = options.split_once('=').unwrap_or((options, ""));
    let planes = match (name, key, value) {
        // With other options behind them the tree may be another.
        ("bsp", "" | "walk" | "listing", value) if !value.contains(',') => Choice::Midpoint,
        ("bsp", "planes", "sah") => Choice::Sah,
        ("bsp", "planes", "oblique") => Choice::Oblique,
        _ => return Ok(f64::NAN),
    };
    with_geometry!(scene.geometry, g => leaves_of(g.clone(), planes, asked))
}

fn leaves_of<G: Geometry>(geometry: G, planes: Choice, asked: &[Asked]) -> Result<f64> {
    let options = BspOptions { planes, ..BspOptions::default() };
    let mut leaves = Leaves::default();
    if planes == Choice::Oblique {
        let tree = Bsp::build_oblique(geometry, &options)?;
        each(asked, |ray, any| match any {
            true => _ = tree.any_hit_with(ray, &mut leaves),
            false => _ = tree.closest_hit_with(ray, &mut leaves),
        });
    } else {
        let tree = Bsp::build(geometry, &options)?;
        each(asked, |ray, any| match any {
            true => _ = tree.any_hit_with(ray, &mut leaves),
            false => _ = tree.closest_hit_with(ray, &mut leaves),
        });
    }
    Ok(leaves.0 as f64 / asked.len() as f64)
}

/// Every ray, and whether any hit will do.
fn each(asked: &[Asked], mut query: impl FnMut(&Ray, bool)) {
    asked.iter().for_each(|asked| query(&asked.ray, asked.origin == Origin::Shadow));
}

pub(super) fn table(measured: &[Measured]) -> Table {
    let mut table = Table::new(
        "scenes",
        "All rays of a picture: trees, the plain grid and a BVH",
        &[
            "<scene",
            "primitives",
            "<accelerator",
            "build ms",
            "bytes",
            "rays",
            "ns/ray",
            "spread %",
            "steps/ray",
            "leaves/ray",
            "tests/ray",
            "time to grid",
            "wrong rays",
        ],
    );
    for m in measured {
        for e in &m.entries {
            let counts = e.cost.counts;
            let per_ray = |n: u64| n as f64 / counts.rays as f64;
            let cells: [Cell; 13] = [
                m.scene.as_str().into(),
                m.primitives.into(),
                e.accel.as_str().into(),
                e.milliseconds.into(),
                e.memory.total().into(),
                m.rays.into(),
                (1e9 * e.cost.seconds / m.rays as f64).into(),
                (100.0 * e.cost.spread).into(),
                if counts.steps == 0 { f64::NAN } else { per_ray(counts.steps) }.into(),
                e.leaves.into(),
                per_ray(counts.tests).into(),
                (e.cost.seconds / m.entries[0].cost.seconds).into(),
                e.cost.wrong.into(),
            ];
            table.row(cells);
        }
    }
    table
}
