//! Accelerators of other people with their own triangle tests: right on ordinary rays, unharmed by bad ones, and seen to
//! differ where they do.

use crate::random::Random;
use glam::Vec3;
use skipgrid::geometry::Mixed;
use skipgrid::registry::{self, Entry, Needs};
use skipgrid::scene::SceneGeometry;
use skipgrid::{Accel, Hit, Ray, Sphere, Triangle};
use std::path::Path;
use std::sync::Arc;

/// The peers that are compiled in and can be built here.
fn peers() -> impl Iterator<Item = &'static Entry> {
    let there = |entry: &&Entry| match entry.missing() {
        Some(cause) => {
            eprintln!("skipped: {}: {cause}", entry.name);
            false
        }
        None => true,
    };
    registry::ENTRIES.iter().filter(|entry| !entry.exact).filter(there)
}

/// As scenes have them, whose accelerators are compiled in the library.
fn scene(triangles: &[Triangle]) -> SceneGeometry {
    SceneGeometry::Triangles(Arc::new(triangles.to_vec()))
}

fn soup(count: usize, size: f32, seed: u64) -> Vec<Triangle> {
    let mut random = Random::new(seed);
    let mut triangle = || {
        let p = random.in_cube();
        [p, p + size * random.in_cube(), p + size * random.in_cube()]
    };
    (0..count).map(|_| triangle()).collect()
}

/// A closed ball of `n` x `2 n` faces with its poles on the axis z, radius 1.
fn ball(n: usize) -> Vec<Triangle> {
    let at = |i: usize, j: usize| {
        let (u, v) =
            ((j % (2 * n)) as f32 / n as f32 * std::f32::consts::PI, i as f32 / n as f32 * std::f32::consts::PI);
        match i {
            0 => Vec3::Z,
            i if i == n => -Vec3::Z,
            _ => Vec3::new(u.cos() * v.sin(), u.sin() * v.sin(), v.cos()),
        }
    };
    let faces = (0..n).flat_map(|i| (0..2 * n).map(move |j| (i, j)));
    faces
        .flat_map(|(i, j)| [[at(i, j), at(i + 1, j), at(i + 1, j + 1)], [at(i, j), at(i + 1, j + 1), at(i, j + 1)]])
        .collect()
}

fn prim(hit: Option<Hit>) -> Option<u32> {
    hit.map(|hit| hit.prim)
}

/// Random rays through random triangles come near an edge by less than an error of f32 about once in 10^5 times, and graze a
/// triangle at less than 10^-4 as rarely: hence one ray in a thousand, and 10^-3 of `t`.
#[test]
fn on_ordinary_rays_peers_agree_with_brute_force() {
    let triangles = soup(600, 0.3, 1);
    let brute = scene(&triangles).accel("brute").expect("always there");
    let mut random = Random::new(2);
    let mut ray = || {
        let origin = 2.0 * random.in_cube();
        Ray::new(origin, random.in_cube() - origin)
    };
    let rays: Vec<Ray> = (0..4000).map(|_| ray()).collect();
    let truth: Vec<Option<Hit>> = rays.iter().map(|ray| brute.closest_hit(ray)).collect();
    assert!(truth.iter().flatten().count() > 1000, "most rays should hit something");
    for entry in peers() {
        let accel = scene(&triangles).accel(entry.name).expect(entry.name);
        assert_eq!(accel.bounds(), brute.bounds(), "{}", entry.name);
        assert!(accel.memory().total() > 36 * triangles.len() as u64, "{}: it copies the triangles", entry.name);
        let mut differing = 0;
        for (ray, expected) in rays.iter().zip(&truth) {
            let hit = accel.closest_hit(ray);
            let same = prim(hit) == prim(*expected) && accel.any_hit(ray) == hit.is_some();
            differing += usize::from(!same);
            if let (true, Some(hit), Some(expected)) = (same, hit, expected) {
                let error = (hit.t - expected.t).abs() / expected.t;
                assert!(error < 1e-3, "{}: {hit:?} for {expected:?}, {ray:?}", entry.name);
            }
        }
        assert!(differing <= rays.len() / 1000, "{}: {differing} of {} rays differ", entry.name, rays.len());
    }
}

