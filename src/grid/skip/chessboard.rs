//! Chessboard distances: the modern isotropic rival at one byte.
//!
//! M. Sramek and A. Kaufman, "Fast Ray-Tracing of Rectilinear Volume Data Using Distance Transforms", 2000: the cube of
//! voxels less than C away along every axis is empty, and the ray goes to where it leaves that cube. Its exit is an
//! ordinary voxel crossing, so there is no rule of thumb to land safely.

use super::distance::{chebyshev_octants, least};
use super::region::box_end;
use super::slot::{One, Slot};
use super::{Method, SkipOptions};
use crate::grid::occupancy::Occupancy;
use crate::grid::walk::Walk;

/// Chebyshev distance to the nearest filled voxel: one byte, in a slot of four.
#[derive(Clone, Copy, Debug)]
pub struct Chessboard;

impl Method for Chessboard {
    type Slot = One;
    type Ray = ();
    const NAME: &'static str = "chessboard distances";
    const PEAK: u64 = 9;

    fn distances(occupancy: &Occupancy, _options: &SkipOptions) -> Vec<Vec<u8>> {
        let octants = chebyshev_octants(occupancy);
        vec![least(&octants.iter().map(Vec::as_slice).collect::<Vec<_>>())]
    }

    #[inline(always)]
    fn ray(_walk: &Walk) {}

    #[inline(always)]
    fn safe_until<T: Slot>(_ray: &(), walk: &Walk, _slots: &[T], slot: T) -> Option<f64> {
        let distance = slot.distance(0);
        (distance > 1).then(|| box_end(walk, distance))
    }
}
