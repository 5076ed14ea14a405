//! Many threads at once: the same answers as one, and no race for a thread sanitizer to find.
//!
//! Needs neither program nor scenes, so that it can be built with a sanitizer in little time; `.ci/races` does that.

use glam::Vec3;
use skipgrid::{Accel, Hit, Ray, Triangle, registry};
use std::sync::{Arc, Barrier, Mutex};

/// Seeded numbers (SplitMix64).
struct Random(u64);

impl Random {
    fn unit(&mut self) -> f32 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let z = (self.0 ^ (self.0 >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        let z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        ((z ^ (z >> 31)) >> 40) as f32 / 16_777_216.0
    }

    fn vector(&mut self) -> Vec3 {
        Vec3::from([(); 3].map(|()| 2.0 * self.unit() - 1.0))
    }
}

/// A soup with a fan in it, so that the exact stage and its memory are at work, and copies.
fn scene() -> Vec<Triangle> {
    let mut random = Random(5);
    let mut triangles: Vec<Triangle> = (0..400)
        .map(|_| {
            let p = random.vector();
            [p, p + 0.3 * random.vector(), p + 0.3 * random.vector()]
        })
        .collect();
    let rim = |i: u16| {
        let (sin, cos) = (f32::from(i) * 0.1).sin_cos();
        Vec3::new(cos, sin, -1.5)
    };
    triangles.extend((0..60).map(|i| [Vec3::ZERO, rim(i), rim(i + 1)]));
    triangles.extend_from_within(100..140);
    triangles
}

fn rays() -> Vec<Ray> {
    let mut random = Random(6);
    let ray = |i: u32| {
        let origin = 3.0 * random.vector();
        let target = if i.is_multiple_of(3) { Vec3::ZERO } else { random.vector() };
        Ray::new(origin, target - origin)
    };
    (0..600).map(ray).collect()
}

fn specs() -> Vec<String> {
    let exact = registry::ENTRIES.iter().filter(|e| e.exact && e.needs == registry::Needs::Any);
    let options = ["grid:mailbox=on", "grid:step=branchless", "bsp:planes=sah", "grid-dsz:landing=paper"];
    exact.map(|e| e.name.to_string()).chain(options.map(String::from)).collect()
}

fn bits(hit: Option<Hit>) -> Option<(u32, u32)> {
    hit.map(|hit| (hit.prim, hit.t.to_bits()))
}

/// What `threads` threads find that trace through one accelerator, each its share of the rays, from the same moment on.
fn traced(accel: &Arc<dyn Accel>, rays: &[Ray], threads: usize) -> Vec<(Option<(u32, u32)>, bool)> {
    let found = Mutex::new(vec![(None, false); rays.len()]);
    let start = Barrier::new(threads);
    std::thread::scope(|scope| {
        for first in 0..threads {
            let (accel, found, start) = (Arc::clone(accel), &found, &start);
            scope.spawn(move || {
                start.wait();
                let mine = (first..rays.len()).step_by(threads);
                let answers: Vec<_> =
                    mine.map(|i| (i, bits(accel.closest_hit(&rays[i])), accel.any_hit(&rays[i]))).collect();
                let mut found = found.lock().expect("no thread panics");
                answers.into_iter().for_each(|(i, hit, any)| found[i] = (hit, any));
            });
        }
    });
    found.into_inner().expect("no thread panics")
}

#[test]
fn one_accelerator_serves_any_number_of_threads() {
    let (triangles, rays) = (Arc::new(scene()), rays());
    for spec in specs() {
        let accel: Arc<dyn Accel> = registry::build(&spec, Arc::clone(&triangles)).expect("it can be built").into();
        let alone = traced(&accel, &rays, 1);
        assert!(alone.iter().filter(|(hit, _)| hit.is_some()).count() > 200, "{spec}");
        for threads in [2, 16] {
            assert_eq!(traced(&accel, &rays, threads), alone, "{spec}: {threads} threads");
        }
    }
}

#[test]
fn accelerators_built_at_once_are_alike() {
    let (triangles, rays) = (Arc::new(scene()), rays());
    for spec in specs() {
        let start = Barrier::new(4);
        let build = || {
            start.wait();
            let accel = registry::build(&spec, Arc::clone(&triangles)).expect("it can be built");
            let hits: Vec<_> = rays.iter().map(|ray| bits(accel.closest_hit(ray))).collect();
            (accel.memory(), accel.describe().split("LANDING").next().map(str::to_owned), hits)
        };
        let built: Vec<_> = std::thread::scope(|scope| {
            let threads: Vec<_> = (0..4).map(|_| scope.spawn(build)).collect();
            threads.into_iter().map(|thread| thread.join().expect("no thread panics")).collect()
        });
        assert!(built.windows(2).all(|pair| pair[0] == pair[1]), "{spec}");
    }
}

/// Skip tables, grids and shadow voxels that are built by 1, 2 and 16 threads are the same.
#[cfg(feature = "parallel")]
#[test]
fn the_number_of_threads_does_not_show_in_what_is_built() {
    use skipgrid::accel::PointShadows;
    use skipgrid::grid::{GridOptions, ShadowVoxels};
    let (triangles, rays) = (Arc::new(scene()), rays());
    let lights = [Vec3::new(0.0, 0.0, 4.0).as_dvec3(), Vec3::new(3.0, -3.0, 0.0).as_dvec3()];
    let with = |threads: usize| {
        let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().expect("threads can be started");
        pool.install(|| {
            let tables: Vec<_> = specs()
                .iter()
                .map(|spec| {
                    let accel = registry::build(spec, Arc::clone(&triangles)).expect("it can be built");
                    let mut counts = skipgrid::accel::Counts::default();
                    let hits: Vec<_> =
                        rays.iter().map(|ray| bits(accel.closest_hit_counted(ray, &mut counts))).collect();
                    (hits, counts, accel.memory())
                })
                .collect();
            let options = GridOptions { density: 8.0, ..GridOptions::default() };
            let shadows = ShadowVoxels::build(Arc::clone(&triangles), &lights, &options).expect("it can be built");
            let ask = |(prim, corners): (usize, &Triangle)| {
                let origin = (corners[0] + corners[1] + corners[2]) / 3.0;
                let ray = Ray::new(origin, lights[0].as_vec3() - origin).with_range(1e-3, 0.999);
                format!("{:?}", shadows.ask(0, prim as u32, &ray))
            };
            let asked: Vec<String> = triangles.iter().enumerate().map(ask).collect();
            (tables, asked)
        })
    };
    let alone = with(1);
    for threads in [2, 16] {
        assert_eq!(with(threads), alone, "{threads} threads");
    }
}
