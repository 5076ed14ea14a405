//! The fast one: a coarse grid with skip bytes over trees of 4 x 4 x 4 cells, with packs of eight at the leaves.
//!
//! ```text
//! Nested
//!  +- part: the large ones      a few primitives as long as the box: packs that every ray tests first        split.rs
//!  +- part: a dense object      its own frame, -1 to 1 along its longest axis                                 frame.rs
//!  |    +- grid on top          coarse; a skip byte for each cell and octant of directions                    build.rs
//!  |         +- empty           the byte is the edge of an empty cube: the ray leaps to its end
//!  |         +- leaf            packs of eight primitives, tested at once                       triangles.rs, spheres.rs
//!  |         |    +- boxes      around eight packs each: which of them does the ray meet?                     boxes.rs
//!  |         +- node            64 cells, a mask of those that are filled                                     shape.rs
//!  |              +- a leaf or a node, for each filled cell
//!  +- part: the rest            another grid
//! ```
//!
//! **A ray** (`walk.rs`) is moved to where it enters the part, in f64, and continues in f32. On top (`step.rs`) it steps and leaps as in
//! [`crate::grid`]. In a node the crossings of all planes are found at once, and from them the mask of the cells that the ray
//! crosses; what that has in common with the filled cells is visited from the lowest bit on, which, with the node seen along
//! the ray's octant, is front to back. At a leaf, eight boxes at a time say which packs are met. A pack rejects what is certainly missed; a
//! hit that is certain and before all others is kept with its bounds; what is left open is judged in f64 from the pack, as is the
//! parameter of the winner at the end, and what that leaves open goes to the geometry's own test. So the answers are those of every
//! other accelerator, to the bit. Counted as steps are cells, nodes and groups of eight boxes.
//!
//! **Why nothing is lost.** Cells tile the ray: each `s` from its begin to its end lies, by comparisons of the computed crossings
//! alone, in the interval of some cell that is visited, or of an empty cube; crossings of one plane are computed
//! alike for the cells on both its sides, and the outermost cells of a node have no outer planes. The ray at that `s` is within
//! rounding of that cell (`frame`: 4 e for the ray, 14 e for a crossing of the grid's, 6 e for one of a node's), and
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
mod frame;
mod lanes;
mod limit;
mod options;
mod pack;
mod place;
mod raster;
mod root;
mod shape;
mod simd;
mod source;
mod spheres;
mod split;
mod step;
mod triangles;
mod walk;

pub use options::{Instructions, NestedOptions, Quality};

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

    /// Builds the grid anew, with the options that it was built with: as a fresh one, to the bit, in the memory of this one.
    /// From the second time on, nothing large is allocated for as many primitives in about as many cells. For that the grid keeps what it needs
    /// while it builds, some 60 bytes for each primitive, which [`Accel::memory`] does not count, as rays do not use
    /// it; [`Clone`] does.
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
        self.closest(&ray, |tests| self.isa.trace(&self.shape, &ray, false, tests))
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        let Some(ray) = ray.intake() else { return false };
        self.any(&ray, |tests| self.isa.trace(&self.shape, &ray, true, tests))
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
