//! Patches whose hits are known in closed form, and the teapot against a fine tessellation.

use super::{brute, point, quadric, teapot};
use crate::random::Random;
use glam::{DVec3, Vec3};
use skipgrid::accel::BruteForce;
use skipgrid::geometry::{BezierPatches, Geometry};
use skipgrid::scene::{Scene, procedural};
use skipgrid::{Accel, Ray, Triangle};

/// Units in the last place of f32 between two numbers of like size.
fn ulps(a: f64, b: f64) -> f64 {
    let near = (a as f32).abs();
    (a - b).abs() / f64::from(near.next_up() - near)
}

#[test]
fn a_flat_patch_is_two_triangles() {
    // Dyadic control points on a parallelogram, evenly spaced: (u, v) is affine.
    let (corner, a, b) = (Vec3::new(0.5, -0.25, 0.75), Vec3::new(3.0, 0.375, 0.75), Vec3::new(-0.75, 2.25, 1.5));
    let at = |i: usize, j: usize| corner + a / 3.0 * i as f32 + b / 3.0 * j as f32;
    let patches = BezierPatches::new([std::array::from_fn(|j| std::array::from_fn(|i| at(i, j)))]);
    let triangles: Vec<Triangle> = vec![[at(0, 0), at(3, 0), at(3, 3)], [at(0, 0), at(3, 3), at(0, 3)]];
    let (ours, theirs) = (brute(&patches), BruteForce::new(&triangles));
    let mut random = Random::new(41);
    let mut hits = 0;
    for i in 0..4000 {
        let origin = 4.0 * random.in_cube();
        let aim = at(0, 0) + a * random.signed().abs() * 1.2 + b * random.signed().abs() * 1.2;
        let mut ray = Ray::new(origin, aim - origin);
        if i % 4 == 0 {
            // Exactly at corners and along borders.
            let (u, v) = ([0.0, 1.0][random.below(2)], [0.0, 0.5, 1.0][random.below(3)]);
            let target = corner + a * u + b * v;
            ray = Ray::new(target - Vec3::new(0.5, -0.25, 4.0), Vec3::new(0.5, -0.25, 4.0));
        }
        let (found, right) = (ours.closest_hit(&ray), theirs.closest_hit(&ray));
        assert_eq!(found.map(|h| h.t.to_bits()), right.map(|h| h.t.to_bits()), "{ray:?}");
        hits += usize::from(found.is_some());
    }
    assert!((1000..3900).contains(&hits), "{hits}");
}

