//! From world to voxel coordinates: where the grid lies, how many voxels it has, how far they are padded.

use super::options::GridOptions;
use crate::ray::{Aabb, Cell};
use glam::DVec3;

/// Voxels reach this far beyond their faces when primitives are inserted, in voxels.
///
/// The walk may be off by [`WALK_ERROR`]; clipping a primitive to a voxel is off by far less than the other half.
pub(crate) const PADDING: f64 = 1.0 / 2048.0;

/// The walk is at most this far from the true ray, in voxels; a ray for which f64 cannot promise it is not walked.
pub(super) const WALK_ERROR: f64 = PADDING / 2.0;

/// Maps world coordinates to voxel coordinates: voxel `i` of an axis is `i..=i + 1`.
///
/// `lo` and `inverse` count as exact: insertion and walk use the same map, so its own rounding cancels.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Frame {
    /// World position of the grid's least corner.
    pub lo: DVec3,
    /// Voxels for each world unit.
    pub inverse: DVec3,
    /// Voxels along x, y and z.
    pub resolution: [u32; 3],
}

impl Frame {
    /// The frame around `bounds` for `count` primitives.
    ///
    /// The box is padded by 2^-10 of its largest extent, so that flat scenes have a thickness and clipping cannot cut
    /// geometry off, and by at least 2^-33 of the largest coordinate, so that f64 can tell its faces apart.
    pub fn new(bounds: &Aabb, count: u32, options: &GridOptions) -> Self {
        let ([min, max], pad) = (bounds.corners(), bounds.padding(2.0_f64.powi(-33)));
        let (lo, hi) = (min - pad, max + pad);
        let extent = hi - lo;
        // Voxels thinner than 2^-34 of the largest coordinate could not be told apart.
        let thinnest = bounds.reach() * 2.0_f64.powi(-34);
        let resolution = options.resolution.unwrap_or_else(|| resolution(extent, count, options.density));
        let mut bounded = [1; 3];
        for axis in 0..3 {
            let most = if thinnest > 0.0 { extent[axis] / thinnest } else { f64::INFINITY };
            bounded[axis] = resolution[axis].min(most.min(f64::from(GridOptions::MAX_RESOLUTION)) as u32).max(1);
        }
        let n = DVec3::from(bounded.map(f64::from));
        Self { lo, inverse: n / extent, resolution: bounded }
    }

    /// World to voxel coordinates.
    #[inline]
    pub fn local(&self, world: DVec3) -> DVec3 {
        (world - self.lo) * self.inverse
    }

    /// Voxels along the axes as floating-point numbers.
    #[inline]
    pub fn size(&self) -> DVec3 {
        DVec3::from(self.resolution.map(f64::from))
    }

    /// The voxel that holds a point in world coordinates; `None` outside the grid.
    #[inline]
    pub fn voxel_at(&self, world: DVec3) -> Option<usize> {
        let p = self.local(world);
        let inside = p.cmpge(DVec3::ZERO).all() && p.cmplt(self.size()).all();
        inside.then(|| self.index([p.x as u32, p.y as u32, p.z as u32]))
    }

    /// The inflated voxel in world coordinates.
    pub fn cell(&self, voxel: [u32; 3]) -> Cell {
        let v = DVec3::from(voxel.map(f64::from));
        Cell { min: self.lo + (v - PADDING) / self.inverse, max: self.lo + (v + 1.0 + PADDING) / self.inverse }
    }

    /// The voxel of an index.
    pub fn coordinates(&self, index: usize) -> [u32; 3] {
        let [nx, ny, _] = self.resolution.map(|n| n as usize);
        // Less than the resolution each.
        [index % nx, index / nx % ny, index / (nx * ny)].map(|i| i as u32)
    }

    /// Index of a voxel: x varies fastest.
    #[inline]
    pub fn index(&self, [x, y, z]: [u32; 3]) -> usize {
        let [nx, ny, _] = self.resolution.map(|n| n as usize);
        (z as usize * ny + y as usize) * nx + x as usize
    }
}

/// Cubic voxels, `density` of them for each primitive. An axis shorter than a voxel gets one, and the others share the
/// rest, so that a flat scene is cut into squares and not into needles.
fn resolution(extent: DVec3, count: u32, density: f64) -> [u32; 3] {
    let wanted = (f64::from(count.max(1)) * density).max(1.0);
    let mut axes: Vec<usize> = (0..3).collect();
    loop {
        // ln keeps the product of three extents in range.
        let volume: f64 = axes.iter().map(|&a| extent[a].ln()).sum();
        let edge = ((volume - wanted.ln()) / axes.len() as f64).exp();
        let long: Vec<usize> = axes.iter().copied().filter(|&a| extent[a] > edge).collect();
        if long.len() == axes.len() || long.is_empty() {
            let mut resolution = [1; 3];
            for a in long {
                let n = (extent[a] / edge).round().clamp(1.0, f64::from(GridOptions::MAX_RESOLUTION));
                resolution[a] = n as u32;
            }
            return resolution;
        }
        axes = long;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn flat_scenes_are_cut_into_squares() {
        let b = Aabb { min: Vec3::ZERO, max: Vec3::new(100.0, 0.0, 100.0) };
        let frame = Frame::new(&b, 10_000, &GridOptions { density: 1.0, ..GridOptions::default() });
        assert_eq!(frame.resolution, [100, 1, 100]);
    }

    #[test]
    fn every_extent_and_scale_gives_a_finite_frame() {
        for (min, max) in [
            (Vec3::ZERO, Vec3::ZERO),
            (Vec3::splat(1e7), Vec3::splat(1e7)),
            (Vec3::splat(-3e38), Vec3::splat(3e38)),
            (Vec3::ZERO, Vec3::splat(1e-45)),
            (Vec3::new(1e30, 0.0, 0.0), Vec3::new(1e30, 1e-30, 1.0)),
        ] {
            let frame = Frame::new(&Aabb { min, max }, 1000, &GridOptions::default());
            assert!(frame.inverse.is_finite() && frame.lo.is_finite(), "{min} {max}: {frame:?}");
            for corner in [min, max] {
                let local = frame.local(corner.as_dvec3());
                assert!(local.cmpgt(DVec3::ZERO).all() && local.cmplt(frame.size()).all(), "{min} {max}: {local}");
            }
        }
    }
}
