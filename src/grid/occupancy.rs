//! Which voxels are filled, without what fills them.

/// One flag for each voxel, x varying fastest; voxels beyond the grid are empty.
#[derive(Clone, Debug)]
pub struct Occupancy {
    /// Voxels along x, y and z.
    pub(super) resolution: [usize; 3],
    pub(super) filled: Vec<bool>,
}

impl Occupancy {
    /// Index of voxel (0, 0, 0)'s neighbour along an axis.
    pub(super) fn stride(&self, axis: usize) -> usize {
        let [nx, ny, _] = self.resolution;
        [1, nx, nx * ny][axis]
    }

    /// Number of voxels.
    pub(super) fn len(&self) -> usize {
        self.filled.len()
    }
}
