//! The measured numbers as tables.

use super::{Form, Point, WAYS};
use crate::papers::report::Table;

/// Tests that find the least root for certain.
pub(super) fn tests(points: &[Point]) -> Table {
    let mut table = Table::new(
        "seeds",
        "Certain tests: work and time",
        &[
            "voxels/axis",
            "<tests",
            "ns/ray",
            "spread %",
            "tests/ray",
            "iterations/test",
            "runs/test",
            "failures/1000 tests",
            "halvings/test",
            "seed bytes",
            "build ms",
            "wrong rays",
        ],
    );
    for point in points {
        for ((name, ..), row) in WAYS.iter().zip(&point.rows) {
            let t = &row.tally;
            let each = |n: u64| n as f64 / t.tests as f64;
            // Grids whose tests begin in the middle keep no seeds.
            let seeds = row.references - point.rows[1].references;
            table.row([
                point.grid.into(),
                (*name).into(),
                row.cost.nanoseconds().into(),
                (100.0 * row.cost.spread).into(),
                row.cost.per_ray(row.cost.counts.tests).into(),
                each(t.iterations).into(),
                each(t.runs).into(),
                (1e3 * each(t.failures)).into(),
                each(t.subdivisions).into(),
                seeds.into(),
                row.build_ms.into(),
                row.cost.wrong.into(),
            ]);
        }
    }
    table
}

/// Newton's method by itself.
pub(super) fn alone(points: &[Point]) -> Table {
    let mut table = Table::new(
        "alone",
        "Newton's method alone: iterations of those that find the hit, and failures",
        &["voxels/axis", "hits", "iterations seed", "failures % seed", "iterations middle", "failures % middle"],
    );
    for point in points {
        let [seed, middle] = point.alone;
        table.row([
            point.grid.into(),
            seed.hits.into(),
            seed.mean().into(),
            (100.0 * seed.failed()).into(),
            middle.mean().into(),
            (100.0 * middle.failed()).into(),
        ]);
    }
    table
}

/// Patches against tessellations.
pub(super) fn forms(forms: &[Form]) -> Table {
    let mut table = Table::new(
        "tessellation",
        "Error against run time: patches and tessellated teapots, camera rays",
        &[
            "<form",
            "primitives",
            "bytes",
            "build ms",
            "ns/ray",
            "mean depth error",
            "median depth error",
            "hit by one only %",
        ],
    );
    for form in forms {
        table.row([
            form.name.as_str().into(),
            form.primitives.into(),
            form.bytes.into(),
            form.build_ms.into(),
            form.nanoseconds.into(),
            form.error[0].into(),
            form.error[1].into(),
            (100.0 * form.differ).into(),
        ]);
    }
    table
}
