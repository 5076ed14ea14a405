//! Surfaces that shine, as spots whose light falls off with the cosine: POV-Ray's own area lights take cosine and distance
//! from their middle.
//!
//! A spot of half-angle 90 degrees and tightness 1 has the intensity `I cos(angle)`, as a small piece of a diffuse emitter
//! has. A triangle becomes `n * n` of them, at the centroids of the congruent triangles into which `n` steps along each side
//! cut it; the sum is then the midpoint rule for the integral over the lamp, with an error of second order in the size of a
//! piece over its distance.

use crate::scene::Scene;
use crate::scene::export::{usable_spheres, usable_triangles};
use glam::DVec3;
use std::f64::consts::PI;

/// Most spots of a scene: each costs POV-Ray a shadow ray at every point.
const MOST: u64 = 4096;

/// A small piece of a lamp.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Spot {
    /// World units.
    pub position: DVec3,
    /// Unit normal of the side that shines.
    pub normal: DVec3,
    /// Radiant intensity along the normal, W/sr.
    pub intensity: DVec3,
}

/// All spots with `grid` steps along each side of a triangle, fewer if there would be too many; and what that changes, in
/// words. A sphere becomes `2 grid^2` spots. With `grid` 0 there is none.
pub(super) fn spots(scene: &Scene, grid: u32) -> (Vec<Spot>, Option<String>) {
    let emission = |material: u32| scene.materials[material as usize].emission.as_dvec3();
    let shines = |material: u32| emission(material).max_element() > 0.0;
    let meshes = || scene.meshes.iter().filter(|mesh| shines(mesh.material));
    let spheres = || usable_spheres(scene).into_iter().filter(|&i| shines(scene.sphere_materials[i]));
    let pieces = meshes().map(|mesh| usable_triangles(mesh).len() as u64).sum::<u64>() + 2 * spheres().count() as u64;
    let fits = |n: &u32| pieces * u64::from(*n).pow(2) <= MOST;
    let steps = (1..=grid).rev().find(fits).unwrap_or(0);
    let warning = match steps {
        _ if steps == grid || pieces == 0 => None,
        0 => Some(format!(
            "{pieces} shining surfaces are too many for POV-Ray's lights: they light nothing in the export"
        )),
        _ => Some(format!(
            "{pieces} shining surfaces have {steps} steps along a side instead of {grid}, so that there are at most {MOST} spots"
        )),
    };
    let mut spots = Vec::new();
    if steps == 0 {
        return (spots, warning);
    }
    for mesh in meshes() {
        for corners in usable_triangles(mesh) {
            let corners = corners.map(|i| mesh.positions[i as usize].as_dvec3());
            triangle(corners, emission(mesh.material), steps, &mut spots);
        }
    }
    for i in spheres() {
        let shape = scene.spheres[i];
        let (centre, radius) = (shape.centre.as_dvec3(), f64::from(shape.radius));
        sphere(centre, radius, emission(scene.sphere_materials[i]), steps, &mut spots);
    }
    (spots, warning)
}

/// A spot at the centroid of each of the `n * n` pieces; none for a triangle without area.
fn triangle([a, b, c]: [DVec3; 3], radiance: DVec3, n: u32, spots: &mut Vec<Spot>) {
    let cross = (b - a).cross(c - a);
    let Some(normal) = cross.try_normalize() else { return };
    let steps = f64::from(n);
    let intensity = radiance * cross.length() / 2.0 / steps.powi(2);
    let mut spot = |u: f64, v: f64| {
        let position = a + (b - a) * (u / steps) + (c - a) * (v / steps);
        spots.push(Spot { position, normal, intensity });
    };
    for i in 0..n {
        for j in 0..n - i {
            let (u, v) = (f64::from(i), f64::from(j));
            spot(u + 1.0 / 3.0, v + 1.0 / 3.0);
            // The piece that stands on its head, beside all but the last of a row.
            if i + j + 1 < n {
                spot(u + 2.0 / 3.0, v + 2.0 / 3.0);
            }
        }
    }
}

/// `2 n * n` spots, evenly spread along a spiral from pole to pole.
/// Source: González 2010, "Measurement of areas on a sphere using Fibonacci and latitude-longitude lattices".
fn sphere(centre: DVec3, radius: f64, radiance: DVec3, n: u32, spots: &mut Vec<Spot>) {
    let count = 2 * n * n;
    let intensity = radiance * 4.0 * PI * radius * radius / f64::from(count);
    let golden = PI * (3.0 - 5f64.sqrt());
    for i in 0..count {
        let z = 1.0 - (2.0 * f64::from(i) + 1.0) / f64::from(count);
        let (sin, cos) = (golden * f64::from(i)).sin_cos();
        let across = (1.0 - z * z).sqrt();
        let normal = DVec3::new(across * cos, across * sin, z);
        spots.push(Spot { position: centre + normal * radius, normal, intensity });
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn pieces_cover_the_triangle_and_the_sphere() {
        let corners = [DVec3::ZERO, DVec3::new(3.0, 0.0, 0.0), DVec3::new(0.0, 6.0, 0.0)];
        for n in 1..6 {
            let mut spots = Vec::new();
            triangle(corners, DVec3::new(1.0, 2.0, 0.0), n, &mut spots);
            assert_eq!(spots.len(), (n * n) as usize);
            let (mut middle, mut power) = (DVec3::ZERO, DVec3::ZERO);
            for spot in &spots {
                middle += spot.position / spots.len() as f64;
                power += spot.intensity;
                assert_eq!(spot.normal, DVec3::Z);
            }
            // The centroid, and radiance times the area of 9.
            assert!(middle.distance(DVec3::new(1.0, 2.0, 0.0)) < 1e-12, "{n}: {middle}");
            assert!(power.distance(DVec3::new(9.0, 18.0, 0.0)) < 1e-12, "{n}: {power}");
        }
        triangle([DVec3::ZERO; 3], DVec3::ONE, 3, &mut Vec::new());
        let mut spots = Vec::new();
        sphere(DVec3::ONE, 2.0, DVec3::ONE, 4, &mut spots);
        let middle = spots.iter().map(|s| s.position).sum::<DVec3>() / spots.len() as f64;
        // 32 points: their middle is that of the sphere but for the unevenness of so few.
        assert!(spots.len() == 32 && middle.distance(DVec3::ONE) < 0.1, "{middle}");
        assert!(spots.iter().all(|s| (s.position.distance(DVec3::ONE) - 2.0).abs() < 1e-12));
    }
}
