//! The uniform grid and its voxel walk.
//!
//! J. Amanatides and A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", Eurographics 1987. Departures from the
//! paper, each because of what it would otherwise get wrong:
//!
//! - `tMax` is recomputed from the voxel index at every step instead of being accumulated: with accumulation in f32,
//!   three of four rays from corner to corner of 1024 voxels an axis visit a wrong voxel (`tests/suite/voxels/printed.rs`).
//! - Voxels are closed and padded, so that a ray along a face, edge or corner meets the primitives on all its sides,
//!   whichever voxel the tie rule of the walk prefers.
//! - An axis along which the ray does not move never wins the comparison: its `tMax` is infinite, never 0/0.
//! - The second traversal function of the paper, which also compares the winner's `t` with the voxel's exit, is the first one
//!   with the ray's end lowered to the winner.
//! - The rayID mailbox belongs to the thread, not to the object.

mod build;
mod cells;
mod frame;
pub(crate) mod lists;
mod mailbox;
mod occupancy;
mod options;
mod seeds;
mod shadow;
pub mod skip;
mod solid;
mod voxelise;
mod voxels;
mod walk;
mod walk_branchless;
mod walk_integer;

pub use crate::geometry::Face;
pub use options::GridOptions;
pub use seeds::SeedRule;
pub use shadow::ShadowVoxels;
pub use solid::{SolidGrid, SolidOptions, SolidSequence, Unskipped};
pub use voxels::{VoxelGrid, VoxelVisit, VoxelVisits};
pub use walk::Walk;
pub use walk_branchless::Branchless;
pub use walk_integer::IntegerWalk;

// For those who judge the walks.
pub(crate) use frame::Frame;
#[cfg(feature = "cli")]
pub(crate) use frame::PADDING;
pub(crate) use walk::{Start, VoxelWalk};

use crate::accel::{Accel, Hit, LeftOut, Memory, Probe, queries_with_probe, scan_all, scan_any};
use crate::geometry::{Best, Geometry, Seed};
use crate::ray::{Aabb, Ray, greater};
use mailbox::Mailbox;
use seeds::Seeds;
use skip::{Look, NoSkip, Skip, Voxels};
use std::marker::PhantomData;

/// A uniform grid over any geometry, which it owns, borrows (`&G`) or shares (`Arc<G>`).
///
/// `S` is what it keeps of each voxel: [`NoSkip`] for lists alone, [`skip::Table`] for lists and distances. `W` is how rays
/// step from voxel to voxel.
///
/// Memory: four bytes for each voxel and four for each reference from a voxel to a primitive; tables say their own. Sixteen
/// more for each reference to a primitive whose test iterates.
#[derive(Clone, Debug)]
pub struct Grid<G, S = NoSkip, W = Walk> {
    geometry: G,
    frame: Frame,
    voxels: S,
    seeds: Seeds,
    bounds: Aabb,
    mailbox: bool,
    options: GridOptions,
    /// For the next rebuild, once there was one.
    shop: Option<Box<build::Workshop>>,
    left_out: LeftOut,
    walk: PhantomData<W>,
}

impl<G, S: Voxels, W> Grid<G, S, W> {
    /// Voxels along x, y and z.
    pub fn resolution(&self) -> [u32; 3] {
        self.frame.resolution
    }

    /// Primitives that no ray can hit, such as triangles with a corner that is not finite: they are in no voxel.
    pub fn ignored(&self) -> u32 {
        self.left_out.unhittable
    }

    /// Primitives that equal an earlier one but for the order of corners: they can tie with it at best, and the least index
    /// wins, so they are in no voxel.
    pub fn copies(&self) -> u32 {
        self.left_out.copies
    }

    /// Number of voxels without a primitive.
    pub fn empty_voxels(&self) -> u64 {
        self.voxels.empty()
    }

