//! Amanatides & Woo 1987, last section: two bits for each light and voxel that spare shadow rays. How many, and in what time?

use super::plot::{Dots, Panel, Plot};
use super::report::{Cell, Claim, Report, Table, Verdict, significant};
use super::{PLAIN, Watch};
use crate::accel::Accel;
use crate::error::{Error, Result};
use crate::measure::Machine;
use crate::measure::rounds::in_turns;
use crate::render::{Film, Integrator, RenderStats, SHADOW_DENSITY, Sampler, Settings, render};
use crate::scene::{Light, LoadOptions, Scene, load};
use glam::{DVec3, Vec3};
use std::time::Instant;

/// What to measure.
#[derive(Clone, Debug, PartialEq)]
pub struct Options {
    /// Rows and columns of the pictures, above 0.
    pub size: u32,
    /// Timed rounds, at least 1.
    pub rounds: u32,
    /// Scenes; none: [`SCENES`].
    pub scenes: Vec<String>,
}

/// Spheres close together and far apart, flat and curved meshes, large triangles.
pub const SCENES: [&str; 7] = ["random:n=1000", "lanes", "flakes:depth=4", "cars", "teapot", "cubes", "cornell"];

/// Numbers of lights.
const LIGHTS: [usize; 3] = [1, 4, 16];

/// Voxels for each primitive.
const DENSITIES: [f64; 4] = [2.0, SHADOW_DENSITY, 64.0, 256.0];

/// One scene with one number of lights.
struct Measured {
    scene: String,
    lights: usize,
    described: String,
    bytes: u64,
    build: f64,
    /// Seconds for the picture without and with the bits; setting the bits is part of the latter.
    seconds: [f64; 2],
    spread: f64,
    plain: RenderStats,
    asked: RenderStats,
    wrong: u64,
}

impl Measured {
    fn share(&self, rays: u64) -> f64 {
        rays as f64 / self.plain.shadow.max(1) as f64
    }

    /// Seconds that the bits save while the picture is made, without those for setting them.
    fn saved(&self) -> f64 {
        self.seconds[0] - (self.seconds[1] - self.build)
    }
}

/// Measures everything.
///
/// # Errors
/// No round; an unknown scene; a structure beyond its memory budget; the picture's size is 0.
pub fn run(options: &Options, watch: &Watch) -> Result<Report> {
    if options.rounds == 0 {
        return Err(Error::invalid("nothing to measure: 0 rounds"));
    }
    let scenes: Vec<String> = match options.scenes[..] {
        [] => SCENES.map(String::from).to_vec(),
        _ => options.scenes.clone(),
    };
    let (mut measured, mut finer) = (Vec::new(), Vec::new());
    let stages = LIGHTS.len() + 1;
    for (i, name) in scenes.iter().enumerate() {
        for (j, lights) in LIGHTS.into_iter().enumerate() {
            watch(i * stages + j, scenes.len() * stages, &format!("{name}, lights: {lights}"));
            measured.push(measure(name, lights, options)?);
        }
        watch((i + 1) * stages - 1, scenes.len() * stages, &format!("{name}, finer voxels"));
        finer.extend(sweep(name)?);
    }
    Ok(report(options, &measured, &finer))
}

fn measure(name: &str, lights: usize, options: &Options) -> Result<Measured> {
    let mut scene = load(name, &LoadOptions::default())?;
    let accel = scene.accel(PLAIN)?;
    let places = places(&scene, &*accel, lights);
    let reach = f64::from(accel.bounds().extent().length_squared()) as f32;
    let light = |&position: &DVec3| Light::Point { position, intensity: Vec3::splat(reach / lights as f32) };
    scene.lights = places.iter().map(light).collect();
    let start = Instant::now();
    let shadows = scene.shadow_voxels(&places, SHADOW_DENSITY)?;
    let build = start.elapsed().as_secs_f64();

    let picture = |on: bool| render(&scene, &*accel, &settings(options.size, on), &|_, _| {});
    let [plain, asked] = [picture(false)?, picture(true)?];
    // Rendered before: the pictures can fail only as they did then.
    let paces = in_turns(2, options.rounds, |i| drop(picture(i == 1)));
    Ok(Measured {
        scene: name.to_string(),
        lights,
        described: shadows.describe(),
        bytes: shadows.memory().tables,
        build,
        seconds: [1.0 / paces[0].per_second, 1.0 / paces[1].per_second],
        spread: paces[0].spread.max(paces[1].spread),
        wrong: differing(&plain, &asked),
        plain: plain.stats,
        asked: asked.stats,
    })
}