/// Both ends count in units of a direction that is not unit, and either side of a triangle is hit.
#[test]
fn peers_keep_to_the_range() {
    let plane = |z: f32| [Vec3::new(-9.0, -9.0, z), Vec3::new(9.0, -9.0, z), Vec3::new(0.0, 9.0, z)];
    let triangles: Vec<Triangle> = (1..=8).map(|z| plane(z as f32)).collect();
    for entry in peers() {
        let accel = scene(&triangles).accel(entry.name).expect(entry.name);
        for (from, up) in [(0.0, 2.0), (9.0, -2.0)] {
            let ray = Ray::new(Vec3::new(0.1, 0.2, from), Vec3::new(0.0, 0.0, up));
            for (t_min, t_max, expected) in [
                (0.0, f32::INFINITY, Some((0.5, 0))),
                (1.25, f32::INFINITY, Some((1.5, 2))),
                (-5.0, 0.75, Some((0.5, 0))),
                (0.7, 0.9, None),
                (4.2, f32::INFINITY, None),
                (-3.0, -1.0, None),
                (f32::NEG_INFINITY, f32::MAX, Some((0.5, 0))),
            ] {
                let ray = ray.with_range(t_min, t_max);
                let hit = accel.closest_hit(&ray);
                assert_eq!(accel.any_hit(&ray), expected.is_some(), "{}: {ray:?}", entry.name);
                assert_eq!(hit.is_some(), expected.is_some(), "{}: {ray:?}", entry.name);
                if let (Some(hit), Some((t, nth))) = (hit, expected) {
                    assert!((hit.t - t).abs() < 1e-5, "{}: {hit:?} for {t}", entry.name);
                    assert_eq!(hit.prim, if up > 0.0 { nth } else { 7 - nth }, "{}: {ray:?}", entry.name);
                }
            }
        }
    }
}

/// From inside a closed ball at its corners: none of ours leaks, or names another triangle than the first of those that share
/// the corner; every peer does one or the other.
#[test]
fn at_shared_corners_peers_differ_and_ours_do_not() {
    let triangles = ball(24);
    let brute = scene(&triangles).accel("brute").expect("always there");
    let mut random = Random::new(3);
    let rays: Vec<Ray> = (0..1000)
        .map(|_| {
            let (origin, corner) = (0.4 * random.in_cube(), triangles[random.below(triangles.len())][random.below(3)]);
            Ray::new(origin, corner - origin)
        })
        .collect();
    let truth: Vec<Option<u32>> = rays.iter().map(|ray| prim(brute.closest_hit(ray))).collect();
    assert!(truth.iter().all(Option::is_some), "a closed ball has no holes");
    let differing = |accel: &dyn Accel| {
        rays.iter().zip(&truth).filter(|(ray, expected)| prim(accel.closest_hit(ray)) != **expected).count()
    };
    for name in ["grid", "grid-octant", "bsp", "obvhs-cwbvh"] {
        let accel = scene(&triangles).accel(name).expect(name);
        assert_eq!(differing(&*accel), 0, "{name}");
    }
    for entry in peers() {
        let accel = scene(&triangles).accel(entry.name).expect(entry.name);
        assert!(differing(&*accel) > 0, "{}: exact after all, so the registry should say so", entry.name);
    }
}

