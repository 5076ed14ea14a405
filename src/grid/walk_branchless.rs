//! The voxel walk with a masked step instead of branches.
//!
//! After an article on branchless DDA voxel tracing: the axis of the next crossing is a mask, and all three axes are
//! advanced by it. The listing is mended in four places:
//!
//! - It advances by `size * mask`, which is `inf * 0` along an axis of no movement; and its first distance is then minus
//!   infinity or 0/0 in half of all cases, and the walk never moves. Here such an axis is never chosen, because its crossing
//!   is at plus infinity.
//! - At a tie it crosses all tied planes at once and skips the voxels beside the edge. Here the mask has one axis, the one
//!   that the branching walk chooses, so that both visit the same voxels in the same order.
//! - It accumulates distances without subtracting the step, so its position is wrong from the second step on. Here a
//!   crossing is recomputed from the integer plane.
//! - It never ends. Here the mask also counts the steps left.

use super::frame::Frame;
use super::walk::{Start, VoxelWalk, Walk};
use crate::ray::Ray;

/// [`Walk`] with a masked step.
#[derive(Clone, Copy, Debug)]
pub struct Branchless(pub(super) Walk);

impl VoxelWalk for Branchless {
    #[inline]
    fn start(frame: &Frame, ray: &Ray) -> Start<Self> {
        match Walk::start(frame, ray) {
            Start::Miss => Start::Miss,
            Start::TooFar => Start::TooFar,
            Start::Inside(walk) => Start::Inside(Self(walk)),
        }
    }

    #[inline(always)]
    fn voxel(&self) -> usize {
        self.0.voxel()
    }

    #[inline(always)]
    fn exit(&self) -> f64 {
        self.0.exit()
    }

    #[inline(always)]
    fn step(&mut self) -> bool {
        self.0.step_masked()
    }

    #[inline(always)]
    fn end_at(&mut self, t: f64) {
        self.0.end_at(t);
    }
}

impl Walk {
    /// [`VoxelWalk::step`] without branches on the axis: the one branch left is the end of the walk.
    #[inline(always)]
    fn step_masked(&mut self) -> bool {
        let [x, y, z] = self.t_next;
        let along_x = x < y && x < z;
        let along_y = !along_x && y < z && y <= x;
        let mask = [along_x, along_y, !(along_x || along_y)];
        if self.exit() >= self.t_end {
            return false;
        }
        let mut inside = false;
        for (axis, on) in mask.into_iter().enumerate() {
            inside |= on && self.left[axis] > 0;
            let on = u32::from(on);
            // Wraps only where the walk ends.
            self.left[axis] = self.left[axis].wrapping_sub(on);
            self.voxel = self.voxel.wrapping_add_signed(self.stride[axis] * on as isize);
            self.plane[axis] += f64::from(on);
            self.t_next[axis] = self.crossing(axis);
        }
        inside
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::{DVec3, Vec3};

    fn sequence<W: VoxelWalk>(frame: &Frame, ray: &Ray) -> Vec<usize> {
        let Start::Inside(mut walk) = W::start(frame, &ray.intake().expect("a ray")) else { return Vec::new() };
        let mut voxels = vec![walk.voxel()];
        while walk.step() {
            voxels.push(walk.voxel());
            assert!(voxels.len() < 100, "{ray:?} does not end");
        }
        voxels
    }

    /// Where the printed listing stalls (an axis without movement), cuts corners (ties) or strays (every ray).
    #[test]
    fn visits_what_the_branching_walk_visits() {
        // Unit voxels at whole numbers: no padding, so that ties are exact.
        let frame = Frame { lo: DVec3::ZERO, inverse: DVec3::ONE, resolution: [8, 6, 9] };
        let mut longest = 0;
        for i in 0..4096_u16 {
            // Directions of few distinct slopes, from points in planes, on edges, at corners and off them.
            let digit = |shift: u16| f32::from(i >> shift & 3) - 1.5;
            let mut direction = Vec3::new(digit(0), digit(2), digit(4));
            let origin = Vec3::new(4.0, 3.0, 4.5) + Vec3::new(digit(6), digit(8), digit(10)).round();
            for zero in [0.0, -0.0] {
                for axis in 0..3 {
                    let ray = Ray::new(origin - 4.0 * direction, direction);
                    let expected = sequence::<Walk>(&frame, &ray);
                    longest = longest.max(expected.len());
                    assert_eq!(sequence::<Branchless>(&frame, &ray), expected, "{ray:?}");
                    direction[axis] = zero;
                    if direction == Vec3::ZERO {
                        direction[axis] = 1.0;
                    }
                }
            }
        }
        assert!(longest > 15, "{longest}");
    }
}
