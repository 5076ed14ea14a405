//! Sets of primitives addressed by index, and the record of the best hit so far.
//!
//! Every accelerator runs the same tests in its leaves, so their answers are equal to the bit. A test decides as if in
//! exact arithmetic: the least `t` wins, and at equal `t` the least index.

pub mod bezier;
mod decided;
mod estimate;
mod exact;
pub(crate) mod expansion;
mod face;
mod indexed;
mod meeting;
mod mixed;
mod number;
pub(crate) mod polygon;
mod root;
mod solid;
mod sphere;
pub(crate) mod stages;
#[cfg(test)]
pub(crate) mod tests;
mod triangle;
mod whole;

pub use bezier::{BezierPatches, Seed};
pub use face::Face;
pub use indexed::IndexedTriangles;
pub use mixed::Mixed;
pub use solid::SolidVoxels;
pub use sphere::{Sphere, SpherePrep};
pub use triangle::{Triangle, TrianglePrep};

use crate::ray::{Aabb, Cell, Ray};
use std::sync::Arc;

/// A set of primitives addressed by index `0..len`.
///
/// Slices and vectors of [`Triangle`] or [`Sphere`] are sets, and [`IndexedTriangles`], [`SolidVoxels`] and [`Mixed`]; so are `&G`,
/// `Box<G>` and `Arc<G>` of any set `G`: an accelerator can borrow, own or share its primitives.
///
/// A primitive of one's own takes four methods. Indices handed to them are below [`Geometry::len`]; others may panic.
///
/// ```
/// use glam::Vec3;
/// use skipgrid::geometry::Best;
/// use skipgrid::{Aabb, Geometry, Hit, Ray, registry};
///
/// /// Squares of edge 1 in planes of equal z, given by their least corners.
/// struct Tiles(Vec<Vec3>);
///
/// impl Geometry for Tiles {
///     type Prep = ();
///
///     fn len(&self) -> u32 {
///         self.0.len() as u32
///     }
///
///     fn bounds(&self, prim: u32) -> Aabb {
///         let low = self.0[prim as usize];
///         Aabb { min: low, max: low + Vec3::new(1.0, 1.0, 0.0) }
///     }
///
///     fn prepare(&self, _: &Ray) {}
///
///     fn test(&self, prim: u32, ray: &Ray, (): &(), best: &mut Best) {
///         let low = self.0[prim as usize].as_dvec3();
///         // Infinite or a NaN if the ray does not move along z: no hit.
///         let t = (low.z - f64::from(ray.origin.z)) / f64::from(ray.direction.z);
///         let at = ray.at(t) - low;
///         if (0.0..=1.0).contains(&at.x) && (0.0..=1.0).contains(&at.y) {
///             best.offer(ray, t, prim);
///         }
///     }
/// }
///
/// let tiles = Tiles((0..9).map(|i| Vec3::Z * i as f32).collect());
/// let down = Ray::new(Vec3::new(0.5, 0.5, 4.5), Vec3::NEG_Z);
/// for name in ["nested", "grid-octant", "bsp"] {
///     assert_eq!(registry::build(name, &tiles)?.closest_hit(&down), Some(Hit { t: 0.5, prim: 4 }));
/// }
/// # Ok::<(), skipgrid::Error>(())
/// ```
pub trait Geometry: Send + Sync {
    /// What the tests of one ray share, such as the watertight test's shear. `()` if nothing.
    type Prep;

    /// Number of primitives, at most 2^32 - 2: the greatest index stands for none.
    fn len(&self) -> u32;

    /// True if there is no primitive.
    fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// The least box around `prim`, world units, or [`Aabb::EMPTY`] if no ray can hit it (a coordinate that is not finite, say).
    ///
    /// Accelerators look for hits within it alone, so it holds the points of all that [`Geometry::test`] finds; a larger box costs
    /// time and loses nothing.
    fn bounds(&self, prim: u32) -> Aabb;

    /// Computes what all tests of `ray` share, for one [`Best`]. `ray` comes from [`Ray::intake`].
    fn prepare(&self, ray: &Ray) -> Self::Prep;

    /// Makes `prim` the winner if `ray` meets it within its range at a smaller parameter than `best`, or at the same
    /// one with a smaller index. Testing a primitive twice changes nothing. `ray` comes from [`Ray::intake`], `prep` from
    /// [`Geometry::prepare`] for the same ray and `best`.
    ///
    /// The simplest implementation computes the parameter and calls [`Best::offer`].
    fn test(&self, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best);

