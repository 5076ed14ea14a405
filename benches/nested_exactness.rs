//! What exact answers cost in the nested grid: its time over that of the same structure with a plain test of triangles in f32.
//!
//! `cargo bench --bench nested_exactness [-- SCENE..]`: scenes of triangles, of the catalogue of `skipgrid bench` or any others.

mod arguments;
mod clock;

use arguments::arguments;
use clock::seconds;
use skipgrid::bench::{Source, geomean, select};
use skipgrid::measure::{Query, RayOptions, ray_sets};
use skipgrid::nested::{Nested, NestedOptions};
use skipgrid::scene::{LoadOptions, SceneGeometry, load};
use skipgrid::{Accel, Ray, Result};
use std::hint::black_box;
use std::path::Path;

fn main() -> Result<()> {
    let (bench, mut names) = arguments();
    if names.is_empty() {
        names = if bench { vec!["triangles".into(), "overlapping".into()] } else { vec!["bumpy:n=8".into()] };
    }
    let (side, rounds) = if bench { (128, 7) } else { (8, 1) };
    let shared = std::env::var("SKIPGRID_SHARED").unwrap_or_else(|_| "../shared".into());
    let mut times: Vec<(&str, Vec<f64>)> = Vec::new();
    println!("scene\trays\tns exact\tns f32\texact over f32\tother answers");
    for scene in select(&names)? {
        let spec = scene.spec(&Path::new(&shared).join("scenes"));
        if matches!(scene.source, Source::File(_)) && !Path::new(&spec).exists() {
            println!("{}: left out, {spec} is not there", scene.name);
            continue;
        }
        let mut loaded = load(&spec, &LoadOptions::default())?;
        if let Some(view) = &scene.view {
            loaded.camera = view.camera();
        }
        let SceneGeometry::Triangles(triangles) = &loaded.geometry else {
            println!("{}: left out, not all of it are triangles", scene.name);
            continue;
        };
        let nested = Nested::build(triangles.clone(), &NestedOptions::default())?;
        let options = RayOptions { width: side, height: side, seed: 1, max_rays: (side * side) as usize };
        for set in ray_sets(&loaded, &nested, &options)? {
            let closest = set.query == Query::Closest;
            let differs = |ray: &&Ray| {
                if closest {
                    nested.closest_hit_rounded(ray).map(|hit| hit.prim) != nested.closest_hit(ray).map(|hit| hit.prim)
                } else {
                    nested.any_hit_rounded(ray) != nested.any_hit(ray)
                }
            };
            let others = set.rays.iter().filter(differs).count();
            let mut took = [Vec::new(), Vec::new()];
            for round in 0..rounds {
                for which in [round % 2, 1 - round % 2] {
                    let begin = seconds();
                    for ray in &set.rays {
                        match (which, closest) {
                            (0, true) => _ = black_box(nested.closest_hit(black_box(ray))),
                            (0, false) => _ = black_box(nested.any_hit(black_box(ray))),
                            (_, true) => _ = black_box(nested.closest_hit_rounded(black_box(ray))),
                            (_, false) => _ = black_box(nested.any_hit_rounded(black_box(ray))),
                        }
                    }
                    took[which].push((seconds() - begin) * 1e9 / set.rays.len().max(1) as f64);
                }
            }
            let [exact, plain] = took.map(|mut times| {
                times.sort_by(f64::total_cmp);
                times[times.len() / 2]
            });
            let (kind, ratio) = (set.kind.name(), exact / plain);
            println!("{}\t{kind}\t{exact:.1}\t{plain:.1}\t{ratio:.3}\t{others} of {}", scene.name, set.rays.len());
            match times.iter_mut().find(|(name, _)| *name == kind) {
                Some((_, ratios)) => ratios.push(ratio),
                None => times.push((kind, vec![ratio])),
            }
        }
    }
    for (kind, ratios) in &times {
        println!("geometric mean\t{kind}\t\t\t{:.3}", geomean(ratios.iter().copied()));
    }
    Ok(())
}