/// Four lights and voxels of one density.
struct Finer {
    scene: String,
    density: f64,
    bytes: u64,
    build: f64,
    described: String,
}

fn sweep(name: &str) -> Result<Vec<Finer>> {
    let scene = load(name, &LoadOptions::default())?;
    let places = places(&scene, &*scene.accel(PLAIN)?, 4);
    let build = |density: f64| {
        let start = Instant::now();
        let shadows = scene.shadow_voxels(&places, density)?;
        let build = start.elapsed().as_secs_f64();
        let bytes = shadows.memory().tables;
        Ok(Finer { scene: name.to_string(), density, bytes, build, described: shadows.describe() })
    };
    DENSITIES.into_iter().map(build).collect()
}

/// Pixels that differ in any bit.
fn differing(a: &Film, b: &Film) -> u64 {
    let bits = |v: &DVec3| v.to_array().map(f64::to_bits);
    a.sum.iter().zip(&b.sum).filter(|(x, y)| bits(x) != bits(y)).count() as u64
}

/// Whitted's method, four samples a pixel, on one thread, as every experiment here.
fn settings(size: u32, on: bool) -> Settings {
    let sampler = Sampler::Regular(2);
    let settings = super::trace::settings(size);
    Settings { integrator: Integrator::Whitted, sampler, shadow_voxels: Some(on), ..settings }
}

/// Lights on a half sphere above the scene, evenly spread; within the room of Cornell's box.
fn places(scene: &Scene, accel: &dyn Accel, lights: usize) -> Vec<DVec3> {
    let bounds = accel.bounds();
    let centre = (0.5 * (bounds.min + bounds.max)).as_dvec3();
    let closed = scene.name.starts_with("cornell");
    let reach = f64::from(bounds.extent().length()) * if closed { 0.2 } else { 0.8 };
    let up = scene.camera.up.abs().max_position();
    let golden = std::f64::consts::PI * (3.0 - 5.0_f64.sqrt());
    let place = |i: usize| {
        let height = 0.25 + 0.7 * (i as f64 + 0.5) / lights as f64;
        let (sine, cosine) = (golden * i as f64).sin_cos();
        let mut way = DVec3::splat((1.0 - height * height).sqrt());
        way[up] = height;
        way[(up + 1) % 3] *= cosine;
        way[(up + 2) % 3] *= sine;
        centre + reach * way
    };
    (0..lights).map(place).collect()
}

fn report(options: &Options, measured: &[Measured], finer: &[Finer]) -> Report {
    Report {
        paper: "shadow-voxels",
        title: "Amanatides & Woo 1987, last section: two bits for each light and voxel",
        machine: Machine::this(),
        settings: vec![
            ("size", format!("{0} x {0} pixels, four samples each", options.size)),
            ("rounds", options.rounds.to_string()),
            ("density", format!("{SHADOW_DENSITY} voxels a primitive")),
        ],
        notes: [
            "Point lights stand on a half sphere above the scene (within the box of cornell), instead of the scene's own. \
             The accelerator is the plain grid; one thread renders, and as many as there are cores set the bits.",
            "A bit is set only where it is proved, so the pictures must be equal to the bit: `wrong pixels` counts those that \
             are not. A ray is spared if its voxel is surely lit or surely dark, and shortened if nothing but what lies in its \
             voxel and the neighbours can be in its way.",
            "Seconds with the bits include those for setting them; `saved us/ray` leaves these out. `pays from` is the number \
             of pictures of this size and number of samples from which on the bits take less time than they save.",
        ]
        .map(String::from)
        .to_vec(),
        claims: vec![spares(measured), pays(measured)],
        tables: vec![table(measured), built(measured), densities(finer)],
        plot: plot(measured),
        wrong: measured.iter().map(|m| m.wrong).sum(),
    }
}