    /// As [`Geometry::test`], for primitives that a filter of the accelerator has let pass: without a filter of its own.
    fn confirm(&self, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
        self.test(prim, ray, prep, best);
    }

    /// Where `ray` meets `prim`, which it certainly does, in its range and first there: a parameter and a bound on its error, at
    /// least 0. `None` if this is not known without a test. `ray` comes from [`Ray::intake`].
    fn locate(&self, _prim: u32, _ray: &Ray) -> Option<(f64, f64)> {
        None
    }

    /// The winner's parameter as f32, the same for every order of tests. `best` is what tests of `ray` made of [`Best::NONE`], and
    /// has a winner.
    fn round(&self, _ray: &Ray, best: &Best) -> f32 {
        best.t as f32
    }

    /// False only if `prim` certainly has no point in the closed box `cell`, world units. By default that their boxes do not meet.
    fn overlaps(&self, prim: u32, cell: &Cell) -> bool {
        cell.meets(&self.bounds(prim))
    }

    /// The corners if `prim` is a triangle, tested as those of a list are; grids insert triangles by clipping instead of
    /// [`Geometry::overlaps`].
    fn triangle(&self, _prim: u32) -> Option<Triangle> {
        None
    }

    /// Bits that tell primitives apart: two with the same bits are hit by the same rays at the same parameters, so that the
    /// later one never wins and structures leave it out. `None` where this is not known.
    fn fingerprint(&self, _prim: u32) -> Option<[u32; 9]> {
        None
    }

    /// The voxels if the primitives are the faces of solid voxels, by the same indices; there is a walk that needs no more.
    fn solid(&self) -> Option<&SolidVoxels> {
        None
    }

    /// True if tests iterate, as those of [`BezierPatches`] do, so that grids keep a [`Seed`] for each reference.
    const ITERATES: bool = false;

    /// Where tests in the closed box `cell`, world units, begin, and the part of `prim` that lies in it; `None` if nothing does.
    fn seed(&self, _prim: u32, _cell: &Cell) -> Option<Seed> {
        None
    }

    /// As [`Geometry::test`], but finds for certain only hits in the box that `seed` comes from. Others may become the
    /// winner too: they are as good as any.
    fn test_from(&self, _seed: &Seed, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
        self.test(prim, ray, prep, best);
    }

    /// The sphere if `prim` is one, tested as those of a list are.
    fn sphere(&self, _prim: u32) -> Option<Sphere> {
        None
    }
}

/// Index of "no primitive".
pub(crate) const NO_PRIM: u32 = u32::MAX;

/// The winner of one ray so far: its parameter with an error bound, and its primitive.
///
/// The true parameter lies in `t - err ..= t + err`, in units of the ray's direction; neither is ever a NaN. Sets that can compute
/// exactly keep `err` above zero and decide overlaps themselves; all others use [`Best::offer`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Best {
    t: f64,
    err: f64,
    prim: u32,
}

impl Best {
    /// No winner yet.
    pub const NONE: Best = Best { t: f64::INFINITY, err: 0.0, prim: NO_PRIM };

    /// The winning primitive, if any.
    #[inline]
    pub fn prim(&self) -> Option<u32> {
        (self.prim != NO_PRIM).then_some(self.prim)
    }

    /// True if a primitive was hit.
    #[inline]
    pub fn is_hit(&self) -> bool {
        self.prim != NO_PRIM
    }

    /// The winner's parameter, `inf` if there is none.
    #[inline]
    pub fn t(&self) -> f64 {
        self.t
    }

    /// Bound on the error of [`Best::t`], at least 0.
    #[inline]
    pub fn err(&self) -> f64 {
        self.err
    }

    /// A parameter at or beyond the winner's true one, `inf` if there is none. A walk may stop where it has passed it.
    #[inline]
    pub fn upper(&self) -> f64 {
        self.t + self.err
    }

    /// Makes `prim` the winner at `t`, known within `err`, whatever the winner was. `t` is no NaN and `err` at least 0.
    #[inline]
    pub fn replace(&mut self, t: f64, err: f64, prim: u32) {
        *self = Best { t, err, prim };
    }

