//! What a walk visited, against the exact path of the ray.

use super::Tally;
use super::visited::Visited;
use crate::grid::PADDING;
use crate::oracle::voxels::{Path, Visit};
use std::collections::HashSet;

/// Compares what a walk visited with the ray's exact path, `None` if it does not meet the grid.
pub(super) fn judge(path: Option<&Path>, visited: &Visited, offset: usize) -> Tally {
    let mut tally = Tally { rays: 1, refused: visited.refused.into(), ..Tally::default() };
    let Some(path) = path else {
        tally.wrong = visited.voxels.len() as u64;
        tally.wrong_rays = (tally.wrong > 0).into();
        return tally;
    };
    tally.voxels = path.visits().iter().filter(|visit| !visit.is_touch()).count() as u64;
    tally.length = path.length();
    if visited.refused {
        return tally;
    }
    tally.t_error = t_error(path, visited, offset);
    if visited.voxels.iter().eq(path.visits().iter().map(|visit| &visit.voxel)) {
        return tally;
    }
    let ours: HashSet<[u32; 3]> = visited.voxels.iter().copied().collect();
    for visit in path.visits().iter().filter(|visit| !visit.is_touch() && !is_visited(path, visit, &ours)) {
        let length = path.chord(visit);
        tally.missed += 1;
        tally.lost += length;
        tally.longest = tally.longest.max(length);
        if !is_covered(path, visit, &ours) {
            tally.uncovered += 1;
            tally.uncovered_length += length;
        }
    }
    let exact: HashSet<[u32; 3]> = path.visits().iter().map(|visit| visit.voxel).collect();
    tally.wrong = ours.iter().filter(|&&voxel| !exact.contains(&voxel) && !path.touches(voxel)).count() as u64;
    tally.wrong_rays = (tally.missed + tally.wrong > 0).into();
    tally
}

/// Whether the voxel is visited, or one below planes that the ray runs in.
fn is_visited(path: &Path, visit: &Visit, ours: &HashSet<[u32; 3]>) -> bool {
    (0..8u32).any(|below| {
        let of = |a: usize| below >> a & 1;
        (0..3).all(|a| of(a) == 0 || path.shared()[a]) && ours.contains(&[0, 1, 2].map(|a| visit.voxel[a] - of(a)))
    })
}

/// Whether the ray's part in a voxel lies in a visited neighbour when inflated, or within the padding of the box's faces.
fn is_covered(path: &Path, visit: &Visit, ours: &HashSet<[u32; 3]>) -> bool {
    let v = visit.voxel.map(i64::from);
    let n = path.resolution().map(i64::from);
    let by_neighbour = (0..27).any(|i| {
        let w = [v[0] + i % 3 - 1, v[1] + i / 3 % 3 - 1, v[2] + i / 9 - 1];
        let index = w.map(u32::try_from);
        let [Ok(x), Ok(y), Ok(z)] = index else { return false };
        ours.contains(&[x, y, z]) && path.lies_in(visit, w, w, PADDING)
    });
    let beside = |a: usize, k: i64| {
        let (mut low, mut high) = (v, v);
        (low[a], high[a]) = (k, k);
        path.lies_in(visit, low, high, PADDING)
    };
    by_neighbour || (0..3).any(|a| beside(a, -1) || beside(a, n[a]))
}

/// The greatest distance of the ray from a plane where the walk crosses it.
fn t_error(path: &Path, visited: &Visited, offset: usize) -> f64 {
    let steps = visited.voxels.windows(2).zip(&visited.exits);
    let errors = steps.skip(offset % 8).step_by(8).filter_map(|(pair, &t)| {
        // A leap may cross planes of several axes at once; t belongs to one of them.
        let crossed = (0..3).filter(|&a| pair[0][a] != pair[1][a]);
        let error =
            |a: usize| if t.is_finite() { path.distance(a, pair[0][a].max(pair[1][a]), t) } else { f64::INFINITY };
        crossed.map(error).reduce(f64::min)
    });
    errors.fold(0.0, f64::max)
}