/// Any bits in a ray: an answer in range and an end. Embree with assertions would end the process.
#[test]
fn no_ray_harms_a_peer() {
    let triangles = soup(200, 0.5, 4);
    let mut random = Random::new(5);
    let special = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        1e-45,
        -1e-45,
        1e-38,
        1e-20,
        1e18,
        -1e18,
        1.9e18,
        1e20,
        f32::MAX,
        f32::MIN,
        f32::INFINITY,
        f32::NEG_INFINITY,
        f32::NAN,
    ];
    let mut number = |bits: bool| match random.next() % 4 {
        0 if bits => f32::from_bits(random.next() as u32),
        1 => random.signed(),
        _ => special[random.below(special.len())],
    };
    let mut vector = |bits| Vec3::new(number(bits), number(bits), number(bits));
    let rays: Vec<Ray> = (0..40_000)
        .map(|i| {
            let (range, bits) = (vector(false), i % 2 == 0);
            Ray::new(vector(bits), vector(bits)).with_range(range.x, range.y)
        })
        .collect();
    for entry in peers() {
        let accel = scene(&triangles).accel(entry.name).expect(entry.name);
        for ray in &rays {
            accel.any_hit(ray);
            if let Some(hit) = accel.closest_hit(ray) {
                assert!(ray.intake().is_some(), "{}: {ray:?} is no ray", entry.name);
                assert!((hit.prim as usize) < triangles.len(), "{}: {hit:?}", entry.name);
                assert!(!(hit.t < 0.0 || hit.t > ray.t_max), "{}: {hit:?} of {ray:?}", entry.name);
            }
        }
    }
}

/// Corners that are not finite or far beyond all others, no extent, no triangle at all: the good ones are found.
#[test]
fn no_triangle_harms_a_peer() {
    let good = soup(50, 0.3, 6);
    let bad = [
        [Vec3::NAN; 3],
        [Vec3::ZERO, Vec3::X, Vec3::new(0.0, f32::INFINITY, 0.0)],
        [Vec3::ZERO, Vec3::X, Vec3::splat(1e20)],
        [Vec3::splat(-3e38), Vec3::splat(3e38), Vec3::X],
        [Vec3::splat(0.5); 3],
        [Vec3::ZERO, Vec3::ZERO, Vec3::X],
        [Vec3::ZERO, Vec3::splat(1e-40), Vec3::X],
    ];
    let mixed: Vec<Triangle> = good.iter().enumerate().flat_map(|(i, t)| [bad[i % bad.len()], *t]).collect();
    let mut random = Random::new(7);
    let rays: Vec<Ray> = (0..500).map(|_| Ray::new(3.0 * random.in_cube(), random.in_cube())).collect();
    for entry in peers() {
        for nothing in [vec![], bad[..4].to_vec()] {
            let accel = scene(&nothing).accel(entry.name).expect(entry.name);
            assert!(rays.iter().all(|ray| !accel.any_hit(ray) && accel.closest_hit(ray).is_none()), "{}", entry.name);
        }
        let (alone, mixed) = (scene(&good).accel(entry.name), scene(&mixed).accel(entry.name));
        let (alone, mixed) = (alone.expect(entry.name), mixed.expect(entry.name));
        assert!(mixed.describe().contains("29 primitives left out"), "{}: {}", entry.name, mixed.describe());
        // A tree over other boxes may lose other rays at an edge, but next to none.
        let same = |ray: &&Ray| prim(mixed.closest_hit(ray)) == prim(alone.closest_hit(ray)).map(|p| 2 * p + 1);
        let differing = rays.len() - rays.iter().filter(same).count();
        assert!(differing <= 2, "{}: {differing} of {} rays differ", entry.name, rays.len());
    }
    // Extents that f32 cannot square: obvhs panics over some, which must end as an error.
    for scale in [1e-38, 1e-20, 1e15, 1e18] {
        let scaled: Vec<Triangle> = good.iter().map(|t| t.map(|c| c * scale)).collect();
        for entry in peers() {
            match scene(&scaled).accel(entry.name) {
                Ok(accel) => rays.iter().for_each(|ray| {
                    accel.closest_hit(&Ray::new(ray.origin * scale, ray.direction));
                }),
                Err(error) => assert!(error.to_string().contains("panics while it builds over 50"), "{error}"),
            }
        }
    }
}

/// Embree works with denormal numbers flushed to zero; it must not leave the processor so, or our tests are not exact.
#[test]
fn building_and_tracing_leave_arithmetic_alone() {
    let triangles = soup(5000, 0.1, 8);
    for entry in peers() {
        let accel = scene(&triangles).accel(entry.name).expect(entry.name);
        accel.closest_hit(&Ray::new(Vec3::splat(2.0), Vec3::NEG_ONE));
        let tiny = std::hint::black_box(f32::MIN_POSITIVE) * std::hint::black_box(0.25);
        assert_eq!(tiny.to_bits(), 0x0020_0000, "{}: denormal numbers became zero", entry.name);
    }
}

