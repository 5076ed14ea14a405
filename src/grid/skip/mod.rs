//! Leaping over empty voxels.
//!
//! A method keeps a few small integers for each empty voxel: distances to filled ones. They describe a region around the
//! voxel in which every voxel is empty, and [`Method::safe_until`] gives the parameter at which the ray leaves that region.
//! The walk goes there at once. One promise, one test for all methods: from the voxel
//! where the ray is up to that parameter it meets empty voxels only.
//!
//! A method is a file that stands for itself: the source, why the region is empty, where it departs from the print. Each has a page
//! with a picture in `docs/methods`.
//!
//! The sources land elsewhere: they carry the ray D - 1 city-block units forwards from where it is, and only if D is at least
//! 5. In three dimensions that passes filled voxels ([`printed`]). A ray that has gone the distance f, 0 <= f < 1, into its
//! voxel along each axis reaches voxels up to floor(f_x + S_x) + floor(f_y + S_y) + floor(f_z + S_z) away after a city-block
//! length S, so the safe length is D - (f_x + f_y + f_z). [`region::Diamond`] has the form of it that needs no position.

pub mod chessboard;
pub mod clouds;
mod distance;
pub mod dsz;
pub mod dsz24;
pub mod dual;
mod none;
pub mod octant;
mod options;
pub mod printed;
pub mod region;
mod slot;
mod table;

pub use chessboard::Chessboard;
pub use clouds::ProximityClouds;
pub use dsz::DirectedSafeZones;
pub use dsz24::DirectedSafeZones24;
pub use dual::DualExtents;
pub use none::NoSkip;
pub use octant::Octants;
pub use options::{Distances, SkipOptions};
pub use printed::{PrintedLanding, PrintedRule};
pub use slot::{Eight, One, Packed, Slot};
pub(super) use table::Free;
pub use table::Table;

use super::occupancy::Occupancy;
use super::walk::Walk;
use crate::accel::Memory;
use crate::parallel;

/// What a walk finds in a voxel. Parameters are the ray's own.
pub enum Look<'a> {
    /// Primitives to test, possibly none; the walk goes on with a step.
    List(&'a [u32]),
    /// The voxel is empty, and so is every voxel that the ray meets before this parameter. Before the next crossing it says
    /// nothing more than that.
    Empty(f64),
    /// The voxel is empty, and nothing is known of others: the walk goes on with a step.
    Near,
}

/// A grid's voxels as a walk `W` meets them: lists, and how far it may go over empty ones. [`NoSkip`] and [`Table`] are
/// what there is; it names types of this module alone, so that no others can be.
pub trait Skip<W> {
    /// What is computed once for each ray.
    type Ray;

    /// Computes it, at the ray's first voxel.
    fn ray(walk: &W) -> Self::Ray;

    /// What is in the walk's voxel.
    fn look(&self, walk: &W, ray: &Self::Ray) -> Look<'_>;
}

/// What is known of a grid's voxels apart from any walk.
pub trait Voxels: Send + Sync {
    /// Bytes of voxels, references and distances.
    fn memory(&self) -> Memory;

    /// Number of voxels without a primitive.
    fn empty(&self) -> u64;

    /// Number of references from voxels to primitives.
    fn references(&self) -> u64;

    /// What is kept for empty voxels, for people; empty if nothing is.
    fn describe(&self) -> String;
}

/// A way to know empty regions from a few distances for each voxel. Those of this module are all there are: it names types
/// that are not public. Which one a grid has is a type parameter, so that the loop over voxels has no choice in it.
pub trait Method: Send + Sync + 'static {
    /// Bytes of a voxel with linear distances.
    type Slot: Slot;
    /// What is computed once for each ray.
    type Ray;
    /// For people.
    const NAME: &'static str;
    /// The first so many fields are widths of regions and not lengths of leaps: no threshold applies to them.
    const WIDTHS: usize = 0;
    /// Bytes a voxel that [`Method::distances`] holds at most, its result included.
    const PEAK: u64;

    /// The distances of all voxels, a plane for each field of the slot; at least 1 where the voxel is empty, 255 for "255
    /// or more".
    fn distances(occupancy: &Occupancy, options: &SkipOptions) -> Vec<Vec<u8>>;

    /// Computes what all looks of one ray share.
    fn ray(walk: &Walk) -> Self::Ray;

    /// The parameter up to which the ray, in the empty voxel of `slot` now, surely meets empty voxels only; `None` if the
    /// distance is 1 and tells nothing. Distances may have been rounded down.
    ///
    /// `None` is for speed alone: whether there is anything to leap over is known from the slot, long before where to.
    fn safe_until<T: Slot>(ray: &Self::Ray, walk: &Walk, slots: &[T], slot: T) -> Option<f64>;
}

/// For each octant of directions and each voxel, x varying fastest, the edge of the cube of empty voxels that begins with it and
/// reaches along the octant; 0 if it is filled, 255 for "255 or more". Bit `a` of an octant is set if it points to lesser
/// coordinates along axis `a`. The old content of `free` is lost and its memory used again.
pub(crate) fn free_cubes(resolution: [usize; 3], filled: impl Iterator<Item = bool> + Clone, free: &mut Vec<u8>) {
    free.clear();
    (0..8).for_each(|_| free.extend(distance::seeds(filled.clone())));
    let voxels = resolution.iter().product::<usize>().max(1);
    parallel::each(free.chunks_mut(voxels).enumerate(), |(octant, plane)| {
        distance::chebyshev_octant(plane, resolution, octant);
    });
}

#[cfg(test)]
mod tests;
