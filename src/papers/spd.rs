//! Haines' Standard Procedural Databases over all accelerators: the comparison that the 1997 paper announced.

use super::plot::{Dots, Panel, Plot};
use super::report::{Cell, Report, Table};
use super::trace::{Asked, Cost, Origin, costs, record, thinned};
use super::{Watch, plain_first};
use crate::accel::{Accel, Memory};
use crate::error::{Error, Result};
use crate::measure::Machine;
use crate::measure::rounds::build;
use crate::registry::{promises_exact, with_default};
use crate::scene::procedural::spd::{Published, SCENES, eye_rays};
use crate::scene::{LoadOptions, Scene, load};

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Rows and columns of the pictures, above 0.
    pub size: u32,
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Voxels a primitive of every grid that does not set it.
    pub density: f64,
    /// Accelerators; the plain grid is added in front.
    pub accels: Vec<String>,
    /// Scenes; empty: all of [`SCENES`].
    pub scenes: Vec<String>,
    /// Most seconds that the plain grid may take for the rays of a picture; slower scenes are traced with fewer rays.
    pub patience: f64,
}

/// The accelerators that are compared unless told otherwise, beside the grids of
/// [`super::semwal_kvarnstrom::METHODS`].
pub const BVHS: [&str; 2] = ["obvhs-bvh2", "obvhs-cwbvh"];

/// One scene under one accelerator.
struct Entry {
    accel: String,
    milliseconds: f64,
    memory: Memory,
    /// By kind of ray.
    costs: [Cost; 3],
}

/// One scene.
struct Measured {
    scene: String,
    primitives: u32,
    /// Rays of the picture, and those traced.
    rays: [u64; 2],
    entries: Vec<Entry>,
    /// If it is one of SPD's: what is published, and the eye hits counted here.
    published: Option<(&'static Published, u64)>,
}

const KINDS: [Origin; 3] = [Origin::Primary, Origin::Shadow, Origin::Secondary];

impl Entry {
    fn rays(&self) -> f64 {
        self.costs.iter().map(|c| c.counts.rays as f64).sum()
    }

    fn per_ray(&self, work: impl Fn(&Cost) -> u64) -> f64 {
        self.costs.iter().map(|c| work(c) as f64).sum::<f64>() / self.rays()
    }

    /// Nanoseconds for each ray of the picture.
    fn nanoseconds(&self) -> f64 {
        let seconds = self.costs.iter().map(|c| c.seconds).filter(|s| s.is_finite());
        1e9 * seconds.sum::<f64>() / self.rays()
    }

    /// Steps a ray; NaN for accelerators that do not count them.
    fn steps(&self) -> f64 {
        let steps = self.per_ray(|c| c.counts.steps);
        if steps == 0.0 { f64::NAN } else { steps }
    }

