//! The fast one: a coarse grid with skip bytes over trees of boxes, eight at a time, or of 4 x 4 x 4 cells, with packs of eight
//! primitives at the leaves.
//!
//! ```text
//! Nested
//!  +- part: the large ones      a few primitives as long as the box: every ray tests their packs first        split.rs
//!  +- part: a dense object      its own frame, -1 to 1 along its longest axis                                 frame.rs
//!  |    +- grid on top          as fine as the primitives want it; a skip byte for each cell and octant       fill.rs, build.rs
//!  |         +- empty           the byte is the edge of an empty cube: the ray leaps to its end               step.rs
//!  |         +- leaf            packs of eight primitives, tested at once                       triangles.rs, spheres.rs
//!  |         |    +- boxes      in trees: which of eight packs or groups does the ray meet?             boxes.rs, tree.rs
//!  |         +- node            64 cells, a mask of those that are filled: an option                            cut.rs
//!  |              +- a leaf or a node, for each filled cell
//!  +- part: the rest            another grid
//! ```
//!
//! **A ray** (`walk`) is moved to where it enters the part. On top it steps and leaps as in [`crate::grid`]. At a leaf,
//! eight boxes at a time say which packs and which groups of boxes are met: packs are tested at once, groups nearest first.
//! In a node the crossings of all planes are found at once, and from them the mask of the cells that the ray crosses; what
//! that has in common with the filled cells is visited from the lowest bit on, which, with the node seen along the ray's
//! octant, is front to back. A pack rejects what is certainly missed; a hit that is certain and before all others is kept
//! with its bounds; what is left open is judged in f64 from the pack, as is the parameter of the winner at the end, and
//! what that leaves open goes to the geometry's own test. So the answers are those of every other accelerator, to the bit.
//! Counted as steps are cells, nodes and groups of eight boxes.
//!
//! **What the cells are for.** Trees of boxes alone, one for each part, take longer, above all in large scenes; so do fine
//! grids with small leaves where primitives lie on surfaces, and nodes (`density` and `below` of [`NestedOptions`];
//! docs/bench.md has numbers).
//!
//! **Why nothing is lost.** Cells tile the ray: each `s` from its begin to its end lies, by comparisons of the computed crossings
//! alone, in the interval of some cell that is visited, or of an empty cube; crossings of one plane are computed
//! alike for the cells on both its sides, and the outermost cells of a node have no outer planes. The ray at that `s` is within
//! rounding of that cell (`frame`: 8 e for the ray, 14 e for a crossing of the grid's, 6 e for one of a node's), and
//! primitives are listed in every cell within the padding, 64 e. So a hit is found when the cell of its `s` is visited,
//! and a walk may end where the next cell begins beyond the winner.
//!
//! **Instructions** are chosen once for each ray, in `simd.rs`; all of them round alike.

#![allow(clippy::needless_range_loop, reason = "an axis indexes several arrays at once")]

mod boxes;
mod build;
mod crowd;
mod cut;
mod exact;
mod fill;
mod frame;
mod lanes;
mod limit;
mod options;
mod pack;
mod place;
mod raster;
mod root;
mod shape;
mod sight;
mod simd;
mod source;
mod spheres;
mod split;
mod step;
mod tree;
mod triangles;
mod walk;

pub use options::{Below, Instructions, NestedOptions, Quality};

use crate::accel::{Accel, Counts, Hit, LeftOut, Memory, scan_all, scan_any};
use crate::error::Result;
use crate::geometry::Geometry;
use crate::ray::{Aabb, Ray};
use exact::Tests;
use root::Workshop;
use shape::{AnyPart, Shape};
use simd::Isa;
use walk::Outcome;

/// A nested grid over any geometry, which it owns, borrows (`&G`) or shares (`Arc<G>`).
#[derive(Clone, Debug)]
pub struct Nested<G> {
    geometry: G,
    shape: Shape,
    isa: Isa,
    bounds: Aabb,
    left_out: LeftOut,
    options: NestedOptions,
    /// For the next rebuild, once there was one.
    shop: Option<Box<Workshop>>,
}

impl<G: Geometry> Nested<G> {
    /// Builds one over `geometry`. Primitives that no ray can hit are left out; an empty geometry is fine.
    ///
    /// # Errors
    /// It would take more than `options.memory` bytes.
    pub fn build(geometry: G, options: &NestedOptions) -> Result<Self> {
        let isa = match options.instructions {
            Instructions::Detected => Isa::detect(),
            Instructions::Portable => Isa::Portable,
        };
        let mut shape = Shape::default();
        let (bounds, left_out) = root::build(&geometry, options, isa, &mut shape, &mut Workshop::default())?;
        Ok(Self { geometry, shape, isa, bounds, left_out, options: *options, shop: None })
    }