    /// Number of references from voxels to primitives.
    pub fn references(&self) -> u64 {
        self.voxels.references()
    }
}

impl<G: Geometry, S: Skip<W> + Voxels, W: VoxelWalk> Grid<G, S, W> {
    /// The closest hit, watched by `probe`; `()` watches nothing and costs nothing.
    pub fn closest_hit_with<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        self.closest_hit_through(&self.voxels, ray, probe)
    }

    /// Whether there is any hit, watched by `probe`.
    pub fn any_hit_with<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        self.any_hit_through(&self.voxels, ray, probe)
    }
}

impl<G: Geometry, S, W: VoxelWalk> Grid<G, S, W> {
    /// As [`Grid::closest_hit_with`], with another look at the voxels.
    fn closest_hit_through<T: Skip<W>, P: Probe>(&self, voxels: &T, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let ray = ray.intake()?;
        let best = match W::start(&self.frame, &ray) {
            Start::Miss => return None,
            Start::TooFar => scan_all(&self.geometry, &ray, probe),
            Start::Inside(walk) => self.trace_either(false, voxels, &ray, walk, probe),
        };
        best.prim().map(|prim| Hit { t: self.geometry.round(&ray, &best), prim })
    }

    /// As [`Grid::any_hit_with`], with another look at the voxels.
    fn any_hit_through<T: Skip<W>, P: Probe>(&self, voxels: &T, ray: &Ray, probe: &mut P) -> bool {
        let Some(ray) = ray.intake() else { return false };
        match W::start(&self.frame, &ray) {
            Start::Miss => false,
            Start::TooFar => scan_any(&self.geometry, &ray, probe),
            Start::Inside(walk) => self.trace_either(true, voxels, &ray, walk, probe).is_hit(),
        }
    }

    /// [`Grid::trace`], compiled for each query on its own where nobody watches.
    #[inline(always)]
    fn trace_either<T: Skip<W>, P: Probe>(&self, any: bool, voxels: &T, ray: &Ray, walk: W, probe: &mut P) -> Best {
        if P::WATCHES {
            self.trace_watched(any, voxels, ray, walk, probe)
        } else {
            self.trace(any, voxels, ray, walk, probe)
        }
    }

    #[inline(never)]
    fn trace_watched<T: Skip<W>, P: Probe>(&self, any: bool, voxels: &T, ray: &Ray, walk: W, probe: &mut P) -> Best {
        self.trace(any, voxels, ray, walk, probe)
    }

    /// Where the test of `prim` begins in the walk's voxel; always `None`, at no cost, if tests do not iterate.
    #[inline(always)]
    fn seed(&self, prim: u32, walk: &W) -> Option<&Seed> {
        if G::ITERATES { self.seeds.find(prim, walk.voxel()) } else { None }
    }

    /// From list to list until the winner, or the first hit if `any` will do, is certain.
    #[inline(always)]
    fn trace<T: Skip<W>, P: Probe>(&self, any: bool, voxels: &T, ray: &Ray, mut walk: W, probe: &mut P) -> Best {
        // Asked for at run time, but once for each test and not for each voxel: a predictable branch beside a test of a hundred
        // instructions, for half as many loops to compile.
        let mut mailbox = self.mailbox.then(|| Mailbox::take(self.geometry.len()));
        let prep = self.geometry.prepare(ray);
        let shared = T::ray(&walk);
        let mut best = Best::NONE;
        loop {
            probe.step();
            match voxels.look(&walk, &shared) {
                Look::List(list) => {
                    for &prim in list {
                        if mailbox.as_mut().is_none_or(|mailbox| mailbox.first_time(prim)) {
                            probe.test();
                            match self.seed(prim, &walk) {
                                Some(seed) => self.geometry.test_from(seed, prim, ray, &prep, &mut best),
                                None => self.geometry.test(prim, ray, &prep, &mut best),
                            }
                            if any && best.is_hit() {
                                return best;
                            }
                        }
                    }
                    if !list.is_empty() {
                        // A winner further along is kept, not accepted: a closer hit may lie in a voxel before it. Passing it,
                        // leaving the grid or reaching the end of the ray accepts it. Infinite if there is no winner.
                        walk.end_at(best.upper());
                    }
                }
                Look::Empty(safe_until) => {
                    // No branch on which is further: no predictor would get it right. To the exit it is a step.
                    let exit = walk.exit();
                    if safe_until > exit {
                        probe.leap();
                    }
                    if !walk.leap(greater(safe_until, exit)) {
                        return best;
                    }
                    continue;
                }
                Look::Near => {}
            }
            if !walk.step() {
                return best;
            }
        }
    }
}

