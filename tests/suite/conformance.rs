//! Every registered accelerator against brute force, to the bit, on small scenes that are hard to get right.
//!
//! The accelerators are those of [`SceneGeometry`], compiled in the library, so that the tests need not compile them all again.

use crate::random::Random;
use glam::Vec3;
use skipgrid::geometry::Mixed;
use skipgrid::scene::SceneGeometry;
use skipgrid::{Accel, Hit, Ray, Sphere, Triangle, registry};
use std::sync::Arc;

/// Triangles as a scene has them.
pub fn triangles(list: &[Triangle]) -> SceneGeometry {
    SceneGeometry::Triangles(Arc::new(list.to_vec()))
}

/// Every entry of the registry that can be built over `geometry`, and the options that change what is built.
pub fn specs(geometry: &SceneGeometry) -> Vec<String> {
    registry::variants(matches!(geometry, SceneGeometry::Voxels(_)))
}

pub fn bits(hit: Option<Hit>) -> Option<(u32, u32)> {
    hit.map(|h| (h.prim, h.t.to_bits()))
}

/// Every accelerator that can be built over `geometry`, as [`check_with`] does.
pub fn check(name: &str, geometry: &SceneGeometry, rays: &[Ray]) {
    check_with(&specs(geometry), name, geometry, rays);
}

/// As brute force answers, to the bit, whichever way each of the accelerators is asked.
pub fn check_with(specs: &[String], name: &str, geometry: &SceneGeometry, rays: &[Ray]) {
    let brute = geometry.accel("brute").unwrap();
    let truth: Vec<_> = rays.iter().map(|r| bits(brute.closest_hit(r))).collect();
    for spec in specs {
        let accel = geometry.accel(spec).unwrap_or_else(|e| panic!("{name}: {spec}: {e}"));
        assert_eq!(accel.bounds(), brute.bounds(), "{name}: {spec}");
        for (ray, &expected) in rays.iter().zip(&truth) {
            let found = bits(accel.closest_hit(ray));
            assert_eq!(found, expected, "{name}: {spec}: {} (prim, t bits)", show(ray));
            assert_eq!(accel.any_hit(ray), expected.is_some(), "{name}: {spec}: any hit of {}", show(ray));
            let mut counts = skipgrid::accel::Counts::default();
            assert_eq!(bits(accel.closest_hit_counted(ray, &mut counts)), expected, "{name}: {spec}: counted");
            assert_eq!(accel.any_hit_counted(ray, &mut counts), expected.is_some(), "{name}: {spec}: counted");
            assert_eq!(counts.rays, 2);
        }
    }
}

fn show(ray: &Ray) -> String {
    let bits = |v: Vec3| v.to_array().map(|x| format!("{:08x}", x.to_bits())).join(" ");
    format!(
        "ray {ray:?} = {} {} {:08x} {:08x}",
        bits(ray.origin),
        bits(ray.direction),
        ray.t_min.to_bits(),
        ray.t_max.to_bits()
    )
}

/// Rays of every class around and within a box: random, aimed at the given points, axis-parallel with both zeros, in planes
/// and along diagonals, far away, tiny and huge directions, short ranges, and rays that are none.
pub fn rays(random: &mut Random, centre: Vec3, size: f32, targets: &[Vec3]) -> Vec<Ray> {
    let mut rays = Vec::new();
    let target = |random: &mut Random| targets[random.below(targets.len())];
    for _ in 0..60 {
        let origin = centre + size * 2.0 * random.in_cube();
        rays.push(Ray::new(origin, random.in_cube()));
        let to = target(random) - origin;
        rays.push(Ray::new(origin, to));
        rays.push(Ray::new(origin, to.normalize_or_zero()));
        rays.push(Ray::new(target(random), random.in_cube()));
        rays.push(Ray::new(target(random), target(random) - target(random)));
        for zero in [0.0, -0.0] {
            let mut d = Vec3::splat(zero);
            d[random.below(3)] = if random.below(2) == 0 { 1.0 } else { -1.0 };
            rays.push(Ray::new(target(random) - d * size * 3.0, d));
            rays.push(Ray::new(target(random), d));
            let mut d = random.in_cube();
            d[random.below(3)] = zero;
            rays.push(Ray::new(target(random) - d * size, d));
        }
        let diagonal = Vec3::from([0, 1, 2].map(|_| if random.below(2) == 0 { 1.0_f32 } else { -1.0 }));
        rays.push(Ray::new(target(random) - diagonal * size, diagonal));
        let far = random.in_cube() * size * [1e3_f32, 1e6, 1e9, 1e12][random.below(4)];
        rays.push(Ray::new(target(random) + far, -far));
        for scale in [1e-40_f32, 1e-20, 1e20] {
            rays.push(Ray::new(origin, to * scale));
        }
        let minor = Vec3::new(1.0, 1e-30, -1e-42);
        rays.push(Ray::new(target(random) - minor * size, minor));
        let hit = Ray::new(origin, to);
        rays.push(hit.with_range(1.0, 1.0));
        rays.push(hit.with_range(0.5, 1.0));
        rays.push(hit.with_range(1.0, 2.0));
        rays.push(hit.with_range(f32::NEG_INFINITY, 0.5));
        rays.push(hit.with_range(-3.0, f32::INFINITY));
        rays.push(hit.with_range(0.0, 0.999));
    }
    for bad in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY, f32::MAX] {
        for axis in 0..3 {
            let mut v = Vec3::ONE;
            v[axis] = bad;
            rays.push(Ray::new(v, Vec3::X));
            rays.push(Ray::new(centre, v));
        }
        rays.push(Ray::new(centre, Vec3::X).with_range(bad, 1.0));
        rays.push(Ray::new(centre, Vec3::X).with_range(0.0, bad));
    }
    rays.push(Ray::new(centre, Vec3::ZERO));
    rays
}

