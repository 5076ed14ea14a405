//! The six faces of a voxel.

use glam::Vec3;

/// A face of a voxel, named by its normal, which points out of the voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum Face {
    /// Towards smaller x.
    NegX,
    /// Towards larger x.
    PosX,
    /// Towards smaller y.
    NegY,
    /// Towards larger y.
    PosY,
    /// Towards smaller z.
    NegZ,
    /// Towards larger z.
    PosZ,
}

impl Face {
    /// All faces, in their order.
    pub const ALL: [Face; 6] = [Face::NegX, Face::PosX, Face::NegY, Face::PosY, Face::NegZ, Face::PosZ];
    /// Those towards smaller coordinates, by axis.
    pub const LOWER: [Face; 3] = [Face::NegX, Face::NegY, Face::NegZ];
    /// Those towards larger coordinates, by axis.
    pub const UPPER: [Face; 3] = [Face::PosX, Face::PosY, Face::PosZ];

    /// 0, 1 or 2 for x, y or z.
    pub fn axis(self) -> usize {
        self as usize / 2
    }

    /// True if the normal points towards larger coordinates.
    pub fn is_upper(self) -> bool {
        self as usize % 2 == 1
    }

    /// The same face as the voxel on its other side sees it.
    pub fn opposite(self) -> Face {
        Self::ALL[self as usize ^ 1]
    }

    /// The unit normal, out of the voxel; on the face that a ray enters through, against the ray.
    pub fn normal(self) -> Vec3 {
        let side = if self.is_upper() { 1.0 } else { -1.0 };
        side * Vec3::AXES[self.axis()]
    }
}
