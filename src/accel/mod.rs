//! What every accelerator answers: which primitive does a ray meet first, and does it meet any.

mod brute;
mod budget;
mod candidates;
mod copies;
mod far;
mod probe;
mod shadows;

pub use brute::BruteForce;
pub(crate) use brute::{scan_all, scan_any};
pub(crate) use budget::default_budget;
#[cfg(feature = "scene")]
pub(crate) use budget::half_the_memory;
pub(crate) use candidates::{Candidates, LeftOut, Sieve};
pub(crate) use far::nearer;
pub use probe::{Counts, Probe};
pub use shadows::{PointShadows, Shadow};

use crate::ray::{Aabb, Ray};
use std::sync::Arc;

/// The first primitive along a ray.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Hit {
    /// Ray parameter, in units of the ray's direction: the exact value rounded to f32, ties to even; `inf` or `-inf` beyond f32's
    /// range. Within the ray's range; never a NaN.
    pub t: f32,
    /// Index in the geometry, below its [`len`](crate::Geometry::len).
    pub prim: u32,
}

/// Finds primitives along rays.
///
/// Contract, checked for every registered accelerator that promises [exact](crate::registry::Entry::exact) answers: `t`
/// lies in `[t_min, t_max]`; the least `t` wins, then the least `prim`; directions need not be unit; a ray that is not
/// finite or has no direction hits nothing; no panic and no endless loop for any bits; [`Accel::any_hit`] is true exactly
/// when [`Accel::closest_hit`] finds something.
///
/// Object-safe: choose at run time with `Box<dyn Accel>`, or statically with `A: Accel + ?Sized`. `&A`, `Box<A>` and
/// `Arc<A>` of any accelerator `A` are accelerators.
///
/// ```
/// use glam::Vec3;
/// use skipgrid::accel::{BruteForce, Counts};
/// use skipgrid::{Accel, Hit, Ray, Sphere};
///
/// let balls = vec![Sphere { centre: Vec3::ZERO, radius: 1.0 }, Sphere { centre: Vec3::X * 4.0, radius: 1.0 }];
/// let accel = BruteForce::new(&balls);
/// let ray = Ray::new(Vec3::X * 9.0, Vec3::new(-2.0, 0.0, 0.0)); // t counts in twos
/// assert_eq!(accel.closest_hit(&ray), Some(Hit { t: 2.0, prim: 1 }));
/// assert!(!accel.any_hit(&ray.with_range(0.0, 1.5)));
///
/// let mut counts = Counts::default();
/// accel.closest_hit_counted(&ray, &mut counts);
/// assert_eq!((counts.rays, counts.tests), (1, 2));
/// assert_eq!(accel.bounds().max, Vec3::new(5.0, 1.0, 1.0));
/// ```
pub trait Accel: Send + Sync {
    /// The first primitive that the ray meets within its range, both ends included; `None` if it meets none.
    fn closest_hit(&self, ray: &Ray) -> Option<Hit>;

    /// True if the ray meets any primitive within its range, both ends included. Mostly faster than the closest hit.
    fn any_hit(&self, ray: &Ray) -> bool;

    /// As [`Accel::closest_hit`], and adds the work done to `counts`. Accelerators that cannot count steps add only rays and tests.
    fn closest_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit>;

    /// As [`Accel::any_hit`], and adds the work done to `counts`.
    fn any_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> bool;

    /// The least box around all primitives that can be hit, world units; [`Aabb::EMPTY`] if there is none.
    fn bounds(&self) -> Aabb;

    /// Bytes held beside the geometry itself.
    fn memory(&self) -> Memory;

    /// What was built, in a line for people: resolution, share of empty cells, what was left out. May be empty.
    fn describe(&self) -> String {
        String::new()
    }
}

/// The four queries of [`Accel`], from two methods of the type that take a [`Probe`].
macro_rules! queries_with_probe {
    ($closest:ident, $any:ident) => {
        fn closest_hit(&self, ray: &$crate::ray::Ray) -> Option<$crate::accel::Hit> {
            self.$closest(ray, &mut ())
        }

        fn any_hit(&self, ray: &$crate::ray::Ray) -> bool {
            self.$any(ray, &mut ())
        }

        fn closest_hit_counted(
            &self,
            ray: &$crate::ray::Ray,
            counts: &mut $crate::accel::Counts,
        ) -> Option<$crate::accel::Hit> {
            counts.rays += 1;
            self.$closest(ray, counts)
        }

        fn any_hit_counted(&self, ray: &$crate::ray::Ray, counts: &mut $crate::accel::Counts) -> bool {
            counts.rays += 1;
            self.$any(ray, counts)
        }
    };
}
pub(crate) use queries_with_probe;

/// Bytes that an accelerator holds beside the geometry, by purpose; what a rebuild keeps for the next one is not counted.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Cells or nodes.
    pub structure: u64,
    /// Primitive indices in leaves or cells.
    pub references: u64,
    /// Skip tables.
    pub tables: u64,
}

impl Memory {
    /// All bytes.
    pub fn total(&self) -> u64 {
        self.structure + self.references + self.tables
    }
}

macro_rules! forward_accel {
    ($($type:ty),*) => {$(
        impl<A: Accel + ?Sized> Accel for $type {
            fn closest_hit(&self, ray: &Ray) -> Option<Hit> { (**self).closest_hit(ray) }
            fn any_hit(&self, ray: &Ray) -> bool { (**self).any_hit(ray) }
            fn closest_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
                (**self).closest_hit_counted(ray, counts)
            }
            fn any_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> bool {
                (**self).any_hit_counted(ray, counts)
            }
            fn bounds(&self) -> Aabb { (**self).bounds() }
            fn memory(&self) -> Memory { (**self).memory() }
            fn describe(&self) -> String { (**self).describe() }
        }
    )*};
}
forward_accel!(&A, Box<A>, Arc<A>);
