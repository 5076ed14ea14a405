//! Arvo 1988: nodes and leaves of a ray, re-traversal against partitioning, best and worst case, and the walks on scenes.

mod claims;
mod regular;
mod scenes;

use super::plot::{Line, Lines, Plot};
use super::report::{Report, significant};
use super::{Watch, plain_first, rising};
use crate::bsp::{Form, Regular};
use crate::error::{Error, Result};
use crate::measure::Machine;
use regular::{Case, Level};
use scenes::Measured;

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Leaves along each axis of the complete trees: powers of two.
    pub grids: Vec<u32>,
    /// Rays through each of them, at least 1.
    pub rays: u32,
    /// Rows and columns of the pictures, above 0.
    pub size: u32,
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Scenes; empty: none.
    pub scenes: Vec<String>,
    /// Accelerators; the plain grid is added in front.
    pub accels: Vec<String>,
    /// Most rays of a picture that are traced.
    pub most: usize,
}

/// The scenes that are measured unless told otherwise.
pub const SCENES: [&str; 5] = ["random:n=3540", "flakes", "bumpy", "spd-tetra", "spd-balls"];

/// Those of a quick run.
pub const QUICK_SCENES: [&str; 2] = ["random:n=62", "flakes:depth=2"];

/// The accelerators that are compared unless told otherwise, beside the plain grid.
pub const METHODS: [&str; 8] = [
    "bsp",
    "bsp:listing=segment",
    "bsp:listing=midpoint",
    "bsp:walk=retraverse",
    "bsp:walk=climb",
    "bsp:planes=sah",
    "bsp:planes=oblique",
    "obvhs-cwbvh",
];

/// Measures everything.
///
/// # Errors
/// No tree size, one that is no power of two, no ray or round; an unknown accelerator or scene; a structure beyond its memory
/// budget; the picture's size is 0.
pub fn run(options: &Options, watch: &Watch) -> Result<Report> {
    if options.grids.is_empty() || options.rays == 0 || options.rounds == 0 {
        let (grids, rays, rounds) = (options.grids.len(), options.rays, options.rounds);
        return Err(Error::invalid(format!("nothing to measure: {grids} trees, {rays} rays, {rounds} rounds")));
    }
    let grids = rising(&options.grids);
    let trees: Vec<Regular> = grids.iter().map(|&n| Regular::new(n)).collect::<Result<_>>()?;
    let stages = trees.len() + options.scenes.len();
    let (mut levels, mut cases) = (Vec::new(), Vec::new());
    for (i, (tree, &n)) in trees.iter().zip(&grids).enumerate() {
        watch(i, stages, &format!("{n} leaves an axis"));
        levels.push(regular::level(tree, n, options.rays, options.rounds));
        cases.extend(regular::cases(tree, n, options.rays));
    }
    let accels = plain_first(&options.accels);
    let mut measured = Vec::new();
    for (i, scene) in options.scenes.iter().enumerate() {
        watch(trees.len() + i, stages, scene);
        measured.push(scenes::measure(scene, &accels, options)?);
    }
    Ok(report(options, &grids, &levels, &cases, &measured))
}

fn report(options: &Options, grids: &[u32], levels: &[Level], cases: &[Case], measured: &[Measured]) -> Report {
    let mut tables = vec![regular::table(levels), regular::case_table(cases)];
    if !measured.is_empty() {
        tables.push(scenes::table(measured));
    }
    Report {
        paper: "arvo",
        title: "Arvo 1988, \"Linear-time voxel walking for octrees\" (Ray Tracing News)",
        machine: Machine::this(),
        settings: vec![
            ("trees", grids.iter().map(|n| format!("{n}^3")).collect::<Vec<_>>().join(", ")),
            ("rays", format!("{} through opposite faces of each tree", options.rays)),
            ("size", format!("{0} x {0} pixels, one sample each", options.size)),
            ("rounds", options.rounds.to_string()),
        ],
        notes: [
            "The trees of N^3 leaves are complete and take no memory: their nodes are computed where they are entered. Nodes \
             and leaves do not depend on the machine; the times are those of the walks alone, for no list is tested and no \
             node fetched.",
            "segment and interval are the two listings of the note, midpoint is Jansen's form of 1986: all three partition \
             the ray. retraverse finds every leaf from the root (Glassner 1984), climb from the lowest node that holds the \
             leaf before too (the 1987 step on an octree); neither is part of the note's theorem.",
            "A node counts whenever it is entered, a leaf among them; an empty subtree (NIL) is a leaf but no node.",
            "Best case: the first leaf answers the ray. Worst case: of the given number of rays from corner to corner the one \
             with most leaves, none of which answers it.",
            "On scenes, the rays of a picture (camera, shadow, and mirror and glass rays) are recorded once and traced on one \
             thread through every accelerator: median of interleaved rounds. Steps are voxels of grids and nodes of trees; \
             the BVH does not count them. Leaves are those of trees alone.",
        ]
        .map(String::from)
        .to_vec(),
        claims: claims::judge(levels, cases),
        tables,
        plot: plot(levels),
        wrong: measured.iter().map(Measured::wrong).sum(),
    }
}

fn plot(levels: &[Level]) -> Plot {
    // All partitioning walks enter the same nodes.
    let shown = [("partitioning", Form::Interval), ("climbing", Form::Climb), ("re-traversal", Form::Retraverse)];
    let line = |(name, form): (&str, Form)| Line {
        name: name.to_string(),
        points: levels.iter().map(|l| (f64::from(l.n), l.of(form).nodes_per_leaf)).collect(),
    };
    let most = levels.iter().map(|l| l.of(Form::Interval).most).fold(0.0, f64::max);
    Plot::Lines(Lines {
        title: "Nodes entered for each leaf of a ray".into(),
        subtitle: format!(
            "Arvo 1988; complete trees, random rays through opposite faces; partitioning never above {}",
            significant(most)
        ),
        x: "leaves on each axis".into(),
        y: "nodes for each leaf, mean of the rays".into(),
        lines: shown.into_iter().map(line).collect(),
    })
}
