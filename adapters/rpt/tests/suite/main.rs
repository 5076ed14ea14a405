//! The plug held against rpt's kd-tree, against every object asked by itself, and against exact arithmetic.

mod hits;
mod renders;
mod shape;

use glam::Vec3;
use rand::{Rng, SeedableRng, rngs::StdRng};
use rpt::{HitRecord, Ray, Shape, Triangle, glm};
use skipgrid::scene::{LoadOptions, load};
use std::path::PathBuf;

/// A bounce of rpt begins here.
pub const EPSILON: f64 = 1e-12;

/// Triangles of a scene, as its f32 say.
pub fn corners(scene: &str) -> Vec<[Vec3; 3]> {
    let scene = load(scene, &LoadOptions::default()).expect("a scene");
    let mesh = |mesh: &skipgrid::scene::Mesh| -> Vec<[Vec3; 3]> {
        mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])).collect()
    };
    scene.meshes.iter().flat_map(mesh).collect()
}

/// The bunny of the data beside the repository (or where `SKIPGRID_SHARED` says), if it is there.
pub fn bunny() -> Option<String> {
    let beside = || PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("../../../shared");
    let path = std::env::var_os("SKIPGRID_SHARED").map_or_else(beside, PathBuf::from).join("scenes/bunny.obj");
    if !path.exists() {
        eprintln!("skipped: {} is not there", path.display());
        return None;
    }
    Some(path.to_string_lossy().into_owned())
}

/// To f64.
pub fn double(v: Vec3) -> glm::DVec3 {
    glm::vec3(v.x.into(), v.y.into(), v.z.into())
}

/// As rpt holds them.
pub fn triangles(corners: &[[Vec3; 3]]) -> Vec<Triangle> {
    corners.iter().map(|t| Triangle::from_vertices(double(t[0]), double(t[1]), double(t[2]))).collect()
}

/// Time and normal; an infinite time for a miss.
pub type Answer = (f64, glm::DVec3);

/// What `shape` answers.
pub fn ask<S: Shape + ?Sized>(shape: &S, ray: &Ray) -> Answer {
    let mut record = HitRecord::new();
    assert_eq!(shape.intersect(ray, EPSILON, &mut record), record.time.is_finite());
    (record.time, record.normal)
}

/// The first of the least times of all objects: what rpt itself says without an accelerator.
pub fn ask_all<S: Shape>(objects: &[S], ray: &Ray) -> Answer {
    let mut record = HitRecord::new();
    objects.iter().for_each(|object| _ = object.intersect(ray, EPSILON, &mut record));
    (record.time, record.normal)
}

/// Seeded rays whose numbers f32 holds: in turn from around the mesh to a random point of it, from such a point into a random
/// direction, from around to a corner, and to the middle of an edge.
pub fn rays(corners: &[[Vec3; 3]], count: usize) -> Vec<(Vec3, Vec3)> {
    let mut random = StdRng::seed_from_u64(count as u64);
    let all = || corners.iter().flatten();
    let (low, high) = (all().copied().reduce(Vec3::min), all().copied().reduce(Vec3::max));
    let (low, high) = low.zip(high).expect("a triangle");
    let mut unit = move || Vec3::from(random.r#gen::<[f32; 3]>());
    let mut ray = |i: usize| {
        let [a, b, c] = corners[(unit().x * corners.len() as f32) as usize % corners.len()];
        let weights = unit();
        let point = (a * weights.x + b * weights.y + c * weights.z) / weights.element_sum();
        let around = low + (unit() * 3.0 - 1.0) * (high - low);
        match i % 4 {
            0 => (around, point - around),
            1 => (point, unit() * 2.0 - 1.0),
            2 => (around, a - around),
            _ => (around, (a + b) / 2.0 - around),
        }
    };
    (0..count).map(&mut ray).collect()
}
