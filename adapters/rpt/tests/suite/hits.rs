//! Hits equal rpt's own, to the last bit of time and normal; where they differ from its kd-tree's, exact arithmetic agrees.

use crate::{ask, ask_all, bunny, corners, double, rays, triangles};
use glam::Vec3;
use rpt::{Mesh, Ray};
use skipgrid::oracle::Oracle;
use skipgrid::registry::ENTRIES;
use skipgrid_rpt::{Accelerated, Objects};

fn in_double(&(origin, direction): &(Vec3, Vec3)) -> Ray {
    Ray { origin: double(origin), dir: double(direction) }
}

/// How far rpt's time of a triangle can be from the true one, in f64 of unit roundoff `u = 2^-53`.
///
/// The time is `n.w / n.d` with the unit normal `n`, from the cross product of two edges, and `w` from the origin to a corner.
/// Differences of f32 are exact in f64 or nearly. A component of the cross product is off by `2 u` of the edges' lengths'
/// product at most, so the vector by `2 sqrt(3) u` of it, which is that over the sine between them of the vector itself; making
/// it a unit adds `4 u`, and a dot product of three terms `4 u` of the lengths. Both dot products are off by as much of `|w|` and
/// of `|d|`, and the quotient by the sum over `|n.d|`.
fn rounding(corners: &[Vec3; 3], (origin, direction): &(Vec3, Vec3), time: f64) -> f64 {
    let [a, b, c] = corners.map(Vec3::as_dvec3);
    let (first, second, d) = (b - a, c - a, direction.as_dvec3());
    let cross = first.cross(second);
    let sine = cross.length() / (first.length() * second.length());
    let each = (2.0 * 3f64.sqrt() / sine + 8.0) * f64::EPSILON / 2.0;
    each * ((a - origin.as_dvec3()).length() + time * d.length()) / cross.normalize().dot(d).abs()
}

/// 200 000 rays over a mesh. Answers that differ are ties, or ours is right and the kd-tree's is wrong.
fn agrees_with_the_kd_tree(scene: &str) {
    let corners = corners(scene);
    let list = triangles(&corners);
    let rays = rays(&corners, 200_000);
    let tree = Mesh::new(list.clone());
    let theirs: Vec<_> = rays.iter().map(|ray| ask(&tree, &in_double(ray))).collect();
    let oracle = Oracle::of_triangles(&corners);
    for spec in ["nested", "grid-octant", "obvhs-cwbvh"] {
        let mesh = Accelerated::new(list.clone(), spec).expect("finite triangles");
        let (mut hits, mut same, mut ties, mut lost) = (0, 0, 0, 0);
        for (ray, theirs) in rays.iter().zip(&theirs) {
            let ours = ask(&mesh, &in_double(ray));
            hits += usize::from(ours.0.is_finite());
            if ours == *theirs {
                continue;
            }
            assert_eq!(ours, ask_all(&list, &in_double(ray)), "{spec}, {ray:?}: all triangles, one by one");
            if ours.0 == theirs.0 {
                same += 1; // another triangle of a shared edge
                continue;
            }
            let exact = skipgrid::Ray::new(ray.0, ray.1).with_range(1e-12, f32::INFINITY);
            let Some(truth) = oracle.closest(&exact) else { panic!("{spec}, {ray:?}: a hit where there is none") };
            let bound =
                truth.prims.iter().map(|&prim| rounding(&corners[prim as usize], ray, truth.t)).fold(0.0, f64::max);
            let [ours, theirs] = [ours.0, theirs.0].map(|time| (time - truth.t).abs());
            assert!(ours <= bound, "{spec}, {ray:?}: ours is {ours:e} off, the kd-tree's {theirs:e}; bound {bound:e}");
            if theirs <= bound { ties += 1 } else { lost += 1 }
        }
        println!(
            "{scene}, {spec}: {hits} hits of {} rays; rpt's kd-tree took another triangle at the same time {same} times, at a \
             time that differs by rounding {ties} times, and lost {lost} hits",
            rays.len()
        );
        assert!(hits > rays.len() / 2 && same < rays.len() / 10 && ties < rays.len() / 10 && lost < rays.len() / 1000);
    }
}

#[test]
fn a_mesh_made_by_formula_is_hit_as_by_the_kd_tree() {
    agrees_with_the_kd_tree("bumpy");
}

#[test]
fn the_bunny_is_hit_as_by_the_kd_tree() {
    if let Some(bunny) = bunny() {
        agrees_with_the_kd_tree(&bunny);
    }
}

/// Where f32 could not even hold the corners apart: far from the origin, seen from far away, and small; and along axes.
#[test]
fn every_accelerator_answers_as_all_objects_do() {
    let corners = corners("bumpy:n=16");
    let near = triangles(&corners);
    let entries: Vec<_> = ENTRIES.iter().filter(|e| e.suits(&Objects::new(near.clone()).expect("triangles"))).collect();
    assert!(entries.len() > 8, "{} accelerators", entries.len());
    for (scale, offset, back) in
        [(1.0, 0.0, 0.0), (1.0, 6.4e6, 0.0), (1e-9, 0.5, 0.0), (1e9, 0.0, 0.0), (1.0, 0.0, 1e5)]
    {
        let place = |v: Vec3| double(v) * scale + rpt::glm::vec3(offset, -offset, offset);
        let moved = |t: &[Vec3; 3]| rpt::Triangle::from_vertices(place(t[0]), place(t[1]), place(t[2]));
        let list: Vec<_> = corners.iter().map(moved).collect();
        let mut asked: Vec<Ray> = rays(&corners, 1200)
            .iter()
            .map(|&(origin, direction)| Ray {
                origin: place(origin) - double(direction) * scale * back,
                dir: double(direction).normalize(),
            })
            .collect();
        // Along an axis: through corners, and in planes of boxes.
        asked.extend(
            corners.iter().take(300).map(|t| Ray { origin: place(t[0] - Vec3::Z * 4.0), dir: double(Vec3::Z) }),
        );
        let truth: Vec<_> = asked.iter().map(|ray| ask_all(&list, ray)).collect();
        assert!(
            truth.iter().filter(|(time, _)| time.is_finite()).count() > 600,
            "rays miss at {scale} {offset} {back}"
        );
        for entry in &entries {
            let mesh = Accelerated::new(list.clone(), entry.name).expect("finite triangles");
            for (ray, truth) in asked.iter().zip(&truth) {
                let place = (scale, offset, back);
                assert_eq!(ask(&mesh, ray), *truth, "{}, {place:?}, {:?} {:?}", entry.name, ray.origin, ray.dir);
            }
        }
    }
}
