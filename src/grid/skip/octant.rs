//! Chessboard distances for each octant of directions: the modern directed rival at eight bytes.
//!
//! Chessboard distances after Sramek & Kaufman 2000, made directional as in Es & Isler 2007 and Deakin & Knackstedt 2020:
//! each empty voxel knows for each octant o of directions the chessboard distance C_o to the nearest filled voxel within
//! the closed octant.
//!
//! Region: the box of C_o voxels along each axis that begins with the voxel and reaches along the octant holds no filled voxel,
//! by the definition of C_o. A ray of octant o moves one way along each axis, so it meets voxels of the closed octant only, and
//! is in the box until it crosses one of its three far planes ([`super::region`]). What lies behind the ray, or to the side that it
//! moves away from, does not shorten the leap. An axis along which it does not move counts as forwards and bounds nothing.
//!
//! Departs from both: one extent for each octant, a cube and not a box of three extents, so that eight bytes are enough.
//!
//! Page with a picture and what it brings: `docs/methods/octants.md`.

use super::distance::chebyshev_octants;
use super::region::box_end;
use super::slot::{Eight, Slot};
use super::{Method, SkipOptions};
use crate::grid::occupancy::Occupancy;
use crate::grid::walk::Walk;

/// Chebyshev distances to the nearest filled voxel of each octant: eight bytes.
#[derive(Clone, Copy, Debug)]
pub struct Octants;

impl Method for Octants {
    type Slot = Eight;
    type Ray = ();
    const NAME: &'static str = "chessboard distances by octant";
    const PEAK: u64 = 8;

    fn distances(occupancy: &Occupancy, _options: &SkipOptions) -> Vec<Vec<u8>> {
        chebyshev_octants(occupancy)
    }

    #[inline(always)]
    fn ray(_walk: &Walk) {}

    #[inline(always)]
    fn safe_until<T: Slot>(_ray: &(), walk: &Walk, _slots: &[T], slot: T) -> Option<f64> {
        let distance = slot.distance(walk.octant);
        (distance > 1).then(|| box_end(walk, distance))
    }
}
