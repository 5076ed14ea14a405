//! The path tracer against closed forms.

mod path;
mod same;
mod whitted;

use glam::{DVec3, Vec3};
use skipgrid::picture::Picture;
use skipgrid::render::{Film, Integrator, Sampler, Settings, render};
use skipgrid::scene::{Bsdf, Camera, CameraSource, Material, Mesh, Scene, SceneParts};

/// A camera at `origin` that looks at `target` with a vertical field of view of `yfov` degrees.
fn camera(origin: [f64; 3], target: [f64; 3], yfov: f64) -> Option<Camera> {
    let (origin, target) = (DVec3::from(origin), DVec3::from(target));
    // Not parallel to any view of these tests.
    let up = DVec3::new(0.123, 1.0, 0.0456);
    Some(Camera { origin, target, up, yfov, source: CameraSource::File })
}

/// A camera whose pixels all show nearly the same point.
fn probe(origin: [f64; 3], target: [f64; 3]) -> Option<Camera> {
    camera(origin, target, 1e-4)
}

fn lambert(albedo: f32) -> Material {
    shining(albedo, Vec3::ZERO)
}

fn shining(albedo: f32, emission: Vec3) -> Material {
    Material { name: String::new(), bsdf: Bsdf::Lambert { albedo: Vec3::splat(albedo), texture: None }, emission }
}

fn of(bsdf: Bsdf) -> Material {
    Material { name: String::new(), bsdf, emission: Vec3::ZERO }
}

/// The square |x|, |y| <= `half` at height `z`; its front looks up or down.
fn square(half: f32, z: f32, up: bool, material: u32) -> Mesh {
    let corners = [(-half, -half), (half, -half), (half, half), (-half, half)];
    Mesh {
        positions: corners.map(|(x, y)| Vec3::new(x, y, z)).to_vec(),
        triangles: if up { vec![[0, 1, 2], [0, 2, 3]] } else { vec![[0, 2, 1], [0, 3, 2]] },
        material,
        ..Mesh::default()
    }
}

/// The box from `min` to `max`; the fronts of its faces look outwards or inwards.
fn cuboid(min: [f32; 3], max: [f32; 3], outwards: bool, material: u32) -> Mesh {
    let pick = |bit: u32, axis: usize, i: u32| if i >> bit & 1 == 1 { max[axis] } else { min[axis] };
    let positions = (0..8).map(|i| Vec3::new(pick(0, 0, i), pick(1, 1, i), pick(2, 2, i))).collect();
    let faces = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    let turn = |[a, b, c]: [u32; 3]| if outwards { [a, b, c] } else { [a, c, b] };
    let triangles = faces.iter().flat_map(|&[a, b, c, d]| [turn([a, b, c]), turn([a, c, d])]).collect();
    Mesh { positions, triangles, material, ..Mesh::default() }
}

fn scene(parts: SceneParts) -> Scene {
    Scene::new(parts).expect("a valid scene")
}

fn settings(integrator: Integrator, size: u32, sampler: Sampler, max_depth: u32) -> Settings {
    Settings { integrator, width: size, height: size, sampler, max_depth, threads: Some(1), ..Settings::default() }
}

fn film(scene: &Scene, settings: &Settings) -> Film {
    let accel = scene.accel("brute").expect("brute exists");
    render(scene, &accel, settings, &|_, _| ()).expect("usable settings")
}

/// One pixel by one sample.
fn pixel(scene: &Scene, integrator: Integrator, max_depth: u32) -> [f64; 3] {
    film(scene, &settings(integrator, 1, Sampler::Regular(1), max_depth)).sum[0].to_array()
}

/// Mean over all samples of a film, and its standard deviation; channel by channel.
///
/// The samples must be independent: take the regular sampler with a camera from [`probe`].
fn mean(film: &Film) -> (DVec3, DVec3) {
    let n = f64::from(film.samples) * film.sum.len() as f64;
    let (sum, squares) = (film.sum.iter().sum::<DVec3>(), film.sum_squares.iter().sum::<DVec3>());
    let mean = sum / n;
    (mean, ((squares / n - mean * mean).max(DVec3::ZERO) / n).map(f64::sqrt))
}

/// The estimate agrees with the closed form within four standard deviations, and those are small.
fn assert_estimates(film: &Film, expected: [f64; 3], what: &str) {
    let (mean, sigma) = mean(film);
    let expected = DVec3::from(expected);
    // f32 geometry may be off by a few 1e-7 where nothing is random.
    let allowed = 4.0 * sigma + 1e-6 * expected;
    assert!((mean - expected).abs().cmple(allowed).all(), "{what}: {mean} is not {expected}, sigma {sigma}");
    assert!(sigma.cmple(0.02 * expected.max(DVec3::splat(1e-3))).all(), "{what}: sigma {sigma} tests nothing");
}

/// Every channel of every pixel is as expected, within `relative` of it.
fn assert_pixels(picture: &Picture, relative: f64, expected: impl Fn(u32, u32) -> f64) {
    let mut lit = 0;
    for y in 0..picture.height {
        for x in 0..picture.width {
            let [r, g, b] = picture.pixels[(y * picture.width + x) as usize].map(f64::from);
            let value = expected(x, y);
            assert!((r - value).abs() <= relative * value, "({x}, {y}): {r} is not {value}");
            assert!(r == g && g == b);
            lit += u32::from(value > 0.0);
        }
    }
    assert!(lit > 0, "all black");
}
