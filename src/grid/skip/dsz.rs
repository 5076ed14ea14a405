//! Directed safe zones.
//!
//! S. K. Semwal and H. Kvarnstrom, "Directed Safe Zones and the Dual Extent Algorithms for Efficient Grid Traversal during Ray
//! Tracing", Graphics Interface 1997, §4: six distances for each empty voxel, one for each face. The ray uses that of the
//! face through which it leaves the voxel, and gets further than a proximity cloud allows, because what lies behind that
//! face's back does not count.
//!
//! Region: let D_f be the city-block distance from the voxel to the nearest filled one beyond face f, in the half of the grid
//! on that side. Once the ray has left through f, all its later voxels lie in that half, because it moves one way along
//! each axis; those fewer than D_f crossings ahead are nearer than D_f, hence empty. So [`Diamond`] with D_f is safe. If
//! rounding names the wrong face near an edge, the ray is off the half space for less than the walk's error, which the
//! padding of the voxels covers.
//!
//! The preprocessing is the paper's eight corner scans (§4.1): the scan of octant o gives Q_o, the distance within that
//! octant, and D_f(v) = 1 + the least Q_o(v + f) of the four octants that contain f.
//!
//! Departs from the paper: the landing, as for [`super::ProximityClouds`]; the scans share sweeps, 2 + 4 + 8 instead of 24
//! (`distance.rs`).
//!
//! Page with a picture, how often D - 1 is wrong and what it brings: `docs/methods/directed-safe-zones.md`.

use super::distance::{FAR, city_block_octants, least};
use super::printed::PrintedRule;
use super::region::{Diamond, corner};
use super::slot::{Eight, Slot};
use super::{Method, SkipOptions};
use crate::grid::occupancy::Occupancy;
use crate::grid::walk::Walk;
use crate::parallel;

/// City-block distances to the nearest filled voxel beyond each face: six bytes, in a slot of eight.
///
/// Faces in the order +x, -x, +y, -y, +z, -z.
#[derive(Clone, Copy, Debug)]
pub struct DirectedSafeZones;

impl Method for DirectedSafeZones {
    type Slot = Eight;
    type Ray = Diamond;
    const NAME: &'static str = "directed safe zones";
    const PEAK: u64 = 14;

    fn distances(occupancy: &Occupancy, _options: &SkipOptions) -> Vec<Vec<u8>> {
        let octants = city_block_octants(occupancy);
        parallel::map(0..6, |face| beyond_face(occupancy, &octants, face))
    }

    #[inline(always)]
    fn ray(walk: &Walk) -> Diamond {
        Diamond::new(walk, &[0, 1, 2])
    }

    #[inline(always)]
    fn safe_until<T: Slot>(ray: &Diamond, walk: &Walk, _slots: &[T], slot: T) -> Option<f64> {
        let distance = slot.distance(next_face(walk));
        (distance > 1).then(|| ray.end(distance, corner(walk)))
    }
}

impl PrintedRule for DirectedSafeZones {
    #[inline(always)]
    fn printed_until<T: Slot>(ray: &Diamond, walk: &Walk, slot: T) -> f64 {
        walk.t + (f64::from(slot.distance(next_face(walk))) - 1.0) * ray.inverse()
    }
}

/// The face through which the ray leaves its voxel.
#[inline(always)]
pub(super) fn next_face(walk: &Walk) -> usize {
    let axis = walk.next_axis();
    2 * axis + (walk.octant >> axis & 1)
}

/// D_f of every voxel.
fn beyond_face(occupancy: &Occupancy, octants: &[Vec<u8>], face: usize) -> Vec<u8> {
    let (axis, lesser) = (face / 2, face % 2);
    let four: Vec<&[u8]> = (0..8).filter(|o| o >> axis & 1 == lesser).map(|o| octants[o].as_slice()).collect();
    let least = least(&four);
    let mut beyond = vec![FAR; least.len()];
    // Along the axis, each voxel takes its neighbour's value; the last one has none.
    let stride = occupancy.stride(axis);
    let line = stride * occupancy.resolution[axis];
    for (to, from) in beyond.chunks_mut(line).zip(least.chunks(line)) {
        let (to, from) =
            if lesser == 0 { (&mut to[..line - stride], &from[stride..]) } else { (&mut to[stride..], from) };
        to.iter_mut().zip(from).for_each(|(to, &from)| *to = from.saturating_add(1));
    }
    beyond
}
