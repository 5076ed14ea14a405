//! Which voxels the walks visit, against exact arithmetic: wrong ones, missed ones, lost length.
//!
//! A voxel is *missed* if a part of the ray longer than a point lies in it and the walk does not visit it; where the
//! ray runs in a plane between voxels it suffices to visit those on one side. The *lost length* is that of these parts.
//! A visited voxel is *wrong* if the ray does not even touch it.
//!
//! What our walks promise is less, and enough: grids insert primitives into voxels that are inflated by `PADDING`, so
//! each point of the ray must lie in a visited voxel *inflated by that*. A part of the ray for which this does not hold
//! is *uncovered*: there hits would be lost. Parts within the padding of the box's faces are excused, since grids keep
//! their primitives further inside. A ray within rounding of a plane, which passes on the wrong side of it, thus misses
//! voxels and leaves nothing uncovered. A ray that a walk refuses, `Start::TooFar`, is tested against all primitives
//! and loses nothing.
//!
//! Walks are compared with the one in f32 that textbooks print, which adds up tMax from voxel to voxel, and with the same one
//! when it computes tMax anew from the plane's index.

mod judge;
mod rays;
mod visited;

use crate::grid::{Branchless, Frame, IntegerWalk, VoxelWalk, Walk};
use crate::oracle::voxels::Voxels;
use crate::ray::Ray;
use judge::judge;
use rayon::prelude::*;
use rays::shot;
use visited::{Visited, textbook, visited};

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
    /// Random, axis-parallel, along diagonals, in planes between voxels, through corners of voxels, from afar, with
    /// components of very different size, short; through the unit cube and through boxes whose planes are no round
    /// numbers.
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::grid::PADDING;

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
