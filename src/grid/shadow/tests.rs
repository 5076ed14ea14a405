//! Whatever shadow voxels know of a ray is what brute force finds.

use super::*;
use crate::accel::BruteForce;
use crate::geometry::tests::Random;
use crate::geometry::{Mixed, Sphere, Triangle};
use glam::Vec3;

/// Answers of the shadow voxels, each compared with brute force: how many of the rays were surely lit, surely dark, shortened.
fn answers<G: Geometry + Clone>(
    geometry: &G,
    lights: &[DVec3],
    resolution: u32,
    rays: &[(usize, u32, Ray)],
) -> [u64; 3] {
    let options = GridOptions { resolution: Some([resolution; 3]), ..GridOptions::default() };
    let shadows = ShadowVoxels::build(geometry.clone(), lights, &options).expect("a grid");
    let brute = BruteForce::new(geometry.clone());
    let mut known = [0; 3];
    for &(light, prim, ray) in rays {
        let (kind, hidden) = match shadows.ask(light, prim, &ray) {
            Shadow::Unknown => continue,
            Shadow::Lit => (0, false),
            Shadow::Dark => (1, true),
            Shadow::Until(t) => (2, brute.any_hit(&ray.with_range(ray.t_min, t))),
        };
        assert_eq!(hidden, brute.any_hit(&ray), "light {light} from {prim}: {ray:?}");
        known[kind] += 1;
    }
    known
}

/// Rays from points of primitives to lights: lifted off on the light's side as a tracer does, lifted off on the other side, not
/// at all, and from anywhere near with any primitive named.
fn rays(random: &mut Random, points: &[(u32, Vec3, Vec3)], lights: &[DVec3]) -> Vec<(usize, u32, Ray)> {
    let mut rays = Vec::new();
    for &(prim, point, normal) in points {
        for (i, light) in lights.iter().enumerate() {
            let to =
                |from: Vec3| Ray::new(from, (*light - from.as_dvec3()).as_vec3()).with_range(0.0, 1.0 - f32::EPSILON);
            let normal = if (light.as_vec3() - point).dot(normal) < 0.0 { -normal } else { normal };
            let lift = point.abs().max_element() * 2.4e-7;
            rays.push((i, prim, to(point + normal * lift)));
            rays.push((i, prim, to(point - normal * lift)));
            rays.push((i, prim, to(point)));
            let any = points[(random.next() % points.len() as u64) as usize].0;
            rays.push((i, any, to(point + 0.05 * random.in_cube())));
            // Not a ray to the light, and not one that ends there.
            rays.push((i, prim, Ray::new(point, random.in_cube())));
            rays.push((i, prim, to(point).with_range(-1.0, 0.5)));
        }
    }
    rays
}

fn lights(random: &mut Random) -> Vec<DVec3> {
    let mut lights: Vec<_> = (0..5).map(|_| 2.5 * random.in_cube().as_dvec3()).collect();
    lights.extend([DVec3::new(0.0, 0.0, 40.0), DVec3::new(0.3, 0.2, 0.1), DVec3::new(-0.9, 1e4, 0.4)]);
    lights
}

fn triangle_points(random: &mut Random, triangles: &[Triangle], each: usize) -> Vec<(u32, Vec3, Vec3)> {
    let mut points = Vec::new();
    for (prim, [a, b, c]) in (0..).zip(triangles) {
        for _ in 0..each {
            let (u, v) = (random.unit(), random.unit());
            let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
            points.push((prim, *a + u * (*b - *a) + v * (*c - *a), (*b - *a).cross(*c - *a).normalize_or_zero()));
        }
    }
    points
}

/// A square of `n` x `n` cells at a height, as triangles.
fn square(n: i32, height: f32, half: f32) -> Vec<Triangle> {
    let at = |i: i32, j: i32| {
        Vec3::new(i as f32 / n as f32 * 2.0 * half - half, j as f32 / n as f32 * 2.0 * half - half, height)
    };
    (0..n * n)
        .flat_map(|k| {
            let (i, j) = (k % n, k / n);
            [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]]
        })
        .collect()
}

