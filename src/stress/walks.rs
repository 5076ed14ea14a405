//! Which voxels the walks visit, against exact arithmetic: wrong ones, missed ones, lost length.
//!
//! A voxel is *missed* if a part of the ray longer than a point lies in it and the walk does not visit it; where the ray runs
//! in a plane between voxels it suffices to visit those on one side. The *lost length* is that of these parts. A visited voxel
//! is *wrong* if the ray does not even touch it.
//!
//! What our walks promise is less, and enough: grids insert primitives into voxels that are inflated by `PADDING`, so each
//! point of the ray must lie in a visited voxel *inflated by that*. A part of the ray for which this does not hold is
//! *uncovered*: there hits would be lost. Parts within the padding of the box's faces are excused, since grids keep their
//! primitives further inside. A ray within rounding of a plane, which passes on the wrong side of it, thus misses voxels and leaves
//! nothing uncovered. A ray that a walk refuses, `Start::TooFar`, is tested against all primitives and loses nothing.
//!
//! Walks are compared with the one in f32 that textbooks print, which adds up tMax from voxel to voxel, and with the same one
//! when it computes tMax anew from the plane's index.

mod rays;

use crate::grid::{Branchless, Frame, IntegerWalk, PADDING, Start, VoxelWalk, Walk};
use crate::oracle::voxels::{Path, Visit, Voxels};
use crate::ray::Ray;
use rayon::prelude::*;
use rays::shot;
use std::collections::HashSet;

/// A grid and the rays that are sent through it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct VoxelCase {
    /// The name on the command line.
    pub name: &'static str,
    /// Voxels along x, y and z.
    pub resolution: [u32; 3],
}

/// All cases: cubes of voxels from 256 to 4096 an axis, and grids with an axis or two of one voxel.
pub const CASES: &[VoxelCase] = &[
    VoxelCase { name: "vox_256", resolution: [256; 3] },
    VoxelCase { name: "vox_1000", resolution: [1000; 3] },
    VoxelCase { name: "vox_1024", resolution: [1024; 3] },
    VoxelCase { name: "vox_2048", resolution: [2048; 3] },
    VoxelCase { name: "vox_4000", resolution: [4000; 3] },
    VoxelCase { name: "vox_4096", resolution: [4096; 3] },
    VoxelCase { name: "vox_1x1x1", resolution: [1; 3] },
    VoxelCase { name: "vox_1x1024x1", resolution: [1, 1024, 1] },
    VoxelCase { name: "vox_4096x1x1000", resolution: [4096, 1, 1000] },
    VoxelCase { name: "vox_3x4001x2", resolution: [3, 4001, 2] },
];

/// Rays of one kind.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Rays {
    /// From the region of one corner of the unit cube to that of the opposite one.
    Corners,
    /// Random, axis-parallel, along diagonals, in planes between voxels, through corners of voxels, from afar, with components
    /// of very different size, short; through the unit cube and through boxes whose planes are no round numbers.
    Stiff,
}

impl Rays {
    /// Both kinds.
    pub const ALL: [Rays; 2] = [Rays::Corners, Rays::Stiff];

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Corners => "corner to corner",
            Self::Stiff => "stiff",
        }
    }
}

/// A walk that is judged.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Judged {
    /// [`Walk`].
    Branching,
    /// [`Branchless`].
    Branchless,
    /// [`IntegerWalk`].
    Integer,
    /// [`Walk`], going from exit to exit as it does after a look at a skip table that knows of nothing further.
    Leaping,
    /// The textbook's in f32, which adds up tMax.
    AddedF32,
    /// The textbook's in f32, with tMax computed anew at each step.
    AnewF32,
}

impl Judged {
    /// All walks, ours first.
    pub const ALL: [Judged; 6] =
        [Self::Branching, Self::Branchless, Self::Integer, Self::Leaping, Self::AddedF32, Self::AnewF32];