#[test]
fn a_paraboloid_is_hit_where_its_equation_says() {
    // z = x^2 + y^2 over the unit square, with exact control points but for thirds, so x = 3 u' in thirds: scaled by 3 and 6.
    let mut points = quadric([[0.0; 3]; 3]);
    for (j, row) in points.iter_mut().enumerate() {
        for (i, p) in row.iter_mut().enumerate() {
            // x = 3 u, y = 3 v, z = (x^2 + y^2) 2 / 3 = 6 (u^2 + v^2): u^2 has the control values 0, 0, 1/3, 1.
            let square = |i: usize| [0.0, 0.0, 2.0, 6.0][i];
            *p = Vec3::new(i as f32, j as f32, square(i) + square(j));
        }
    }
    let patches = BezierPatches::new([points]);
    let accel = brute(&patches);
    let mut random = Random::new(42);
    let (mut hits, mut second) = (0, 0);
    for _ in 0..6000 {
        let origin = Vec3::new(1.5, 1.5, 6.0) + 8.0 * random.in_cube();
        let aim = point(&patches, 0, f64::from(random.signed().abs()), f64::from(random.signed().abs())).as_vec3();
        let ray = Ray::new(origin, aim - origin);
        // 3 z = 2 (x^2 + y^2) along the ray: a t^2 + b t + c = 0, in f64 without cancellation.
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let a = 2.0 * (d.x * d.x + d.y * d.y);
        let b = 4.0 * (o.x * d.x + o.y * d.y) - 3.0 * d.z;
        let c = 2.0 * (o.x * o.x + o.y * o.y) - 3.0 * o.z;
        let discriminant = b * b - 4.0 * a * c;
        if discriminant < 1e-6 * b * b {
            continue;
        }
        let q = -0.5 * (b + discriminant.sqrt().copysign(b));
        let mut roots = [q / a, c / q];
        roots.sort_by(f64::total_cmp);
        // Whether a root is on the patch, unless it is too near to the border to be told here.
        let place = |t: f64| {
            let p = o + t * d;
            let out = (p.x - 1.5).abs().max((p.y - 1.5).abs()) - 1.5;
            if t < -1e-9 || out > 1e-9 {
                Some(false)
            } else if t > 1e-9 && out < -1e-9 {
                Some(true)
            } else {
                None
            }
        };
        let expected = match roots.map(place) {
            [Some(true), _] => Some(roots[0]),
            [Some(false), Some(true)] => Some(roots[1]),
            [Some(false), Some(false)] => None,
            _ => continue,
        };
        let found = accel.closest_hit(&ray);
        assert_eq!(found.is_some(), expected.is_some(), "{ray:?} {roots:?}");
        if let (Some(hit), Some(t)) = (found, expected) {
            // The quotient's rounding is far below a unit of f32; 0.5 of one is the rounding of t.
            assert!(ulps(t, f64::from(hit.t)) <= 0.501, "{ray:?} {t} {hit:?}");
            hits += 1;
            second += usize::from(t == roots[1]);
        }
    }
    assert!(hits > 2000 && second > 200, "{hits} {second}");
}

#[test]
fn a_wave_is_crossed_as_often_as_it_can_be() {
    // z = 27 (u - 1/6)(u - 1/2)(u - 5/6) across: a ray along u at z = 0 meets it at three places.
    let cubic = {
        // Control values from the power basis: c0, c0 + c1/3, c0 + 2 c1/3 + c2/3, sum.
        let (c3, c2, c1, c0) = (27.0, -40.5, 27.0 * 23.0 / 36.0, -27.0 * 5.0 / 72.0);
        [c0, c0 + c1 / 3.0, c0 + 2.0 * c1 / 3.0 + c2 / 3.0, c0 + c1 + c2 + c3]
    };
    let points = std::array::from_fn(|j| std::array::from_fn(|i| Vec3::new(i as f32, j as f32, cubic[i])));
    let patches = BezierPatches::new([points]);
    let accel = brute(&patches);
    let mut t_min = -10.0_f32;
    let mut found = Vec::new();
    while let Some(hit) =
        accel.closest_hit(&Ray::new(Vec3::new(-1.0, 1.0, 0.0), Vec3::X).with_range(t_min, f32::INFINITY))
    {
        found.push(hit.t);
        t_min = hit.t + 1e-3;
    }
    assert_eq!(found.len(), 3, "{found:?}");
    for (t, right) in found.iter().zip([1.5, 2.5, 3.5]) {
        assert!((t - right).abs() < 2e-6, "{found:?}");
    }
}

#[test]
fn no_ray_passes_between_patches_that_share_a_border() {
    let patches = BezierPatches::new(teapot());
    let accel = brute(&patches);
    let mut random = Random::new(43);
    // Borders of the body's patches (8 to 19): the pot is convex there and closed sideways. From inside, a ray at a point
    // of a border must hit something.
    let mut shots = 0;
    for _ in 0..3000 {
        let prim = 8 + random.below(12) as u32;
        let (u, v) = ([0.0, 1.0][random.below(2)], f64::from(random.signed().abs()));
        let target = if random.below(2) == 0 { point(&patches, prim, u, v) } else { point(&patches, prim, v, u) };
        let inside = DVec3::new(0.0, 1.0, 0.0) + 0.2 * random.in_cube().as_dvec3();
        let (origin, target) = (inside.as_vec3(), target.as_vec3());
        let ray = Ray::new(origin, target - origin);
        // The rim is open: the lid and the neck are not closed against each other.
        if target.y > 2.2 {
            continue;
        }
        shots += 1;
        assert!(accel.any_hit(&ray), "{ray:?}");
    }
    assert!(shots > 1500, "{shots}");
}

