//! The primitive lists of all voxels as one compressed array.
//!
//! A. Lagae and P. Dutré, "Compact, Fast and Robust Grids for Ray Tracing", 2008: one offset for each voxel and one index
//! for each reference, nothing else.

use crate::accel::Memory;

/// Lists of primitive indices, one for each voxel, each in ascending order.
#[derive(Clone, Debug, Default)]
pub struct Cells {
    /// List `v` is `prims[start[v]..start[v + 1]]`.
    start: Vec<u32>,
    prims: Vec<u32>,
}

impl Cells {
    /// Takes offsets (one more than voxels, ascending, the last one the number of references) and references.
    pub fn new(start: Vec<u32>, prims: Vec<u32>) -> Self {
        debug_assert_eq!(start.last().map(|&n| n as usize), Some(prims.len()));
        Self { start, prims }
    }

    /// Offsets and references, for their memory to be used again.
    pub fn into_parts(self) -> (Vec<u32>, Vec<u32>) {
        (self.start, self.prims)
    }

    /// The primitives in a voxel.
    #[inline(always)]
    pub fn list(&self, voxel: usize) -> &[u32] {
        &self.prims[self.start[voxel] as usize..self.start[voxel + 1] as usize]
    }

    /// Number of references before a voxel's.
    pub fn begin(&self, voxel: usize) -> u64 {
        u64::from(self.start[voxel])
    }

    /// Number of voxels.
    pub fn voxels(&self) -> usize {
        self.start.len() - 1
    }

    /// Whether each voxel has a primitive.
    pub fn flags(&self) -> Vec<bool> {
        self.start.windows(2).map(|w| w[0] != w[1]).collect()
    }

    /// Number of voxels without a primitive.
    pub fn empty(&self) -> u64 {
        self.start.windows(2).filter(|w| w[0] == w[1]).count() as u64
    }

    /// Number of references.
    pub fn references(&self) -> u64 {
        self.prims.len() as u64
    }

    pub fn memory(&self) -> Memory {
        Memory { structure: self.start.len() as u64 * 4, references: self.prims.len() as u64 * 4, tables: 0 }
    }
}
