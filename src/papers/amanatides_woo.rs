//! Amanatides & Woo 1987: tests per ray with and without rayID, time against subdivision, operations per step.

use super::plot::{Line, Lines, Plot};
use super::report::{Cell, Claim, Report, Table, Verdict, significant};
use super::trace::{Asked, Cost, check, costs, pass, record, settings, thinned};
use super::{Watch, printed_walk};
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::measure::Machine;
use crate::measure::rounds::in_turns;
use crate::render::render;
use crate::scene::{Scene, procedural};

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Rows and columns of the pictures.
    pub size: u32,
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Subdivisions of each axis to sweep over.
    pub grids: Vec<u32>,
}

/// A row of the paper's table. Time is for 512 x 512 pixels on a machine of 1987.
struct Published {
    figure: u32,
    scene: &'static str,
    minutes: f64,
    subdivision: u32,
    objects: u64,
    objects_per_voxel: f64,
    tests: f64,
    tests_with_id: f64,
}

/// The paper's table as a later document repeats it; the paper itself was not at hand.
const PUBLISHED: [Published; 4] = [
    Published {
        figure: 4,
        scene: "random:n=4",
        minutes: 49.5,
        subdivision: 20,
        objects: 4,
        objects_per_voxel: 0.3,
        tests: 4.6,
        tests_with_id: 1.7,
    },
    Published {
        figure: 5,
        scene: "random:n=31",
        minutes: 44.8,
        subdivision: 20,
        objects: 31,
        objects_per_voxel: 0.9,
        tests: 5.3,
        tests_with_id: 2.0,
    },
    Published {
        figure: 6,
        scene: "random:n=62",
        minutes: 21.7,
        subdivision: 30,
        objects: 62,
        objects_per_voxel: 0.2,
        tests: 1.9,
        tests_with_id: 1.4,
    },
    Published {
        figure: 7,
        scene: "random:n=3540",
        minutes: 32.6,
        subdivision: 40,
        objects: 3540,
        objects_per_voxel: 1.1,
        tests: 6.6,
        tests_with_id: 3.8,
    },
];

/// One scene at one subdivision.
struct Point {
    subdivision: u32,
    objects_per_voxel: f64,
    off: Cost,
    on: Cost,
}

impl Point {
    fn tests(&self) -> [f64; 2] {
        [self.off, self.on].map(|c| c.counts.tests as f64 / c.counts.rays as f64)
    }

    /// Tests without rayID over those with it.
    fn gain(&self) -> f64 {
        self.off.counts.tests as f64 / self.on.counts.tests.max(1) as f64
    }
}

/// One scene at all subdivisions, coarsest first.
struct Sweep {
    published: &'static Published,
    rays: usize,
    points: Vec<Point>,
    /// Rendering with every object tested for every ray: seconds for the whole, and for tracing alone.
    naive: [f64; 2],
    wrong: u64,
}

/// Measures everything.
///
/// # Errors
/// No subdivision or one out of range; a grid beyond its memory budget; the picture's size is 0.
pub fn run(options: &Options, watch: &Watch) -> Result<Report> {
    if options.grids.is_empty() || options.rounds == 0 {
        let (grids, rounds) = (options.grids.len(), options.rounds);
        return Err(Error::invalid(format!("nothing to measure: {grids} subdivisions, {rounds} rounds")));
    }
    let mut grids = options.grids.clone();
    grids.sort_unstable();
    grids.dedup();
    let mut sweeps = Vec::new();
    for (i, published) in PUBLISHED.iter().enumerate() {
        watch(i, PUBLISHED.len(), published.scene);
        sweeps.push(sweep(published, &grids, options)?);
    }
    Ok(report(options, &grids, &sweeps))
}

