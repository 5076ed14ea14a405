//! Semwal & Kvarnstrom 1997: skip methods on Random, Lanes, Flakes and Cars, three views, three grid sizes.

mod claims;
mod landing;
mod study;
mod tables;
mod views;

pub use views::SETTINGS;

use super::plot::{Dots, Panel, Plot};
use super::report::Report;
use super::{PLAIN, Watch};
use crate::error::{Error, Result};
use crate::measure::Machine;
use crate::registry;
use study::Study;
use views::VIEWS_IN_WORDS;

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Rows and columns of the pictures, above 0.
    pub size: u32,
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Voxels on each axis.
    pub grids: Vec<u32>,
    /// Accelerators; the plain grid is added in front.
    pub accels: Vec<String>,
    /// Some of the names in [`SETTINGS`]; empty: all.
    pub scenes: Vec<String>,
}

/// The methods that are compared unless told otherwise: the paper's, its announced ones, and modern rivals.
pub const METHODS: [&str; 10] = [
    PLAIN,
    "grid-clouds",
    "grid-dsz",
    "grid-dual",
    "grid-dsz24",
    "grid-chessboard",
    "grid-octant",
    "grid-clouds:distances=log2",
    "grid-dsz:distances=log2",
    "grid-dual:distances=log2",
];

/// Measures everything.
///
/// # Errors
/// No grid, or one out of range; an unknown accelerator or scene; a structure beyond its memory budget; the picture's
/// size is 0.
pub fn run(options: &Options, watch: &Watch) -> Result<Report> {
    if options.grids.is_empty() || options.rounds == 0 {
        let (grids, rounds) = (options.grids.len(), options.rounds);
        return Err(Error::invalid(format!("nothing to measure: {grids} grid sizes, {rounds} rounds")));
    }
    let names = SETTINGS.map(|s| s.name);
    if let Some(unknown) = options.scenes.iter().find(|name| !names.contains(&name.as_str())) {
        let hint = registry::did_you_mean(&names, unknown, 2);
        return Err(Error::invalid(format!("scene `{unknown}` is none of the paper's{hint}: {}", names.join(", "))));
    }
    let study = Study::measure(options, watch)?;
    Ok(report(options, &study))
}

fn report(options: &Options, study: &Study) -> Report {
    let mut notes: Vec<String> = [
        "preprocess s is the time to build the whole accelerator, lists and skip table, on all cores. render s is the time \
         to trace all rays of the picture (camera, shadow and mirror rays, recorded once) on one thread, without shading: \
         median of interleaved rounds. total s is their sum.",
        "steps are voxels entered, by a step or at the end of a leap. mean distance is the voxels that the plain grid \
         enters for each voxel that the method enters: the mean length of its moves, leaps included. ratio is the plain \
         grid's render s over the method's.",
        VIEWS_IN_WORDS,
        "The printed landing rule, a leap of D - 1 units, can pass over a filled voxel; the answer is wrong if no voxel that \
         is still visited holds the primitive. Boxes that fill single voxels show how often that is; random rays through \
         them.",
        "The paper's tables are lost: only its claims can be compared.",
    ]
    .map(String::from)
    .to_vec();
    for setting in SETTINGS.iter().filter(|s| study.scenes.contains(&s.name)) {
        notes.push(format!("{}: {}.", setting.name, setting.words));
    }
    let grids: Vec<String> = study.grids.iter().map(u32::to_string).collect();
    Report {
        paper: "semwal-kvarnstrom",
        title: "Semwal & Kvarnstrom 1997, \"Directed Safe Zones and the Dual Extent Algorithms for Efficient Grid \
                Traversal during Ray Tracing\"",
        machine: Machine::this(),
        settings: vec![
            ("size", format!("{0} x {0} pixels, one sample each", options.size)),
            ("rounds", options.rounds.to_string()),
            ("grids", grids.join(", ")),
        ],
        notes,
        claims: claims::judge(study),
        tables: tables::all(study),
        plot: plot(study),
        wrong: study.wrong(),
    }
}

/// Steps on the left, time on the right, a row of panels for each scene; means over the views.
fn plot(study: &Study) -> Plot {
    let panel = |s: usize, unit: &str, value: &dyn Fn(&super::trace::Cost) -> f64| Panel {
        title: format!("{}: {unit}", study.scenes[s]),
        rows: (0..study.methods.len())
            .map(|m| {
                let over_views = |g: usize| {
                    let values = (0..study.views()).map(|v| value(study.cost(s, v, g, m)));
                    values.sum::<f64>() / study.views() as f64
                };
                (study.methods[m].clone(), (0..study.grids.len()).map(over_views).collect())
            })
            .collect(),
    };
    let panels = (0..study.scenes.len()).flat_map(|s| {
        [
            panel(s, "voxels entered by a ray", &|c| c.per_ray(c.counts.steps)),
            panel(s, "nanoseconds a ray", &|c| c.nanoseconds()),
        ]
    });
    Plot::Dots(Dots {
        title: "Skip methods: steps and time".into(),
        subtitle: "Scenes of Semwal & Kvarnstrom 1997; means over three views; logarithmic scales; left is better"
            .into(),
        series: study.grids.iter().map(|n| format!("{n} voxels an axis")).collect(),
        panels: panels.collect(),
        columns: 2,
    })
}
