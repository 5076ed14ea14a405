//! The complete tree: how many nodes and leaves a ray meets, and which.

use crate::random::Random;
use glam::Vec3;
use skipgrid::bsp::{Form, Met, Regular};
use skipgrid::grid::VoxelGrid;
use skipgrid::{Aabb, Ray};
use std::collections::BTreeSet;

/// From a face of the unit cube through the opposite one.
fn through(random: &mut Random) -> Ray {
    let axis = random.below(3);
    let mut point = |side: f32| {
        let mut p = 0.5 * (random.in_cube() + Vec3::ONE);
        p[axis] = side;
        p
    };
    let (from, to) = (point(0.0), point(1.0));
    let (from, to) = if random.below(2) == 0 { (from, to) } else { (to, from) };
    Ray::new(from - (to - from), to - from)
}

/// Nodes and the leaves in their order.
fn walked(tree: &Regular, ray: &Ray, form: Form) -> (usize, Vec<[u32; 3]>) {
    let (mut nodes, mut leaves) = (0, Vec::new());
    let near = tree.walk(ray, form, &mut |met| {
        match met {
            Met::Node => nodes += 1,
            Met::Leaf(leaf) => leaves.push(leaf),
        }
        true
    });
    assert!(near);
    (nodes, leaves)
}

/// All nodes on the ways from the root to the leaves of a tree with `n` an axis.
fn ancestors(leaves: &[[u32; 3]], n: u32) -> usize {
    let levels = n.ilog2();
    let mut nodes = BTreeSet::new();
    for leaf in leaves {
        for depth in 0..=3 * levels {
            // How often each axis was halved.
            let halved = [0, 1, 2].map(|axis| (depth + 2 - axis) / 3);
            nodes.insert((depth, [0, 1, 2].map(|axis| leaf[axis] >> (levels - halved[axis]))));
        }
    }
    nodes.len()
}

#[test]
fn nodes_for_each_leaf_are_few_and_their_number_does_not_grow() {
    // N, then as another program counted them over other rays: nodes a ray, nodes for each leaf, re-traversal's nodes to
    // partitioning's.
    let counted = [
        (4, 24.0, 3.67, 1.91),
        (16, 123.0, 4.63, 2.81),
        (64, 520.0, 4.90, 3.88),
        (256, 2106.0, 4.97, 5.03),
        (1024, 8510.0, 4.98, 6.23),
    ];
    for (n, nodes_a_ray, per_leaf, ratio) in counted {
        let tree = Regular::new(n).expect("a power of two");
        let mut random = Random::new(u64::from(n));
        let rays = 400;
        let (mut sums, mut each) = ([0.0; 3], 0.0);
        for _ in 0..rays {
            let ray = through(&mut random);
            let (nodes, leaves) = walked(&tree, &ray, Form::Interval);
            let fraction = nodes as f64 / leaves.len() as f64;
            assert!(fraction < 6.1, "{n}: {fraction} nodes for each leaf: {ray:?}");
            assert!(leaves.len() <= 3 * n as usize, "{n}: {} leaves: {ray:?}", leaves.len());
            // Each node at most once: no more than there are above the leaves, which are all different.
            assert_eq!(leaves.iter().collect::<BTreeSet<_>>().len(), leaves.len(), "{n}: {ray:?}");
            if n <= 64 {
                assert_eq!(nodes, ancestors(&leaves, n), "{n}: {ray:?}");
            }
            for pair in leaves.windows(2) {
                let apart = (0..3).map(|a| pair[0][a].abs_diff(pair[1][a])).max();
                assert_eq!(apart, Some(1), "{n}: {pair:?} of {ray:?}");
            }
            let (again, same) = walked(&tree, &ray, Form::Retraverse);
            assert_eq!(same.len() * (3 * n.ilog2() as usize + 1), again, "{n}: {ray:?}");
            let sum = [leaves.len() as f64, nodes as f64, again as f64];
            sums.iter_mut().zip(sum).for_each(|(a, b)| *a += b / f64::from(rays));
            each += fraction / f64::from(rays);
        }
        // N leaves along the axis between the faces, and along the two others the mean distance of two of N whole numbers.
        let size = f64::from(n);
        let leaves_a_ray = size + 2.0 * (size * size - 1.0) / (3.0 * size);
        // A ray's leaves have a standard deviation of N/3; the mean of 400 rays has 1 % of itself, and 5 % is five of those.
        let near = |ours: f64, other: f64, what: &str| {
            assert!((ours / other - 1.0).abs() < 0.05, "{n}: {ours} {what}, expected {other}");
        };
        near(sums[0], leaves_a_ray, "leaves a ray");
        near(sums[1], nodes_a_ray, "nodes a ray");
        near(each, per_leaf, "nodes for each leaf");
        near(sums[2] / sums[1], ratio, "re-traversal to partitioning");
    }
}

#[test]
fn all_walks_visit_the_voxels_of_a_grid_in_their_order() {
    let mut random = Random::new(77);
    for n in [1, 2, 8, 32, 128] {
        let tree = Regular::new(n).expect("a power of two");
        let grid = VoxelGrid::new(Aabb { min: Vec3::ZERO, max: Vec3::ONE }, [n; 3]).expect("a box with an extent");
        for i in 0..200 {
            let mut ray = through(&mut random);
            match i % 4 {
                1 => ray = Ray::new(ray.at(1.3).as_vec3(), ray.direction),
                2 => ray = ray.with_range(f32::NEG_INFINITY, 1.6),
                3 => {
                    // Two axes of no movement.
                    let axis = ray.direction.abs().max_position();
                    let mut d = Vec3::ZERO;
                    d[axis] = ray.direction[axis];
                    ray.direction = d;
                }
                _ => {}
            }
            let voxels: Vec<[u32; 3]> = grid.voxels(&ray).map(|v| v.voxel).collect();
            for (name, form) in Form::ALL {
                assert_eq!(walked(&tree, &ray, form).1, voxels, "{n}, {name}: {ray:?}");
            }
        }
    }
}

#[test]
fn climbing_enters_fewer_nodes_than_starting_again_from_the_root() {
    let mut random = Random::new(78);
    let tree = Regular::new(64).expect("a power of two");
    for _ in 0..50 {
        let ray = through(&mut random);
        let [climb, again, partition] =
            [Form::Climb, Form::Retraverse, Form::Interval].map(|form| walked(&tree, &ray, form).0);
        assert!(partition < climb && climb < again, "{partition} {climb} {again}: {ray:?}");
    }
}

#[test]
fn sizes_that_cannot_be_halved_are_refused() {
    for n in [0, 3, 1000, (1 << 20) + 1, 1 << 21] {
        let error = Regular::new(n).expect_err("no power of two, or too many");
        assert!(error.to_string().contains(&n.to_string()), "{error}");
    }
}
