//! Bicubic Bézier patches: Newton's method where it is certain to find the one root there is, subdivision elsewhere.
//!
//! J. Amanatides and A. Woo, "A Fast Voxel Traversal Algorithm for Ray Tracing", 1987, last section: where the
//! intersection of a primitive is computed by iteration, each voxel can keep a starting point for it. Departs from it:
//! beside the starting point a voxel keeps the part of the patch that lies in it, so that the root can be shown to be the
//! only one, and the answer is the same whatever the seed: the least root, by subdivision where Newton's method fails.

mod cover;
mod double;
mod net;
mod pencil;
mod search;

pub use pencil::Pencil;

use super::whole::power_of_two;
use super::{Best, Geometry};
use crate::ray::{Aabb, Cell, Ray};
use glam::{DVec3, Vec3};
use net::{Net, Rect};
use search::{Hint, Search};
use std::sync::Arc;
use std::sync::atomic::{AtomicU64, Ordering};

/// A patch is cut into `SIDE * SIDE` squares with a box each.
const SIDE: usize = 4;

/// Side of the squares of parameters that seeds are stored in.
const UNIT: f64 = 65_535.0;

/// The control points of a patch, world units: `points[j][i]` belongs to `B_i(u) B_j(v)`. Its front is where u runs right
/// and v up.
pub type ControlPoints = [[Vec3; 4]; 4];

/// One patch, closed and two-sided.
#[derive(Clone, Copy, Debug)]
struct BezierPatch {
    points: ControlPoints,
    /// Greatest absolute coordinate.
    reach: f64,
    /// Depths this near to each other count as equal: 2^-70 of `reach`, a power of two.
    quantum: f64,
    /// Boxes of the squares that it is cut into; empty if it is not finite.
    boxes: [Aabb; SIDE * SIDE],
}

impl BezierPatch {
    fn new(points: ControlPoints) -> Self {
        let all = Aabb::of_points(points.as_flattened());
        let reach = f64::from(points.as_flattened().iter().fold(0.0_f32, |most, p| most.max(p.abs().max_element())));
        let exponent = f64::from_bits(reach.max(1e-60).to_bits() & f64::INFINITY.to_bits());
        let mut patch = Self { points, reach, quantum: exponent * power_of_two(-70), boxes: [all; SIDE * SIDE] };
        if !all.is_empty() {
            patch.boxes = cover::boxes(&patch);
        }
        patch
    }

    fn is_usable(&self) -> bool {
        !self.boxes[0].is_empty()
    }
}

/// How roots are found.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Method {
    /// Newton's method where it is certain, subdivision elsewhere.
    #[default]
    Newton,
    /// Subdivision down to 2^-30 of the patch, with one polishing at the end: what Newton's method is to be compared with.
    Subdivision,
}

/// Work of patch tests; independent of the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Tally {
    /// Patch tests.
    pub tests: u64,
    /// Runs of Newton's method.
    pub runs: u64,
    /// Iterations of all runs.
    pub iterations: u64,
    /// Runs that did not converge, or to a point outside the part where they were to find a root.
    pub failures: u64,
    /// Parts of patches that were halved.
    pub subdivisions: u64,
}

/// Adds up the work of patch tests on all threads.
#[derive(Debug, Default)]
pub struct Watch {
    sums: [AtomicU64; 5],
}

impl Watch {
    /// The work so far.
    pub fn tally(&self) -> Tally {
        let [tests, runs, iterations, failures, subdivisions] =
            self.sums.each_ref().map(|sum| sum.load(Ordering::Relaxed));
        Tally { tests, runs, iterations, failures, subdivisions }
    }

    fn add(&self, tally: &Tally) {
        let Tally { tests, runs, iterations, failures, subdivisions } = *tally;
        for (sum, n) in self.sums.iter().zip([tests, runs, iterations, failures, subdivisions]) {
            sum.fetch_add(n, Ordering::Relaxed);
        }
    }
}

