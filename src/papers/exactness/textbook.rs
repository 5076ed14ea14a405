//! The voxel walk of textbooks: everything in f32, `tMax` accumulated.
//!
//! Amanatides & Woo 1987, section 2. Where it loses voxels is known; it is here to be compared with.

use crate::grid::{Frame, Start, VoxelWalk};
use crate::ray::Ray;
use glam::Vec3;

/// A walk whose rounding errors grow with the number of voxels that it crosses.
///
/// Kept from our walk, since the paper leaves them open: an axis of no movement never wins, and the walk ends at the faces
/// of the grid by counting steps, so that it ends at all.
#[derive(Clone, Copy, Debug)]
pub struct Textbook {
    voxel: usize,
    /// tMaxX, tMaxY, tMaxZ.
    t_max: [f32; 3],
    /// tDeltaX, tDeltaY, tDeltaZ.
    t_delta: [f32; 3],
    stride: [isize; 3],
    left: [u32; 3],
    t_end: f32,
}

impl VoxelWalk for Textbook {
    fn start(frame: &Frame, ray: &Ray) -> Start<Self> {
        let (low, inverse) = (frame.lo.as_vec3(), frame.inverse.as_vec3());
        let size = frame.size().as_vec3();
        let (origin, direction) = ((ray.origin - low) * inverse, ray.direction * inverse);
        let (mut t, mut t_end) = (ray.t_min, ray.t_max);
        for axis in 0..3 {
            if direction[axis] == 0.0 {
                if origin[axis] < 0.0 || origin[axis] > size[axis] {
                    return Start::Miss;
                }
                continue;
            }
            let (a, b) = (-origin[axis] / direction[axis], (size[axis] - origin[axis]) / direction[axis]);
            t = t.max(a.min(b));
            t_end = t_end.min(a.max(b));
        }
        // A NaN or an infinite entry has no first voxel.
        if !(t <= t_end && t.is_finite()) {
            return Start::Miss;
        }
        let entry: Vec3 = origin + t * direction;
        let mut walk =
            Self { voxel: 0, t_max: [f32::INFINITY; 3], t_delta: [0.0; 3], stride: [0; 3], left: [0; 3], t_end };
        let mut stride = 1;
        for axis in 0..3 {
            let last = frame.resolution[axis] - 1;
            // At most 4095, as no axis has more voxels; a negative number or a NaN becomes 0.
            let index = (entry[axis] as u32).min(last);
            walk.voxel += index as usize * stride as usize;
            if direction[axis] != 0.0 {
                let forwards = direction[axis] > 0.0;
                let plane = if forwards { index + 1 } else { index } as f32;
                walk.t_max[axis] = (plane - origin[axis]) / direction[axis];
                walk.t_delta[axis] = 1.0 / direction[axis].abs();
                walk.left[axis] = if forwards { last - index } else { index };
                walk.stride[axis] = if forwards { stride } else { -stride };
            }
            stride *= frame.resolution[axis] as isize;
        }
        Start::Inside(walk)
    }

    #[inline(always)]
    fn voxel(&self) -> usize {
        self.voxel
    }

    #[inline(always)]
    fn exit(&self) -> f64 {
        let [x, y, z] = self.t_max;
        f64::from(x.min(y).min(z))
    }

    #[inline(always)]
    fn step(&mut self) -> bool {
        let [x, y, z] = self.t_max;
        if x < y {
            if x < z { self.cross::<0>() } else { self.cross::<2>() }
        } else if y < z {
            self.cross::<1>()
        } else {
            self.cross::<2>()
        }
    }

    #[inline(always)]
    fn end_at(&mut self, t: f64) {
        let t = t as f32;
        if t < self.t_end {
            self.t_end = t;
        }
    }
}

impl Textbook {
    #[inline(always)]
    fn cross<const AXIS: usize>(&mut self) -> bool {
        if self.left[AXIS] == 0 || self.t_max[AXIS] >= self.t_end {
            return false;
        }
        self.left[AXIS] -= 1;
        self.voxel = self.voxel.wrapping_add_signed(self.stride[AXIS]);
        self.t_max[AXIS] += self.t_delta[AXIS];
        true
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Accel;
    use crate::grid::{Grid, GridOptions};

    /// A row of triangles across the axis x, a voxel each: the walk finds the first, the one beyond `t_min`, and none behind
    /// the end.
    #[test]
    fn finds_the_first_along_a_row() {
        let at = |x: f32| [Vec3::new(x, -1.0, -1.0), Vec3::new(x, 1.0, -1.0), Vec3::new(x, 0.0, 1.0)];
        let triangles: Vec<_> = (0..32).map(|i| at(i as f32)).collect();
        let options = GridOptions { resolution: Some([32, 4, 4]), ..GridOptions::default() };
        let grid = Grid::build(&triangles, &options).expect("a small grid").with_walk::<Textbook>();
        for (x, towards) in [(-3.5, 1.0), (40.5, -1.0), (7.5, 1.0), (7.5, -1.0)] {
            let ray = Ray::new(Vec3::new(x, 0.0, 0.0), Vec3::new(towards, 0.0, 0.0));
            let first = if towards > 0.0 { x.max(-1.0).ceil() } else { x.min(32.0).floor() };
            let first = first.clamp(0.0, 31.0);
            let hit = grid.closest_hit(&ray).expect("it is there");
            assert_eq!((hit.prim as f32, hit.t), (first, (first - x).abs()), "{x} {towards}");
            let second = grid.closest_hit(&ray.with_range(hit.t + 0.5, 99.0)).expect("it is there");
            assert_eq!(second.prim as f32, first + towards);
            assert_eq!(grid.closest_hit(&ray.with_range(0.0, hit.t - 0.25)), None);
        }
        assert_eq!(grid.closest_hit(&Ray::new(Vec3::new(-1.0, 5.0, 0.0), Vec3::X)), None);
    }
}
