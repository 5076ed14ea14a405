//! No table: the plain walk.

use super::{Look, Skip, Voxels};
use crate::accel::Memory;
use crate::grid::cells::Cells;
use crate::grid::walk::VoxelWalk;

/// Lists alone; every voxel is walked.
#[derive(Clone, Debug)]
pub struct NoSkip(pub(in crate::grid) Cells);

impl<W: VoxelWalk> Skip<W> for NoSkip {
    type Ray = ();

    #[inline(always)]
    fn ray(_walk: &W) {}

    #[inline(always)]
    fn look(&self, walk: &W, _ray: &()) -> Look<'_> {
        Look::List(self.0.list(walk.voxel()))
    }
}

impl Voxels for NoSkip {
    fn memory(&self) -> Memory {
        self.0.memory()
    }

    fn empty(&self) -> u64 {
        self.0.empty()
    }

    fn references(&self) -> u64 {
        self.0.references()
    }

    fn describe(&self) -> String {
        String::new()
    }
}
