//! Chessboard distances for each octant of directions: the modern directed rival at eight bytes.
//!
//! Chessboard distances after Sramek & Kaufman 2000, made directional as in Es & Isler 2007 and Deakin & Knackstedt 2020 but
//! with one extent for each octant: the cube of C voxels ahead of the voxel, along the ray's sense of each axis, is empty.

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