#[test]
fn peers_trace_in_several_threads_at_once() {
    let triangles = soup(2000, 0.2, 9);
    let mut random = Random::new(10);
    let rays: Vec<Ray> = (0..5000).map(|_| Ray::new(2.0 * random.in_cube(), random.in_cube())).collect();
    for entry in peers() {
        let accel = scene(&triangles).accel(entry.name).expect(entry.name);
        let trace = || rays.iter().map(|ray| accel.closest_hit(ray)).collect::<Vec<_>>();
        let alone = trace();
        std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(trace)).collect();
            threads.into_iter().for_each(|t| assert_eq!(t.join().expect("no panic"), alone, "{}", entry.name));
        });
    }
}

#[test]
fn peers_take_one_kind_of_primitive_and_some_triangles_alone() {
    let sphere = |x: f32, radius| Sphere { centre: Vec3::X * x, radius };
    let spheres = vec![sphere(0.0, 1.0), sphere(5.0, 2.0), sphere(5.0, -1.0), sphere(9.0, 1.5)];
    let mixed = Mixed { triangles: vec![[Vec3::ZERO, Vec3::X, Vec3::Y]], spheres: spheres.clone() };
    for entry in peers() {
        let name = entry.name;
        let round = entry.needs == Needs::OneKind;
        assert_eq!((entry.suits(&spheres), entry.suits(&mixed)), (round, false), "{name}");
        let Err(error) = SceneGeometry::Mixed(Arc::new(mixed.clone())).accel(name) else { panic!("{name} was built") };
        let text = error.to_string();
        assert_eq!(
            text,
            format!("accelerator `{name}`: needs a scene of triangles alone, but primitive 1 of 5 is none")
        );
        let built = SceneGeometry::Spheres(Arc::new(spheres.clone())).accel(name);
        if !round {
            assert!(built.is_err_and(|e| e.to_string().contains("primitive 0 of 4 is none")), "{name}");
            continue;
        }
        let accel = built.unwrap_or_else(|e| panic!("{e}"));
        // By hand: the near side of the first, the far side of it from within, a sphere beyond, past all, and a short ray.
        // The direction has length 2.
        for (x, y, range, right) in [
            (-3.0, 0.0, (0.0, f32::INFINITY), Some((1.0, 0))),
            (0.0, 0.0, (0.0, f32::INFINITY), Some((0.5, 0))),
            (1.5, 0.0, (0.0, f32::INFINITY), Some((0.75, 1))),
            (-3.0, 1.5, (0.0, f32::INFINITY), Some(((8.0 - 1.75_f32.sqrt()) / 2.0, 1))),
            (-3.0, 2.5, (0.0, f32::INFINITY), None),
            (-3.0, 0.0, (0.0, 0.9), None),
            (-3.0, 0.0, (2.5, 4.5), Some((3.0, 1))),
        ] {
            let ray = Ray::new(Vec3::new(x, y, 0.0), 2.0 * Vec3::X).with_range(range.0, range.1);
            let hit = accel.closest_hit(&ray);
            assert_eq!(prim(hit), right.map(|(_, prim)| prim), "{name} {x} {y} {range:?}: {hit:?}");
            assert_eq!(accel.any_hit(&ray), right.is_some(), "{name} {x} {y} {range:?}");
            if let (Some(hit), Some((t, _))) = (hit, right) {
                // A few roundings of f32.
                assert!((hit.t - t).abs() <= 1e-6 * t.max(1.0), "{name} {x} {y}: {} for {t}", hit.t);
            }
        }
    }
}

/// Without a feature, its accelerators are unknown, but how to get them is not.
#[test]
fn what_is_left_out_says_how_to_get_it() {
    for (name, feature) in registry::LEFT_OUT {
        assert!(registry::ENTRIES.iter().all(|entry| entry.name != *name));
        let Err(error) = scene(&[[Vec3::ZERO, Vec3::X, Vec3::Y]]).accel(name) else { panic!("{name} was built") };
        let text = error.to_string();
        assert!(text.contains(&format!("`cargo build --features {feature}` brings it in")), "{text}");
    }
}

