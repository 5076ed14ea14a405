//! Building the walk over solid voxels.

use super::faces::Solid;
use super::marks::Marks;
use super::{Shown, SolidGrid, Space, Unskipped};
use crate::error::{Error, Result};
use crate::geometry::SolidVoxels;
use crate::grid::frame::{Frame, PADDING};
use crate::grid::occupancy::Occupancy;
use crate::grid::options::GridOptions;
use crate::grid::skip::{Method, SkipOptions, Slot, Table};
use glam::DVec3;
use std::marker::PhantomData;

/// How to build a [`SolidGrid`].
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct SolidOptions {
    /// Bytes that the walk may take beside the voxels themselves; what needs more is refused.
    pub memory: u64,
}

impl Default for SolidOptions {
    /// As for grids: a quarter of the machine's memory, at most 8 GiB.
    fn default() -> Self {
        Self { memory: GridOptions::default().memory }
    }
}

impl SolidGrid {
    /// Builds the plain walk.
    ///
    /// # Errors
    /// It would take more than `options.memory` bytes.
    pub fn build(voxels: SolidVoxels, options: &SolidOptions) -> Result<Self> {
        let resolution = voxels.resolution().map(|n| n + 2);
        let edge = f64::from(voxels.edge());
        let frame = Frame { lo: voxels.origin().as_dvec3() - edge, inverse: DVec3::splat(1.0 / edge), resolution };
        let near = 4.0 * (deviation(&voxels, &frame) + PADDING);
        let marks = marks(&voxels, &frame, options.memory)?;
        let solid = Solid { voxels, marks, resolution, near };
        Ok(Self { frame, solid, space: Unskipped, memory: options.memory, walk: PhantomData })
    }
}

#[expect(private_bounds, reason = "walks and tables are those of this module")]
impl<W: Shown> SolidGrid<Unskipped, W> {
    /// The same voxels with the distances of method `M` in slots `T`: to the nearest voxel at the surface.
    ///
    /// # Errors
    /// An option is out of range, or the distances would take more than the budget of memory.
    pub fn with_table<M: Method, T: Slot>(self, options: &SkipOptions) -> Result<SolidGrid<Table<M, T>>> {
        let Self { frame, solid, memory, .. } = self;
        let flags = (0..solid.marks.len()).map(|voxel| solid.marks.surface(voxel));
        let wanted = solid.marks.len() as u64;
        let what = || format!("skip table of {} over {wanted} voxels", M::NAME);
        if wanted > memory {
            return Err(Error::TooLarge { what: what(), wanted, allowed: memory });
        }
        let mut filled = Vec::new();
        filled.try_reserve_exact(flags.len()).map_err(|_| Error::TooLarge { what: what(), wanted, allowed: memory })?;
        filled.extend(flags);
        let occupancy = Occupancy { resolution: frame.resolution.map(|n| n as usize), filled };
        let space = Table::without_lists(&occupancy, options, memory - solid.marks.bytes().min(memory))?;
        Ok(SolidGrid { frame, solid, space, memory, walk: PhantomData })
    }

    /// The same voxels walked by `V`.
    pub fn with_walk<V: Shown>(self) -> SolidGrid<Unskipped, V>
    where
        Unskipped: Space<V>,
    {
        let Self { frame, solid, space, memory, .. } = self;
        SolidGrid { frame, solid, space, memory, walk: PhantomData }
    }
}

/// How far a plane lies from a whole number in the frame, at most.
fn deviation(voxels: &SolidVoxels, frame: &Frame) -> f64 {
    let mut most = 0.0_f64;
    for axis in 0..3 {
        for (k, &plane) in voxels.planes(axis).iter().enumerate() {
            let local = (f64::from(plane) - frame.lo[axis]) * frame.inverse[axis];
            most = most.max((local - (k as f64 + 1.0)).abs());
        }
    }
    most
}

