//! The article's own question: which solid voxels does a ray cross, and which first?

use crate::error::Result;
use crate::geometry::SolidVoxels;
use crate::grid::voxels::{VoxelGrid, VoxelVisit};
use crate::ray::{Aabb, Ray};

/// Solid voxels along rays, in the exact sequence of [`VoxelGrid::voxels`].
///
/// Planes are those of [`VoxelGrid`] over the voxels' box, which are not rounded. Where [`SolidVoxels::planes`] are not
/// either (whole numbers, say), the first solid voxel that a ray enters from outside is the one that an accelerator hits; but
/// at an edge the rules differ: here a voxel holds its lower faces, there the least primitive wins.
///
/// ```
/// use glam::Vec3;
/// use skipgrid::Ray;
/// use skipgrid::geometry::{Face, SolidVoxels};
/// use skipgrid::grid::SolidSequence;
///
/// let voxels = SolidVoxels::new([4, 1, 1], vec![0, 1, 0, 1], Vec3::ZERO, 1.0)?;
/// let sequence = SolidSequence::new(&voxels)?;
/// let ray = Ray::new(Vec3::new(-1.0, 0.5, 0.5), Vec3::X);
/// let crossed: Vec<_> = sequence.crossings(&ray).map(|visit| (visit.voxel[0], visit.entry, visit.exit)).collect();
/// assert_eq!(crossed, [(1, 2.0, 3.0), (3, 4.0, 5.0)]);
/// // From within a solid voxel: there, through no face.
/// let within = sequence.first_solid(&Ray::new(Vec3::new(1.5, 0.5, 0.5), Vec3::X)).expect("it starts in one");
/// assert_eq!((within.voxel, within.entry, within.face), ([1, 0, 0], 0.0, None));
/// assert_eq!(sequence.first_solid(&ray).and_then(|visit| visit.face), Some(Face::NegX));
/// # Ok::<(), skipgrid::Error>(())
/// ```
#[derive(Clone, Debug)]
pub struct SolidSequence {
    voxels: SolidVoxels,
    grid: VoxelGrid,
}

impl SolidSequence {
    /// The voxels and the grid over their box.
    ///
    /// # Errors
    /// As [`VoxelGrid::new`]; solid voxels, whose planes are apart, give no cause.
    pub fn new(voxels: &SolidVoxels) -> Result<Self> {
        let mut bounds = Aabb { min: voxels.origin(), max: voxels.origin() };
        for axis in 0..3 {
            if let Some(&last) = voxels.planes(axis).last() {
                bounds.max[axis] = last;
            }
        }
        Ok(Self { voxels: voxels.clone(), grid: VoxelGrid::new(bounds, voxels.resolution())? })
    }

    /// Every solid voxel on the way, in order, with the parameters of entry and exit and the face of entry. Nothing for a ray that
    /// [`Ray::intake`] refuses.
    pub fn crossings(&self, ray: &Ray) -> impl Iterator<Item = VoxelVisit> + '_ {
        self.grid.voxels(ray).filter(|visit| self.voxels.material(visit.voxel) != 0)
    }

    /// The first one, `None` if there is none: `face` is `None` and `entry` the ray's start if it starts there.
    pub fn first_solid(&self, ray: &Ray) -> Option<VoxelVisit> {
        self.crossings(ray).next()
    }
}