    /// The name in reports.
    pub fn name(self) -> &'static str {
        match self {
            Self::Branching => "branching",
            Self::Branchless => "branchless",
            Self::Integer => "integer",
            Self::Leaping => "leaping",
            Self::AddedF32 => "textbook f32, tMax added up",
            Self::AnewF32 => "textbook f32, tMax computed anew",
        }
    }

    /// True if nothing may be uncovered.
    pub fn is_ours(self) -> bool {
        !matches!(self, Self::AddedF32 | Self::AnewF32)
    }

    fn visit(self, frame: &Frame, ray: &Ray) -> Visited {
        match self {
            Self::Branching => visited::<Walk>(frame, ray, VoxelWalk::step),
            Self::Branchless => visited::<Branchless>(frame, ray, VoxelWalk::step),
            Self::Integer => visited::<IntegerWalk>(frame, ray, VoxelWalk::step),
            Self::Leaping => visited::<Walk>(frame, ray, |walk| walk.leap(walk.exit())),
            Self::AddedF32 => textbook(frame, ray, true),
            Self::AnewF32 => textbook(frame, ray, false),
        }
    }
}

/// What a walk did with some rays.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Tally {
    /// Rays traced.
    pub rays: u64,
    /// Rays that the walk refused, to have them tested against all primitives.
    pub refused: u64,
    /// Rays with a missed or a wrong voxel.
    pub wrong_rays: u64,
    /// Voxels that the rays pass through.
    pub voxels: u64,
    /// Length of the rays in the grid, in voxels along the axis on which each crosses most.
    pub length: f64,
    /// Visited voxels that the ray does not touch.
    pub wrong: u64,
    /// Voxels that the ray passes through and the walk does not visit.
    pub missed: u64,
    /// Length of the rays in missed voxels, in the unit of `length`.
    pub lost: f64,
    /// The longest part of a ray in a missed voxel, in the unit of `length`.
    pub longest: f64,
    /// The greatest distance of the ray from a plane at the parameter at which the walk crosses it, in voxels along the
    /// plane's axis; infinite if such a parameter is no number. Every eighth crossing is looked at.
    pub t_error: f64,
    /// Missed voxels with a part of the ray that no visited voxel covers when inflated.
    pub uncovered: u64,
    /// Length of the rays in those, in the unit of `length`.
    pub uncovered_length: f64,
}

impl Tally {
    /// [`Tally::lost`] in millionths of the length.
    pub fn lost_ppm(&self) -> f64 {
        millionths(self.lost, self.length)
    }

    /// [`Tally::uncovered_length`] in millionths of the length.
    pub fn uncovered_ppm(&self) -> f64 {
        millionths(self.uncovered_length, self.length)
    }

    fn merge(self, other: Self) -> Self {
        Self {
            rays: self.rays + other.rays,
            refused: self.refused + other.refused,
            wrong_rays: self.wrong_rays + other.wrong_rays,
            voxels: self.voxels + other.voxels,
            length: self.length + other.length,
            wrong: self.wrong + other.wrong,
            missed: self.missed + other.missed,
            lost: self.lost + other.lost,
            longest: self.longest.max(other.longest),
            t_error: self.t_error.max(other.t_error),
            uncovered: self.uncovered + other.uncovered,
            uncovered_length: self.uncovered_length + other.uncovered_length,
        }
    }
}

fn millionths(part: f64, of: f64) -> f64 {
    if of > 0.0 { part / of * 1e6 } else { 0.0 }
}

/// One row of the table: a walk and a kind of rays.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Row {
    /// The walk.
    pub walk: Judged,
    /// What it was sent through the grid.
    pub rays: Rays,
    /// What it did.
    pub tally: Tally,
}

impl Row {
    /// False if a walk of ours leaves a part of a ray uncovered.
    pub fn keeps_promise(&self) -> bool {
        !self.walk.is_ours() || self.tally.uncovered == 0
    }
}

/// `count` rays of each kind through the grid of `case`, by every walk. The same rays for the same count, on all cores.
pub fn study(case: &VoxelCase, count: usize) -> Vec<Row> {
    let each = |rays: Rays| {
        let tallies = (0..count).into_par_iter().map(|i| {
            let (frame, ray) = shot(case, rays, i);
            judge_all(&frame, &ray, i)
        });
        let none = || [Tally::default(); Judged::ALL.len()];
        let sums = tallies.reduce(none, |a, b| std::array::from_fn(|i| a[i].merge(b[i])));
        Judged::ALL.into_iter().zip(sums).map(move |(walk, tally)| Row { walk, rays, tally })
    };
    Rays::ALL.into_iter().flat_map(each).collect()
}

