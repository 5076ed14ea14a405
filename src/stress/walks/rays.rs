//! The rays that are sent through the grids, and the grids.

use super::{Rays, VoxelCase};
use crate::grid::Frame;
use crate::random::Random;
use crate::ray::Ray;
use glam::{DVec3, Vec3};

/// The grid and the ray of an index.
pub(super) fn shot(case: &VoxelCase, rays: Rays, index: usize) -> (Frame, Ray) {
    let mut random = Random::new(index as u64 * 0x1_0001 + u64::from(rays == Rays::Stiff));
    let random = &mut random;
    let n = case.resolution;
    let size = DVec3::from(n.map(f64::from));
    let unit = Frame { lo: DVec3::ZERO, inverse: size, resolution: n };
    match rays {
        Rays::Corners => {
            let from = 0.1 * in_unit(random);
            let to = Vec3::ONE - 0.1 * in_unit(random);
            (unit, Ray::new(from, to - from))
        }
        Rays::Stiff => {
            // The unit cube in every other round of classes.
            let round = index / 8;
            let frame = if round.is_multiple_of(2) {
                unit
            } else {
                let extent = 1.0 + in_unit(random).as_dvec3();
                let lo = (in_unit(random) - 0.5).as_dvec3() * [1.0, 10.0, 1e4, 1e-3][round / 2 % 4];
                Frame { lo, inverse: size / extent, resolution: n }
            };
            (frame, stiff(random, &frame, index % 8))
        }
    }
}

/// A ray of a class through a grid.
fn stiff(random: &mut Random, frame: &Frame, class: usize) -> Ray {
    let size = frame.size();
    let world = |local: DVec3| (frame.lo + local / frame.inverse).as_vec3();
    let inside = |random: &mut Random| world(in_unit(random).as_dvec3() * size);
    // The nearest f32 to a corner of voxels.
    let corner = |random: &mut Random| world((in_unit(random).as_dvec3() * (size + 1.0)).floor().min(size));
    let signs = |random: &mut Random| (in_unit(random) - 0.5).signum();
    let axis = random.below(3);
    let all = |ray: Ray| ray.with_range(f32::NEG_INFINITY, f32::INFINITY);
    match class {
        0 => {
            let (from, to) = (inside(random), inside(random));
            all(Ray::new(from, to - from))
        }
        // Along edges of voxels, and off them.
        1 => {
            let origin = if random.below(2) == 0 { corner(random) } else { inside(random) };
            let mut direction = Vec3::ZERO * signs(random);
            direction[axis] = signs(random).x;
            all(Ray::new(origin, direction))
        }
        // Diagonals of voxels, which meet three planes at a time.
        2 => all(Ray::new(corner(random), signs(random) / frame.inverse.as_vec3())),
        3 => {
            let mut direction = inside(random) - inside(random);
            direction[axis] = 0.0_f32.copysign(signs(random).x);
            all(Ray::new(corner(random), direction))
        }
        4 => {
            let (from, to) = (corner(random), corner(random));
            all(Ray::new(from, to - from))
        }
        5 => {
            let target = inside(random);
            let away = (in_unit(random) - 0.5) * 10f32.powf(random.within(1.0, 8.0) as f32);
            Ray::new(target + away, -away)
        }
        6 => {
            let mut direction = inside(random) - inside(random);
            direction[axis] *= 10f32.powf(random.within(-40.0, -2.0) as f32);
            all(Ray::new(corner(random), direction))
        }
        _ => {
            let (from, to) = (inside(random), inside(random));
            let start = random.within(0.0, 1.0) as f32;
            Ray::new(from, to - from).with_range(start, start + random.within(0.0, 0.5) as f32)
        }
    }
}

/// Uniform in the unit cube.
fn in_unit(random: &mut Random) -> Vec3 {
    DVec3::new(random.unit(), random.unit(), random.unit()).as_vec3()
}