fn sweep(published: &'static Published, grids: &[u32], options: &Options) -> Result<Sweep> {
    let scene = Scene::new(procedural::parse(published.scene)?)?;
    let spec = |n: u32, mailbox: &str| format!("grid:resolution={n},mailbox={mailbox}");
    let asked = record(&scene, &scene.accel(&spec(published.subdivision, "off"))?, options.size)?;
    let mut subdivisions = [grids, &[published.subdivision]].concat();
    subdivisions.sort_unstable();
    subdivisions.dedup();
    let mut points = Vec::new();
    for n in subdivisions {
        let [off, on] = [scene.accel(&spec(n, "off"))?, scene.accel(&spec(n, "on"))?];
        let references = off.memory().references / size_of::<u32>() as u64;
        let cost = costs(&asked, &[&*off, &*on], options.rounds);
        let voxels = f64::from(n).powi(3);
        let objects_per_voxel = references as f64 / voxels;
        points.push(Point { subdivision: n, objects_per_voxel, off: cost[0], on: cost[1] });
    }
    let (naive, wrong) = naive(&scene, &asked, options)?;
    let wrong = points.iter().map(|p| p.off.wrong + p.on.wrong).sum::<u64>() + wrong;
    Ok(Sweep { published, rays: asked.len(), points, naive, wrong })
}

/// Seconds for a small picture by brute force, and for tracing its rays alone; and the number of wrong answers.
fn naive(scene: &Scene, asked: &[Asked], options: &Options) -> Result<([f64; 2], u64)> {
    let brute = scene.accel("brute")?;
    let size = options.size.min(64);
    let few = record(scene, &brute, size)?;
    // Checked before: the render can fail only as it did in `record`.
    let passes = in_turns(2, options.rounds, |i| match i {
        0 => drop(render(scene, &*brute, &settings(size), &|_, _| {})),
        _ => pass(&few, &*brute),
    });
    let wrong = check(&thinned(asked, 4096), &*brute).1;
    Ok(([1.0 / passes[0].per_second, 1.0 / passes[1].per_second], wrong))
}

fn report(options: &Options, grids: &[u32], sweeps: &[Sweep]) -> Report {
    Report {
        paper: "amanatides-woo",
        title: "Amanatides & Woo 1987, \"A Fast Voxel Traversal Algorithm for Ray Tracing\"",
        machine: Machine::this(),
        settings: vec![
            ("size", format!("{0} x {0} pixels, one sample each", options.size)),
            ("rounds", options.rounds.to_string()),
            ("grids", grids.iter().map(u32::to_string).collect::<Vec<_>>().join(", ")),
        ],
        notes: [
            "What the paper's objects are is unknown; ours are spheres of random size at random places, one in four a \
             mirror, with one light and shadows. The counts of objects and the subdivisions are the paper's.",
            "The paper's figures are second-hand: a later document repeats its table. Its times are minutes for \
             512 x 512 pixels on a machine of 1987.",
            "Time is that of tracing all rays of the picture (camera, shadow and mirror rays, recorded once) on one \
             thread, without shading: median of interleaved rounds.",
            "The paper's gain from rayID comes with sloppy insertion by bounding box; our insertion is exact, so there \
             are fewer tests to save.",
            "The initialisation is not printed in the paper, only the sums 33 (ray starts inside) to 40 (outside).",
        ]
        .map(String::from)
        .to_vec(),
        claims: vec![fall_and_rise(sweeps), growing_gain(sweeps), naive_share(sweeps)],
        tables: vec![comparison(sweeps), sweep_table(sweeps), naive_table(sweeps), operations()],
        plot: plot(sweeps),
        wrong: sweeps.iter().map(|s| s.wrong).sum(),
    }
}

/// The paper's table with ours beside it.
fn comparison(sweeps: &[Sweep]) -> Table {
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
fn sweep_table(sweeps: &[Sweep]) -> Table {
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
                (point.off.counts.steps as f64 / point.off.counts.rays as f64).into(),
                off.into(),
                on.into(),
                point.gain().into(),
            ];
            table.row(cells);
        }
    }
    table
}