fn skipgrid(args: &[&str], embree: Option<&str>) -> (Option<i32>, String, String) {
    let embree = embree.map(|path| ("SKIPGRID_EMBREE", path));
    crate::ended(crate::program(Path::new(".")).args(args).envs(embree))
}

#[test]
fn a_missing_embree_is_named_and_costs_nothing_else() {
    let gone = Some("no/such/library.so");
    let (code, _, error) = skipgrid(&["info", "bumpy:n=8", "--accel", "embree"], gone);
    assert_eq!(code, Some(2), "{error}");
    for part in ["accelerator `embree`: needs Embree 3 or 4", "SKIPGRID_EMBREE=no/such/library.so"] {
        assert!(error.contains(part), "{error}");
    }
    let (code, list, _) = skipgrid(&["list"], gone);
    assert_eq!(code, Some(0));
    assert_eq!(list.matches("NOT AVAILABLE: needs Embree 3 or 4").count(), 2, "{list}");
    // A library, but not the right one.
    let (code, _, error) = skipgrid(&["info", "bumpy:n=8", "--accel", "embree-robust"], Some("libc.so.6"));
    assert_eq!(code, Some(2), "{error}");
    assert!(error.contains("needs Embree 3 or 4"), "{error}");
}

#[test]
fn compare_says_how_peers_differ_and_does_not_fail() {
    let args = ["compare", "bumpy:n=12", "--size", "32x32", "--rounds", "1"];
    let names = ["--accel", "obvhs-native-cwbvh", "--accel", "grid", "--accel", "brute"];
    let (code, out, error) = skipgrid(&[&args[..], &names].concat(), None);
    assert_eq!(code, Some(0), "{error}");
    assert!(out.contains("identical hits: grid, brute gave"), "{out}");
    let line =
        out.lines().find(|line| line.starts_with("obvhs-native-cwbvh, which promises no exact answers, against grid"));
    assert!(line.is_some(), "{out}");
    let (code, out, _) = skipgrid(&[&args[..], &names, &["--format", "json"]].concat(), None);
    let value: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!((code, &value["identical"], &value["truth"]), (Some(0), &true.into(), &"grid".into()));
    let rows = value["accelerators"].as_array().expect("rows");
    let differing = |row: &serde_json::Value| {
        row["deviations"].as_object().expect("counts").values().filter_map(serde_json::Value::as_u64).sum::<u64>()
    };
    assert_eq!(rows.iter().map(|row| row["exact"] == true).collect::<Vec<_>>(), [false, true, true]);
    assert!(differing(&rows[0]) > 0, "f32 gives some t other bits: {out}");
    assert_eq!((differing(&rows[1]), differing(&rows[2])), (0, 0));
    // With no exact one among them, the first is the measure, and nothing can fail.
    let (code, out, _) = skipgrid(&[&args[..], &names[..2]].concat(), None);
    assert_eq!(code, Some(0));
    assert!(out.contains("none of the accelerators promises exact answers"), "{out}");
}

#[test]
fn papers_count_wrong_rays_of_peers_and_hold_nothing_against_them() {
    let args = ["papers", "spd", "--quick", "--size", "16", "--scene", "bumpy:n=8", "--format", "json"];
    let (code, out, error) = skipgrid(&[&args[..], &["--accel", "obvhs-native-bvh2"]].concat(), None);
    assert_eq!(code, Some(0), "{error}");
    let value: serde_json::Value = serde_json::from_str(&out).expect("JSON");
    assert_eq!(value["wrong"], 0);
    let tables = value["tables"].as_array().expect("tables").iter().flat_map(|t| t["rows"].as_array().expect("rows"));
    let peer =
        tables.filter(|row| row["accelerator"] == "obvhs-native-bvh2").find_map(|row| row["wrong rays"].as_f64());
    assert!(peer > Some(0.0), "f32 gives some t other bits: {out}");
}