fn check_triangles(name: &str, seed: u64, triangles: &[Triangle]) {
    let mut random = Random::new(seed);
    let finite: Vec<Vec3> = triangles.iter().flatten().copied().filter(|p| p.is_finite()).collect();
    let (min, max) = finite.iter().fold((Vec3::MAX, Vec3::MIN), |(a, b), &p| (a.min(p), b.max(p)));
    let centre = min * 0.5 + max * 0.5;
    let set = self::triangles(triangles);
    check(name, &set, &rays(&mut random, centre, (max - min).max_element().max(1e-44), &finite));
}

#[test]
fn random_triangles_agree() {
    let mut random = Random::new(1);
    let triangles: Vec<Triangle> = (0..400)
        .map(|_| {
            let p = random.in_cube();
            [p, p + 0.2 * random.in_cube(), p + 0.2 * random.in_cube()]
        })
        .collect();
    check_triangles("soup", 2, &triangles);
    for scale in [1e-37_f32, 1e-20, 1e18, 1e37] {
        let scaled: Vec<Triangle> = triangles.iter().map(|t| t.map(|p| p * scale)).collect();
        check_triangles(&format!("soup x {scale:e}"), 3, &scaled);
    }
    for offset in [1e3_f32, 1e6] {
        let moved: Vec<Triangle> = triangles.iter().map(|t| t.map(|p| p + offset)).collect();
        check_triangles(&format!("soup + {offset:e}"), 4, &moved);
    }
}

#[test]
fn lattices_of_shared_edges_agree() {
    // A box of quads on integer coordinates: rays along its planes, edges and diagonals meet many corners exactly.
    let mut triangles = Vec::new();
    for axis in 0..3 {
        for side in [0.0, 4.0] {
            for i in 0..4 {
                for j in 0..4 {
                    let at = |u: i32, v: i32| {
                        let mut p = Vec3::ZERO;
                        p[axis] = side;
                        p[(axis + 1) % 3] = u as f32;
                        p[(axis + 2) % 3] = v as f32;
                        p
                    };
                    triangles.push([at(i, j), at(i + 1, j), at(i + 1, j + 1)]);
                    triangles.push([at(i, j), at(i + 1, j + 1), at(i, j + 1)]);
                }
            }
        }
    }
    check_triangles("lattice box", 5, &triangles);
    let doubled: Vec<Triangle> = triangles.iter().chain(triangles.iter().rev()).copied().collect();
    check_triangles("lattice box, every triangle twice", 6, &doubled);
}

#[test]
fn slivers_fans_and_flat_scenes_agree() {
    let needles: Vec<Triangle> = (0..200)
        .map(|i| {
            let x = i as f32 * 1e-6;
            [Vec3::new(x, 0.0, 0.0), Vec3::new(x + 1e-6, 0.0, 0.0), Vec3::new(x, 1.0, 0.0)]
        })
        .collect();
    check_triangles("needles", 7, &needles);
    let rim = |i: i32| {
        let a = i as f32 * 0.0785;
        Vec3::new(a.cos(), a.sin(), 0.5)
    };
    let fan: Vec<Triangle> = (0..80).map(|i| [Vec3::ZERO, rim(i), rim(i + 1)]).collect();
    check_triangles("fan", 8, &fan);
    let mut random = Random::new(9);
    let flat: Vec<Triangle> =
        (0..200).map(|_| [0, 1, 2].map(|_| random.in_cube() * Vec3::new(1.0, 0.0, 1.0))).collect();
    check_triangles("flat", 10, &flat);
    check_triangles("one triangle", 11, &[[Vec3::ZERO, Vec3::X, Vec3::Y]]);
    check_triangles("one point", 12, &[[Vec3::ONE; 3]]);
    check_triangles(
        "coplanar overlap",
        13,
        &(0..60).map(|i| [Vec3::ZERO, Vec3::X, Vec3::Y + i as f32 * Vec3::X * 0.01]).collect::<Vec<_>>(),
    );
}

