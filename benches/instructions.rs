//! The hot loops, for callgrind to count their instructions: `.ci/instructions` runs this and compares.
//!
//! Every call of `hot_loop` traces the rays of one kind through one accelerator over one scene, once. A line on standard
//! output says which, in the order of the calls: scene,accelerator,kind,rays.

use skipgrid::accel::Accel;
use skipgrid::measure::{Query, RayOptions, RaySet, ray_sets};
use skipgrid::registry::ENTRIES;
use skipgrid::scene::{LoadOptions, load};
use std::hint::black_box;

/// Triangles and spheres, small enough for a program that runs fifty times as slowly as usual.
const SCENES: [&str; 2] = ["bumpy:n=40", "random:n=5000"];
/// Those that are in the registry. The nested grid in its portable form, as callgrind does not know all instructions of the other.
const ACCELS: [&str; 4] = ["grid", "grid-octant", "nested:isa=portable", "obvhs-cwbvh"];
/// Rows and columns of the film.
const SIDE: u32 = 32;

fn main() -> Result<(), skipgrid::Error> {
    for spec in SCENES {
        let scene = load(spec, &LoadOptions::default())?;
        let options = RayOptions { width: SIDE, height: SIDE, ..RayOptions::default() };
        let sets = ray_sets(&scene, &*scene.accel("grid")?, &options)?;
        for name in ACCELS.iter().filter(|name| ENTRIES.iter().any(|entry| name.split(':').next() == Some(entry.name)))
        {
            let accel = scene.accel(name)?;
            for set in &sets {
                black_box(hot_loop(&*accel, set));
                println!("{spec},{name},{},{}", set.kind.name(), set.rays.len());
            }
        }
    }
    Ok(())
}

/// What is counted. Not inlined, so that it can be found by its name.
#[inline(never)]
fn hot_loop(accel: &dyn Accel, set: &RaySet) -> u32 {
    match set.query {
        Query::Closest => set.rays.iter().filter_map(|ray| accel.closest_hit(ray)).fold(0, |sum, hit| sum ^ hit.prim),
        Query::Any => set.rays.iter().map(|ray| u32::from(accel.any_hit(ray))).sum(),
    }
}
