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

    /// The voxel beside `voxel` across `face` (0 to 5: +x, -x, +y, -y, +z, -z), or `None` beyond the grid.
    pub(super) fn neighbour(&self, voxel: usize, face: usize) -> Option<usize> {
        let (axis, stride) = (face / 2, self.stride(face / 2));
        let at = voxel / stride % self.resolution[axis];
        if face & 1 == 0 {
            (at + 1 < self.resolution[axis]).then(|| voxel + stride)
        } else {
            (at > 0).then(|| voxel - stride)
        }
    }
}
