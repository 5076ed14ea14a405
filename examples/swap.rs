//! A tracer of one's own, ambient occlusion, that takes any accelerator: chosen by its type, or at run time by its name.

use glam::{Vec2, Vec3};
use skipgrid::grid::{Grid, GridOptions};
use skipgrid::{Accel, Ray, Sphere, registry};

/// The share of the sky that is seen from `point`, by rays that spread around `normal`.
fn sky<A: Accel + ?Sized>(accel: &A, point: Vec3, normal: Vec3) -> f32 {
    const RAYS: u32 = 32;
    let free = (0..RAYS).filter(|&i| {
        // A cosine distribution: unit normal plus a point of the unit sphere, here along a spiral.
        let z = 1.0 - (2 * i + 1) as f32 / RAYS as f32;
        let around = Vec2::from_angle(2.399_963 * i as f32) * (1.0 - z * z).sqrt();
        !accel.any_hit(&Ray::new(point + normal * 1e-3, normal + around.extend(z)))
    });
    free.count() as f32 / RAYS as f32
}

/// A picture in characters, seen along -z.
fn picture<A: Accel + ?Sized>(accel: &A, spheres: &[Sphere]) -> String {
    let (width, height) = (64, 28);
    let mut out = String::new();
    for y in 0..height {
        for x in 0..width {
            let film = Vec2::new(x as f32 / width as f32 - 0.5, 0.5 - y as f32 / height as f32) * 9.0;
            let ray = Ray::new(film.extend(9.0), Vec3::NEG_Z);
            out.push(accel.closest_hit(&ray).map_or(' ', |hit| {
                let point = ray.at(f64::from(hit.t)).as_vec3();
                let light = sky(accel, point, (point - spheres[hit.prim as usize].centre).normalize());
                ['#', '%', '*', '+', ':', '.'][((light * 6.0) as usize).min(5)]
            }));
        }
        out.push('\n');
    }
    out
}

fn main() -> skipgrid::Result<()> {
    let spheres: Vec<Sphere> = (0..300)
        .map(|i| {
            let angle = i as f32 * 0.37;
            let centre = Vec3::new(angle.cos() * 3.0, angle.sin() * 3.0, (i as f32 * 1.7).sin());
            Sphere { centre, radius: 0.2 + 0.4 * (i as f32 * 0.9).sin().abs() }
        })
        .collect();
    // By type: the tracer is compiled for this accelerator, and no call is virtual.
    let by_type = picture(&Grid::build(&spheres[..], &GridOptions::default())?, &spheres);
    println!("{by_type}");

    // At run time: one virtual call for each ray.
    let suiting = registry::ENTRIES.iter().filter(|entry| entry.exact && entry.suits(&spheres));
    let mut swapped = 0;
    for name in suiting.map(|entry| entry.name) {
        let accel: Box<dyn Accel> = registry::build(name, spheres.clone())?;
        assert_eq!(picture(&accel, &spheres), by_type, "{name}");
        swapped += 1;
    }
    println!("the same from all {swapped} exact accelerators");
    Ok(())
}
