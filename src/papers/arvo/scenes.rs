//! The walks as accelerators of real scenes.

use super::Options;
use crate::accel::{Accel, Memory};
use crate::error::Result;
use crate::measure::rounds::build;
use crate::papers::report::{Cell, Table};
use crate::papers::trace::{Cost, costs, record, thinned};
use crate::registry::promises_exact;
use crate::scene::{LoadOptions, load};

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
}

impl Measured {
    pub fn wrong(&self) -> u64 {
        self.entries.iter().filter(|e| promises_exact(&e.accel)).map(|e| e.cost.wrong).sum()
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
        entries.push(Entry { accel: name.clone(), milliseconds: *milliseconds, memory: accel.memory(), cost });
    }
    Ok(Measured { scene: spec.to_string(), primitives: scene.primitive_count(), rays: asked.len() as u64, entries })
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
            let known = |n: u64| if n == 0 { f64::NAN } else { e.cost.per_ray(n) };
            let cells: [Cell; 13] = [
                m.scene.as_str().into(),
                m.primitives.into(),
                e.accel.as_str().into(),
                e.milliseconds.into(),
                e.memory.total().into(),
                m.rays.into(),
                e.cost.nanoseconds().into(),
                (100.0 * e.cost.spread).into(),
                known(counts.steps).into(),
                known(counts.leaves).into(),
                e.cost.per_ray(counts.tests).into(),
                (e.cost.seconds / m.entries[0].cost.seconds).into(),
                e.cost.wrong.into(),
            ];
            table.row(cells);
        }
    }
    table
}