    /// Builds the grid anew, with the options that it was built with: as a fresh one, to the bit, in the memory of this
    /// one. From the second time on, nothing large is allocated for as many primitives in about as many cells. For that the
    /// grid keeps what it needs while it builds, some 60 bytes for each primitive, which [`Accel::memory`] does not count,
    /// as rays do not use it; [`Clone`] does.
    ///
    /// # Errors
    /// It would take more than `options.memory` bytes. Then every ray tests all primitives: answers as always, but slow.
    ///
    /// # Example
    /// ```
    /// # use skipgrid::{Accel, Ray, Triangle, nested::{Nested, NestedOptions}};
    /// # use glam::Vec3;
    /// let frame = |height: f32| -> Vec<Triangle> { vec![[Vec3::X, Vec3::Y, Vec3::ZERO].map(|p| p + Vec3::Z * height)] };
    /// let mut nested = Nested::build(frame(0.0), &NestedOptions::default())?;
    /// nested.rebuild(frame(-1.0))?;
    /// let down = Ray::new(Vec3::new(0.25, 0.25, 1.0), Vec3::NEG_Z);
    /// assert_eq!(nested.closest_hit(&down).map(|hit| hit.t), Some(2.0));
    /// # Ok::<(), skipgrid::Error>(())
    /// ```
    pub fn rebuild(&mut self, geometry: G) -> Result<()> {
        let mut shop = self.shop.take().unwrap_or_default();
        let built = root::build(&geometry, &self.options, self.isa, &mut self.shape, &mut shop);
        let (found, result) = match built {
            Ok(found) => (found, Ok(())),
            Err(error) => (root::list(&geometry, &mut self.shape, &mut shop), Err(error)),
        };
        (self.bounds, self.left_out) = found;
        (self.geometry, self.shop) = (geometry, Some(shop));
        result
    }

    /// As [`Accel::closest_hit`], with the test of triangles as f32 has it, after Möller and Trumbore: for measuring what
    /// exact answers cost (`cargo bench --bench nested_exactness`). Rays through edges may miss or hit twice, parameters
    /// are off by some roundings, and of two that are as near either may win.
    #[must_use]
    pub fn closest_hit_rounded(&self, ray: &Ray) -> Option<Hit> {
        let ray = ray.intake()?;
        let mut tests = Tests::new(&self.geometry, &ray);
        self.isa.trace::<false>(&self.shape, &ray, false, &mut tests);
        tests.best.prim().map(|prim| Hit { t: tests.best.t() as f32, prim })
    }

    /// As [`Accel::any_hit`], with the test of [`Nested::closest_hit_rounded`].
    #[must_use]
    pub fn any_hit_rounded(&self, ray: &Ray) -> bool {
        let Some(ray) = ray.intake() else { return false };
        let mut tests = Tests::new(&self.geometry, &ray);
        self.isa.trace::<false>(&self.shape, &ray, true, &mut tests) == Outcome::Hit
    }

    #[inline]
    fn closest(&self, ray: &Ray, trace: impl FnOnce(&mut Tests<G>) -> Outcome) -> Option<Hit> {
        let mut tests = Tests::new(&self.geometry, ray);
        let best = match trace(&mut tests) {
            Outcome::TooFar => scan_all(&self.geometry, ray, &mut ()),
            _ => tests.best,
        };
        best.prim().map(|prim| Hit { t: self.geometry.round(ray, &best), prim })
    }

    #[inline]
    fn any(&self, ray: &Ray, trace: impl FnOnce(&mut Tests<G>) -> Outcome) -> bool {
        let mut tests = Tests::new(&self.geometry, ray);
        match trace(&mut tests) {
            Outcome::TooFar => scan_any(&self.geometry, ray, &mut ()),
            Outcome::Hit => true,
            Outcome::Done => tests.best.is_hit(),
        }
    }
}

impl<G: Geometry> Accel for Nested<G> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let ray = ray.intake()?;
        self.closest(&ray, |tests| self.isa.trace::<true>(&self.shape, &ray, false, tests))
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        let Some(ray) = ray.intake() else { return false };
        self.any(&ray, |tests| self.isa.trace::<true>(&self.shape, &ray, true, tests))
    }

    // Counted in portable code: one loop less to compile.
    fn closest_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
        counts.rays += 1;
        let ray = ray.intake()?;
        self.closest(&ray, |tests| walk::trace_counted(&self.shape, &ray, false, tests, counts))
    }

    fn any_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> bool {
        counts.rays += 1;
        let Some(ray) = ray.intake() else { return false };
        self.any(&ray, |tests| walk::trace_counted(&self.shape, &ray, true, tests, counts))
    }

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn memory(&self) -> Memory {
        let mut memory = Memory::default();
        for part in &self.shape.parts {
            let [structure, references, tables] = part.bytes();
            memory.structure += structure;
            memory.references += references;
            memory.tables += tables;
        }
        memory
    }

    fn describe(&self) -> String {
        let parts: Vec<String> = self.shape.parts.iter().map(AnyPart::describe).collect();
        format!("{}; {} code{}", parts.join("; "), self.isa.name(), self.left_out)
    }
}

#[cfg(test)]
mod tests;
