//! The article on branchless DDA voxel tracing: solid voxels, branching and branchless, plain and with each skip table.

use super::plot::{Dots, Panel, Plot};
use super::printed_dda::{Printed, double_steps, stalled};
use super::report::{Cell, Claim, Report, Table, Verdict, significant};
use super::trace::{Cost, ask, costs};
use super::{PLAIN, Watch};
use crate::accel::{Accel, Memory};
use crate::error::{Error, Result};
use crate::measure::rounds::build;
use crate::measure::{Machine, RayKind, RayOptions, ray_sets};
use crate::random::Random;
use crate::registry::ENTRIES;
use crate::scene::{LoadOptions, load};
use glam::DVec2;

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Rows and columns of the film that camera rays go through, above 0.
    pub size: u32,
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Scenes of solid voxels.
    pub scenes: Vec<String>,
}

/// The walks over the voxels themselves; the first two are what the article compares.
const WALKS: [&str; 8] = [
    "voxels",
    "voxels:step=branchless",
    "voxels:skip=clouds",
    "voxels:skip=dsz",
    "voxels:skip=dual",
    "voxels:skip=dsz24",
    "voxels:skip=chessboard",
    "voxels:skip=octant",
];

/// Over the triangles of the faces; the BVH only where it is compiled in.
const OVER_FACES: [&str; 3] = [PLAIN, "grid:step=branchless", "obvhs-cwbvh"];

/// The lists of rays.
const LISTS: [&str; 3] = ["camera", "camera shuffled", "diffuse"];

/// Rays of the claim about axes of no movement, and the seed of their origins.
const STALLS: (u32, u64) = (10_000, 12);
/// Steps of the claim about ties.
const TIES: u32 = 1000;

/// One accelerator on one scene.
struct Entry {
    accel: String,
    milliseconds: f64,
    memory: Memory,
    /// By list.
    costs: Vec<Cost>,
}

impl Entry {
    fn nanoseconds(&self, list: usize) -> f64 {
        self.costs[list].nanoseconds()
    }
}

/// One scene.
struct Measured {
    scene: String,
    faces: u32,
    entries: Vec<Entry>,
}

impl Measured {
    /// Time of the branching walk over that of the branchless one: above 1 where branches cost.
    fn gain(&self, list: usize) -> f64 {
        self.entries[0].nanoseconds(list) / self.entries[1].nanoseconds(list)
    }
}

/// Measures everything.
///
/// # Errors
/// No scene, an unknown one or one that does not consist of solid voxels; a structure beyond its memory budget; the size is
/// 0.
pub fn run(options: &Options, watch: &Watch) -> Result<Report> {
    if options.scenes.is_empty() || options.rounds == 0 {
        let (scenes, rounds) = (options.scenes.len(), options.rounds);
        return Err(Error::invalid(format!("nothing to measure: {scenes} scenes, {rounds} rounds")));
    }
    let mut measured = Vec::new();
    for (i, scene) in options.scenes.iter().enumerate() {
        watch(i, options.scenes.len(), scene);
        measured.push(measure(scene, options)?);
    }
    Ok(report(options, &measured))
}

fn measure(spec: &str, options: &Options) -> Result<Measured> {
    let scene = load(spec, &LoadOptions::default())?;
    let Some(voxels) = scene.voxels() else {
        return Err(Error::invalid(format!("scene `{spec}` does not consist of solid voxels")));
    };
    let faces = voxels.exposed_faces();
    let here = |spec: &&&str| ENTRIES.iter().any(|entry| spec.split(':').next() == Some(entry.name));
    let mut built = Vec::new();
    for name in WALKS.iter().chain(&OVER_FACES).filter(here) {
        built.push((name.to_string(), build(&scene, name)?));
    }
    let Some((_, (plain, _))) = built.iter().find(|(name, _)| name == PLAIN) else {
        unreachable!("the plain grid is always there")
    };
    let size = options.size;
    let sets = RayOptions { width: size, height: size, max_rays: (size as usize).pow(2), ..RayOptions::default() };
    let sets = ray_sets(&scene, &**plain, &sets)?;
    let of = |kind: RayKind| sets.iter().find(|set| set.kind == kind).map_or(&[][..], |set| &set.rays);
    let mut shuffled = of(RayKind::Camera).to_vec();
    Random::new(7).shuffle(&mut shuffled);
    let accels: Vec<&dyn Accel> = built.iter().map(|(_, (accel, _))| &**accel).collect();
    let lists = [of(RayKind::Camera), &shuffled, of(RayKind::Diffuse)];
    let by_list = lists.map(|rays| costs(&ask(rays, &**plain), &accels, options.rounds));
    let entries = built.iter().enumerate().map(|(i, (accel, (built, milliseconds)))| Entry {
        accel: accel.clone(),
        milliseconds: *milliseconds,
        memory: built.memory(),
        costs: by_list.iter().map(|costs| costs[i]).collect(),
    });
    Ok(Measured { scene: spec.to_string(), faces, entries: entries.collect() })
}

