//! Voxels that lie in the umbra of one primitive.
//!
//! The shadow that a convex occluder casts from a point is convex, so it holds a voxel if it holds its corners. Rays do not end
//! at the light exactly, hence the light is a small box here, and its corners are combined with those of the voxel.

use crate::geometry::{Geometry, Sphere, Triangle};
use crate::ray::Cell;
use glam::DVec3;

/// True only if every segment from the box `voxel` to the box `light` surely meets `prim`, well within both.
pub(super) fn holds<G: Geometry>(geometry: &G, prim: u32, voxel: &Cell, light: &Cell) -> bool {
    if let Some(triangle) = geometry.triangle(prim) {
        behind_triangle(&triangle, voxel, light)
    } else {
        geometry.sphere(prim).is_some_and(|sphere| behind_sphere(&sphere, voxel, light))
    }
}

fn corners(cell: &Cell) -> [DVec3; 8] {
    std::array::from_fn(|i| DVec3::from([0, 1, 2].map(|a| if i >> a & 1 == 0 { cell.min[a] } else { cell.max[a] })))
}

/// The segment from c to l passes through the triangle if c and l lie on different sides of its plane, and the line keeps all
/// three edges to the same side: the signs of the volumes of (c, l, edge). A volume is affine in c and affine in l, so its sign
/// is that of the corners wherever all pairs of corners agree.
fn behind_triangle(triangle: &Triangle, voxel: &Cell, light: &Cell) -> bool {
    let [p, q, r] = triangle.map(|p| p.as_dvec3());
    let normal = (q - p).cross(r - p);
    let (from, to) = (corners(voxel), corners(light));
    let side = |x: DVec3| sign(normal.dot(x - p), normal.length() * (x - p).length());
    let (here, there) = (common(from.iter().map(|&x| side(x))), common(to.iter().map(|&x| side(x))));
    if here * there >= 0.0 {
        return false;
    }
    let volume = |a: DVec3, b: DVec3, c: DVec3, l: DVec3| {
        let (a, b, l) = (a - c, b - c, l - c);
        sign(a.cross(b).dot(l), a.length() * b.length() * l.length())
    };
    let edge = |a: DVec3, b: DVec3| common(from.iter().flat_map(|&c| to.iter().map(move |&l| volume(a, b, c, l))));
    let first = edge(p, q);
    first != 0.0 && edge(q, r) == first && edge(r, p) == first
}

/// The sign of a value whose rounding error is a few units of 2^-53 of `size`; 0 if it is not certain.
fn sign(value: f64, size: f64) -> f64 {
    const ERROR: f64 = 1.0 / (1u64 << 45) as f64;
    // Nothing is certain of a NaN either.
    if value.abs() > size * ERROR { value.signum() } else { 0.0 }
}

/// The sign that all have; 0 if they differ or one is not certain.
fn common(mut signs: impl Iterator<Item = f64>) -> f64 {
    let first = signs.next().unwrap_or(0.0);
    if signs.all(|s| s == first) { first } else { 0.0 }
}

/// Seen from the light's centre, the corners lie behind a smaller sphere; what the light's box and rounding move the segment by
/// is less than what the sphere was made smaller by. Voxel and light lie outside the sphere, so the segment enters it.
fn behind_sphere(sphere: &Sphere, voxel: &Cell, light: &Cell) -> bool {
    let (centre, radius) = (sphere.centre.as_dvec3(), f64::from(sphere.radius));
    let eye = 0.5 * (light.min + light.max);
    let margin = (light.max - light.min).length() + 1e-9 * (radius + centre.abs().max_element());
    let inner = radius - margin;
    let nearest = centre.clamp(voxel.min, voxel.max);
    let outside = |p: DVec3| (p - centre).length() > radius + margin;
    inner > 0.0
        && outside(nearest)
        && outside(eye)
        && corners(voxel).iter().all(|&corner| {
            let way = corner - eye;
            let along = (centre - eye).dot(way) / way.length_squared();
            // Within the segment, by less than what matters: its ends lie outside.
            along > 0.0 && along < 1.0 && (eye + way * along - centre).length() < inner
        })
}
