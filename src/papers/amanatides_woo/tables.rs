//! The measured numbers as the paper's tables.

use super::Sweep;
use crate::papers::printed_walk;
use crate::papers::report::{Cell, Table};

/// The paper's table with ours beside it.
pub(super) fn comparison(sweeps: &[Sweep]) -> Table {
    let mut table = Table::new(
        "table",
        "The paper's table: tests per ray without and with rayID (the paper's columns are marked 1987)",
        &[
            "<scene",
            "figure",
            "subdivision",
            "objects",
            "rays",
            "time s",
            "time min 1987",
            "objects/voxel",
            "objects/voxel 1987",
            "tests/ray",
            "tests/ray 1987",
            "tests/ray rayID",
            "tests/ray rayID 1987",
            "gain",
            "gain 1987",
        ],
    );
    for sweep in sweeps {
        let p = sweep.published;
        let Some(point) = sweep.points.iter().find(|point| point.subdivision == p.subdivision) else {
            unreachable!("the paper's subdivision is always measured")
        };
        let [off, on] = point.tests();
        let cells: [Cell; 15] = [
            p.scene.into(),
            p.figure.into(),
            p.subdivision.into(),
            p.objects.into(),
            (sweep.rays as u64).into(),
            point.off.seconds.into(),
            p.minutes.into(),
            point.objects_per_voxel.into(),
            p.objects_per_voxel.into(),
            off.into(),
            p.tests.into(),
            on.into(),
            p.tests_with_id.into(),
            point.gain().into(),
            (p.tests / p.tests_with_id).into(),
        ];
        table.row(cells);
    }
    table
}

/// The paper's figure 3 as numbers.
pub(super) fn subdivisions(sweeps: &[Sweep]) -> Table {
    let mut table = Table::new(
        "subdivision",
        "Time against subdivision (the paper's figure 3, whose values are not known)",
        &[
            "<scene",
            "subdivision",
            "time s",
            "time s rayID",
            "spread %",
            "objects/voxel",
            "steps/ray",
            "tests/ray",
            "tests/ray rayID",
            "gain",
        ],
    );
    for sweep in sweeps {
        for point in &sweep.points {
            let [off, on] = point.tests();
            let cells: [Cell; 10] = [
                sweep.published.scene.into(),
                point.subdivision.into(),
                point.off.seconds.into(),
                point.on.seconds.into(),
                (100.0 * point.off.spread).into(),
                point.objects_per_voxel.into(),
                point.off.per_ray(point.off.counts.steps).into(),
                off.into(),
                on.into(),
                point.gain().into(),
            ];
            table.row(cells);
        }
    }
    table
}

/// The share of tracing in naive rendering.
pub(super) fn naive(sweeps: &[Sweep]) -> Table {
    let mut table = Table::new(
        "naive",
        "Every object tested for every ray: whole render against tracing alone, one thread, at most 64 x 64 pixels",
        &["<scene", "objects", "render s", "tracing s", "tracing %"],
    );
    for sweep in sweeps {
        let [all, tracing] = sweep.naive;
        let cells: [Cell; 5] = [
            sweep.published.scene.into(),
            sweep.published.objects.into(),
            all.into(),
            tracing.into(),
            (100.0 * sweep.tracing_share()).into(),
        ];
        table.row(cells);
    }
    table
}

/// The printed loop, counted.
pub(super) fn operations() -> Table {
    let mut table = Table::new(
        "operations",
        "Operations of the loop as printed, counted while it runs, and of one plain way to write its initialisation",
        &["<operation", "counted", "<paper"],
    );
    let (origin, direction) = ([0.3, 0.6, 0.2], [1.0, 0.7, 0.25]);
    let inside = printed_walk::walk(origin, direction, None, 16, |voxel| voxel == [15, 11, 4]);
    let outside = printed_walk::walk([-1.0, -0.5, -0.25], direction, Some(1.0), 16, |_| true);
    let steps = (inside.voxels.len() as f64 - 1.0).max(1.0);
    for (name, count, paper) in [
        ("float compares a step", inside.steps.float_compares, "2"),
        ("float additions a step", inside.steps.float_adds, "1"),
        ("integer compares a step", inside.steps.int_compares, "2"),
        ("integer additions a step", inside.steps.int_adds, "1"),
    ] {
        let cells: [Cell; 3] = [name.into(), (count as f64 / steps).into(), paper.into()];
        table.row(cells);
    }
    for (name, walked, paper) in [
        ("float operations to start, from inside", &inside, "33"),
        ("float operations to start, from outside", &outside, "up to 40"),
    ] {
        let cells: [Cell; 3] = [name.into(), walked.start.float().into(), paper.into()];
        table.row(cells);
    }
    table
}
