//! The voxel walk in whole numbers: only adds and compares from voxel to voxel.
//!
//! Amanatides & Woo 1987 announce it in their last section, without a listing. After clipping, the ray starts at a point that
//! is a multiple of 2^-28 voxels and moves `rate[i]` units along axis `i`, the largest of them 2^40. It crosses a plane that
//! is `gap` away after `gap / rate[i]`; times the product of all rates that is `gap` times the product of the *other* axes'
//! rates, a whole number below 2^120. So tMax and tDelta are i128, and the walk visits exactly the voxels of this ray,
//! however long it is; ties go z, y, x as in the paper. An axis with rate 0 has no part in the products and is never crossed.
//!
//! Error, in voxels, at the same parameter of the ray: the start is off by 2^-29 along each axis. A rate is off by half a unit
//! of the 2^40 by which the fastest axis moves, and that one moves 2^12 voxels at most: 2^-29 at the end. Scaling in f64 adds
//! a few 2^-53 of 2^12 to both. So the ray is less than 2^-27 from the one that [`Walk::start`] clips, which may be off by
//! half of [`WALK_ERROR`] = 2^-12 where it agrees to walk at all: there is room to spare.
//!
//! [`WALK_ERROR`]: super::frame::WALK_ERROR

use super::frame::Frame;
use super::walk::{Start, VoxelWalk, Walk};
use crate::ray::Ray;

/// Units of length in a voxel.
const VOXEL: f64 = (1u64 << 28) as f64;

/// Units by which the ray moves along its fastest axis, in the time that the others are measured in.
const FASTEST: f64 = (1u64 << 40) as f64;

/// [`Walk`] in whole numbers.
#[derive(Clone, Copy, Debug)]
pub struct IntegerWalk {
    voxel: usize,
    /// tMax: when the ray crosses the next plane of each axis; `i128::MAX` if it does not move along it.
    t_next: [i128; 3],
    /// tDelta: from plane to plane.
    t_delta: [i128; 3],
    /// From voxel index to voxel index.
    stride: [isize; 3],
    /// Steps that stay within the grid.
    left: [u32; 3],
    /// When the ray leaves the grid or ends, or later.
    end: i128,
    /// The ray's parameter at time 0.
    start: f64,
    /// The ray's parameter for each unit of time.
    unit: f64,
}

/// A ray that starts in a voxel, in whole numbers.
#[derive(Clone, Copy, Debug)]
struct Fixed {
    /// Units from the start to the next plane of each axis, 0 to one voxel.
    gap: [i128; 3],
    /// Units by which the ray moves, 0 to 2^40.
    rate: [i128; 3],
    /// The ray's parameter for the time in which it moves by the rates.
    unit: f64,
}

impl Fixed {
    /// The nearest one to the ray at the beginning of `walk`.
    fn nearest(walk: &Walk) -> Self {
        let fastest = walk.speed.iter().fold(0.0, |a: f64, b| a.max(*b));
        let mut fixed = Self { gap: [0; 3], rate: [0; 3], unit: FASTEST / VOXEL / fastest };
        for axis in 0..3 {
            // An entry a hair outside the voxel moves to its border. Without movement the gap is infinite and not looked at.
            let gap = (walk.plane[axis] - walk.origin[axis]) - walk.t * walk.speed[axis];
            fixed.gap[axis] = (gap * VOXEL).round().clamp(0.0, VOXEL) as i128;
            fixed.rate[axis] = (walk.speed[axis] / fastest * FASTEST).round() as i128;
        }
        fixed
    }
}

impl VoxelWalk for IntegerWalk {
    #[inline]
    fn start(frame: &Frame, ray: &Ray) -> Start<Self> {
        match Walk::start(frame, ray) {
            Start::Miss => Start::Miss,
            Start::TooFar => Start::TooFar,
            Start::Inside(walk) => Start::Inside(Self::along(&Fixed::nearest(&walk), &walk)),
        }
    }

    #[inline(always)]
    fn voxel(&self) -> usize {
        self.voxel
    }

    #[inline(always)]
    fn exit(&self) -> f64 {
        let [x, y, z] = self.t_next;
        self.start + x.min(y).min(z) as f64 * self.unit
    }