fn report(options: &Options, measured: &[Measured]) -> Report {
    let wrong = measured.iter().flat_map(|m| &m.entries).flat_map(|e| &e.costs).map(|c| c.wrong).sum();
    Report {
        paper: "dda",
        title: "An article on branchless DDA voxel tracing",
        machine: Machine::this(),
        settings: vec![
            ("size", format!("{0} x {0} camera rays", options.size)),
            ("rounds", options.rounds.to_string()),
            ("scenes", options.scenes.join(", ")),
        ],
        notes: [
            "The accelerators called `voxels` walk the array of voxels itself: a hit is a crossing from empty to solid or \
             back, and the triangles of that face decide in exact arithmetic. The others have lists or nodes of the same \
             triangles. All answers must be equal to the bit.",
            "Camera rays come row by row, so that neighbours take nearly the same branches; the same rays in random order \
             do not, and neither do diffuse rays, from what the camera sees in random directions and order. On a processor \
             core a branch costs if it is guessed wrongly; the article speaks of graphics cards, where a branch costs if \
             rays that run together part.",
            "Time is for the closest hit, on one thread: median of interleaved rounds. The ratio is the time of `voxels` over \
             that of the row, above 1 where the row is faster.",
        ]
        .map(String::from)
        .to_vec(),
        claims: vec![branches(measured), positions(), still_axes(), ties()],
        tables: vec![rays_table(measured), builds(measured), printed()],
        plot: plot(measured),
        wrong,
    }
}

fn rays_table(measured: &[Measured]) -> Table {
    let columns = [
        "<scene",
        "<rays",
        "<accelerator",
        "ns/ray",
        "ratio",
        "spread %",
        "steps/ray",
        "leaps/ray",
        "tests/ray",
        "wrong rays",
    ];
    let mut table = Table::new("rays", "Time and work for each ray", &columns);
    for one in measured {
        for (list, name) in LISTS.iter().enumerate() {
            for entry in &one.entries {
                let cost = &entry.costs[list];
                let steps = cost.per_ray(cost.counts.steps);
                let cells: [Cell; 10] = [
                    one.scene.clone().into(),
                    (*name).into(),
                    entry.accel.clone().into(),
                    entry.nanoseconds(list).into(),
                    (one.entries[0].nanoseconds(list) / entry.nanoseconds(list)).into(),
                    (100.0 * cost.spread).into(),
                    // A BVH does not count its nodes.
                    (if steps == 0.0 { f64::NAN } else { steps }).into(),
                    cost.per_ray(cost.counts.leaps).into(),
                    cost.per_ray(cost.counts.tests).into(),
                    cost.wrong.into(),
                ];
                table.row(cells);
            }
        }
    }
    table
}

fn builds(measured: &[Measured]) -> Table {
    let columns = ["<scene", "faces", "<accelerator", "build ms", "bytes", "bytes of tables"];
    let mut table = Table::new("builds", "Building, beside the voxels themselves", &columns);
    for one in measured {
        for entry in &one.entries {
            let cells: [Cell; 6] = [
                one.scene.clone().into(),
                one.faces.into(),
                entry.accel.clone().into(),
                entry.milliseconds.into(),
                entry.memory.total().into(),
                entry.memory.tables.into(),
            ];
            table.row(cells);
        }
    }
    table
}

/// The example of the listing's drift: origin, direction, and the steps looked at.
const DRIFT: (DVec2, DVec2, [u32; 2]) = (DVec2::new(0.3, 0.6), DVec2::new(0.8, 0.6), [2, 6]);

/// After each of the steps: the printed position and the right one.
fn drift() -> Vec<(u32, DVec2, DVec2)> {
    let (origin, direction, steps) = DRIFT;
    let mut walk = Printed::new(origin, direction);
    let mut found = Vec::new();
    for step in 1..=steps[1] {
        walk.step();
        if steps.contains(&step) {
            found.push((step, walk.position, walk.right));
        }
    }
    found
}