#[test]
fn poles_and_corners_are_hit() {
    let patches = BezierPatches::new(teapot());
    let accel = brute(&patches);
    // The knob's top is one point of four patches: 3.15 high. Rays through it and around it, however near.
    for near in [0.0, 1e-30_f32, 1e-20, 1e-12, 1e-9, 1e-6, 1e-3] {
        for side in [Vec3::X, -Vec3::Z, Vec3::new(0.6, 0.0, 0.8), Vec3::new(-0.3, 0.0, 0.1)] {
            let hit =
                accel.closest_hit(&Ray::new(Vec3::new(0.0, 7.0, 0.0) + side * near, Vec3::NEG_Y)).expect("the knob");
            assert!((hit.t - (7.0 - 3.15)).abs() < 1e-6 + near * 0.1, "{near:e} {side} {hit:?}");
            let slant = Vec3::new(0.3, -1.0, 0.2);
            let ray = Ray::new(Vec3::new(0.0, 3.15, 0.0) - 2.0 * slant + side * near, slant);
            assert!((accel.closest_hit(&ray).expect("the knob").t - 2.0).abs() < 1e-6 + near, "{near:e} {side}");
        }
    }
    // The middle of the bottom.
    let hit = accel.closest_hit(&Ray::new(Vec3::new(0.0, -3.0, 0.0), Vec3::Y)).expect("the bottom");
    assert!((hit.t - 3.0).abs() < 1e-6, "{hit:?}");
}

#[test]
fn a_fine_tessellation_sees_the_same() {
    // Triangles between 32 steps deviate from the patch by less than a 1/8 of the second derivative over 32^2.
    let steps = 32;
    let scene = Scene::new(procedural::parse(&format!("teapot:n={steps}")).expect("a scene")).expect("a scene");
    let triangles = scene.accel("grid").expect("a grid");
    let patches = BezierPatches::new(teapot());
    let accel = brute(&patches);
    let mut random = Random::new(44);
    let (mut hits, mut differ) = (0, 0);
    for _ in 0..3000 {
        let origin = Vec3::new(0.0, 1.5, 0.0) + 8.0 * random.in_cube().normalize_or(Vec3::X);
        let ray = Ray::new(origin, Vec3::new(0.0, 1.5, 0.0) + 2.0 * random.in_cube() - origin);
        match (accel.closest_hit(&ray), triangles.closest_hit(&ray)) {
            (Some(a), Some(b)) => {
                hits += 1;
                // Along a ray that meets the surface at a slant the deviation grows; at silhouettes it has no bound.
                let (u, v) = patches.locate(a.prim, &ray, a.t).expect("a hit");
                let facing = patches.normal(a.prim, u, v).normalize_or_zero().dot(ray.direction.as_dvec3()).abs();
                let apart = f64::from(a.t - b.t).abs() * facing;
                differ += usize::from(apart > 0.01);
            }
            (None, None) => {}
            _ => differ += 1,
        }
    }
    assert!(hits > 1500 && differ < hits / 100, "{hits} hits, {differ} differ");
}

#[test]
fn bounds_hold_the_surface() {
    let patches = BezierPatches::new(teapot());
    let mut random = Random::new(45);
    for prim in 0..patches.len() {
        let aabb = patches.bounds(prim);
        for _ in 0..50 {
            let p = point(&patches, prim, f64::from(random.signed().abs()), f64::from(random.signed().abs()));
            let inside = p.cmpge(aabb.min.as_dvec3() - 1e-14).all() && p.cmple(aabb.max.as_dvec3() + 1e-14).all();
            assert!(inside, "{prim} {p}");
        }
    }
}