    #[inline(always)]
    fn step(&mut self) -> bool {
        let [x, y, z] = self.t_next;
        if x < y {
            if x < z { self.cross::<0>() } else { self.cross::<2>() }
        } else if y < z {
            self.cross::<1>()
        } else {
            self.cross::<2>()
        }
    }

    /// The time is rounded up, by more than its own error.
    #[inline]
    fn end_at(&mut self, t: f64) {
        const UP: f64 = 1.0 + 8.0 * f64::EPSILON;
        // `as` saturates: a t that is infinite or beyond all crossings ends nothing.
        let end = ((t - self.start) / self.unit * UP) as i128;
        self.end = self.end.min(end.saturating_add(1));
    }
}

impl IntegerWalk {
    /// The fixed-point ray from the beginning of `walk`.
    fn along(fixed: &Fixed, walk: &Walk) -> Self {
        let others = |axis: usize| {
            let rates = (0..3).filter(|&other| other != axis).map(|other| fixed.rate[other].max(1));
            rates.product::<i128>()
        };
        let moves = fixed.rate.map(|rate| rate > 0);
        let t_next = [0, 1, 2].map(|axis| if moves[axis] { fixed.gap[axis] * others(axis) } else { i128::MAX });
        let t_delta = [0, 1, 2].map(|axis| if moves[axis] { VOXEL as i128 * others(axis) } else { 0 });
        let product: f64 = fixed.rate.iter().map(|&rate| rate.max(1) as f64).product();
        let (Walk { voxel, stride, left, .. }, unit) = (*walk, fixed.unit / product);
        let mut integer = Self { voxel, t_next, t_delta, stride, left, end: i128::MAX, start: walk.t, unit };
        integer.end_at(walk.t_end);
        integer
    }

    #[inline(always)]
    fn cross<const AXIS: usize>(&mut self) -> bool {
        if self.left[AXIS] == 0 || self.t_next[AXIS] >= self.end {
            return false;
        }
        self.left[AXIS] -= 1;
        self.voxel = self.voxel.wrapping_add_signed(self.stride[AXIS]);
        self.t_next[AXIS] += self.t_delta[AXIS];
        true
    }
}

#[cfg(test)]
mod tests {
    use super::super::frame::WALK_ERROR;
    use super::*;
    use crate::geometry::tests::Random;
    use glam::{DVec3, Vec3};

    /// The box from -1 to 1.
    fn frame(resolution: [u32; 3]) -> Frame {
        let n = DVec3::from(resolution.map(f64::from));
        Frame { lo: DVec3::NEG_ONE, inverse: n / 2.0, resolution }
    }

    const RESOLUTIONS: [[u32; 3]; 7] =
        [[1; 3], [2; 3], [3, 5, 7], [64; 3], [1000, 1, 33], [4096, 4001, 2], [4096, 4096, 4096]];

    /// Calls `check` with rays of every class of direction.
    fn for_rays(seed: u64, mut check: impl FnMut(&Frame, &Ray)) {
        let mut random = Random::new(seed);
        for resolution in RESOLUTIONS {
            let frame = frame(resolution);
            let n = Vec3::from(resolution.map(|n| n as f32));
            for i in 0..240 {
                let signs = random.in_cube().signum();
                // On the lattice of the corners, as near as f32 comes.
                let corner = ((random.in_cube() * n).round() / n).clamp(Vec3::NEG_ONE, Vec3::ONE);
                let (mut origin, mut direction) = (2.0 * random.in_cube(), Vec3::ZERO);
                let axis = (random.next() % 3) as usize;
                match i % 8 {
                    0 | 1 => direction = random.in_cube() - origin,
                    2 => (origin, direction[axis]) = (corner, signs[axis]),
                    3 => {
                        direction = random.in_cube() - origin;
                        (origin[axis], direction[axis]) = (corner[axis], 0.0);
                    }
                    4 => (origin, direction) = (corner, signs),
                    5 => (origin, direction) = (corner - 2.0 * signs / n, signs / n),
                    6 => {
                        direction = random.in_cube() - origin;
                        direction[axis] *= 10f32.powf(40.0 * random.unit() - 45.0);
                    }
                    _ => {
                        origin *= 10f32.powf(7.0 * random.unit());
                        direction = (random.in_cube() - origin) * 10f32.powf(30.0 * (2.0 * random.unit() - 1.0));
                    }
                }
                check(&frame, &Ray::new(origin, direction).with_range(f32::NEG_INFINITY, f32::INFINITY));
            }
        }
    }