fn judge_all(frame: &Frame, ray: &Ray, offset: usize) -> [Tally; Judged::ALL.len()] {
    let path = Voxels::of_map(frame.lo, frame.inverse, frame.resolution).path(ray);
    Judged::ALL.map(|walk| judge(path.as_ref(), &walk.visit(frame, ray), offset))
}

/// What a walk visits.
#[derive(Clone, Debug, Default)]
struct Visited {
    refused: bool,
    voxels: Vec<[u32; 3]>,
    /// Where it says that it leaves each of them.
    exits: Vec<f64>,
}

fn visited<W: VoxelWalk>(frame: &Frame, ray: &Ray, mut step: impl FnMut(&mut W) -> bool) -> Visited {
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

/// The walk of the textbooks: clipping, tMax and tDelta in f32. It stops at the end of the ray and where it leaves the grid.
fn textbook(frame: &Frame, ray: &Ray, add: bool) -> Visited {
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

/// Compares what a walk visited with the ray's exact path, `None` if it does not meet the grid.
fn judge(path: Option<&Path>, visited: &Visited, offset: usize) -> Tally {
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

#[cfg(test)]
mod tests {
    use super::*;

    fn row(rows: &[Row], walk: Judged, rays: Rays) -> Tally {
        let found = rows.iter().find(|row| row.walk == walk && row.rays == rays);
        found.expect("every walk has a row for each kind of rays").tally
    }

    #[test]
    fn our_walks_cover_every_ray_and_the_textbooks_does_not() {
        for case in CASES {
            // As many voxels for each case, about.
            let count = (80_000 / case.resolution.iter().sum::<u32>()).clamp(16, 160) as usize;
            let rows = study(case, count);
            for row in &rows {
                assert!(row.keeps_promise(), "{} {row:?}", case.name);
                assert_eq!(row.tally.rays, count as u64);
                if row.walk.is_ours() {
                    // The walks promise half of the padding.
                    assert!(row.tally.t_error <= PADDING / 2.0, "{} {row:?}", case.name);
                }
            }
            assert!(row(&rows, Judged::Branching, Rays::Stiff).voxels > 400 || case.resolution == [1; 3]);
            // From corner to corner next to nothing is even outside of the visited voxels themselves. A leap counts a plane as
            // crossed 2^-20 voxels before it.
            for walk in Judged::ALL.into_iter().filter(|walk| walk.is_ours()) {
                let tally = row(&rows, walk, Rays::Corners);
                let most = if walk == Judged::Leaping { 1e-4 } else { 1e-6 };
                assert!(tally.lost_ppm() < most && tally.longest < 1e-5, "{} {walk:?} {tally:?}", case.name);
            }
            if case.resolution[0] >= 1024 && case.resolution[1] >= 1024 {
                let added = row(&rows, Judged::AddedF32, Rays::Corners);
                let anew = row(&rows, Judged::AnewF32, Rays::Corners);
                assert!(added.wrong_rays * 2 > added.rays && added.lost_ppm() > 1.0, "{} {added:?}", case.name);
                assert!(added.uncovered > 0 && anew.t_error < 0.1 * added.t_error, "{} {anew:?}", case.name);
            }
        }
    }

    #[test]
    fn a_walk_that_leaves_out_a_voxel_is_caught() {
        let case = &CASES[0];
        let mut caught = [0, 0];
        for i in 0..50 {
            let (frame, ray) = shot(case, Rays::Corners, i);
            let path = Voxels::of_map(frame.lo, frame.inverse, frame.resolution).path(&ray).expect("it starts inside");
            let mut visited = Judged::Branching.visit(&frame, &ray);
            assert_eq!(judge(Some(&path), &visited, 0).missed, 0);
            // The voxel in the middle, and another that lies nowhere near.
            let middle = visited.voxels.len() / 2;
            let length = path.chord(&path.visits()[middle]);
            visited.voxels.remove(middle);
            visited.exits.remove(middle);
            visited.voxels.push([255, 0, 0]);
            visited.exits.push(f64::NAN);
            let tally = judge(Some(&path), &visited, 0);
            assert_eq!((tally.missed, tally.wrong, tally.lost), (1, 1, length));
            caught[0] += tally.uncovered;
            caught[1] += u64::from(length > 0.01);
        }
        // A part of a hundredth of a voxel in length reaches out of the padding on one side.
        assert!(caught[0] >= caught[1] && caught[1] > 30, "{caught:?}");
    }
}
