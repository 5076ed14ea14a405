//! Proximity clouds.
//!
//! D. Cohen and Z. Sheffer, "Proximity Clouds: An Acceleration Technique for 3D Grid Traversal", 1994; Semwal & Kvarnstrom
//! 1997 §3: each empty voxel knows the city-block distance D to the nearest filled one, and the ray skips ahead by D - 1.
//!
//! Region: the ball of city-block radius D around the voxel holds no filled voxel, by the definition of D. Every voxel that the
//! ray meets later is this one and some crossings, each a step away from it, so those fewer than D crossings ahead are empty. The
//! ray leaves the ball on a plane, wherever in the voxel it is: [`Diamond`] has the parameter.
//!
//! Departs from both: the leap ends on that plane instead of D - 1 units on. The printed landing passes no filled voxel in the
//! plane, where the ray lands on the first one at worst, nor from a voxel's centre; from elsewhere in space it may
//! ([`super::printed`]). A leap is taken wherever it passes the next crossing, not from D = 5 on. The two mask passes of the
//! distance transform are six sweeps (`distance.rs`).
//!
//! Page with a picture, the smallest example and what it brings: `docs/methods/proximity-clouds.md`.

use super::distance::city_block;
use super::printed::PrintedRule;
use super::region::{Diamond, corner};
use super::slot::{One, Slot};
use super::{Method, SkipOptions};
use crate::grid::occupancy::Occupancy;
use crate::grid::walk::Walk;

/// City-block distance to the nearest filled voxel: one byte, in a slot of four.
#[derive(Clone, Copy, Debug)]
pub struct ProximityClouds;

impl Method for ProximityClouds {
    type Slot = One;
    type Ray = Diamond;
    const NAME: &'static str = "proximity clouds";
    const PEAK: u64 = 1;

    fn distances(occupancy: &Occupancy, _options: &SkipOptions) -> Vec<Vec<u8>> {
        vec![city_block(occupancy)]
    }

    #[inline(always)]
    fn ray(walk: &Walk) -> Diamond {
        Diamond::new(walk, &[0, 1, 2])
    }

    #[inline(always)]
    fn safe_until<T: Slot>(ray: &Diamond, walk: &Walk, _slots: &[T], slot: T) -> Option<f64> {
        let distance = slot.distance(0);
        (distance > 1).then(|| ray.end(distance, corner(walk)))
    }
}

impl PrintedRule for ProximityClouds {
    /// x' = x + (D - 1) C, where the components of C sum to 1.
    #[inline(always)]
    fn printed_until<T: Slot>(ray: &Diamond, walk: &Walk, slot: T) -> f64 {
        walk.t + (f64::from(slot.distance(0)) - 1.0) * ray.inverse()
    }
}