impl<G: Geometry, S: Skip<W> + Voxels, W: VoxelWalk> Accel for Grid<G, S, W> {
    queries_with_probe!(closest_hit_with, any_hit_with);

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn memory(&self) -> Memory {
        let memory = self.voxels.memory();
        Memory { references: memory.references + self.seeds.bytes(), ..memory }
    }

    fn describe(&self) -> String {
        let [x, y, z] = self.frame.resolution;
        let voxels = u64::from(x) * u64::from(y) * u64::from(z);
        let (empty, references) = (self.voxels.empty(), self.voxels.references());
        let filled = (voxels - empty).max(1);
        let mut line = format!(
            "{x} x {y} x {z} voxels, {:.1} % empty, {:.2} references a filled voxel, mailbox {}",
            100.0 * empty as f64 / voxels as f64,
            references as f64 / filled as f64,
            if self.mailbox { "on" } else { "left out" },
        );
        let table = self.voxels.describe();
        if !table.is_empty() {
            line += &format!(", {table}");
        }
        if G::ITERATES {
            line += &match self.seeds.bytes() {
                0 => ", tests begin in the middle".to_string(),
                bytes => format!(", seeds of {bytes} bytes"),
            };
        }
        line + &self.left_out.to_string()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn describes_what_was_built_and_what_was_left_out() {
        let corner = |x: f32| [Vec3::new(x, 0.0, 0.0), Vec3::new(x + 0.05, 0.0, 0.0), Vec3::new(x, 0.1, 0.1)];
        let triangles = vec![corner(0.0), corner(0.95), [Vec3::NAN; 3]];
        let options = GridOptions { resolution: Some([10, 1, 1]), ..GridOptions::default() };
        let grid = Grid::build(&triangles, &options).unwrap();
        assert_eq!((grid.resolution(), grid.ignored()), ([10, 1, 1], 1));
        let line = grid.describe();
        assert!(
            line.starts_with("10 x 1 x 1 voxels, 80.0 % empty, 1.00 references a filled voxel, mailbox left out"),
            "{line}"
        );
        assert!(line.ends_with("1 primitives that no ray can hit left out"), "{line}");
        assert_eq!(grid.memory().total(), 4 * (10 + 1 + 2));
    }

    #[test]
    fn a_walk_takes_a_step_for_each_voxel() {
        // One triangle far along +x, seen through 9 empty voxels: the walk takes a step for each.
        let triangles =
            vec![[Vec3::ZERO; 3], [Vec3::new(10.0, 0.0, 0.0), Vec3::new(10.0, 1.0, 0.0), Vec3::new(10.0, 0.0, 1.0)]];
        let options = GridOptions { resolution: Some([10, 1, 1]), ..GridOptions::default() };
        let grid = Grid::build(&triangles, &options).unwrap();
        let mut counts = crate::accel::Counts::default();
        let ray = Ray::new(Vec3::new(-5.0, 0.25, 0.25), Vec3::X);
        assert_eq!(grid.closest_hit_counted(&ray, &mut counts), Some(Hit { t: 15.0, prim: 1 }));
        assert_eq!((counts.steps, counts.tests), (10, 2));
    }
}