#[test]
fn mixed_scales_and_bad_vertices_agree() {
    let mut random = Random::new(14);
    let mut stadium: Vec<Triangle> = vec![
        [Vec3::new(-1e6, 0.0, -1e6), Vec3::new(1e6, 0.0, -1e6), Vec3::new(0.0, 0.0, 1e6)],
        [Vec3::new(-1e6, 0.0, 1e6), Vec3::new(1e6, 0.0, 1e6), Vec3::new(0.0, 1e6, 1e6)],
    ];
    stadium.extend((0..150).map(|_| {
        let p = random.in_cube();
        [p, p + 0.1 * random.in_cube(), p + 0.1 * random.in_cube()]
    }));
    check_triangles("stadium", 15, &stadium);
    let bad = [f32::NAN, f32::INFINITY, f32::NEG_INFINITY];
    for i in (0..stadium.len()).step_by(7) {
        stadium[i][random.below(3)][random.below(3)] = bad[random.below(3)];
        let p = stadium[i + 1][0];
        stadium[i + 1] = [p, p, stadium[i + 1][2]];
    }
    check_triangles("stadium with bad and degenerate triangles", 16, &stadium);
}

fn spheres(random: &mut Random, count: usize) -> Vec<Sphere> {
    (0..count)
        .map(|i| {
            let radius = [0.1, 0.01, 0.3, 1e-4][i % 4];
            Sphere { centre: random.in_cube(), radius }
        })
        .collect()
}

#[test]
fn spheres_and_mixtures_agree() {
    let mut random = Random::new(17);
    let mut balls = spheres(&mut random, 200);
    let targets: Vec<Vec3> = balls.iter().map(|s| s.centre + s.radius * random.in_cube()).collect();
    let shots = rays(&mut random, Vec3::ZERO, 1.0, &targets);
    let set = |balls: &[Sphere]| SceneGeometry::Spheres(Arc::new(balls.to_vec()));
    check("spheres", &set(&balls), &shots);
    balls.push(Sphere { centre: Vec3::new(0.0, -1e4, 0.0), radius: 1e4 });
    balls.push(balls[3]);
    balls.push(Sphere { centre: Vec3::ZERO, radius: f32::NAN });
    balls.push(Sphere { centre: Vec3::splat(f32::INFINITY), radius: 1.0 });
    balls.push(Sphere { centre: Vec3::ZERO, radius: -1.0 });
    check("spheres of all sizes", &set(&balls), &shots);
    let triangles: Vec<Triangle> = (0..200)
        .map(|_| {
            let p = random.in_cube();
            [p, p + 0.3 * random.in_cube(), p + 0.3 * random.in_cube()]
        })
        .collect();
    let mixed = SceneGeometry::Mixed(Arc::new(Mixed { triangles, spheres: balls }));
    check("triangles and spheres", &mixed, &shots);
}

#[test]
fn threads_and_forwarding_change_nothing() {
    let mut random = Random::new(18);
    let balls = spheres(&mut random, 300);
    let shots = rays(&mut random, Vec3::ZERO, 1.0, &balls.iter().map(|s| s.centre).collect::<Vec<_>>());
    let geometry = SceneGeometry::Spheres(Arc::new(balls));
    for spec in specs(&geometry) {
        let accel: Arc<dyn Accel> = Arc::from(geometry.accel(&spec).unwrap());
        let alone: Vec<_> = shots.iter().map(|r| bits(accel.closest_hit(r))).collect();
        let found: Vec<_> = std::thread::scope(|scope| {
            let halves = [shots.len() / 3, shots.len()];
            let handles: Vec<_> = halves
                .iter()
                .scan(0, |from, &to| Some((std::mem::replace(from, to), to)))
                .map(|(from, to)| {
                    let (accel, shots) = (&accel, &shots[from..to]);
                    scope.spawn(move || shots.iter().map(|r| bits((&accel).closest_hit(r))).collect::<Vec<_>>())
                })
                .collect();
            handles.into_iter().flat_map(|h| h.join().unwrap()).collect()
        });
        assert_eq!(alone, found, "{spec}");
    }
}
