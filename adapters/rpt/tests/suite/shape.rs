//! What rpt asks of a shape beside hits: ranges, samples, boxes, transformed copies; and what cannot be built.

use crate::{EPSILON, ask, ask_all, corners, double, rays, triangles};
use glam::Vec3;
use rand::{SeedableRng, rngs::StdRng};
use rpt::{Bounded, HitRecord, KdTree, Ray, Shape, Transformable, Triangle, cube, glm, sphere};
use skipgrid::Accel;
use skipgrid::grid::{Grid, GridOptions};
use skipgrid_rpt::Accelerated;
use std::sync::Arc;

fn square(z: f32) -> [Triangle; 2] {
    let at = |x: f32, y: f32| double(Vec3::new(x, y, z));
    [[at(0.0, 0.0), at(1.0, 0.0), at(1.0, 1.0)], [at(0.0, 0.0), at(1.0, 1.0), at(0.0, 1.0)]]
        .map(|[a, b, c]| Triangle::from_vertices(a, b, c))
}

#[test]
fn only_times_in_the_range_count() {
    let list: Vec<Triangle> = (1..=3).flat_map(|z| square(z as f32)).collect();
    let mesh = Accelerated::new(list, "nested").expect("finite triangles");
    // Time counts in the direction's length; rpt takes rays for parallel to a triangle below 1e-8.
    for length in [1.0, 0.5, 1e-7, 1e20] {
        let ray = Ray { origin: glm::vec3(0.3, 0.2, 0.0), dir: glm::vec3(0.0, 0.0, length) };
        for (t_min, limit, hit) in [
            (0.0, f64::INFINITY, Some(1.0)),
            (1.0, f64::INFINITY, Some(1.0)),
            (1.0 + 1e-15, f64::INFINITY, Some(2.0)),
            (1.5, 2.0, None),
            (1.5, 2.0 + 1e-15, Some(2.0)),
            (-5.0, 0.9, None),
            (3.5, f64::INFINITY, None),
        ] {
            let mut record = HitRecord { time: limit / length, normal: glm::vec3(7.0, 7.0, 7.0) };
            assert_eq!(mesh.intersect(&ray, t_min / length, &mut record), hit.is_some(), "{t_min} {limit} {length}");
            assert_eq!(record.time, hit.unwrap_or(limit) / length);
            assert_eq!(record.normal.z, if hit.is_some() { 1.0 } else { 7.0 });
        }
    }
    for dir in [glm::vec3(0.0, 0.0, 0.0), glm::vec3(f64::NAN, 0.0, 1.0), glm::vec3(f64::INFINITY, 0.0, 1.0)] {
        assert!(!mesh.intersect(&Ray { origin: glm::vec3(0.3, 0.2, 0.0), dir }, EPSILON, &mut HitRecord::new()));
    }
}

/// A bounce of rpt begins on the surface: it must neither hit that again nor pass through the next one.
#[test]
fn bounces_start_on_a_surface() {
    let z = 1.0 + f32::EPSILON; // the next one is one unit in the last place of f32 away
    let list: Vec<Triangle> = square(1.0).into_iter().chain(square(z)).collect();
    let mesh = Accelerated::new(list, "grid").expect("finite triangles");
    let ray = Ray { origin: glm::vec3(0.3, 0.2, 1.0), dir: glm::vec3(0.0, 0.0, 1.0) };
    assert_eq!(ask(&mesh, &ray).0, f64::from(f32::EPSILON));
}

