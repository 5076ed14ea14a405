//! Crowds in one place: identical primitives, and different ones around one point.

use super::draw::{axis, in_box, in_cube, inwards, pick, unit};
use super::shapes::{Mesh, mixed, spheres, triangles};
use super::{Case, Stage};
use crate::geometry::{Sphere, Triangle};
use crate::random::Random;
use crate::ray::Ray;
use glam::{DVec3, Vec3};

/// Rays of the cases with 10^5 primitives.
const FEW: u64 = 1000;
const REASON: &str = "the exact answer tests all 10^5 primitives for each ray";

pub(super) const CASES: &[Case] = &[
    Case::new("identical_1e5", "10^5 times the same triangle, rays at its inside, edges and corners", identical)
        .at_most(FEW, REASON),
    Case::new("identical_spheres_1e5", "10^5 times the same sphere, rays at it and along its tangents", balls)
        .at_most(FEW, REASON),
    Case::new("one_point", "2000 triangles in one corner and 200 around it, in every size", point)
        .at_most(300, "the exact answer compares 2000 triangles for each ray"),
    Case::new("one_point_spheres", "spheres of one centre, spheres through one point, and corners there", centres)
        .at_most(1000, "the exact answer compares 300 primitives for each ray"),
];

/// As many primitives as the crowd, but each in a place of its own.
fn scattered(random: &mut Random, n: usize) -> Vec<Triangle> {
    (0..n)
        .map(|_| {
            let p = in_box(random, 0.0, 1.0);
            [(); 3].map(|()| p + in_cube(random) * 0.02)
        })
        .collect()
}

fn identical(random: &mut Random) -> Stage {
    let triangle = [Vec3::new(0.1, 0.2, 0.3), Vec3::new(0.9, 0.3, 0.2), Vec3::new(0.4, 0.8, 0.7)];
    let shoot = move |random: &mut Random| {
        let [a, b, c] = triangle;
        let (s, t) = (random.unit() as f32, random.unit() as f32);
        let target = match random.below(4) {
            0 => pick(random, &triangle),
            1 => a + s * (b - a),
            _ => a + (1.0 - s) * ((b - a) + t * (c - b)),
        };
        let origin = Vec3::splat(0.5) + unit(random) * 1.5;
        Ray::new(origin, target - origin)
    };
    Stage::new(triangles(vec![triangle; 100_000]), shoot, |random| inwards(random, Vec3::splat(0.5), 1.0))
        .against(triangles(scattered(random, 100_000)))
}

fn balls(random: &mut Random) -> Stage {
    let ball = Sphere { centre: Vec3::new(0.4, 0.5, 0.6), radius: 0.3 };
    let ordinary = (0..100_000).map(|_| Sphere { centre: in_box(random, 0.0, 1.0), radius: 0.005 }).collect::<Vec<_>>();
    let shoot = move |random: &mut Random| {
        let origin = ball.centre + unit(random) * 1.5;
        let side = (origin - ball.centre).cross(unit(random)).normalize_or(Vec3::X);
        // At the rim seen from the origin, or within it.
        let reach = if random.below(2) == 0 { 0.3 * (1.5f32.powi(2) / (1.5f32.powi(2) - 0.09)).sqrt() } else { 0.2 };
        Ray::new(origin, ball.centre + side * reach - origin)
    };
    Stage::new(spheres(vec![ball; 100_000]), shoot, |random| inwards(random, Vec3::splat(0.5), 1.0))
        .against(spheres(ordinary))
}

fn point(random: &mut Random) -> Stage {
    let apex = Vec3::new(0.25, -0.5, 0.75);
    let mut list: Vec<Triangle> = (0..2000)
        .map(|_| {
            let size = 10f64.powf(random.within(-3.0, 0.0)) as f32;
            [apex, apex + unit(random) * size, apex + unit(random) * size]
        })
        .collect();
    // Nested about the point, which is in none of them.
    for k in 0..10 {
        let size = 2f64.powi(-k);
        let mesh = Mesh::sphere(4, 4, apex.as_dvec3(), || size * random.within(0.9, 1.0));
        list.extend(mesh.triangles().split_off(4));
    }
    list.extend((0..5).map(|i| [1.0, 2.0, 3.0].map(|k| in_cube(random) * 5.0 + k * 20.0 * Vec3::X * (i - 2) as f32)));
    random.shuffle(&mut list);
    let shoot = move |random: &mut Random| {
        let origin = match random.below(3) {
            0 => apex + axis(random) * 2.0,
            // Exact differences, so that rays meet the point itself.
            1 => apex + (in_cube(random) * 64.0).round() / 32.0,
            _ => apex + unit(random) * 3.0,
        };
        let direction = apex - origin;
        Ray::new(origin, if direction == Vec3::ZERO { Vec3::X } else { direction })
    };
    Stage::new(triangles(list), shoot, move |random| into(random, apex))
}

fn centres(random: &mut Random) -> Stage {
    let centre = DVec3::new(0.25, -0.5, 0.75);
    let mut balls: Vec<Sphere> =
        (1..=100).map(|i| Sphere { centre: centre.as_vec3(), radius: i as f32 / 64.0 }).collect();
    // Through the centre: whole multiples along an axis are exact.
    balls.extend((1..=100).map(|i| {
        let mut at = centre.as_vec3();
        at[i % 3] += i as f32 / 64.0 * if i % 2 == 0 { 1.0 } else { -1.0 };
        Sphere { centre: at, radius: i as f32 / 64.0 }
    }));
    balls.extend((0..5).map(|_| Sphere { centre: in_cube(random) * 50.0, radius: 1.0 }));
    let list = (0..200).map(|_| [centre.as_vec3(), unit(random), unit(random)]).collect();
    let shoot = move |random: &mut Random| {
        let centre = centre.as_vec3();
        // Differences are exact.
        let origin = match random.below(3) {
            0 => centre + axis(random) * 3.0,
            _ => centre + (in_cube(random) * 64.0).round() / 16.0,
        };
        let direction = if origin == centre { Vec3::X } else { centre - origin };
        match random.below(4) {
            0 => Ray::new(origin, direction),
            1 => Ray::new(centre, direction),
            // Behind the least of the spheres about the point, which is at most 8 away: at the point itself.
            _ => Ray::new(origin, direction).with_range(0.999, f32::INFINITY),
        }
    };
    // As many of these begin behind the spheres: how many primitives a ray must pass is not what exactness costs.
    let good = move |random: &mut Random| {
        let ray = into(random, centre.as_vec3());
        if random.below(2) == 0 { ray } else { ray.with_range(0.97, f32::INFINITY) }
    };
    Stage::new(mixed(list, balls), shoot, good)
}

/// Into the crowd around `point`, not at it: what many primitives in one place cost is not what exactness costs.
fn into(random: &mut Random, point: Vec3) -> Ray {
    let origin = point + unit(random) * 3.0;
    Ray::new(origin, point + in_cube(random) * 0.05 - origin)
}
