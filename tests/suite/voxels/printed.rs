//! Walks as printed: wrong where the exact one is right.

use super::{check, grid};
use crate::random::Random;
use glam::{IVec2, Vec2, Vec3};
use skipgrid::Ray;
use skipgrid::grid::VoxelGrid;

/// The walk of Amanatides & Woo 1987 in f32, tMax accumulated as printed, in the unit cube with `n` voxels an axis.
fn accumulated(ray: &Ray, n: u32) -> Vec<[u32; 3]> {
    let cell = 1.0 / n as f32;
    let (o, d) = (ray.origin.to_array(), ray.direction.to_array());
    let mut voxel = o.map(|x| (x / cell) as u32);
    let step = d.map(|x| if x > 0.0 { 1 } else { -1i32 });
    let mut t_max = [0, 1, 2].map(|a| ((voxel[a] + u32::from(step[a] > 0)) as f32 * cell - o[a]) / d[a]);
    let t_delta = d.map(|x| cell / x.abs());
    let mut visited = vec![voxel];
    loop {
        let [x, y, z] = t_max;
        let axis = if x < y {
            if x < z { 0 } else { 2 }
        } else if y < z {
            1
        } else {
            2
        };
        voxel[axis] = voxel[axis].wrapping_add_signed(step[axis]);
        if voxel[axis] >= n {
            return visited;
        }
        t_max[axis] += t_delta[axis];
        visited.push(voxel);
    }
}

#[test]
fn accumulating_the_parameter_in_f32_visits_wrong_voxels() {
    let mut random = Random::new(11);
    // Measured over 1500 other rays: 86 % of them at 1024 voxels an axis, all at 4096.
    for (n, least) in [(1024, 0.75), (4096, 1.0)] {
        let grid = grid([0.0; 3], [1.0; 3], [n; 3]);
        let (rays, mut wrong) = (60, 0);
        for _ in 0..rays {
            // From one corner's region to the other's.
            let mut near = || 0.1 * random.in_cube().abs();
            let (from, to) = (near(), Vec3::ONE - near());
            let ray = Ray::new(from, to - from);
            check(&grid, &ray, "corner to corner");
            let exact: Vec<_> = grid.voxels(&ray).map(|v| v.voxel).collect();
            wrong += u32::from(accumulated(&ray, n) != exact);
        }
        let share = f64::from(wrong) / f64::from(rays);
        assert!(share >= least, "{n} voxels an axis: {share} of the rays go wrong");
    }
}

/// The branchless walk of the DDA article, its last listing as printed, in two dimensions.
struct Branchless {
    direction: Vec2,
    step: Vec2,
    size: Vec2,
    next: Vec2,
    voxel: Vec2,
    position: Vec2,
    normal: Vec2,
}

impl Branchless {
    fn new(origin: Vec2, direction: Vec2) -> Self {
        // As in shaders: the sign of 0 is 0.
        let step = Vec2::from(direction.to_array().map(|x| if x == 0.0 { 0.0 } else { x.signum() }));
        let next = (step * 0.5 + 0.5 - (origin - origin.floor())) / direction;
        let (size, voxel) = (1.0 / direction.abs(), origin.floor());
        Self { direction, step, size, next, voxel, position: origin, normal: Vec2::ZERO }
    }

    fn step(&mut self) {
        // As in shaders: min(x, y) is y if y < x, else x.
        let closest = if self.next.y < self.next.x { self.next.y } else { self.next.x };
        let mask = Vec2::from(self.next.to_array().map(|t| f32::from(u8::from(t <= closest))));
        self.voxel += mask * self.step;
        self.position += self.direction * closest;
        self.next += self.size * mask;
        self.normal = -mask * self.step;
    }
}

/// The exact walk in the same plane: 64 voxels an axis, of edge 1, from -32 on.
fn plane() -> VoxelGrid {
    grid([-32.0, -32.0, 0.0], [32.0, 32.0, 1.0], [64, 64, 1])
}

fn in_plane(origin: Vec2, direction: Vec2) -> Ray {
    Ray::new(origin.extend(0.5), direction.extend(0.0))
}

/// Voxels of the exact walk, numbered as the article does.
fn voxels(origin: Vec2, direction: Vec2) -> impl Iterator<Item = IVec2> {
    let ray = in_plane(origin, direction);
    check(&plane(), &ray, "the article's plane");
    plane().voxels(&ray).map(|v| IVec2::new(v.voxel[0] as i32 - 32, v.voxel[1] as i32 - 32))
}

#[test]
fn branchless_steps_as_printed_stall_on_axis_parallel_rays() {
    let (mut random, mut stalled) = (Random::new(12), 0);
    for _ in 0..10_000 {
        let origin = 4.0 * Vec2::new(random.signed(), random.signed());
        let mut walk = Branchless::new(origin, Vec2::X);
        walk.step();
        // (0.5 - fract) / 0 is -inf in the upper half of a voxel, is chosen, and leads nowhere.
        let stays = walk.voxel == origin.floor();
        assert!(!stays || origin.y - origin.y.floor() >= 0.5, "{origin}");
        stalled += u32::from(stays);
        let second = voxels(origin, Vec2::X).nth(1);
        assert_eq!(second, Some(origin.floor().as_ivec2() + IVec2::X), "{origin}");
    }
    // 5015 of another 10 000; five standard deviations are 250.
    assert!((4750..=5250).contains(&stalled), "{stalled}");
}

#[test]
fn branchless_steps_as_printed_cut_corners_at_ties() {
    let centre = Vec2::splat(0.5);
    let mut walk = Branchless::new(centre, Vec2::ONE);
    walk.step();
    assert_eq!((walk.voxel, walk.normal), (Vec2::ONE, -Vec2::ONE)); // no unit normal, no neighbour through a face
    let exact: Vec<_> = voxels(centre, Vec2::ONE).take(5).collect();
    assert_eq!(exact, [(0, 0), (0, 1), (1, 1), (1, 2), (2, 2)].map(IVec2::from));
}

#[test]
fn branchless_positions_as_printed_run_ahead_of_the_ray() {
    let (origin, direction) = (Vec2::new(0.3, 0.6), Vec2::new(0.8, 0.6));
    let ray = in_plane(origin, direction);
    let mut walk = Branchless::new(origin, direction);
    // Step, position as printed to so many decimals, and where the ray is.
    let expected = [(2, (1.533, 1.525), 3, (1.0, 1.125)), (6, (11.0, 8.6), 1, (3.5, 3.0))];
    let mut exact = plane().voxels(&ray);
    exact.next();
    for step in 1..=6 {
        walk.step();
        let visit = exact.next().expect("the grid is wide");
        let position = ray.at(visit.entry);
        for (_, printed, decimals, right) in expected.iter().filter(|(number, ..)| *number == step) {
            let off = (walk.position - Vec2::from(*printed)).abs().max_element();
            assert!(off <= 0.5001 * 0.1f32.powi(*decimals), "step {step}: {} as printed", walk.position);
            assert!((position.x - right.0).abs().max((position.y - right.1).abs()) < 1e-6, "step {step}: {position}");
        }
    }
}
