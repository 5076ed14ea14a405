//! How fine a grid is and what it may take.

use super::seeds::SeedRule;
use crate::accel::default_budget;
use crate::error::{Error, Result};

/// How to build a [`super::Grid`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridOptions {
    /// Voxels for each primitive, finite and above 0; ignored if `resolution` is given.
    pub density: f64,
    /// Voxels along x, y and z, each 1 to [`GridOptions::MAX_RESOLUTION`]; fewer are made where f64 cannot tell so many apart.
    pub resolution: Option<[u32; 3]>,
    /// Remember for each ray which primitives it has met (the paper's rayID), so that none is tested twice. Pays for
    /// primitives that are large or costly to test; takes four bytes for each primitive and thread.
    pub mailbox: bool,
    /// Where tests begin that iterate; means nothing to primitives whose tests do not.
    pub seeds: SeedRule,
    /// Bytes that voxels and references may take together; a grid that needs more is refused.
    pub memory: u64,
}

impl Default for GridOptions {
    /// Two voxels a primitive, no mailbox, a quarter of the machine's memory but at most 8 GiB.
    fn default() -> Self {
        Self { density: 2.0, resolution: None, mailbox: false, seeds: SeedRule::Voxel, memory: default_budget() }
    }
}

impl GridOptions {
    /// Most voxels along one axis.
    pub const MAX_RESOLUTION: u32 = 4096;

    /// # Errors
    /// The density is not a finite number above 0, or a resolution is 0 or above [`GridOptions::MAX_RESOLUTION`].
    pub(super) fn check(&self) -> Result<()> {
        if !(self.density.is_finite() && self.density > 0.0) {
            return Err(Error::invalid(format!("grid density is {}, but must be finite and above 0", self.density)));
        }
        if let Some(bad) = self.resolution.and_then(|r| r.into_iter().find(|n| !(1..=Self::MAX_RESOLUTION).contains(n)))
        {
            return Err(Error::invalid(format!("grid resolution is {bad}, but must be 1 to {}", Self::MAX_RESOLUTION)));
        }
        Ok(())
    }
}
