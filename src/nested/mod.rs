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
use crate::geometry::{Best, Geometry};
use crate::ray::{Aabb, Ray};
use exact::Tests;
use lanes::Portable;
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

    /// The winner, asked of the best instructions there are.
    #[inline]
    fn winner(&self, ray: &Ray, any: bool) -> Best {
        let mut tests = Tests::new(&self.geometry, ray);
        match self.isa.trace(&self.shape, ray, any, &mut tests) {
            Outcome::Done => tests.best,
            Outcome::TooFar => self.scan(ray, any, &mut ()),
        }
    }

    /// The same, counted; in portable code, for one loop less to compile.
    fn winner_counted(&self, ray: &Ray, any: bool, counts: &mut Counts) -> Best {
        counts.rays += 1;
        let mut tests = Tests::new(&self.geometry, ray);
        match walk::trace::<Portable, _>(&self.shape, ray, any, &mut tests, counts) {
            Outcome::Done => tests.best,
            Outcome::TooFar => self.scan(ray, any, counts),
        }
    }

    /// Every primitive, for a ray that starts too far away.
    #[cold]
    fn scan<P: crate::accel::Probe>(&self, ray: &Ray, any: bool, probe: &mut P) -> Best {
        if !any {
            return scan_all(&self.geometry, ray, probe);
        }
        let mut best = Best::NONE;
        if scan_any(&self.geometry, ray, probe) {
            best.replace(0.0, 0.0, 0);
        }
        best
    }

    fn hit(&self, ray: &Ray, best: &Best) -> Option<Hit> {
        best.prim().map(|prim| Hit { t: self.geometry.round(ray, best), prim })
    }
}

impl<G: Geometry> Accel for Nested<G> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        let ray = ray.intake()?;
        self.hit(&ray, &self.winner(&ray, false))
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        ray.intake().is_some_and(|ray| self.winner(&ray, true).is_hit())
    }

    fn closest_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
        let Some(ray) = ray.intake() else {
            counts.rays += 1;
            return None;
        };
        self.hit(&ray, &self.winner_counted(&ray, false, counts))
    }

    fn any_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> bool {
        let Some(ray) = ray.intake() else {
            counts.rays += 1;
            return false;
        };
        self.winner_counted(&ray, true, counts).is_hit()
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