fn naive_table(sweeps: &[Sweep]) -> Table {
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
            (100.0 * share(sweep)).into(),
        ];
        table.row(cells);
    }
    table
}

fn share(sweep: &Sweep) -> f64 {
    sweep.naive[1] / sweep.naive[0]
}

/// The printed loop, counted.
fn operations() -> Table {
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

/// Two figures that are this near are the same.
const TIE: f64 = 0.01;

fn fall_and_rise(sweeps: &[Sweep]) -> Claim {
    let best = |sweep: &Sweep| {
        let times = sweep.points.iter().map(|p| p.off.seconds).enumerate();
        times.min_by(|a, b| a.1.total_cmp(&b.1)).map_or(0, |(i, _)| i)
    };
    let enough = sweeps.iter().all(|s| s.points.len() >= 3);
    let holds = sweeps.iter().all(|s| (1..s.points.len() - 1).contains(&best(s)));
    let numbers: Vec<String> = sweeps
        .iter()
        .map(|s| {
            let at = best(s);
            let [first, least, last] = [0, at, s.points.len() - 1].map(|i| significant(s.points[i].off.seconds));
            format!("{}: {first} s, least {least} s at {}, {last} s", s.published.scene, s.points[at].subdivision)
        })
        .collect();
    Claim {
        id: "A13",
        claim: "execution time plummets and then rises as the grid is refined",
        rule: "on each scene the least time is at neither end of the sweep",
        verdict: if enough { Verdict::of(holds) } else { Verdict::NotMeasured },
        numbers: numbers.join("; "),
    }
}

fn growing_gain(sweeps: &[Sweep]) -> Claim {
    let grows = |s: &Sweep| s.points.windows(2).all(|w| w[1].gain() >= w[0].gain() * (1.0 - TIE));
    let several = sweeps.iter().all(|s| s.points.len() >= 2);
    let numbers: Vec<String> = sweeps
        .iter()
        .map(|s| {
            let gains: Vec<String> =
                s.points.iter().map(|p| format!("{} at {}", significant(p.gain()), p.subdivision)).collect();
            format!("{}: {}", s.published.scene, gains.join(", "))
        })
        .collect();
    Claim {
        id: "A14",
        claim: "the gain from rayID grows with the subdivision",
        rule: "on each scene tests without rayID over tests with it fall by no more than 1 % from any subdivision to \
               the next finer one",
        verdict: if several { Verdict::of(sweeps.iter().all(grows)) } else { Verdict::NotMeasured },
        numbers: numbers.join("; "),
    }
}

fn naive_share(sweeps: &[Sweep]) -> Claim {
    let numbers: Vec<String> = sweeps
        .iter()
        .map(|s| format!("{} %: {} objects", significant(100.0 * share(s)), s.published.objects))
        .collect();
    Claim {
        id: "A15",
        claim: "intersection takes up to 95 % of the time of naive ray tracing",
        rule: "on some scene tracing by brute force takes at least 95 % of the time of the whole render",
        verdict: Verdict::of(sweeps.iter().any(|s| share(s) >= 0.95)),
        numbers: numbers.join("; "),
    }
}

fn plot(sweeps: &[Sweep]) -> Plot {
    let line = |s: &Sweep| Line {
        name: format!("{} objects", s.published.objects),
        points: s
            .points
            .iter()
            .map(|p| (f64::from(p.subdivision), 1e9 * p.off.seconds / p.off.counts.rays as f64))
            .collect(),
    };
    Plot::Lines(Lines {
        title: "Time against subdivision".into(),
        subtitle: "Amanatides & Woo 1987, figure 3, on random spheres; plain grid without rayID, one thread".into(),
        x: "voxels on each axis".into(),
        y: "nanoseconds a ray".into(),
        lines: sweeps.iter().map(line).collect(),
    })
}