/// Which voxels of the frame are solid, and which touch an exposed face.
fn marks(voxels: &SolidVoxels, frame: &Frame, memory: u64) -> Result<Marks> {
    let [nx, ny, nz] = frame.resolution.map(|n| n as usize);
    // At most 4098^3: no overflow in 64 bits.
    let count = nx as u64 * ny as u64 * nz as u64;
    let wanted = Marks::bytes_for(count);
    let what = || format!("bits of {nx} x {ny} x {nz} voxels");
    if wanted > memory {
        return Err(Error::TooLarge { what: what(), wanted, allowed: memory });
    }
    let mut marks =
        Marks::new(count as usize).ok_or_else(|| Error::TooLarge { what: what(), wanted, allowed: memory })?;
    let [mx, my, _] = voxels.resolution().map(|n| n as usize);
    for (row, materials) in voxels.materials().chunks_exact(mx).enumerate() {
        let first = frame.index([1, (row % my) as u32 + 1, (row / my) as u32 + 1]);
        materials.iter().enumerate().filter(|(_, m)| **m != 0).for_each(|(x, _)| marks.set_solid(first + x));
    }
    let strides = [1, nx, nx * ny];
    for face in 0..voxels.exposed_faces() {
        let (voxel, face) = voxels.face_of(2 * face);
        let index = frame.index(voxel.map(|c| c + 1));
        let axis = face.axis();
        let (u, v) = (strides[(axis + 1) % 3], strides[(axis + 2) % 3]);
        let beyond = if face.is_upper() { index + strides[axis] } else { index - strides[axis] };
        // The border leaves room on all sides.
        for side in [index, beyond] {
            for corner in [side - u - v, side - u, side - u + v] {
                [corner, corner + u, corner + 2 * u].into_iter().for_each(|voxel| marks.set_surface(voxel));
            }
        }
    }
    Ok(marks)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::accel::Accel;
    use glam::Vec3;

    #[test]
    fn voxels_at_the_surface_are_those_with_another_kind_around() {
        // 7 x 6 x 5, solid by a fixed pattern of blobs.
        let [nx, ny, nz] = [7_i64, 6, 5];
        let pattern = |x: i64, y: i64, z: i64| {
            let inside = (0..nx).contains(&x) && (0..ny).contains(&y) && (0..nz).contains(&z);
            inside && (x < 4 && y < 4 && z < 4 || x == 6 && y == 5)
        };
        let cells = (0..nx * ny * nz).map(|i| u8::from(pattern(i % nx, i / nx % ny, i / nx / ny)));
        let voxels = SolidVoxels::new([7, 6, 5], cells.collect(), Vec3::ZERO, 1.0).expect("voxels");
        let grid = SolidGrid::build(voxels, &SolidOptions::default()).expect("small");
        let mut surfaces = 0;
        for (i, (x, y, z)) in
            (-1..=nz).flat_map(|z| (-1..=ny).flat_map(move |y| (-1..=nx).map(move |x| (x, y, z)))).enumerate()
        {
            let around = (0..27).map(|n| pattern(x + n % 3 - 1, y + n / 3 % 3 - 1, z + n / 9 - 1));
            let count = around.filter(|&solid| solid).count();
            assert_eq!(grid.solid.marks.solid(i), pattern(x, y, z), "{x} {y} {z}");
            assert_eq!(grid.solid.marks.surface(i), count != 0 && count != 27, "{x} {y} {z}");
            surfaces += u64::from(count != 0 && count != 27);
        }
        assert_eq!(grid.solid.marks.surfaces(), surfaces);
        // The inner 2 x 2 x 2 of the block of 4 x 4 x 4.
        assert_eq!(grid.solid.marks.inside(), 8);
        let line = grid.describe();
        assert!(line.starts_with("7 x 6 x 5 voxels and a border") && line.contains("8 solid voxels off"), "{line}");
        // 9 x 8 x 7 voxels in words of 32.
        assert_eq!(grid.memory().total(), 16 * 8);
    }
}