    fn wrong(&self) -> u64 {
        self.costs.iter().map(|c| c.wrong).sum()
    }
}

/// Measures everything.
///
/// # Errors
/// No scene; an unknown accelerator or scene; a structure beyond its memory budget; the picture's size or the density is
/// not above 0.
pub fn run(options: &Options, watch: &Watch) -> Result<Report> {
    let scenes: Vec<String> = if options.scenes.is_empty() {
        SCENES.iter().map(|scene| scene.name.to_string()).collect()
    } else {
        options.scenes.clone()
    };
    if scenes.is_empty() || options.rounds == 0 {
        let (scenes, rounds) = (scenes.len(), options.rounds);
        return Err(Error::invalid(format!("nothing to measure: {scenes} scenes, {rounds} rounds")));
    }
    let accels = plain_first(&options.accels);
    let mut measured = Vec::new();
    for (i, spec) in scenes.iter().enumerate() {
        watch(i, scenes.len(), spec);
        measured.push(measure(spec, &accels, options)?);
    }
    Ok(report(options, &measured))
}

fn measure(spec: &str, specs: &[String], options: &Options) -> Result<Measured> {
    let scene = load(spec, &LoadOptions::default())?;
    let mut built = Vec::new();
    let mut accels = Vec::new();
    for name in specs {
        let dense = with_default(name, "density", &options.density.to_string());
        let (accel, milliseconds) = build(&scene, &dense)?;
        built.push((milliseconds, accel.memory()));
        accels.push(accel);
    }
    let accels: Vec<&dyn Accel> = accels.iter().map(|a| &**a).collect();
    let asked = record(&scene, accels[0], options.size)?;
    let some = within(&asked, accels[0], options.patience);
    let by_kind = KINDS.map(|kind| {
        let rays: Vec<Asked> = some.iter().filter(|a| a.origin == kind).copied().collect();
        costs(&rays, &accels, options.rounds)
    });
    let entry = |(i, (milliseconds, memory)): (usize, (f64, Memory))| Entry {
        accel: specs[i].clone(),
        milliseconds,
        memory,
        costs: [0, 1, 2].map(|k| by_kind[k][i]),
    };
    let entries: Vec<Entry> = built.into_iter().enumerate().map(entry).collect();
    let published = SCENES.iter().find(|scene| scene.name == spec);
    let published = published.map(|published| (published, eye_hits(&scene, &accels, &entries)));
    let rays = [asked.len() as u64, some.len() as u64];
    Ok(Measured { scene: spec.to_string(), primitives: scene.primitive_count(), rays, entries, published })
}

/// Those of SPD's eye rays that hit something, by the fastest accelerator: all agree.
fn eye_hits(scene: &Scene, accels: &[&dyn Accel], entries: &[Entry]) -> u64 {
    let fastest = entries.iter().zip(accels).min_by(|a, b| a.0.nanoseconds().total_cmp(&b.0.nanoseconds()));
    let Some((_, accel)) = fastest else { return 0 };
    eye_rays(&scene.camera).iter().filter(|ray| accel.any_hit(ray)).count() as u64
}

/// As many of the rays as `accel` traces in about `seconds`.
fn within(asked: &[Asked], accel: &dyn Accel, seconds: f64) -> Vec<Asked> {
    let few = thinned(asked, 4096);
    let pace = costs(&few, &[accel], 1)[0].seconds / few.len().max(1) as f64;
    // Saturates; an empty list gives NaN, which becomes 0.
    thinned(asked, (seconds / pace) as usize)
}

fn report(options: &Options, measured: &[Measured]) -> Report {
    Report {
        paper: "spd",
        title: "Haines' Standard Procedural Databases over all accelerators",
        machine: Machine::this(),
        settings: vec![
            ("size", format!("{0} x {0} pixels, one sample each", options.size)),
            ("rounds", options.rounds.to_string()),
            ("density", format!("{} voxels a primitive in every grid", options.density)),
        ],
        notes: vec![
            "The rays of a picture (camera, shadow, and mirror and glass rays) are recorded once and traced by kind on one \
             thread through every accelerator: median of interleaved rounds. ns/ray is the mean over all of them; ratio is \
             the plain grid's over the accelerator's."
                .to_string(),
            "build ms is on all cores. bytes are those beside the primitives. Cones, cylinders and patches are triangles \
             here."
                .to_string(),
            format!(
                "Where the plain grid would take more than {} s for the rays of the picture, only so many of them are \
                 traced, in stretches of 64.",
                options.patience
            ),
            "About 20 voxels an object was the best density of uniform grids on most of these scenes in Havran & Sixta \
             1999 (Ray Tracing News 12-1)."
                .to_string(),
        ],
        claims: Vec::new(),
        tables: vec![winners(measured), scenes(measured), table(measured)],
        plot: plot(measured),
        wrong: measured.iter().flat_map(|m| &m.entries).filter(|e| promises_exact(&e.accel)).map(Entry::wrong).sum(),
    }
}

fn winners(measured: &[Measured]) -> Table {
    let mut table = Table::new(
        "fastest",
        "The fastest of each family",
        &["<scene", "<fastest grid", "ratio", "<fastest BVH", "ratio of BVH", "grid over BVH"],
    );
    for m in measured {
        let plain = m.entries[0].nanoseconds();
        let fastest = |grids: bool| {
            let family = m.entries.iter().filter(|e| e.accel.starts_with("grid") == grids);
            let best = family.min_by(|a, b| a.nanoseconds().total_cmp(&b.nanoseconds()));
            best.map_or(("-".to_string(), f64::NAN), |e| (e.accel.clone(), plain / e.nanoseconds()))
        };
        let ((grid, grid_ratio), (bvh, bvh_ratio)) = (fastest(true), fastest(false));
        let cells: [Cell; 6] = [
            m.scene.as_str().into(),
            grid.into(),
            grid_ratio.into(),
            bvh.into(),
            bvh_ratio.into(),
            (grid_ratio / bvh_ratio).into(),
        ];
        table.row(cells);
    }
    table
}

/// What is published of the scenes beside what they are here.
fn scenes(measured: &[Measured]) -> Table {
    let mut table = Table::new(
        "scenes",
        "The scenes: primitives, and which of SPD's 513 x 513 eye rays hit something",
        &[
            "<scene",
            "primitives",
            "primitives of SPD",
            "eye hits",
            "eye hits of SPD",
            "eye hits of Havran & Sixta 1999",
        ],
    );
    for (m, (published, hits)) in measured.iter().filter_map(|m| Some((m, m.published?))) {
        let known = |hits: Option<u32>| Cell::Real(hits.map_or(f64::NAN, f64::from));
        let cells: [Cell; 6] = [
            m.scene.as_str().into(),
            m.primitives.into(),
            published.primitives.into(),
            hits.into(),
            known(published.hits_haines),
            known(published.hits_havran),
        ];
        table.row(cells);
    }
    table
}

fn table(measured: &[Measured]) -> Table {
    let mut table = Table::new(
        "spd",
        "Every scene and accelerator",
        &[
            "<scene",
            "primitives",
            "<accelerator",
            "build ms",
            "bytes",
            "rays",
            "traced",
            "ns/ray primary",
            "ns/ray shadow",
            "ns/ray secondary",
            "ns/ray",
            "steps/ray",
            "leaps/ray",
            "tests/ray",
            "ratio",
            "wrong rays",
        ],
    );
    for m in measured {
        for e in &m.entries {
            let [primary, shadow, secondary] = [0, 1, 2].map(|k| {
                let cost = &e.costs[k];
                Cell::Real(cost.nanoseconds())
            });
            let [rays, traced] = m.rays;
            let uncounted = e.steps().is_nan();
            let leaps = if uncounted { f64::NAN } else { e.per_ray(|c| c.counts.leaps) };
            let cells: [Cell; 16] = [
                m.scene.as_str().into(),
                m.primitives.into(),
                e.accel.as_str().into(),
                e.milliseconds.into(),
                e.memory.total().into(),
                rays.into(),
                traced.into(),
                primary,
                shadow,
                secondary,
                e.nanoseconds().into(),
                e.steps().into(),
                leaps.into(),
                e.per_ray(|c| c.counts.tests).into(),
                (m.entries[0].nanoseconds() / e.nanoseconds()).into(),
                e.wrong().into(),
            ];
            table.row(cells);
        }
    }
    table
}

fn plot(measured: &[Measured]) -> Plot {
    let panel = |m: &Measured| {
        let (time, steps) = (m.entries[0].nanoseconds(), m.entries[0].steps());
        let row = |e: &Entry| (e.accel.clone(), vec![e.nanoseconds() / time, e.steps() / steps]);
        Panel { title: format!("{}: relative to grid", m.scene), rows: m.entries.iter().map(row).collect() }
    };
    Plot::Dots(Dots {
        title: "Time and steps a ray, relative to the plain grid".into(),
        subtitle: "Haines' SPD; all rays of a picture; logarithmic scales; left is better; BVHs do not count steps"
            .into(),
        series: vec!["time a ray".into(), "voxels entered by a ray".into()],
        panels: measured.iter().map(panel).collect(),
        columns: 3,
    })
}
