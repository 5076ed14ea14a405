//! Every primitive for every ray: the accelerator that cannot be wrong about where primitives lie.

use super::{Accel, Hit, Memory, Probe, queries_with_probe};
use crate::geometry::{Best, Geometry};
use crate::ray::{Aabb, Ray};

/// Tests every primitive for every ray.
///
/// Fastest for a handful of primitives, and the reference for the conformance tests. Holds nothing beside the geometry.
#[derive(Clone, Debug)]
pub struct BruteForce<G> {
    geometry: G,
    bounds: Aabb,
}

impl<G: Geometry> BruteForce<G> {
    /// Wraps the geometry; any geometry will do, an empty one too. Looks at the box of each primitive, for [`Accel::bounds`].
    pub fn new(geometry: G) -> Self {
        let bounds = (0..geometry.len()).fold(Aabb::EMPTY, |b, prim| b.union(&geometry.bounds(prim)));
        Self { geometry, bounds }
    }

    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let ray = ray.intake()?;
        let best = scan_all(&self.geometry, &ray, probe);
        best.prim().map(|prim| Hit { t: self.geometry.round(&ray, &best), prim })
    }

    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        let Some(ray) = ray.intake() else { return false };
        scan_any(&self.geometry, &ray, probe)
    }
}

/// The closest of all primitives; where other structures end up when a ray starts too far away for their arithmetic.
/// `ray` comes from [`Ray::intake`].
///
/// Copies of the winner, corner by corner, are not tested: they tie with it, and the least index wins. Not by
/// [`Geometry::fingerprint`], which sorts corners: that takes longer than most tests.
pub(crate) fn scan_all<G: Geometry, P: Probe>(geometry: &G, ray: &Ray, probe: &mut P) -> Best {
    let prep = geometry.prepare(ray);
    let shape = |prim| (geometry.triangle(prim), geometry.sphere(prim));
    let (mut best, mut winner) = (Best::NONE, (None, None));
    for prim in 0..geometry.len() {
        if winner != (None, None) && shape(prim) == winner {
            continue;
        }
        probe.test();
        let before = best.prim();
        geometry.test(prim, ray, &prep, &mut best);
        if best.prim() != before {
            winner = best.prim().map_or((None, None), shape);
        }
    }
    best
}

/// True if the ray meets any of all primitives.
pub(crate) fn scan_any<G: Geometry, P: Probe>(geometry: &G, ray: &Ray, probe: &mut P) -> bool {
    let prep = geometry.prepare(ray);
    let mut best = Best::NONE;
    (0..geometry.len()).any(|prim| {
        probe.test();
        geometry.test(prim, ray, &prep, &mut best);
        best.is_hit()
    })
}

impl<G: Geometry> Accel for BruteForce<G> {
    queries_with_probe!(closest, any);

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn memory(&self) -> Memory {
        Memory::default()
    }
}
