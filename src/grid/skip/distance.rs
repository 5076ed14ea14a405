//! Distances to the nearest filled voxel, by sweeps over the grid.
//!
//! A plane here is one byte for each voxel, in the order of the grid; 255 means "255 or more", and voxels beyond the grid
//! are empty. All sweeps are linear in the number of voxels, and parallel over rows, slabs or octants.
//!
//! City-block distances are separable: what two mask passes over the whole grid find (Borgefors 1986; Semwal & Kvarnstrom
//! 1997 §2) is also found by one pass along each axis and sense, and these are independent line by line.
//!
//! An octant is the set of directions with given signs: bit `a` of its number is set if axis `a` points to lesser
//! coordinates. A face is 0 to 5: +x, -x, +y, -y, +z, -z.

use crate::grid::occupancy::Occupancy;
use crate::parallel;

/// "255 or more".
pub(super) const FAR: u8 = u8::MAX;

/// City-block distance to the nearest filled voxel in any direction; 0 in filled voxels.
pub(super) fn city_block(occupancy: &Occupancy) -> Vec<u8> {
    let mut plane = filled(occupancy);
    for axis in 0..3 {
        sweep(&mut plane, occupancy.resolution, axis, false);
        sweep(&mut plane, occupancy.resolution, axis, true);
    }
    plane
}

/// City-block distance to the nearest filled voxel in each of the eight closed octants; 0 in filled voxels.
pub(super) fn city_block_octants(occupancy: &Occupancy) -> Vec<Vec<u8>> {
    // Octants that agree on the first axes share their sweeps: 2 + 4 + 8 instead of 8 times 3.
    let mut planes = vec![filled(occupancy)];
    for axis in 0..3 {
        let both = planes.into_iter().flat_map(|plane| [(plane.clone(), false), (plane, true)]);
        let swept = parallel::map(both, |(mut plane, lesser)| {
            sweep(&mut plane, occupancy.resolution, axis, lesser);
            (lesser, plane)
        });
        // The axis' bit is above the bits of the axes before it.
        let (lesser, greater): (Vec<_>, Vec<_>) = swept.into_iter().partition(|(lesser, _)| *lesser);
        planes = greater.into_iter().chain(lesser).map(|(_, plane)| plane).collect();
    }
    planes
}

/// Chebyshev distance to the nearest filled voxel in each of the eight closed octants; 0 in filled voxels.
pub(super) fn chebyshev_octants(occupancy: &Occupancy) -> Vec<Vec<u8>> {
    parallel::map(0..8, |octant| {
        let mut plane = filled(occupancy);
        chebyshev_octant(&mut plane, occupancy.resolution, octant);
        plane
    })
}

/// The least of some planes in each voxel.
pub(super) fn least(planes: &[&[u8]]) -> Vec<u8> {
    let mut least = planes[0].to_vec();
    for plane in &planes[1..] {
        least.iter_mut().zip(*plane).for_each(|(l, &p)| *l = (*l).min(p));
    }
    least
}

fn filled(occupancy: &Occupancy) -> Vec<u8> {
    seeds(occupancy.filled.iter().copied()).collect()
}

/// Where distances begin: 0 in filled voxels, far in others.
pub(super) fn seeds(filled: impl Iterator<Item = bool>) -> impl Iterator<Item = u8> {
    filled.map(|filled| if filled { 0 } else { FAR })
}

/// Lowers each distance to at most one more than that of its neighbour towards greater (or `lesser`) coordinates.
pub(super) fn sweep(plane: &mut [u8], [nx, ny, nz]: [usize; 3], axis: usize, lesser: bool) {
    match axis {
        0 => parallel::each(plane.chunks_mut(nx * ny), |slab| {
            for row in slab.chunks_mut(nx) {
                let mut distance = FAR;
                let mut lower = |d: &mut u8| {
                    distance = (*d).min(distance.saturating_add(1));
                    *d = distance;
                };
                if lesser { row.iter_mut().for_each(&mut lower) } else { row.iter_mut().rev().for_each(&mut lower) }
            }
        }),
        1 => parallel::each(plane.chunks_mut(nx * ny), |slab| pull_rows(slab.chunks_mut(nx).collect(), lesser)),
        _ => {
            // Strips of every slab, gathered by their place in the slab.
            let strip = (nx * ny).div_ceil(64).max(nx);
            let mut strips: Vec<Vec<&mut [u8]>> = Vec::new();
            strips.resize_with((nx * ny).div_ceil(strip), || Vec::with_capacity(nz));
            for slab in plane.chunks_mut(nx * ny) {
                strips.iter_mut().zip(slab.chunks_mut(strip)).for_each(|(rows, row)| rows.push(row));
            }
            parallel::each(strips, |rows| pull_rows(rows, lesser));
        }
    }
}