fn spares(measured: &[Measured]) -> Claim {
    let shares = measured.iter().map(|m| m.share(m.asked.spared));
    let numbers = measured
        .iter()
        .map(|m| format!("{} with {}: {} %", m.scene, m.lights, significant(100.0 * m.share(m.asked.spared))));
    Claim {
        id: "A11",
        claim: "two bits a voxel and light spare shadow rays",
        rule: "a tenth of the shadow rays or more are spared on every scene",
        verdict: Verdict::of(shares.fold(f64::INFINITY, f64::min) >= 0.1),
        numbers: numbers.collect::<Vec<_>>().join(", "),
    }
}

fn pays(measured: &[Measured]) -> Claim {
    let holds = measured.iter().all(|m| m.seconds[1] < m.seconds[0]);
    let numbers =
        measured.iter().map(|m| format!("{} with {}: {}", m.scene, m.lights, significant(m.seconds[0] / m.seconds[1])));
    Claim {
        id: "A11t",
        claim: "they save time",
        rule: "a picture takes less time with the bits than without on every scene, setting them included",
        verdict: Verdict::of(holds),
        numbers: format!("speed with over without: {}", numbers.collect::<Vec<_>>().join(", ")),
    }
}

fn table(measured: &[Measured]) -> Table {
    let mut table = Table::new(
        "shadow",
        "Shadow rays spared and time, by number of lights",
        &[
            "<scene",
            "lights",
            "shadow rays",
            "spared %",
            "shortened %",
            "time s without",
            "time s with",
            "spread %",
            "setting the bits s",
            "saved us/ray",
            "pays from",
            "wrong pixels",
        ],
    );
    for m in measured {
        let saved = m.saved();
        let cells: [Cell; 12] = [
            m.scene.as_str().into(),
            (m.lights as u64).into(),
            m.plain.shadow.into(),
            (100.0 * m.share(m.asked.spared)).into(),
            (100.0 * m.share(m.asked.shortened)).into(),
            m.seconds[0].into(),
            m.seconds[1].into(),
            (100.0 * m.spread).into(),
            m.build.into(),
            (1e6 * saved / m.plain.shadow as f64).into(),
            if saved > 0.0 { (m.build / saved).into() } else { f64::NAN.into() },
            m.wrong.into(),
        ];
        table.row(cells);
    }
    table
}

fn built(measured: &[Measured]) -> Table {
    let mut table = Table::new("bits", "What is known of the voxels", &["<scene", "lights", "bytes", "<voxels"]);
    for m in measured {
        let cells: [Cell; 4] =
            [m.scene.as_str().into(), (m.lights as u64).into(), m.bytes.into(), m.described.as_str().into()];
        table.row(cells);
    }
    table
}

fn densities(finer: &[Finer]) -> Table {
    let columns = ["<scene", "voxels/primitive", "bytes", "setting the bits s", "<voxels"];
    let mut table = Table::new("density", "The smaller the voxels the more of them are decided: four lights", &columns);
    for f in finer {
        let cells: [Cell; 5] =
            [f.scene.as_str().into(), f.density.into(), f.bytes.into(), f.build.into(), f.described.as_str().into()];
        table.row(cells);
    }
    table
}

fn plot(measured: &[Measured]) -> Plot {
    let panel = |rows: &[Measured]| Panel {
        title: format!("{}: relative to no bits", rows[0].scene),
        rows: rows
            .iter()
            .map(|m| {
                let traced = 1.0 - m.share(m.asked.spared);
                let without = (m.seconds[1] - m.build) / m.seconds[0];
                (format!("lights: {}", m.lights), vec![m.seconds[1] / m.seconds[0], without, traced])
            })
            .collect(),
    };
    Plot::Dots(Dots {
        title: "Shadow voxels: time and shadow rays, relative to none".into(),
        subtitle: "Whitted pictures with point lights; logarithmic scales; left is better".into(),
        series: vec!["time".into(), "time without setting the bits".into(), "shadow rays traced".into()],
        panels: measured.chunks(LIGHTS.len()).map(panel).collect(),
        columns: 3,
    })
}