    /// Makes `prim` the winner if `t`, taken as exact, lies in the ray's range and is less than the winner's, or equal
    /// to it with a smaller index. A NaN is never a hit. For sets whose parameters are all taken as exact.
    #[inline]
    pub fn offer(&mut self, ray: &Ray, t: f64, prim: u32) {
        let in_range = t >= f64::from(ray.t_min) && t <= f64::from(ray.t_max);
        if in_range && (t < self.t || (t == self.t && prim < self.prim)) {
            self.replace(t, 0.0, prim);
        }
    }
}

macro_rules! forward_geometry {
    ($([$($generics:tt)*] $type:ty),* $(,)?) => {$(
        impl<$($generics)*> Geometry for $type {
            type Prep = G::Prep;
            #[inline]
            fn len(&self) -> u32 { (**self).len() }
            #[inline]
            fn bounds(&self, prim: u32) -> Aabb { (**self).bounds(prim) }
            #[inline]
            fn prepare(&self, ray: &Ray) -> Self::Prep { (**self).prepare(ray) }
            #[inline]
            fn test(&self, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
                (**self).test(prim, ray, prep, best);
            }
            #[inline]
            fn confirm(&self, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
                (**self).confirm(prim, ray, prep, best);
            }
            #[inline]
            fn locate(&self, prim: u32, ray: &Ray) -> Option<(f64, f64)> { (**self).locate(prim, ray) }
            #[inline]
            fn round(&self, ray: &Ray, best: &Best) -> f32 { (**self).round(ray, best) }
            #[inline]
            fn overlaps(&self, prim: u32, cell: &Cell) -> bool { (**self).overlaps(prim, cell) }
            #[inline]
            fn triangle(&self, prim: u32) -> Option<Triangle> { (**self).triangle(prim) }
            const ITERATES: bool = G::ITERATES;
            fn seed(&self, prim: u32, cell: &Cell) -> Option<Seed> { (**self).seed(prim, cell) }
            #[inline]
            fn test_from(&self, seed: &Seed, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
                (**self).test_from(seed, prim, ray, prep, best);
            }
            #[inline]
            fn fingerprint(&self, prim: u32) -> Option<[u32; 9]> { (**self).fingerprint(prim) }
            #[inline]
            fn solid(&self) -> Option<&SolidVoxels> { (**self).solid() }
            #[inline]
            fn sphere(&self, prim: u32) -> Option<Sphere> { (**self).sphere(prim) }
        }
    )*};
}
forward_geometry!([G: Geometry + ?Sized] &G, [G: Geometry + ?Sized] Box<G>, [G: Geometry + ?Sized] Arc<G>);

/// `Vec<P>` is a set wherever `[P]` is.
impl<P: Send + Sync> Geometry for Vec<P>
where
    [P]: Geometry,
{
    type Prep = <[P] as Geometry>::Prep;
    #[inline]
    fn len(&self) -> u32 {
        Geometry::len(self.as_slice())
    }
    #[inline]
    fn bounds(&self, prim: u32) -> Aabb {
        self.as_slice().bounds(prim)
    }
    #[inline]
    fn prepare(&self, ray: &Ray) -> Self::Prep {
        self.as_slice().prepare(ray)
    }
    #[inline]
    fn test(&self, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
        self.as_slice().test(prim, ray, prep, best);
    }
    #[inline]
    fn confirm(&self, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
        self.as_slice().confirm(prim, ray, prep, best);
    }
    #[inline]
    fn locate(&self, prim: u32, ray: &Ray) -> Option<(f64, f64)> {
        self.as_slice().locate(prim, ray)
    }
    #[inline]
    fn round(&self, ray: &Ray, best: &Best) -> f32 {
        self.as_slice().round(ray, best)
    }
    #[inline]
    fn overlaps(&self, prim: u32, cell: &Cell) -> bool {
        self.as_slice().overlaps(prim, cell)
    }
    #[inline]
    fn triangle(&self, prim: u32) -> Option<Triangle> {
        self.as_slice().triangle(prim)
    }
    #[inline]
    fn fingerprint(&self, prim: u32) -> Option<[u32; 9]> {
        self.as_slice().fingerprint(prim)
    }
    const ITERATES: bool = <[P] as Geometry>::ITERATES;
    fn seed(&self, prim: u32, cell: &Cell) -> Option<Seed> {
        self.as_slice().seed(prim, cell)
    }
    #[inline]
    fn test_from(&self, seed: &Seed, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
        self.as_slice().test_from(seed, prim, ray, prep, best);
    }
    #[inline]
    fn sphere(&self, prim: u32) -> Option<Sphere> {
        self.as_slice().sphere(prim)
    }
}
