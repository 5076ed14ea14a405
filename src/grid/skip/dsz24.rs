//! Directed safe zones with 24 values: one for each face and each quarter of the directions that leave through it.
//!
//! Semwal & Kvarnstrom 1997 §10 announce "four values per wall" as future work. The value of face f and octant o is
//! D_fo(v) = 1 + Q_o(v + f), where Q_o is the city-block distance to the nearest filled voxel within the closed octant o. So the
//! 24 values of a voxel are read off the eight values of its neighbours, and eight bytes a voxel are enough.
//!
//! Region: after leaving v through f, a ray of octant o meets voxels of that octant of v + f only, because it moves one way along
//! each axis, and those nearer to v + f than Q_o(v + f) are empty. From v they are one crossing further, so every voxel fewer than
//! D_fo crossings ahead is empty: [`Diamond`] with D_fo is safe. D_fo is at least D_f of [`super::DirectedSafeZones`], which is the
//! least of the four.
//!
//! Departs from the paper: eight values are kept in the place of 24, and the ray looks at the neighbour's instead of its own; the
//! landing, as for [`super::ProximityClouds`].
//!
//! Page with a picture and what it brings: `docs/methods/dsz24.md`.

use super::distance::city_block_octants;
use super::region::{Diamond, corner};
use super::slot::{Eight, Slot};
use super::{Method, SkipOptions};
use crate::grid::occupancy::Occupancy;
use crate::grid::walk::Walk;

/// City-block distances to the nearest filled voxel of each octant: eight bytes.
#[derive(Clone, Copy, Debug)]
pub struct DirectedSafeZones24;

impl Method for DirectedSafeZones24 {
    type Slot = Eight;
    type Ray = Diamond;
    const NAME: &'static str = "directed safe zones of 24 values";
    const PEAK: u64 = 12;

    fn distances(occupancy: &Occupancy, _options: &SkipOptions) -> Vec<Vec<u8>> {
        city_block_octants(occupancy)
    }

    #[inline(always)]
    fn ray(walk: &Walk) -> Diamond {
        Diamond::new(walk, &[0, 1, 2])
    }

    #[inline(always)]
    fn safe_until<T: Slot>(ray: &Diamond, walk: &Walk, slots: &[T], _slot: T) -> Option<f64> {
        let axis = walk.next_axis();
        if walk.left[axis] == 0 {
            // The next crossing leaves the grid.
            return None;
        }
        let beside = slots[walk.voxel.wrapping_add_signed(walk.stride[axis])];
        match beside.place() {
            Some(_) => None,
            None => {
                let distance = beside.distance(walk.octant);
                (distance > 1).then(|| ray.end(1 + distance, corner(walk)))
            }
        }
    }
}
