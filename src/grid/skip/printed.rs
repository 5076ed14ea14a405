//! The landing rule as printed, to show what it gets wrong.
//!
//! Semwal & Kvarnstrom 1997 §3 to §5 carry the ray D - 1 city-block units on from where it is. A ray that has gone the part
//! f_i of its voxel along axis i, F in all, crosses up to floor(F + S) faces in a length of S. In the plane F is less than
//! 2, and from a voxel's centre it is 3/2 at most: at most D faces are crossed, and the ray lands on the first filled voxel
//! at worst. In space F may be nearly 3: D + 1 faces, and the ray lands behind a filled voxel. That they leap from D = 5 on
//! only hides most of it.
//!
//! The smallest example stands in `docs/methods/proximity-clouds.md`; `the_printed_landing_loses_voxels` demands that there
//! be some.

use super::table::Table;
use super::{Distances, Look, Method, NoSkip, Skip, SkipOptions, Slot};
use crate::accel::{Accel, Counts, Hit, Memory};
use crate::error::{Error, Result};
use crate::geometry::Geometry;
use crate::grid::Grid;
use crate::grid::walk::Walk;
use crate::ray::{Aabb, Ray};
use std::sync::atomic::{AtomicU64, Ordering};

/// A method with a landing rule in print.
pub trait PrintedRule: Method {
    /// Where the paper lands.
    fn printed_until<T: Slot>(ray: &Self::Ray, walk: &Walk, slot: T) -> f64;
}

/// Answers with the printed rule, wrong answers included, and counts these by tracing each ray by the exact rule as well.
///
/// For demonstration only: its answers depend on luck, and each ray is traced twice.
#[derive(Debug)]
pub struct PrintedLanding<G, M: Method> {
    grid: Grid<G, Table<M>>,
    rays: AtomicU64,
    wrong: AtomicU64,
}

impl<G: Geometry, M: PrintedRule> PrintedLanding<G, M> {
    /// Gives a plain grid the method's distances and the paper's landing.
    ///
    /// # Errors
    /// As [`Grid::with_table`], and distances are to be linear.
    pub fn new(grid: Grid<G, NoSkip>, options: &SkipOptions) -> Result<Self> {
        if options.distances != Distances::Linear {
            return Err(Error::invalid("the printed landing takes linear distances only"));
        }
        Ok(Self { grid: grid.with_skip(options)?, rays: AtomicU64::new(0), wrong: AtomicU64::new(0) })
    }

    /// Rays traced so far, and those of them whose answer was wrong.
    pub fn wrong(&self) -> (u64, u64) {
        (self.rays.load(Ordering::Relaxed), self.wrong.load(Ordering::Relaxed))
    }

    fn note(&self, wrong: bool) {
        self.rays.fetch_add(1, Ordering::Relaxed);
        self.wrong.fetch_add(u64::from(wrong), Ordering::Relaxed);
    }
}

impl<G: Geometry, M: PrintedRule> Accel for PrintedLanding<G, M> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.closest_hit_counted(ray, &mut Counts::default())
    }

    fn any_hit(&self, ray: &Ray) -> bool {
        self.any_hit_counted(ray, &mut Counts::default())
    }

    fn closest_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
        counts.rays += 1;
        let printed = self.grid.closest_hit_through(&Printed(&self.grid.voxels), ray, counts);
        self.note(printed != self.grid.closest_hit(ray));
        printed
    }

    fn any_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> bool {
        counts.rays += 1;
        let printed = self.grid.any_hit_through(&Printed(&self.grid.voxels), ray, counts);
        self.note(printed != self.grid.any_hit(ray));
        printed
    }

    fn bounds(&self) -> Aabb {
        self.grid.bounds()
    }

    fn memory(&self) -> Memory {
        self.grid.memory()
    }

    fn describe(&self) -> String {
        let (rays, wrong) = self.wrong();
        format!("{}; LANDING AS PRINTED: {wrong} of {rays} rays wrong so far", self.grid.describe())
    }
}

/// A table looked at through the printed rule.
pub(super) struct Printed<'a, M: Method>(pub &'a Table<M>);

impl<M: PrintedRule> Skip<Walk> for Printed<'_, M> {
    type Ray = M::Ray;

    fn ray(walk: &Walk) -> M::Ray {
        M::ray(walk)
    }

    fn look(&self, walk: &Walk, ray: &M::Ray) -> Look<'_> {
        let slot = self.0.slots[walk.voxel];
        match slot.place() {
            Some(place) => Look::List(self.0.list(place)),
            None => Look::Empty(M::printed_until(ray, walk, slot)),
        }
    }
}