/// Lowers each row, element by element, to at most one more than the row after it (before it, if `lesser`).
fn pull_rows(mut rows: Vec<&mut [u8]>, lesser: bool) {
    if !lesser {
        rows.reverse();
    }
    for i in 1..rows.len() {
        let (done, rest) = rows.split_at_mut(i);
        let from = &*done[i - 1];
        rest[0].iter_mut().zip(from).for_each(|(d, &f)| *d = (*d).min(f.saturating_add(1)));
    }
}

/// One more than the least of the seven neighbours in the octant, slab by slab and row by row from its far corner.
pub(super) fn chebyshev_octant(plane: &mut [u8], [nx, ny, nz]: [usize; 3], octant: usize) {
    let lesser = [octant & 1 != 0, octant & 2 != 0, octant & 4 != 0];
    // The least of the three rows ahead: beside, above, and both; one longer than a row, so that every voxel has one ahead.
    let mut ahead = vec![FAR; nx + 2];
    for k in 0..nz {
        let z = if lesser[2] { k } else { nz - 1 - k };
        for j in 0..ny {
            let y = if lesser[1] { j } else { ny - 1 - j };
            let row = (z * ny + y) * nx;
            ahead.fill(FAR);
            for (dj, dk) in [(1, 0), (0, 1), (1, 1)] {
                if j < dj || k < dk {
                    continue;
                }
                let (y, z) = (if lesser[1] { y - dj } else { y + dj }, if lesser[2] { z - dk } else { z + dk });
                let from = &plane[(z * ny + y) * nx..][..nx];
                ahead[1..=nx].iter_mut().zip(from).for_each(|(a, &f)| *a = (*a).min(f));
            }
            let mut last = FAR;
            for i in 0..nx {
                let x = if lesser[0] { i } else { nx - 1 - i };
                // `ahead[x + 1]` lies ahead of voxel x in the rows ahead; its neighbour along x as well.
                let diagonal = if lesser[0] { ahead[x] } else { ahead[x + 2] };
                let least = last.min(ahead[x + 1]).min(diagonal);
                last = plane[row + x].min(least.saturating_add(1));
                plane[row + x] = last;
            }
        }
    }
}

/// Number of empty voxels from each voxel straight on across `face`, itself included.
pub(super) fn run(occupancy: &Occupancy, face: usize) -> Vec<u8> {
    let mut plane = filled(occupancy);
    sweep(&mut plane, occupancy.resolution, face / 2, face % 2 == 1);
    plane
}

/// The least of each voxel's value and one more than those of its four neighbours to the sides of `axis`.
pub(super) fn widen(occupancy: &Occupancy, plane: &[u8], axis: usize) -> Vec<u8> {
    let [nx, ny, nz] = occupancy.resolution;
    let mut wide = plane.to_vec();
    parallel::each(wide.chunks_mut(nx * ny).enumerate(), |(z, slab)| {
        for (y, row) in slab.chunks_mut(nx).enumerate() {
            let lower = |row: &mut [u8], from: &[u8]| {
                row.iter_mut().zip(from).for_each(|(d, &f)| *d = (*d).min(f.saturating_add(1)));
            };
            let at = |y: usize, z: usize| &plane[(z * ny + y) * nx..][..nx];
            if axis != 0 {
                lower(&mut row[1..], at(y, z));
                lower(row, &at(y, z)[1..]);
            }
            if axis != 1 {
                if y > 0 {
                    lower(row, at(y - 1, z));
                }
                if y + 1 < ny {
                    lower(row, at(y + 1, z));
                }
            }
            if axis != 2 {
                if z > 0 {
                    lower(row, at(y, z - 1));
                }
                if z + 1 < nz {
                    lower(row, at(y, z + 1));
                }
            }
        }
    });
    wide
}
