//! The fast one: a coarse grid with skip bytes over trees of 4 x 4 x 4 cells, with packs of eight at the leaves.

mod build;
mod exact;
mod frame;
mod lanes;
mod options;
mod pack;
mod raster;
mod root;
mod shape;
mod simd;
mod source;
mod spheres;
mod split;
mod triangles;
mod walk;

pub use options::{NestedOptions, Quality};

use crate::accel::{Accel, Candidates, Counts, Hit, LeftOut, Memory, scan_all, scan_any};
use crate::error::Result;
use crate::geometry::Geometry;
use crate::ray::{Aabb, Ray};
use exact::Tests;
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
}

impl<G: Geometry> Nested<G> {
    /// Builds one over `geometry`. Primitives that no ray can hit are left out; an empty geometry is fine.
    ///
    /// # Errors
    /// It would take more than `options.memory` bytes.
    pub fn build(geometry: G, options: &NestedOptions) -> Result<Self> {
        let Candidates { prims, bounds, left_out } = Candidates::of(&geometry);
        let isa = Isa::detect();
        let shape = root::build(&geometry, &prims, options, isa)?;
        Ok(Self { geometry, shape, isa, bounds, left_out })
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
