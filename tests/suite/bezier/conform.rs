//! Every accelerator of the registry, with seeds for each voxel and without, against brute force to the bit.

use super::teapot;
use crate::conformance::{check_with, rays, specs};
use crate::random::Random;
use glam::Vec3;
use skipgrid::Ray;
use skipgrid::geometry::BezierPatches;
use skipgrid::geometry::bezier::ControlPoints;
use skipgrid::scene::SceneGeometry;
use std::sync::Arc;

/// All accelerators, and grids whose tests begin elsewhere.
fn all(patches: &SceneGeometry) -> Vec<String> {
    let mut all = specs(patches);
    all.retain(|s| !s.contains("density=30,distances") && !s.contains("resolution=1x40x1,distances"));
    all.push("grid:seeds=fixed".into());
    all.push("grid:seeds=fixed,mailbox=on,resolution=24".into());
    all.push("grid:seeds=voxel,resolution=24".into());
    all.push("grid-octant:seeds=voxel,resolution=24".into());
    all
}

/// Rays of every kind, and rays at points of the patches, their borders and corners, and along their tangents.
fn check_patches(name: &str, seed: u64, points: &[ControlPoints]) {
    let mut random = Random::new(seed);
    let patches = BezierPatches::new(points.iter().copied());
    let finite: Vec<Vec3> = points.iter().flat_map(|p| p.as_flattened()).copied().filter(|p| p.is_finite()).collect();
    let (min, max) = finite.iter().fold((Vec3::MAX, Vec3::MIN), |(a, b), &p| (a.min(p), b.max(p)));
    let (centre, size) = (min * 0.5 + max * 0.5, (max - min).max_element().max(1e-44));
    let usable: Vec<u32> =
        (0..points.len() as u32).filter(|&p| points[p as usize].as_flattened().iter().all(|p| p.is_finite())).collect();
    let mut aimed = Vec::new();
    let mut tangents = Vec::new();
    for _ in 0..60 {
        let prim = usable[random.below(usable.len())];
        let mut parameter = || [0.0, 1.0, 0.5, 0.25, random.signed().abs()][random.below(5)];
        let (u, v) = (f64::from(parameter()), f64::from(parameter()));
        let [p, along_u, along_v] = patches.evaluate(prim, u, v).map(|p| p.as_vec3());
        aimed.push(p);
        let along = if random.below(2) == 0 { along_u } else { along_v };
        if along != Vec3::ZERO {
            tangents.push(Ray::new(p - along * 2.0, along));
            tangents.push(Ray::new(p, along).with_range(f32::NEG_INFINITY, f32::INFINITY));
        }
    }
    let mut shots = rays(&mut random, centre, size, &aimed);
    shots.truncate(shots.len().min(700));
    shots.extend(tangents);
    let patches = SceneGeometry::Patches(Arc::new(patches));
    check_with(&all(&patches), name, &patches, &shots);
}

fn random_patches(random: &mut Random, count: usize) -> Vec<ControlPoints> {
    (0..count)
        .map(|_| {
            let (p, a, b) = (random.in_cube(), random.in_cube() * 0.2, random.in_cube() * 0.2);
            std::array::from_fn(|j| std::array::from_fn(|i| p + a * i as f32 + b * j as f32 + 0.1 * random.in_cube()))
        })
        .collect()
}

#[test]
fn the_teapot_agrees() {
    check_patches("teapot", 31, &teapot());
}

#[test]
fn random_patches_of_all_sizes_agree() {
    let mut random = Random::new(32);
    let patches = random_patches(&mut random, 24);
    check_patches("patches", 33, &patches);
    for scale in [1e-37_f32, 1e18, 1e37] {
        let scaled: Vec<_> = patches[..8].iter().map(|p| p.map(|row| row.map(|p| p * scale))).collect();
        check_patches(&format!("patches x {scale:e}"), 34, &scaled);
    }
    let moved: Vec<_> = patches[..8].iter().map(|p| p.map(|row| row.map(|p| p + 1e6))).collect();
    check_patches("patches + 1e6", 35, &moved);
}

#[test]
fn flat_collapsed_and_bad_patches_agree() {
    let mut random = Random::new(36);
    let on_grid = |f: &dyn Fn(f32, f32) -> Vec3| -> ControlPoints {
        std::array::from_fn(|j| std::array::from_fn(|i| f(i as f32, j as f32)))
    };
    let mut patches = vec![
        on_grid(&|i, j| Vec3::new(i, j, 0.0)),
        on_grid(&|i, j| Vec3::new(i, j, 0.0)),
        // Neighbours that share borders, and one folded back onto itself.
        on_grid(&|i, j| Vec3::new(i + 3.0, j, i * (3.0 - i) * 0.25)),
        on_grid(&|i, j| Vec3::new(i, j + 3.0, j * 0.5)),
        on_grid(&|i, j| Vec3::new((i - 1.5).abs() * 2.0, j, 1.0 + i * 0.3)),
        // An edge of one point, two, and all of one.
        on_grid(&|i, j| Vec3::new(i * j / 3.0, j, 1.0)),
        on_grid(&|i, j| Vec3::new(i * j * (3.0 - j), j, 2.0 + i * i * 0.1)),
        on_grid(&|_, _| Vec3::new(1.0, 1.0, 3.0)),
    ];
    check_patches("flat and collapsed", 37, &patches);
    for (i, bad) in [f32::NAN, f32::INFINITY, f32::NEG_INFINITY].into_iter().enumerate() {
        patches[i][random.below(4)][random.below(4)][random.below(3)] = bad;
    }
    check_patches("with coordinates that are not finite", 38, &patches);
}
