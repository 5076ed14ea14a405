//! Dual extents.
//!
//! Semwal & Kvarnstrom 1997 §5: each empty voxel knows its proximity cloud D and, for each face, how much further a lane of
//! the cloud's width is empty. Rays that run nearly along an axis get far in a lane.
//!
//! Region: let R_f(w) be the number of empty voxels from w straight along face f. The least R_f(w) + |w - v| over the voxels w
//! beside v, less than D steps to the sides, is E_f(v): every voxel ahead of v that is less than D steps to the sides and less
//! than E steps in all is empty. It contains the cloud, because E is at least D. The ray leaves it at the lesser of two
//! [`Diamond`]s: that of E over all axes, and that of D over the two axes to the sides. The extent is that of the axis along
//! which the ray is fastest; the paper does not say which.
//!
//! Departs from the paper: the landing, as for [`super::ProximityClouds`]; the width of the lanes is limited
//! ([`SkipOptions::lane`]), any lesser D being as true; and the preprocessing, "many times" that of the clouds in the paper,
//! widens all lanes of the grid by one voxel at a time instead of looking at D² voxels for each voxel and face.
//!
//! Page with a picture and what it brings: `docs/methods/dual-extents.md`.

use super::distance::{city_block, run, widen};
use super::printed::PrintedRule;
use super::region::{Diamond, coordinate, corner};
use super::slot::{Eight, Slot};
use super::{Method, SkipOptions};
use crate::grid::occupancy::Occupancy;
use crate::grid::walk::Walk;
use crate::parallel;
use crate::ray::lesser;

/// City-block distance, limited to the lanes' half width, and the extents E towards each face: seven bytes, in a slot of eight.
#[derive(Clone, Copy, Debug)]
pub struct DualExtents;

/// What the looks of one ray share.
#[derive(Clone, Copy, Debug)]
pub struct Lane {
    all: Diamond,
    sides: Diamond,
    /// The fastest axis and the field of its extent.
    axis: usize,
    field: usize,
}

impl Method for DualExtents {
    type Slot = Eight;
    type Ray = Lane;
    const NAME: &'static str = "dual extents";
    const WIDTHS: usize = 1;
    // The cloud, six extents, and two planes at work for each face.
    const PEAK: u64 = 19;

    fn distances(occupancy: &Occupancy, options: &SkipOptions) -> Vec<Vec<u8>> {
        let mut cloud = city_block(occupancy);
        cloud.iter_mut().for_each(|d| *d = (*d).min(options.lane));
        let extents = parallel::map(0..6, |face| extents(occupancy, &cloud, face, options.lane));
        std::iter::once(cloud).chain(extents).collect()
    }

    #[inline(always)]
    fn ray(walk: &Walk) -> Lane {
        let [x, y, z] = walk.speed;
        let axis = if x >= y && x >= z { 0 } else { usize::from(y < z) + 1 };
        let sides = [(axis + 1) % 3, (axis + 2) % 3];
        Lane {
            all: Diamond::new(walk, &[0, 1, 2]),
            sides: Diamond::new(walk, &sides),
            axis,
            field: 1 + 2 * axis + (walk.octant >> axis & 1),
        }
    }

    #[inline(always)]
    fn safe_until<T: Slot>(ray: &Lane, walk: &Walk, _slots: &[T], slot: T) -> Option<f64> {
        let extent = slot.distance(ray.field);
        (extent > 1).then(|| {
            let sum = corner(walk);
            let beside = ray.sides.end(slot.distance(0), sum - coordinate(walk, ray.axis));
            lesser(ray.all.end(extent, sum), beside)
        })
    }
}

impl PrintedRule for DualExtents {
    /// The lesser of D - 1 + D_de and (D - 1) over the part of the ray's length that goes to the sides.
    #[inline(always)]
    fn printed_until<T: Slot>(ray: &Lane, walk: &Walk, slot: T) -> f64 {
        let ahead = (f64::from(slot.distance(ray.field)) - 1.0) * ray.all.inverse();
        let beside = f64::from(slot.distance(0)) - 1.0;
        let moves_aside = ray.sides.inverse().is_finite();
        walk.t + if moves_aside { lesser(ahead, beside * ray.sides.inverse()) } else { ahead }
    }
}

/// E of every voxel towards a face, for lanes of the half width that `cloud` gives, at most `lane`.
fn extents(occupancy: &Occupancy, cloud: &[u8], face: usize, lane: u8) -> Vec<u8> {
    let mut runs = run(occupancy, face);
    let mut extents = runs.clone();
    let widest = cloud.iter().copied().max().unwrap_or(0).min(lane);
    for half in 1..widest {
        runs = widen(occupancy, &runs, face / 2);
        // Lanes of half width D reach D - 1 voxels to the sides.
        for ((extent, &wide), &d) in extents.iter_mut().zip(&runs).zip(cloud) {
            if d > half {
                *extent = wide;
            }
        }
    }
    extents
}