/// Where a voxel begins to look for a root of a patch, and the part of the patch that lies in the voxel.
///
/// Parameters are multiples of 1/65535; the part reaches at least that far beyond what is in the voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Seed {
    start: [u16; 2],
    low: [u16; 2],
    high: [u16; 2],
}

impl Seed {
    fn new(start: (f64, f64), rect: &Rect) -> Self {
        // `as` saturates.
        let down = |x: f64| ((x * UNIT).floor() - 1.0) as u16;
        let up = |x: f64| ((x * UNIT).ceil() + 1.0) as u16;
        Self {
            start: [(start.0 * UNIT).round() as u16, (start.1 * UNIT).round() as u16],
            low: [down(rect.u.0), down(rect.v.0)],
            high: [up(rect.u.1), up(rect.v.1)],
        }
    }

    /// The starting point (u, v), each in 0..=1.
    pub fn start(&self) -> (f64, f64) {
        let [u, v] = self.start.map(|x| f64::from(x) / UNIT);
        (u, v)
    }

    fn hint(&self) -> Hint {
        let [low, high] = [self.low, self.high].map(|p| p.map(|x| f64::from(x) / UNIT));
        Hint { start: self.start(), rect: Rect { u: (low[0], high[0]), v: (low[1], high[1]) } }
    }
}

/// The middle of the patch: where there is no seed.
const MIDDLE: Hint = Hint { start: (0.5, 0.5), rect: Rect::ALL };

/// A set of bicubic Bézier patches.
///
/// A ray hits a patch at the least of its parameters within the ray's range. The parameter is computed with about 2^-90
/// of the patch's size and then taken as exact, so that it is the exact one rounded to f32 unless that lies within 2^-50
/// of the middle between two f32. Parameters nearer to each other than 2^-53, or 2^-70 of the size of the coordinates,
/// count as equal. The border belongs to the patch, and so does what is within 2^-60 of it in u and v, so that a ray
/// cannot pass between patches that share the control points of a border. A ray that touches a patch within 2^-48 of its
/// size hits it; the point is then known to 2^-30 of its size only.
///
/// A patch with a coordinate that is not finite is never hit.
#[derive(Clone, Debug, Default)]
pub struct BezierPatches {
    patches: Vec<BezierPatch>,
    method: Method,
    watch: Option<Arc<Watch>>,
}

impl BezierPatches {
    /// The set of these patches. At most 2^32 - 2 can be told apart; those beyond are never hit.
    pub fn new(patches: impl IntoIterator<Item = ControlPoints>) -> Self {
        Self { patches: patches.into_iter().map(BezierPatch::new).collect(), ..Self::default() }
    }

    /// The same patches with another way to find roots.
    pub fn with_method(self, method: Method) -> Self {
        Self { method, ..self }
    }

    /// The same patches, whose tests are counted by `watch`.
    pub fn watched(self, watch: Arc<Watch>) -> Self {
        Self { watch: Some(watch), ..self }
    }

    /// The control points of a patch, world units. As all methods that take the index of a patch, panics if there is none.
    pub fn points(&self, prim: u32) -> &ControlPoints {
        &self.patches[prim as usize].points
    }

    /// Bytes of the set.
    pub fn bytes(&self) -> u64 {
        size_of_val(self.patches.as_slice()) as u64
    }

    /// The parameters (u, v), each in 0..=1, at which `ray` meets `prim` at `t`, within a unit in the last place of it;
    /// `None` if it does not, or `t` is a NaN.
    pub fn locate(&self, prim: u32, ray: &Ray, t: f32) -> Option<(f64, f64)> {
        let ray = ray.with_range(t.next_down(), t.next_up()).intake()?;
        let mut best = Best::NONE;
        self.search(prim, &ray, &Pencil::new(&ray), MIDDLE, &mut best)
    }

