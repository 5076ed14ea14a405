//! What the obvhs adapters cost against obvhs used as its authors intend: with its own triangle test over triangles in leaf
//! order. The adapters run the exact test instead and pad boxes; this prints by how much that slows rays down.
//!
//! `cargo run --release --example obvhs_overhead [SCENE]`: a scene file of triangles, or two made-up ones.

use glam::Vec3;
use obvhs::BvhBuildParams;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::{Ray as NativeRay, RayHit};
use obvhs::rt_triangle::RtTriangle;
use skipgrid::{Accel, Ray, Triangle, registry};
use std::hint::black_box;
use std::time::{Duration, Instant};

const ROUNDS: usize = 9;

fn main() -> Result<(), Box<dyn std::error::Error>> {
    println!("time of the adapter / time of obvhs itself; median and range of {ROUNDS} interleaved rounds, one thread");
    println!("{:<24} {:<8} {:<8} {:>7}  range", "scene", "tree", "rays", "ratio");
    match std::env::args().nth(1) {
        Some(path) => {
            let scene = skipgrid::scene::load(&path, &Default::default())?;
            let skipgrid::scene::SceneGeometry::Triangles(triangles) = &scene.geometry else {
                return Err("obvhs' own test is for triangles; the scene has spheres".into());
            };
            measure(&scene.name, triangles)?;
        }
        None => {
            measure("bumpy sphere, 180k", &bumpy_sphere(300))?;
            measure("triangle soup, 50k", &soup(50_000))?;
        }
    }
    Ok(())
}

fn measure(name: &str, triangles: &[Triangle]) -> Result<(), Box<dyn std::error::Error>> {
    let native: Vec<obvhs::triangle::Triangle> = triangles
        .iter()
        .map(|&[a, b, c]| obvhs::triangle::Triangle { v0: a.into(), v1: b.into(), v2: c.into() })
        .collect();
    let in_order = |order: &[u32]| order.iter().map(|&i| RtTriangle::from(&native[i as usize])).collect::<Vec<_>>();
    let cw = build_cwbvh_from_tris(&native, BvhBuildParams::medium_build(), &mut Duration::default());
    let cw_triangles = in_order(&cw.primitive_indices);
    let b2 = build_bvh2_from_tris(&native, BvhBuildParams::medium_build(), &mut Duration::default());
    let b2_triangles = in_order(&b2.primitive_indices);
    let adapted_cw = registry::build("obvhs-cwbvh", triangles)?;
    let adapted_b2 = registry::build("obvhs-bvh2", triangles)?;
    for (kind, rays) in rays(&*adapted_cw) {
        let native = |r: &Ray| NativeRay::new(r.origin.into(), r.direction.into(), 0.0, f32::INFINITY);
        report(
            name,
            "cwbvh",
            kind,
            || trace(&rays, |r| adapted_cw.closest_hit(r).is_some()),
            || trace(&rays, |r| cw.ray_traverse(native(r), &mut RayHit::none(), |r, id| cw_triangles[id].intersect(r))),
        );
        report(
            name,
            "bvh2",
            kind,
            || trace(&rays, |r| adapted_b2.closest_hit(r).is_some()),
            || trace(&rays, |r| b2.ray_traverse(native(r), &mut RayHit::none(), |r, id| b2_triangles[id].intersect(r))),
        );
    }
    Ok(())
}

fn trace(rays: &[Ray], hit: impl Fn(&Ray) -> bool) -> Duration {
    let start = Instant::now();
    black_box(rays.iter().filter(|r| hit(r)).count());
    start.elapsed()
}

fn report(name: &str, tree: &str, kind: &str, ours: impl Fn() -> Duration, theirs: impl Fn() -> Duration) {
    let mut ratios: Vec<f64> = (0..ROUNDS).map(|_| ours().as_secs_f64() / theirs().as_secs_f64()).collect();
    ratios.sort_by(f64::total_cmp);
    let (min, median, max) = (ratios[0], ratios[ROUNDS / 2], ratios[ROUNDS - 1]);
    println!("{name:<24} {tree:<8} {kind:<8} {median:>7.3}  {min:.3}..{max:.3}");
}

/// Rays of a camera, and rays in all directions from where those hit.
fn rays(accel: &dyn Accel) -> [(&'static str, Vec<Ray>); 2] {
    let bounds = accel.bounds();
    let centre = (bounds.min + bounds.max) * 0.5;
    let eye = centre + bounds.extent().length() * Vec3::new(0.5, 0.4, 0.8);
    let forward = (centre - eye).normalize();
    let right = forward.cross(Vec3::Y).normalize();
    let up = right.cross(forward);
    let (width, height) = (384, 256);
    let camera: Vec<Ray> = (0..width * height)
        .map(|i| {
            let (x, y) = ((i % width) as f32 / width as f32 - 0.5, (i / width) as f32 / height as f32 - 0.5);
            Ray::new(eye, forward + x * 1.05 * right - y * 0.7 * up)
        })
        .collect();
    let mut random = Random(7);
    let bounce = camera
        .iter()
        .filter_map(|r| accel.closest_hit(r).map(|hit| r.origin + (hit.t * 0.9999) * r.direction))
        .map(|p| Ray::new(p, random.in_cube()))
        .collect();
    [("camera", camera), ("bounce", bounce)]
}

fn bumpy_sphere(n: usize) -> Vec<Triangle> {
    let at = |i: usize, j: usize| {
        let (u, v) = (i as f32 / n as f32 * std::f32::consts::TAU, j as f32 / n as f32 * std::f32::consts::PI);
        Vec3::new(u.cos() * v.sin(), v.cos(), u.sin() * v.sin()) * (0.8 + 0.1 * (9.0 * u).sin() * (7.0 * v).sin())
    };
    (0..n * n)
        .flat_map(|k| {
            let (i, j) = (k % n, k / n);
            let [a, b, c, d] = [at(i, j), at(i + 1, j), at(i + 1, j + 1), at(i, j + 1)];
            [[a, b, c], [a, c, d]]
        })
        .collect()
}

fn soup(n: usize) -> Vec<Triangle> {
    let mut random = Random(1);
    let mut triangle = || {
        let p = random.in_cube();
        [p, p + 0.05 * random.in_cube(), p + 0.05 * random.in_cube()]
    };
    (0..n).map(|_| triangle()).collect()
}

/// SplitMix64.
struct Random(u64);

impl Random {
    fn signed(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / (1 << 23) as f32 - 1.0
    }

    fn in_cube(&mut self) -> Vec3 {
        Vec3::new(self.signed(), self.signed(), self.signed())
    }
}
