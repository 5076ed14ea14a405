//! The cost of exactness: time against plain triangle tests in the same grid, and errors against run time.
//!
//! Not a paper of others: the measurements behind our own claim that exact answers cost little.

mod cost;
mod errors;
mod mix;
mod plain;
mod textbook;

pub use plain::{MollerTrumbore32, MollerTrumbore64, PlainTriangles, Test, Woop32};
pub use textbook::Textbook;

use super::Watch;
use super::report::{Claim, Report, Verdict, significant};
use crate::error::{Error, Result};
use crate::measure::Machine;
use cost::Cost;
use errors::Study;

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Rows and columns of the films that the rays of the scenes go through, above 0.
    pub size: u32,
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Scenes of triangles for the cost of the test.
    pub scenes: Vec<String>,
    /// Rays of each case of the mix that errors are counted on, at least 1.
    pub rays: u32,
    /// Whether peers are measured that are compiled in and present.
    pub peers: bool,
}

/// Name on the command line.
pub(super) const NAME: &str = "exactness";

/// Ordinary scenes that can be made here.
pub const SCENES: [&str; 6] = ["bumpy", "knot", "teapot", "cubes", "spd-gears", "spd-tetra"];

/// The target: time of the exact test over Woop's in f32 in the same grid.
const TARGET: f64 = 1.10;

/// Measures everything.
///
/// # Errors
/// No scene, round or ray; a scene that cannot be loaded or does not consist of triangles; a grid beyond its memory budget.
pub fn run(options: &Options, watch: &Watch) -> Result<Report> {
    if options.scenes.is_empty() || options.rounds == 0 || options.rays == 0 {
        let (scenes, rounds, rays) = (options.scenes.len(), options.rounds, options.rays);
        return Err(Error::invalid(format!("nothing to measure: {scenes} scenes, {rounds} rounds, {rays} rays")));
    }
    let stages = options.scenes.len() + 3;
    let mut costs = Vec::new();
    for (i, scene) in options.scenes.iter().enumerate() {
        watch(i, stages, scene);
        costs.extend(cost::measure(scene, options)?);
    }
    let study = errors::measure(options, watch, options.scenes.len(), stages)?;
    Ok(report(options, &costs, &study))
}

fn report(options: &Options, costs: &[Cost], study: &Study) -> Report {
    let mut notes = [
        "The same grid, the same voxel walk and the same rays under each test; all contenders take turns within one process, \
         on one thread. Ratios are taken within each round.",
        "Plain tests: Woop, Benthin & Wald 2013 in f32 without its second try in f64; Möller & Trumbore 1997 in f32 and in f64, \
         without an epsilon. The textbook walk is Amanatides & Woo's in f32 with tMax accumulated; the grid below it is ours, \
         whose voxels are padded.",
        "The mix is fixed: cases of the stress test's catalogue, two of ordinary rays and six that are aimed at corners, edges \
         and seams, along axes, at needles and from far away. An error is strict: a hit missed or invented, or a primitive that \
         exact arithmetic does not put first (any of those that tie will do).",
        "Peers run as their authors intend, with triangle tests of their own and in most cases other trees than a grid: their \
         times say what they cost, not what their tests cost.",
    ]
    .map(String::from)
    .to_vec();
    notes.extend(study.absent.iter().map(|cause| format!("Left out: {cause}.")));
    Report {
        paper: NAME,
        title: "The cost of exact answers",
        machine: Machine::this(),
        settings: vec![
            ("size", format!("{0} x {0} pixels", options.size)),
            ("rounds", options.rounds.to_string()),
            ("rays of a case", options.rays.to_string()),
        ],
        notes,
        claims: claims(costs, study),
        tables: vec![cost::time_table(costs), cost::stage_table(costs), study.table(), study.case_table()],
        plot: study.plot(),
        wrong: study.wrong,
    }
}

fn claims(costs: &[Cost], study: &Study) -> Vec<Claim> {
    let ratio = cost::mean_ratio(costs);
    let worst = costs.iter().map(Cost::ratio).fold(f64::NAN, f64::max);
    let errors = |test: &str, accumulated| study.errors(test, accumulated).unwrap_or(0);
    let ours = errors("exact", false);
    let textbook = errors(MollerTrumbore32::NAME, true);
    vec![
        Claim {
            id: "X1",
            claim: "The exact test costs at most a tenth more time than Woop's in f32",
            rule: "geometric mean over scenes and kinds of rays of the median ratio: at most 1.10",
            verdict: Verdict::of(ratio <= TARGET),
            numbers: format!("{} in the mean, {} at worst", significant(ratio), significant(worst)),
        },
        Claim {
            id: "X2",
            claim: "The exact test with recomputed crossings makes no error",
            rule: "no ray of the mix whose primitive, bits of t or answer to any hit differ from exact arithmetic",
            verdict: Verdict::of(study.wrong == 0 && ours == 0),
            numbers: format!("{} rays differ", study.wrong),
        },
        Claim {
            id: "X3",
            claim: "The textbook's f32 test and walk make errors on the mix",
            rule: "more than none",
            verdict: Verdict::of(textbook > 0),
            numbers: format!("{textbook} rays"),
        },
    ]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::{LoadOptions, SceneGeometry, load};

    #[test]
    fn the_usual_scenes_are_there_and_of_triangles() {
        for name in SCENES {
            let scene = load(name, &LoadOptions::default()).expect(name);
            assert!(matches!(scene.geometry, SceneGeometry::Triangles(_)), "{name}");
        }
    }
}
