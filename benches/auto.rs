//! Whether `auto` chooses well: the time to an image with its choice, over that with the best of a list of fixed ones.
//!
//! `cargo bench --bench auto [-- SCENE..]`: the scenes of `reference/`, those of the catalogue of `skipgrid bench`, or any
//! others. An image is a build and a picture with direct light, shading included: 512 x 512 pixels of one sample, and 128 x
//! 128 of 64.

mod arguments;
mod clock;

use arguments::arguments;
use clock::seconds;
use skipgrid::Result;
use skipgrid::bench::{BenchScene, Source, select};
use skipgrid::render::{Sampler, Settings, render};
use skipgrid::scene::{LoadOptions, Scene, load};
use std::hint::black_box;
use std::path::Path;

/// What may be chosen, and what else a user would try.
const FIXED: [&str; 10] = [
    "brute",
    "grid",
    "grid:density=0.5",
    "nested",
    "nested:quality=fast",
    "voxels",
    "obvhs-bvh2:preset=fastest",
    "obvhs-bvh2",
    "obvhs-cwbvh:preset=fastest",
    "obvhs-cwbvh",
];

/// With more primitives than this brute force takes minutes.
const FEW: u32 = 500;

/// What takes so many times as long as the best in its first round is not asked again.
const HOPELESS: f64 = 3.0;

fn main() -> Result<()> {
    let (bench, mut names) = arguments();
    if names.is_empty() && !bench {
        names.push("cornell".into());
    }
    let (sizes, rounds) = if bench { ([512, 128], 3) } else { ([8, 2], 1) };
    println!(
        "| scene | primitives | 1 sample: auto | best | auto over best | 64 samples: auto | best | auto over best |"
    );
    println!("|---|---|---|---|---|---|---|---|");
    let (mut missed, mut images) = (0, 0);
    for (name, scene) in scenes(&names)? {
        let mut line = format!("| {name} | {} |", scene.primitive_count());
        for (size, spp) in [(sizes[0], 1), (sizes[1], 64)] {
            let settings = Settings {
                width: size,
                height: size,
                sampler: Sampler::Sobol(spp),
                max_depth: 2,
                threads: Some(1),
                ..Settings::default()
            };
            let spec = format!("auto:rays={}", settings.expected_rays(&scene));
            let (chosen, _) = scene.choose(&spec)?.expect("it is auto");
            let mut fixed: Vec<String> =
                FIXED.iter().filter(|spec| suits(spec, &scene)).map(|s| s.to_string()).collect();
            if !fixed.contains(&chosen) {
                fixed.push(chosen.clone());
            }
            let times = times(&scene, &fixed, &settings, rounds)?;
            let of_chosen = times[fixed.iter().position(|spec| *spec == chosen).expect("among them")];
            let best = (0..times.len()).min_by(|&a, &b| times[a].total_cmp(&times[b])).expect("not empty");
            let ratio = of_chosen / times[best];
            images += 1;
            missed += u32::from(ratio > 1.1);
            let mark = if ratio > 1.1 { "**" } else { "" };
            line += &format!(" {chosen} | {} | {mark}{ratio:.2}{mark} |", fixed[best]);
        }
        println!("{line}");
    }
    println!("\n{missed} of {images} images took more than 1.1 times as long as with the best.");
    Ok(())
}

/// Scenes by name: of the catalogue, files, or made by formula; all of `reference/` and of the catalogue if there are no names.
fn scenes(names: &[String]) -> Result<Vec<(String, Scene)>> {
    let shared = std::env::var("SKIPGRID_SHARED").unwrap_or_else(|_| "../shared".into());
    let mut scenes = Vec::new();
    if names.is_empty() {
        let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("reference/scenes");
        let mut files: Vec<_> = std::fs::read_dir(folder).into_iter().flatten().flatten().map(|e| e.path()).collect();
        files.retain(|file| file.extension().is_some_and(|e| e == "toml"));
        files.sort();
        for file in files {
            let name = file.file_stem().unwrap_or_default().to_string_lossy().into_owned();
            scenes.push((name, load(&file.to_string_lossy(), &LoadOptions::default())?));
        }
    }
    for scene in select(names)? {
        let BenchScene { name, source, view, .. } = &scene;
        let spec = scene.spec(&Path::new(&shared).join("scenes"));
        if matches!(source, Source::File(_)) && !Path::new(&spec).exists() {
            eprintln!("{name}: left out, {spec} is not there");
            continue;
        }
        let mut loaded = load(&spec, &LoadOptions::default())?;
        if let Some(view) = view {
            loaded.camera = view.camera();
        }
        scenes.push((name.clone(), loaded));
    }
    Ok(scenes)
}

fn suits(spec: &str, scene: &Scene) -> bool {
    match spec {
        "brute" => scene.primitive_count() <= FEW,
        "voxels" => scene.voxels().is_some(),
        _ => true,
    }
}

/// Seconds of the processor to an image with each, the least of some rounds; those that are hopeless have one.
fn times(scene: &Scene, specs: &[String], settings: &Settings, rounds: usize) -> Result<Vec<f64>> {
    let mut times = vec![f64::INFINITY; specs.len()];
    for round in 0..rounds {
        let best = times.iter().copied().fold(f64::INFINITY, f64::min);
        for i in 0..specs.len() {
            let i = (i + round) % specs.len();
            if round > 0 && times[i] > HOPELESS * best {
                continue;
            }
            let begin = seconds();
            let accel = scene.accel(&specs[i])?;
            black_box(render(scene, &*accel, settings, &|_, _| {})?);
            times[i] = times[i].min(seconds() - begin);
        }
    }
    Ok(times)
}
