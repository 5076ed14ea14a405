//! The measured numbers as the paper's tables.

use super::super::report::{Cell, Table};
use super::study::Study;
use super::views::VIEWS;

/// A summary first, then the paper's tables, then what the paper does not have.
pub fn all(study: &Study) -> Vec<Table> {
    let mut tables = vec![summary(study)];
    tables.extend((0..study.scenes.len()).map(|s| scene(study, s)));
    tables.push(properties(study));
    tables.push(memory(study));
    tables.extend([landing(study), full(study), brute(study)].into_iter().filter(|t| !t.rows.is_empty()));
    tables
}

/// Geometric mean of positive numbers.
fn mean(values: impl Iterator<Item = f64>) -> f64 {
    let (sum, n) = values.fold((0.0, 0), |(sum, n), x| (sum + x.ln(), n + 1));
    (sum / f64::from(n)).exp()
}

fn summary(study: &Study) -> Table {
    let mut table = Table::new(
        "summary",
        "Geometric means over scenes and views of what is in the next tables",
        &["grid", "<method", "ratio", "least ratio", "greatest ratio", "mean distance", "preprocess over plain"],
    );
    for (g, grid) in study.grids.iter().enumerate() {
        for (m, method) in study.methods.iter().enumerate() {
            let cases = || (0..study.scenes.len()).flat_map(|s| (0..study.views()).map(move |v| (s, v)));
            let ratios = || cases().map(|(s, v)| study.ratio(s, v, g, m));
            let distance = |(s, v)| distance(study, (s, v, g), m);
            let builds = (0..study.scenes.len()).map(|s| study.built(s, g, m).seconds / study.built(s, g, 0).seconds);
            let cells: [Cell; 7] = [
                (*grid).into(),
                method.as_str().into(),
                mean(ratios()).into(),
                ratios().fold(f64::INFINITY, f64::min).into(),
                ratios().fold(0.0, f64::max).into(),
                mean(cases().map(distance)).into(),
                mean(builds).into(),
            ];
            table.row(cells);
        }
    }
    table
}

/// Voxels of the plain walk for each of the method's; NaN for what counts no steps.
fn distance(study: &Study, (s, v, g): (usize, usize, usize), m: usize) -> f64 {
    let [plain, steps] = [0, m].map(|m| study.cost(s, v, g, m).counts.steps as f64);
    if steps == 0.0 { f64::NAN } else { plain / steps }
}

fn scene(study: &Study, s: usize) -> Table {
    let name = study.scenes[s];
    let mut table = Table::new(
        name,
        format!("{name}, {} primitives: every view, grid and method", study.primitives[s]),
        &[
            "<view",
            "grid",
            "<method",
            "preprocess s",
            "render s",
            "total s",
            "rays",
            "steps",
            "leaps",
            "mean distance",
            "tests/ray",
            "ratio",
            "wrong rays",
        ],
    );
    for (v, view) in VIEWS.iter().enumerate() {
        for (g, grid) in study.grids.iter().enumerate() {
            for (m, method) in study.methods.iter().enumerate() {
                let (built, cost) = (study.built(s, g, m), study.cost(s, v, g, m));
                let cells: [Cell; 13] = [
                    (*view).into(),
                    (*grid).into(),
                    method.as_str().into(),
                    built.seconds.into(),
                    cost.seconds.into(),
                    (built.seconds + cost.seconds).into(),
                    cost.counts.rays.into(),
                    cost.counts.steps.into(),
                    cost.counts.leaps.into(),
                    distance(study, (s, v, g), m).into(),
                    cost.per_ray(cost.counts.tests).into(),
                    study.ratio(s, v, g, m).into(),
                    cost.wrong.into(),
                ];
                table.row(cells);
            }
        }
    }
    table
}

fn properties(study: &Study) -> Table {
    let mut table = Table::new(
        "properties",
        "How full the voxels are",
        &["<scene", "primitives", "grid", "empty voxels %", "objects/occupied voxel"],
    );
    for (s, name) in study.scenes.iter().enumerate() {
        for (g, grid) in study.grids.iter().enumerate() {
            let filling = study.fillings[s * study.grids.len() + g];
            let filled = filling.voxels - filling.empty;
            let cells: [Cell; 5] = [
                (*name).into(),
                study.primitives[s].into(),
                (*grid).into(),
                (100.0 * filling.empty as f64 / filling.voxels as f64).into(),
                (filling.references as f64 / filled.max(1) as f64).into(),
            ];
            table.row(cells);
        }
    }
    table
}

fn memory(study: &Study) -> Table {
    let mut table = Table::new(
        "memory",
        "Bytes held beside the objects; bytes per voxel are those of voxels, starts of lists and skip tables, without references",
        &["<scene", "grid", "<method", "voxels", "references", "skip tables", "total", "bytes/voxel"],
    );
    for (s, name) in study.scenes.iter().enumerate() {
        for (g, grid) in study.grids.iter().enumerate() {
            for (m, method) in study.methods.iter().enumerate() {
                let memory = study.built(s, g, m).memory;
                let cells: [Cell; 8] = [
                    (*name).into(),
                    (*grid).into(),
                    method.as_str().into(),
                    memory.structure.into(),
                    memory.references.into(),
                    memory.tables.into(),
                    memory.total().into(),
                    ((memory.structure + memory.tables) as f64 / f64::from(*grid).powi(3)).into(),
                ];
                table.row(cells);
            }
        }
    }
    table
}

fn landing(study: &Study) -> Table {
    let mut table = Table::new(
        "landing",
        "Wrong rays of the printed landing rule, all views: answers that differ from the plain grid's",
        &["<scene", "grid", "<method", "rays", "wrong rays", "wrong %"],
    );
    for landing in &study.landings {
        let cells: [Cell; 6] = [
            landing.scene.as_str().into(),
            landing.grid.into(),
            landing.method.as_str().into(),
            landing.rays.into(),
            landing.wrong.into(),
            (100.0 * landing.wrong as f64 / landing.rays as f64).into(),
        ];
        table.row(cells);
    }
    table
}

fn full(study: &Study) -> Table {
    let mut table = Table::new(
        "full",
        "Nearly full grids: random in few voxels, first view, some of its rays",
        &["grid", "<method", "rays", "steps", "leaps", "render s", "wrong rays"],
    );
    for full in &study.full {
        let cells: [Cell; 7] = [
            full.grid.into(),
            study.methods[full.method].as_str().into(),
            full.cost.counts.rays.into(),
            full.cost.counts.steps.into(),
            full.cost.counts.leaps.into(),
            full.cost.seconds.into(),
            full.cost.wrong.into(),
        ];
        table.row(cells);
    }
    table
}

fn brute(study: &Study) -> Table {
    let mut table = Table::new(
        "brute",
        "Every object for every ray on random, first view: seconds for all rays, extrapolated from a sample of them",
        &["rays", "sample", "render s", "times the plain grid's at the largest size"],
    );
    if let (Some(brute), Some(s)) = (study.brute, study.scene("random")) {
        let plain = study.cost(s, 0, study.grids.len() - 1, 0).seconds;
        let cells: [Cell; 4] =
            [brute.rays.into(), brute.sample.into(), brute.seconds.into(), (brute.seconds / plain).into()];
        table.row(cells);
    }
    table
}
