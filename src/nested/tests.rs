//! The nested grid against brute force, and its parts against what they promise.

use super::*;
use crate::accel::BruteForce;
use crate::geometry::tests::Random;
use crate::geometry::{Mixed, Sphere, Triangle};
use glam::Vec3;

fn bits(hit: Option<Hit>) -> Option<(u32, u32)> {
    hit.map(|h| (h.prim, h.t.to_bits()))
}

/// Rays at `targets` from near and far, along axes and with every length of direction.
fn rays(random: &mut Random, count: usize, targets: &[Vec3]) -> Vec<Ray> {
    let mut rays = Vec::new();
    for i in 0..count {
        let target = targets[random.next() as usize % targets.len()] + random.in_cube() * [0.0, 1e-3][i % 2];
        let distance = [0.1, 2.0, 5.0, 1e3, 1e6, 1e9, 1e15][random.next() as usize % 7];
        let mut direction = random.in_cube();
        if i % 5 == 0 {
            direction[i % 3] = 0.0;
        }
        if i % 7 == 0 {
            direction[(i + 1) % 3] = 0.0;
        }
        direction *= [1.0, 1e-30, 1e18][random.next() as usize % 3];
        let origin = target - direction * (distance / direction.length().max(1e-38));
        let ray = Ray::new(origin, direction);
        rays.push(match i % 6 {
            0 => ray.with_range(f32::NEG_INFINITY, f32::INFINITY),
            1 => ray.with_range(-1.0, 0.5),
            _ => ray,
        });
    }
    rays
}

fn check<G: Geometry + Clone>(name: &str, geometry: &G, rays: &[Ray]) {
    let brute = BruteForce::new(geometry);
    for quality in [Quality::Fast, Quality::Default, Quality::Best] {
        let mut nested = Nested::build(geometry, &NestedOptions { quality, ..NestedOptions::default() }).unwrap();
        println!("{name}: {}", nested.describe());
        for isa in [Isa::detect(), Isa::Portable] {
            nested.isa = isa;
            for ray in rays {
                let expected = bits(brute.closest_hit(ray));
                assert_eq!(bits(nested.closest_hit(ray)), expected, "{name}: {ray:?}");
                assert_eq!(nested.any_hit(ray), expected.is_some(), "{name}: any hit of {ray:?}");
            }
        }
    }
}

fn soup(random: &mut Random, count: usize, size: f32) -> Vec<Triangle> {
    (0..count)
        .map(|_| {
            let p = random.in_cube();
            [p, p + size * random.in_cube(), p + size * random.in_cube()]
        })
        .collect()
}

#[test]
fn answers_as_brute_force_does() {
    let mut random = Random::new(3);
    for (count, size) in [(1, 1.0), (7, 0.5), (300, 0.3), (3000, 0.05), (2000, 0.6)] {
        let triangles = soup(&mut random, count, size);
        let targets: Vec<Vec3> = triangles.iter().flatten().copied().collect();
        let shots = rays(&mut random, 2000, &targets);
        check(&format!("{count} triangles of {size}"), &triangles, &shots);
        let flat: Vec<Triangle> = triangles.iter().map(|t| t.map(|p| p * Vec3::new(1.0, 0.0, 1.0))).collect();
        check(&format!("{count} flat triangles"), &flat, &shots);
        let spheres: Vec<Sphere> =
            targets.iter().take(count).map(|&centre| Sphere { centre, radius: random.unit() * size * 0.3 }).collect();
        check(&format!("{count} spheres"), &spheres, &shots);
        check(&format!("{count} of each"), &Mixed { triangles, spheres }, &shots);
    }
}

#[test]
fn large_and_small_at_once() {
    let mut random = Random::new(5);
    let mut triangles = soup(&mut random, 2000, 0.02);
    triangles.extend(soup(&mut random, 20, 1.0).iter().map(|t| t.map(|p| p * 1e6)));
    triangles.extend(soup(&mut random, 500, 0.02).iter().map(|t| t.map(|p| p * 10.0 + 1e4)));
    let targets: Vec<Vec3> = triangles.iter().flatten().copied().collect();
    let shots = rays(&mut random, 3000, &targets);
    check("large and small", &triangles, &shots);
}
