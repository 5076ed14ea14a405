//! What survives the packs is decided by the geometry's own exact test, as in every other accelerator.

use crate::geometry::{Best, Geometry};
use crate::ray::Ray;

/// The exact tests of one ray, without the geometry's type: walks are compiled once for all geometries.
pub(super) trait Exact {
    /// Tests a primitive; what is known of the winner's parameter, if there is a winner.
    fn test(&mut self, prim: u32) -> Option<Known>;

    /// As [`Exact::test`], of a primitive that certainly is the winner.
    fn settle(&mut self, prim: u32) -> Option<Known>;

    /// Makes a primitive the winner that certainly is, with its parameter and a bound on the error.
    fn replace(&mut self, prim: u32, t: f64, err: f64) -> Option<Known>;

    /// Makes a primitive the winner that certainly is met where the winner is, and has a smaller index.
    fn rename(&mut self, prim: u32);

    /// What is known of the winner's parameter, if there is a winner.
    fn known(&self) -> Option<Known>;
}

/// The winner, whose parameter is known to lie within two others.
#[derive(Clone, Copy, Debug)]
pub(super) struct Known {
    pub prim: u32,
    pub lower: f64,
    pub upper: f64,
}

/// The exact tests of one ray of `geometry`.
pub(super) struct Tests<'a, G: Geometry> {
    geometry: &'a G,
    ray: Ray,
    /// Made when the first primitive comes: many rays meet none.
    prep: Option<G::Prep>,
    /// The winner.
    pub best: Best,
}

impl<'a, G: Geometry> Tests<'a, G> {
    /// `ray` comes from [`Ray::intake`].
    pub fn new(geometry: &'a G, ray: &Ray) -> Self {
        Self { geometry, ray: *ray, prep: None, best: Best::NONE }
    }
}

impl<G: Geometry> Exact for Tests<'_, G> {
    #[inline(never)]
    fn test(&mut self, prim: u32) -> Option<Known> {
        let prep = self.prep.get_or_insert_with(|| self.geometry.prepare(&self.ray));
        self.geometry.confirm(prim, &self.ray, prep, &mut self.best);
        self.known()
    }

    fn settle(&mut self, prim: u32) -> Option<Known> {
        match self.geometry.locate(prim, &self.ray) {
            Some((t, err)) => {
                self.best.replace(t, err, prim);
                self.known()
            }
            None => self.test(prim),
        }
    }

    fn replace(&mut self, prim: u32, t: f64, err: f64) -> Option<Known> {
        self.best.replace(t, err, prim);
        self.known()
    }

    fn rename(&mut self, prim: u32) {
        self.best.replace(self.best.t(), self.best.err(), prim);
    }

    #[inline]
    fn known(&self) -> Option<Known> {
        let (t, err) = (self.best.t(), self.best.err());
        self.best.prim().map(|prim| Known { prim, lower: t - err, upper: t + err })
    }
}
