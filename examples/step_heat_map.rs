//! The work of each ray as a picture, for several accelerators on one scale: `step_heat_map [PICTURE.png]`.

use skipgrid::accel::Counts;
use skipgrid::picture::{Picture, falsecolour, io};
use skipgrid::scene::{self, LoadOptions};
use skipgrid::{Accel, Ray};

const SIZE: u32 = 128;
const ACCELERATORS: [&str; 4] = ["grid:resolution=64", "grid-dsz:resolution=64", "grid-octant:resolution=64", "nested"];

fn main() -> skipgrid::Result<()> {
    let scene = scene::load("lanes", &LoadOptions::default())?;
    // Side by side, steps in the first channel.
    let width = SIZE * ACCELERATORS.len() as u32;
    let mut work = Picture::new(width, SIZE);
    let mut hits = Vec::new();
    for (column, spec) in (0..).zip(ACCELERATORS) {
        let accel: Box<dyn Accel> = scene.accel(spec)?;
        let mut all = Counts::default();
        let mut found = Vec::new();
        for (x, y) in (0..SIZE).flat_map(|y| (0..SIZE).map(move |x| (x, y))) {
            let direction = scene.camera.direction(f64::from(x) + 0.5, f64::from(y) + 0.5, SIZE, SIZE);
            let ray = Ray::new(scene.camera.origin.as_vec3(), direction.as_vec3());
            let mut counts = Counts::default();
            found.push(accel.closest_hit_counted(&ray, &mut counts));
            work.pixels[(y * width + column * SIZE + x) as usize][0] = counts.steps as f32;
            all += counts;
        }
        let each = |n: u64| n as f64 / all.rays as f64;
        println!(
            "{spec:<26} {:6.2} steps, {:5.2} leaps, {:5.2} tests a ray",
            each(all.steps),
            each(all.leaps),
            each(all.tests)
        );
        hits.push(found);
    }
    assert!(hits.iter().all(|found| *found == hits[0]), "all answers are the same");

    let most = work.pixels.iter().map(|p| p[0]).fold(0.0, f32::max);
    match std::env::args().nth(1) {
        Some(path) => io::write(path, &falsecolour::counts(&work, 0, most), &io::Attributes::default()),
        None => {
            // In characters, every fourth pixel across and every eighth down.
            for y in (0..SIZE).step_by(8) {
                let level = |x: u32| work.pixels[(y * width + x) as usize][0].ln_1p() / most.ln_1p();
                let row: String =
                    (0..width).step_by(4).map(|x| b" .:-=+*#%@"[(level(x) * 9.99) as usize] as char).collect();
                println!("{row}");
            }
            Ok(())
        }
    }
}