#[test]
fn objects_of_other_kinds_and_copies_of_meshes_are_objects() {
    let list = triangles(&corners("bumpy:n=16"));
    let place = |i: usize| glm::vec3((i % 4) as f64 * 1.7, (i / 4) as f64 * 1.9, (i * i % 5) as f64);
    let mesh = Arc::new(Accelerated::new(list.clone(), "nested").expect("finite triangles"));
    let copies: Vec<_> = (0..16).map(|i| Arc::clone(&mesh).rotate_y(i as f64).translate(&place(i))).collect();
    let ours = Accelerated::new(copies, "grid-octant").expect("finite boxes");
    let tree = Arc::new(KdTree::new(list));
    let theirs: Vec<_> = (0..16).map(|i| Arc::clone(&tree).rotate_y(i as f64).translate(&place(i))).collect();

    let balls: Vec<_> = (0..40).map(|i| sphere().scale(&glm::vec3(0.3, 0.2, 0.5)).translate(&place(i))).collect();
    let grid = |objects| Grid::<_>::build(objects, &GridOptions::default());
    let by_type = Accelerated::with(balls.clone(), grid).expect("finite boxes");
    assert!(by_type.accel().memory().total() > 0);
    let cubes: Vec<_> = (0..40).map(|i| cube().rotate_x(0.3).translate(&place(i))).collect();
    let boxes = Accelerated::new(cubes.clone(), "obvhs-cwbvh").expect("finite boxes");

    let (low, high) = (Vec3::splat(-2.0), Vec3::new(7.0, 20.0, 6.0));
    let mut hits = [0; 3];
    for (origin, direction) in rays(&[[low, high, Vec3::new(7.0, -2.0, 6.0)]], 4000) {
        let ray = Ray { origin: double(origin), dir: double(direction).normalize() };
        let answers = [
            [ask(&ours, &ray), ask_all(&theirs, &ray)],
            [ask(&by_type, &ray), ask_all(&balls, &ray)],
            [ask(&boxes, &ray), ask_all(&cubes, &ray)],
        ];
        for (hits, [ours, theirs]) in hits.iter_mut().zip(answers) {
            assert_eq!(ours, theirs, "{origin} {direction}");
            *hits += usize::from(ours.0.is_finite());
        }
    }
    assert!(hits.iter().all(|&hits| hits > 100), "{hits:?}");
}

/// The mean of one over the density is the area, whatever is sampled how often.
#[test]
fn samples_lie_on_the_objects_with_their_density() {
    let list: Vec<Triangle> = (1..=3).flat_map(|z| square(z as f32)).collect();
    let mesh = Accelerated::new(list.clone(), "nested").expect("finite triangles");
    let mut random = StdRng::seed_from_u64(5);
    let mut seen = [0; 3];
    for _ in 0..3000 {
        let (point, normal, density) = mesh.sample(&glm::vec3(0.0, 0.0, 0.0), &mut random);
        assert!((0.0..=1.0).contains(&point.x) && (0.0..=1.0).contains(&point.y) && normal.z == 1.0);
        assert!((density - 1.0 / 3.0).abs() < 1e-12, "three squares of area 1: {density}");
        seen[point.z as usize - 1] += 1;
    }
    // Binomial with p = 1/3: a standard deviation of 25.8.
    assert!(seen.iter().all(|&n: &i32| (n - 1000).abs() < 6 * 26), "{seen:?}");
    let [ours, theirs] = [mesh.bounding_box(), KdTree::new(list).bounding_box()];
    assert_eq!((ours.p_min, ours.p_max), (theirs.p_min, theirs.p_max));
}

#[test]
fn what_cannot_be_built_is_refused_with_the_reason() {
    let said = |list: Vec<Triangle>, spec: &str| Accelerated::new(list, spec).err().expect("refused").to_string();
    assert_eq!(said(vec![], "nested"), "0 objects, where 1 to 2^32 - 2 can be told apart");
    let mut bad = square(1.0).to_vec();
    bad[1].v2.y = f64::INFINITY;
    assert!(said(bad, "nested").starts_with("object 1 of 2 has a box that is not finite"));
    let good = || square(1.0).to_vec();
    assert!(said(good(), "netsed").contains("did you mean `nested`"));
    assert!(said(good(), "grid:density=x").contains("`density` cannot be `x`"));
    assert!(said(good(), "voxels").contains("solid voxels"));
}