    /// The point at (u, v) of `prim` and the derivatives along u and v there, world units. Both parameters run from 0 to 1 over the
    /// patch; beyond it the polynomials go on.
    pub fn evaluate(&self, prim: u32, u: f64, v: f64) -> [DVec3; 3] {
        let points = self.points(prim);
        let [x, y, z] =
            [0, 1, 2].map(|axis| Net(points.map(|row| row.map(|p| f64::from(p[axis])))).value_and_slopes(u, v));
        [DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1), DVec3::new(x.2, y.2, z.2)]
    }

    /// The direction in which the front of `prim` looks at (u, v), not of unit length; where an edge has no length, that of
    /// a point nearby. Zero if there is none.
    pub fn normal(&self, prim: u32, u: f64, v: f64) -> DVec3 {
        let normal = |u: f64, v: f64| {
            let [_, along_u, along_v] = self.evaluate(prim, u, v);
            (along_u.cross(along_v), along_u.length() * along_v.length())
        };
        let (here, size) = normal(u, v);
        let reach = self.patches[prim as usize].reach;
        if here.length() > 1e-6 * size && size > 1e-9 * reach * reach {
            return here;
        }
        let inwards = |x: f64| x + 1e-4 * if x < 0.5 { 1.0 } else { -1.0 };
        let (nearby, _) = normal(inwards(u), inwards(v));
        if nearby == DVec3::ZERO { here } else { nearby }
    }

    /// Newton's method alone, without certainty, from `start`, a pair (u, v), to a root of `prim` on the line of `ray`: the
    /// root, on the patch or not, `None` if it does not converge or the ray hits nothing by definition; and the number of
    /// iterations. The classical test that seeds are judged by.
    pub fn newton(&self, prim: u32, ray: &Ray, start: (f64, f64)) -> (Option<(f64, f64)>, u32) {
        let Some(ray) = ray.intake() else { return (None, 0) };
        let run = search::newton(&Pencil::new(&ray).nets(&self.patches[prim as usize]), start);
        (run.root, run.iterations)
    }

    fn search(&self, prim: u32, ray: &Ray, pencil: &Pencil, hint: Hint, best: &mut Best) -> Option<(f64, f64)> {
        let patch = &self.patches[prim as usize];
        if !patch.is_usable() {
            return None;
        }
        let tally = Tally::default();
        let mut search = Search { patch, ray, pencil, prim, method: self.method, best, tally, at: None };
        search.run(hint);
        if let Some(watch) = &self.watch {
            watch.add(&search.tally);
        }
        search.at
    }
}

impl Geometry for BezierPatches {
    type Prep = Pencil;

    const ITERATES: bool = true;

    fn len(&self) -> u32 {
        u32::try_from(self.patches.len()).unwrap_or(u32::MAX - 1).min(u32::MAX - 1)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        let patch = &self.patches[prim as usize];
        patch.boxes.iter().fold(Aabb::EMPTY, |all, one| all.union(one))
    }

    fn prepare(&self, ray: &Ray) -> Pencil {
        Pencil::new(ray)
    }

    fn test(&self, prim: u32, ray: &Ray, pencil: &Pencil, best: &mut Best) {
        self.search(prim, ray, pencil, MIDDLE, best);
    }

    fn round(&self, _ray: &Ray, best: &Best) -> f32 {
        best.t() as f32 + 0.0 // -0 becomes 0
    }

    fn overlaps(&self, prim: u32, cell: &Cell) -> bool {
        let patch = &self.patches[prim as usize];
        let mut found = false;
        if patch.is_usable() {
            cover::cover(patch, &patch.boxes, cell, |_| {
                found = true;
                false
            });
        }
        found
    }

    fn seed(&self, prim: u32, cell: &Cell) -> Option<Seed> {
        let patch = &self.patches[prim as usize];
        if !patch.is_usable() {
            return None;
        }
        let mut all: Option<Rect> = None;
        cover::cover(patch, &patch.boxes, cell, |rect| {
            all = Some(all.map_or(*rect, |all| all.union(rect)));
            true
        });
        all.map(|rect| Seed::new(rect.centre(), &rect))
    }

    fn test_from(&self, seed: &Seed, prim: u32, ray: &Ray, pencil: &Pencil, best: &mut Best) {
        self.search(prim, ray, pencil, seed.hint(), best);
    }
}

#[cfg(test)]
mod tests;
