//! The voxels that a walk visits: one of ours, or the textbooks' in f32.

use crate::grid::{Frame, Start, VoxelWalk};
use crate::ray::Ray;

/// What a walk visits.
#[derive(Clone, Debug, Default)]
pub(super) struct Visited {
    /// Whether the walk leaves the ray to a test of all primitives.
    pub refused: bool,
    /// In the order of the visits.
    pub voxels: Vec<[u32; 3]>,
    /// Where it says that it leaves each of them.
    pub exits: Vec<f64>,
}

/// What the walk `W` visits when it goes on by `step`.
pub(super) fn visited<W: VoxelWalk>(frame: &Frame, ray: &Ray, mut step: impl FnMut(&mut W) -> bool) -> Visited {
    let mut visited = Visited::default();
    let Some(ray) = ray.intake() else { return visited };
    match W::start(frame, &ray) {
        Start::Miss => {}
        Start::TooFar => visited.refused = true,
        Start::Inside(mut walk) => loop {
            visited.voxels.push(frame.coordinates(walk.voxel()));
            visited.exits.push(walk.exit());
            if !step(&mut walk) {
                break;
            }
        },
    }
    visited
}

/// The walk of the textbooks: clipping, tMax and tDelta in f32; `add`: tMax is added up, else computed anew at each
/// step. It stops at the end of the ray and where it leaves the grid.
pub(super) fn textbook(frame: &Frame, ray: &Ray, add: bool) -> Visited {
    let mut visited = Visited::default();
    let (lo, cell) = (frame.lo.as_vec3(), (1.0 / frame.inverse).as_vec3());
    let (o, d, n) = (ray.origin, ray.direction, frame.resolution);
    let mut start = ray.t_min;
    let mut end = ray.t_max;
    for a in 0..3 {
        let [t0, t1] = [0, n[a]].map(|k| (lo[a] + k as f32 * cell[a] - o[a]) / d[a]);
        start = start.max(t0.min(t1));
        end = end.min(t0.max(t1));
    }
    // A range that is no number is none either.
    if start.partial_cmp(&end).is_none_or(|order| order.is_gt()) || !start.is_finite() {
        return visited;
    }
    let p = o + start * d;
    let mut voxel = [0, 1, 2].map(|a| (((p[a] - lo[a]) / cell[a]) as u32).min(n[a] - 1));
    let up = d.to_array().map(|x| x > 0.0);
    let crossing = |a: usize, index: u32| {
        let plane = lo[a] + (index + u32::from(up[a])) as f32 * cell[a];
        if d[a] == 0.0 { f32::INFINITY } else { (plane - o[a]) / d[a] }
    };
    let mut t_max = [0, 1, 2].map(|a| crossing(a, voxel[a]));
    let t_delta = [0, 1, 2].map(|a| cell[a] / d[a].abs());
    loop {
        let [x, y, z] = t_max;
        let a = if x < y {
            if x < z { 0 } else { 2 }
        } else if y < z {
            1
        } else {
            2
        };
        visited.voxels.push(voxel);
        visited.exits.push(t_max[a].into());
        let next = if up[a] { voxel[a] + 1 } else { voxel[a].wrapping_sub(1) };
        if next >= n[a] || t_max[a] > ray.t_max {
            return visited;
        }
        voxel[a] = next;
        t_max[a] = if add { t_max[a] + t_delta[a] } else { crossing(a, next) };
    }
}