#[test]
fn a_floor_below_a_table_is_lit_and_dark() {
    let mut random = Random::new(51);
    let mut triangles = square(12, -0.5, 1.0);
    triangles.extend(square(1, 0.25, 0.5));
    for turned in [false, true] {
        if turned {
            // Coordinates that are rounded, so that the floor is no longer exactly flat.
            let turn = glam::Quat::from_rotation_y(0.5) * glam::Quat::from_rotation_x(0.3);
            triangles.iter_mut().flatten().for_each(|p| *p = turn * *p + Vec3::new(3.0, 2.0, 1.0));
        }
        let shift = if turned { DVec3::new(3.0, 2.0, 1.0) } else { DVec3::ZERO };
        let lights: Vec<DVec3> = lights(&mut random).into_iter().map(|l| l + shift).collect();
        let points = triangle_points(&mut random, &triangles, 12);
        let rays = rays(&mut random, &points, &lights);
        for resolution in [1, 7, 24] {
            let known = answers(&triangles, &lights, resolution, &rays);
            if resolution == 24 {
                assert!(known[0] > 2000 && known[1] > 200, "turned {turned}: {known:?} of {}", rays.len());
            }
        }
    }
}

#[test]
fn spheres_shade_spheres() {
    let mut random = Random::new(52);
    let spheres: Vec<Sphere> =
        (0..60).map(|i| Sphere { centre: random.in_cube(), radius: [0.02, 0.05, 0.3][i % 3] }).collect();
    let points: Vec<_> = (0..4000)
        .map(|i| {
            let prim = i % 60;
            let normal = random.in_cube().normalize();
            (prim, spheres[prim as usize].centre + spheres[prim as usize].radius * normal, normal)
        })
        .collect();
    let lights = lights(&mut random);
    let rays = rays(&mut random, &points, &lights);
    let known = answers(&spheres, &lights, 32, &rays);
    assert!(known[0] > 1000 && known[1] > 1000 && known[2] > 1000, "{known:?} of {}", rays.len());
    let mixed = Mixed { triangles: square(3, -1.1, 2.0), spheres };
    let shifted: Vec<_> = rays.iter().map(|&(light, prim, ray)| (light, prim + 18, ray)).collect();
    let mixed_known = answers(&mixed, &lights, 32, &shifted);
    assert!(mixed_known[1] > 1000, "{mixed_known:?}");
}

#[test]
fn soups_needles_and_bad_corners_do_no_harm() {
    let mut random = Random::new(53);
    let mut triangles = random.soup(300, 0.4);
    for i in (0..300).step_by(5) {
        let [a, b, _] = triangles[i];
        triangles[i][2] = [a, a + 0.5 * (b - a), Vec3::NAN, b + Vec3::splat(1e-6)][i / 5 % 4];
    }
    let lights = lights(&mut random);
    let points = triangle_points(&mut random, &triangles, 3);
    let rays = rays(&mut random, &points, &lights);
    let known = answers(&triangles, &lights, 20, &rays);
    assert!(known[1] > 0 && known[2] > 0, "{known:?}");
}

#[test]
fn nothing_and_no_light_are_fine() {
    let none: Vec<Triangle> = Vec::new();
    let ray = Ray::new(Vec3::ZERO, Vec3::Z);
    let shadows = ShadowVoxels::build(&none, &[DVec3::Z], &GridOptions::default()).expect("an empty grid");
    assert_eq!(shadows.ask(0, 0, &ray), Shadow::Unknown);
    let shadows = ShadowVoxels::build(&none, &[], &GridOptions::default()).expect("an empty grid");
    assert_eq!(shadows.memory().tables, 0);
    let error = ShadowVoxels::build(&none, &[DVec3::NAN], &GridOptions::default()).expect_err("a bad light");
    assert!(error.to_string().contains("light 0"), "{error}");
}