fn printed() -> Table {
    let columns = ["<what", "printed", "right"];
    let mut table = Table::new("printed", "The article's last listing as printed, in two dimensions", &columns);
    for (step, position, right) in drift() {
        for (axis, name) in ["x", "y"].into_iter().enumerate() {
            let what = format!("{name} of the position after step {step} from (0.3, 0.6) along (0.8, 0.6)");
            let cells: [Cell; 3] = [what.into(), position[axis].into(), right[axis].into()];
            table.row(cells);
        }
    }
    let (rays, seed) = STALLS;
    let what = format!("of {rays} rays along x from random origins, those that never leave their voxel");
    let cells: [Cell; 3] = [what.into(), stalled(rays, seed).into(), 0_u32.into()];
    table.row(cells);
    let what = format!("of {TIES} steps along the diagonal from a voxel's middle, those that cross two planes at once");
    let cells: [Cell; 3] = [what.into(), double_steps(TIES).into(), 0_u32.into()];
    table.row(cells);
    table
}

/// Two figures that are this near are the same.
const TIE: f64 = 0.01;

fn branches(measured: &[Measured]) -> Claim {
    let holds = measured.iter().all(|m| m.gain(2) > 1.0 + TIE && m.gain(1) > m.gain(0) * (1.0 + TIE));
    let numbers: Vec<String> = measured
        .iter()
        .map(|m| {
            let [camera, shuffled, diffuse] = [0, 1, 2].map(|list| significant(m.gain(list)));
            format!("{}: camera {camera}, the same shuffled {shuffled}, diffuse {diffuse}", m.scene)
        })
        .collect();
    Claim {
        id: "B7",
        claim: "branches cost, because neighbouring rays take different ones",
        rule: "on every scene the branchless walk is faster on diffuse rays by more than 1 %, and its gain on camera rays is \
               greater by more than 1 % in random order than in the picture's; numbers are the time of the branching walk \
               over that of the branchless one",
        verdict: Verdict::of(holds),
        numbers: numbers.join("; "),
    }
}

fn positions() -> Claim {
    let numbers: Vec<String> = drift()
        .iter()
        .map(|(step, p, right)| {
            format!("step {step}: ({:.3}, {:.3}) instead of ({:.3}, {:.3})", p.x, p.y, right.x, right.y)
        })
        .collect();
    Claim {
        id: "B1",
        claim: "the position is advanced by the direction times the distance to the next crossing",
        rule: "the printed position is where the ray is, within 0.001, after 2 and 6 steps",
        verdict: Verdict::of(drift().iter().all(|(_, p, right)| p.distance(*right) < 1e-3)),
        numbers: numbers.join("; "),
    }
}

fn still_axes() -> Claim {
    let (rays, seed) = STALLS;
    let stalled = stalled(rays, seed);
    Claim {
        id: "B3",
        claim: "an axis along which the direction is 0 makes no problem",
        rule: "every ray along x from a random origin leaves its voxel in the first step",
        verdict: Verdict::of(stalled == 0),
        numbers: format!("{stalled} of {rays} rays do not"),
    }
}

fn ties() -> Claim {
    let double = double_steps(TIES);
    Claim {
        id: "B4",
        claim: "a step crosses the nearest face, and the normal is that of this face",
        rule: "along the diagonal from a voxel's middle every step crosses one face",
        verdict: Verdict::of(double == 0),
        numbers: format!(
            "{double} of {TIES} steps cross two, past the voxels beside the edge, with a normal of length 1.41"
        ),
    }
}

fn plot(measured: &[Measured]) -> Plot {
    let row = |e: &Entry| (e.accel.clone(), (0..LISTS.len()).map(|list| e.nanoseconds(list)).collect());
    let panel =
        |m: &Measured| Panel { title: format!("{}, ns/ray", m.scene), rows: m.entries.iter().map(row).collect() };
    Plot::Dots(Dots {
        title: "Solid voxels".into(),
        subtitle: "Time for a ray; the same camera rays in the picture's order and shuffled; one thread".into(),
        series: LISTS.map(String::from).to_vec(),
        panels: measured.iter().map(panel).collect(),
        columns: 2,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_listing_has_the_faults_that_are_known_of_it() {
        // Worked out by hand from the listing: after step 2 and 6.
        let expected = [((1.533, 1.525), (1.0, 1.125)), ((11.0, 8.6), (3.5, 3.0))];
        for ((_, printed, right), (by_hand, truth)) in drift().into_iter().zip(expected) {
            assert!((printed - DVec2::from(by_hand)).abs().max_element() < 0.05, "{printed}");
            assert!((right - DVec2::from(truth)).abs().max_element() < 1e-9, "{right}");
        }
        assert!((drift()[0].1 - DVec2::new(1.533, 1.525)).abs().max_element() < 5e-4);
        // Half of them, within five standard deviations of 50.
        assert!((4750..=5250).contains(&stalled(10_000, 1)));
        assert_eq!(double_steps(100), 100);
        for claim in [positions(), still_axes(), ties()] {
            assert_eq!(claim.verdict, Verdict::Fails, "{claim:?}");
        }
    }
}
