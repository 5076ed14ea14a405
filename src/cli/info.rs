//! `skipgrid info`: what a scene holds and what an accelerator makes of it.

use super::Outcome;
use super::console::{Console, Format};
use super::document::document;
use super::input::{DEFAULT_ACCEL, SceneArgs, build, choose, usual_rays};
use super::table::{Table, short};
use crate::accel::Accel;
use crate::auto::Choice;
use crate::error::Result;
use crate::ray::Aabb;
use crate::scene::{Bsdf, CameraSource, Light, Scene, SceneGeometry};
use glam::Vec3;
use serde_json::{Value, json};
use std::time::Instant;

/// Show what a scene holds, and size and build time of an accelerator over it
#[derive(Debug, clap::Args)]
#[command(
    after_help = "Examples:\n  skipgrid info room.glb\n  skipgrid info random:n=10000 --accel grid:density=4\n  skipgrid info room.glb --rays 1e9"
)]
pub struct Args {
    #[command(flatten)]
    scene: SceneArgs,

    /// Accelerator, with options; see `skipgrid list`
    #[arg(long, value_name = "A", default_value = DEFAULT_ACCEL)]
    accel: String,

    /// Rays that `auto` is to reckon with; default: as `render` would send without options
    #[arg(long, value_name = "N", value_parser = parse_rays)]
    rays: Option<f64>,

    /// Form of the answer
    #[arg(long, value_enum, default_value_t)]
    format: Format,
}

/// A number of rays, at least 0.
fn parse_rays(text: &str) -> std::result::Result<f64, String> {
    text.parse().ok().filter(|r: &f64| r.is_finite() && *r >= 0.0).ok_or_else(|| "not a number of at least 0".into())
}

/// Prints the facts.
pub fn run(args: &Args, console: &Console) -> Result<Outcome> {
    let start = Instant::now();
    let scene = args.scene.load(console)?;
    let load_ms = start.elapsed().as_secs_f64() * 1e3;
    let rays = args.rays.unwrap_or_else(|| usual_rays(&scene));
    let (spec, choice) = choose(&args.scene.spec(&args.accel), &scene, rays)?;
    let start = Instant::now();
    let accel = build(&scene, &spec, console)?;
    let build_ms = start.elapsed().as_secs_f64() * 1e3;

    let facts = facts(&scene, (&spec, choice.as_ref()), &*accel, load_ms, build_ms);
    match args.format {
        Format::Text => {
            let width = facts.iter().map(|(name, _, _)| name.len()).max().unwrap_or(0);
            let lines = facts.iter().map(|(name, text, _)| format!("{name:<width$}  {text}\n"));
            console.data(&lines.collect::<String>())?;
        }
        Format::Json => {
            let map = facts.into_iter().map(|(name, _, value)| (name.replace(' ', "_"), value));
            console.json(&document("skipgrid.info/1", Value::Object(map.collect())))?;
        }
        Format::Csv => {
            let mut table = Table::new(&["<fact", "<value"]);
            facts.into_iter().for_each(|(name, text, _)| table.row(vec![name.to_string(), text]));
            console.data(&table.csv())?;
        }
    }
    Ok(Outcome::Done)
}

