//! Chessboard distances: the modern isotropic rival at one byte.
//!
//! M. Sramek and A. Kaufman, "Fast Ray-Tracing of Rectilinear Volume Data Using Distance Transforms", 2000: each empty voxel
//! knows the chessboard distance C to the nearest filled one, the greatest of the differences of their coordinates, and the ray
//! goes to where it leaves the cube of voxels less than C away along every axis.
//!
//! Region: that cube holds no filled voxel, by the definition of C. The ray moves one way along each axis, so all of the cube that
//! it can meet is the box of C voxels along each axis that begins with the voxel. It is in that box until the least of the
//! parameters at which it crosses the box's three far planes ([`super::region`]).
//!
//! The exit is an ordinary voxel crossing, so there is no rule of thumb to land safely. What can fail is an implementation
//! that takes `floor` of the point on the face: it may be rounded to the voxel before, from which the ray leaps to the same
//! face for ever. Here planes are counted, and one at least is crossed ([`crate::grid::Walk`]).
//!
//! Departs from the paper: it samples volumes, here filled voxels hold primitives; the distances are the least of those of the
//! eight octants (`distance.rs`), and end at 255.
//!
//! Page with a picture and what it brings: `docs/methods/chessboard.md`.

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
