//! Starting points for primitives whose tests iterate: one for each reference from a voxel.
//!
//! Source: Amanatides & Woo 1987, last section. A hit lies in a voxel that the ray meets, and the part of the primitive
//! that its seed knows of covers the padded voxel: what a test does not look for is found in another voxel.

use super::frame::Frame;
use super::options::GridOptions;
use super::voxelise::voxels_of;
use crate::error::{Error, Result};
use crate::geometry::{Geometry, Seed};

/// Where tests begin that iterate.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum SeedRule {
    /// In each voxel at a point of the primitive in that voxel.
    #[default]
    Voxel,
    /// In the middle of the primitive.
    Fixed,
}

/// The seeds of all references, sorted by primitive and voxel; empty if the geometry does not iterate.
///
/// Shape: primitive `p` has the entries `start[p]..start[p + 1]`, voxels ascending.
#[derive(Clone, Debug, Default)]
pub(super) struct Seeds {
    start: Vec<u32>,
    voxels: Vec<u32>,
    seeds: Vec<Seed>,
}

impl Seeds {
    /// The seeds of `references` references.
    ///
    /// # Errors
    /// They would take more than `allowed` bytes.
    pub fn new<G: Geometry>(
        geometry: &G,
        frame: &Frame,
        references: u64,
        options: &GridOptions,
        allowed: u64,
    ) -> Result<Self> {
        let mut all = Self::default();
        if !G::ITERATES || options.seeds == SeedRule::Fixed {
            return Ok(all);
        }
        let each = (size_of::<u32>() + size_of::<Seed>()) as u64;
        let wanted = references * each + (u64::from(geometry.len()) + 1) * 4;
        let refused =
            |cause: &str| Error::TooLarge { what: format!("seeds of {references} references{cause}"), wanted, allowed };
        if wanted > allowed {
            return Err(refused(""));
        }
        let entries = references as usize;
        let reserved =
            all.start.try_reserve_exact(geometry.len() as usize + 1).and(all.voxels.try_reserve_exact(entries));
        reserved.and(all.seeds.try_reserve_exact(entries)).map_err(|_| refused(" (the system refuses the memory)"))?;
        all.start.push(0);
        for prim in 0..geometry.len() {
            let begin = all.voxels.len();
            voxels_of(geometry, prim, frame, &mut |voxel| {
                if let Some(seed) = geometry.seed(prim, &frame.cell(frame.coordinates(voxel))) {
                    // A grid has fewer than 2^32 voxels.
                    all.voxels.push(voxel as u32);
                    all.seeds.push(seed);
                }
            });
            debug_assert!(all.voxels[begin..].is_sorted(), "voxels are visited in their order");
            all.start.push(all.voxels.len() as u32);
        }
        Ok(all)
    }

    /// True if nothing is kept.
    pub fn is_empty(&self) -> bool {
        self.start.is_empty()
    }

    /// The seed of a reference; `None` if none is kept.
    #[inline]
    pub fn find(&self, prim: u32, voxel: usize) -> Option<&Seed> {
        let (&begin, &end) = self.start.get(prim as usize).zip(self.start.get(prim as usize + 1))?;
        let (begin, end) = (begin as usize, end as usize);
        let at = self.voxels[begin..end].binary_search(&(voxel as u32)).ok()?;
        Some(&self.seeds[begin + at])
    }

    /// Bytes.
    pub fn bytes(&self) -> u64 {
        (size_of_val(self.start.as_slice()) + size_of_val(self.voxels.as_slice()) + size_of_val(self.seeds.as_slice()))
            as u64
    }
}