/// Name, text and JSON value of each fact.
type Fact = (&'static str, String, Value);

fn facts(
    scene: &Scene,
    (spec, choice): (&str, Option<&Choice>),
    accel: &dyn Accel,
    load_ms: f64,
    build_ms: f64,
) -> Vec<Fact> {
    let (triangles, spheres) = (scene.triangle_count(), scene.spheres.len());
    let mut facts: Vec<Fact> = vec![("scene", scene.name.clone(), json!(scene.name))];
    let mut count = |name, n: usize| facts.push((name, n.to_string(), json!(n)));
    count("triangles", triangles as usize);
    count("spheres", spheres);
    if !scene.patch_materials.is_empty() {
        count("patches", scene.patch_materials.len());
    }
    count("meshes", scene.meshes.len());
    if let Some(voxels) = scene.voxels() {
        // Below 2^32.
        count("solid voxels", voxels.solid_voxels() as usize);
        let size = voxels.resolution();
        facts.push(("voxels", size.map(|n| n.to_string()).join(" x "), json!(size)));
    }
    let mut count = |name, n: usize| facts.push((name, n.to_string(), json!(n)));
    count("textures", scene.textures.len());

    let materials = tally(scene.materials.iter().map(|m| match m.bsdf {
        Bsdf::Lambert { .. } => "lambert",
        Bsdf::Mirror { .. } => "mirror",
        Bsdf::Dielectric { .. } => "dielectric",
        Bsdf::Conductor { .. } => "conductor",
    }));
    facts.push(("materials", in_words(&materials), tally_json(&materials)));
    let emissive = scene.materials.iter().filter(|m| m.emission != Vec3::ZERO).count();
    facts.push(("emissive materials", emissive.to_string(), json!(emissive)));
    let lights = tally(scene.lights.iter().map(|light| match light {
        Light::Point { .. } => "point",
        Light::Spot { .. } => "spot",
        Light::Directional { .. } => "directional",
    }));
    facts.push(("lights", in_words(&lights), tally_json(&lights)));
    let environment = scene.environment.to_array();
    facts.push(("environment", format!("{environment:?}"), json!(environment)));

    let Aabb { min, max } = accel.bounds();
    let (text, value) = if accel.bounds().is_empty() {
        ("empty".to_string(), Value::Null)
    } else {
        let (min, max) = (min.to_array(), max.to_array());
        (format!("{min:?} to {max:?}"), json!({ "min": min, "max": max }))
    };
    facts.push(("extent", text, value));

    let camera = &scene.camera;
    let source = if camera.source == CameraSource::File { "from the scene" } else { "framed" };
    let [origin, target, up] = [camera.origin, camera.target, camera.up].map(|v| v.to_array());
    facts.push((
        "camera",
        format!("{source}: origin {origin:?}, target {target:?}, up {up:?}, yfov {:?}", camera.yfov),
        json!({ "source": source, "origin": origin, "target": target, "up": up, "yfov": camera.yfov }),
    ));

    let memory = accel.memory();
    facts.push(("accelerator", spec.to_string(), json!(spec)));
    if let Some(choice) = choice {
        facts.push(("chosen", choice.reason(), json!(choice.reason())));
    }
    let built = accel.describe();
    if !built.is_empty() {
        facts.push(("built", built.clone(), json!(built)));
    }
    facts.push(("load ms", short(load_ms), json!(load_ms)));
    facts.push(("build ms", short(build_ms), json!(build_ms)));
    for (name, bytes) in [
        ("structure bytes", memory.structure),
        ("reference bytes", memory.references),
        ("skip table bytes", memory.tables),
        ("bytes", memory.total()),
    ] {
        facts.push((name, bytes.to_string(), json!(bytes)));
    }
    let mut left_out = left_out(scene);
    if let Some(choice) = choice {
        left_out.extend(choice.left_out());
    } else if memory.tables == 0 {
        left_out.push("skip table: this accelerator has none".to_string());
    }
    facts.push(("left out", left_out.join("; "), json!(left_out)));
    facts
}

/// What this scene makes unnecessary, with the reason.
pub(super) fn left_out(scene: &Scene) -> Vec<String> {
    let mut left_out = Vec::new();
    match scene.geometry {
        SceneGeometry::Triangles(_) => left_out.push("sphere test: the scene has triangles only".to_string()),
        SceneGeometry::Spheres(_) => left_out.push("triangle test: the scene has spheres only".to_string()),
        SceneGeometry::Mixed(_) => {}
        SceneGeometry::Voxels(_) => left_out.push("sphere test: the scene has voxels only".to_string()),
        SceneGeometry::Patches(_) => {
            left_out.push("triangle and sphere tests: the scene has patches only".to_string());
        }
    }
    let materials = scene.materials.len();
    if scene.textures.is_empty() {
        left_out.push(format!("texture look-up: none of {materials} materials has a texture"));
    }
    if scene.materials.iter().all(|m| m.emission == Vec3::ZERO) {
        left_out.push(format!("area lights: none of {materials} materials emits"));
    }
    if !scene.has_point_lights() {
        let lights = scene.lights.len();
        left_out.push(format!("shadow voxels: none of {lights} lights is a point or a spot"));
    }
    left_out
}

/// Names with their numbers, in order of first appearance.
fn tally<'a>(names: impl Iterator<Item = &'a str>) -> Vec<(&'a str, usize)> {
    let mut counts: Vec<(&str, usize)> = Vec::new();
    for name in names {
        match counts.iter_mut().find(|(known, _)| *known == name) {
            Some((_, n)) => *n += 1,
            None => counts.push((name, 1)),
        }
    }
    counts
}

fn in_words(counts: &[(&str, usize)]) -> String {
    if counts.is_empty() {
        return "none".to_string();
    }
    counts.iter().map(|(name, n)| format!("{n} {name}")).collect::<Vec<_>>().join(", ")
}

fn tally_json(counts: &[(&str, usize)]) -> Value {
    Value::Object(counts.iter().map(|&(name, n)| (name.to_string(), json!(n))).collect())
}