    /// The voxels of the fixed-point ray by fractions: crossings `gap / rate` are compared by cross-multiplication.
    fn fractions(fixed: &Fixed, walk: &Walk) -> Vec<usize> {
        let (mut voxel, mut left, mut gap) = (walk.voxel, walk.left, fixed.gap);
        let mut visited = vec![voxel];
        loop {
            let moving = (0..3).rev().filter(|&a| fixed.rate[a] > 0);
            // The last axis is the first to be compared, and stays the nearest at a tie.
            let nearest = moving.reduce(|a, b| if gap[b] * fixed.rate[a] < gap[a] * fixed.rate[b] { b } else { a });
            let axis = nearest.expect("the fastest axis moves");
            if left[axis] == 0 {
                return visited;
            }
            left[axis] -= 1;
            gap[axis] += 1 << 28;
            voxel = voxel.strict_add_signed(walk.stride[axis]);
            visited.push(voxel);
        }
    }

    #[test]
    fn visits_what_fractions_say() {
        let (mut walks, mut voxels) = (0, 0);
        for_rays(1, |frame, ray| {
            let Some(ray) = ray.intake() else { return };
            let Start::Inside(walk) = Walk::start(frame, &ray) else { return };
            let fixed = Fixed::nearest(&walk);
            let mut integer = IntegerWalk::along(&fixed, &walk);
            // To the edge of the grid: where the ray ends is another test's.
            integer.end = i128::MAX;
            let mut visited = vec![integer.voxel()];
            while integer.step() {
                visited.push(integer.voxel());
            }
            assert_eq!(visited, fractions(&fixed, &walk), "{ray:?} in {frame:?}");
            walks += 1;
            voxels += visited.len();
        });
        assert!(walks > 1000 && voxels > 1_000_000, "{walks} walks, {voxels} voxels");
    }

    #[test]
    fn stays_near_the_ray() {
        let mut walks = 0;
        for_rays(2, |frame, ray| {
            let Some(ray) = ray.intake() else { return };
            let Start::Inside(mut walk) = IntegerWalk::start(frame, &ray) else { return };
            let [nx, ny, _] = frame.resolution.map(|n| n as usize);
            let mut entry = walk.start;
            loop {
                let (v, exit) = (walk.voxel(), walk.exit());
                let lower = DVec3::new((v % nx) as f64, (v / nx % ny) as f64, (v / nx / ny) as f64);
                assert!(entry <= exit, "{entry} {exit} {ray:?}");
                for t in [entry, exit] {
                    let position = frame.local(ray.at(t));
                    let outside = (lower - position).max(position - lower - DVec3::ONE).max_element();
                    assert!(outside <= WALK_ERROR, "{outside} voxels outside at {t}, {ray:?} in {frame:?}");
                }
                entry = exit;
                if !walk.step() {
                    break;
                }
            }
            // The walk ends where the ray leaves the grid.
            let Start::Inside(clipped) = Walk::start(frame, &ray) else { unreachable!("it started before") };
            let missing = (clipped.t_end - entry) * clipped.speed.into_iter().fold(0.0, f64::max);
            assert!(missing.abs() <= WALK_ERROR, "{missing} voxels missing, {ray:?} in {frame:?}");
            walks += 1;
        });
        assert!(walks > 1000, "{walks}");
    }

    #[test]
    fn ends_at_the_first_crossing_beyond() {
        let frame = frame([8, 1, 1]);
        let ray = Ray::new(Vec3::new(-2.0, 0.1, 0.1), Vec3::X);
        for (t, voxels) in [(0.5, 1), (1.2, 1), (1.3, 2), (1.6, 3), (2.7, 7), (2.8, 8), (9.0, 8), (f64::INFINITY, 8)] {
            let Start::Inside(mut walk) = IntegerWalk::start(&frame, &ray) else { unreachable!("it meets the box") };
            walk.end_at(t);
            walk.end_at(t + 1.0); // does not raise it again
            let steps = std::iter::from_fn(|| walk.step().then_some(())).take(20).count();
            assert_eq!(steps + 1, voxels, "{t}");
        }
    }
}
