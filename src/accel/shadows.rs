//! What is known of a shadow ray before it is traced.

use super::Memory;
use crate::ray::Ray;

/// What is known of a ray towards a light.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Shadow {
    /// Nothing lies along it.
    Lit,
    /// Something does.
    Dark,
    /// Nothing lies along it beyond this parameter, which is its end at most: it is enough to trace the ray as far as that, itself
    /// included.
    Until(f32),
    /// Nothing.
    Unknown,
}

/// Points from which certain lights are surely seen, and points from which they are surely not.
///
/// A tracer asks before it traces a ray towards a light. What is known of a ray is so to the bit: a picture is the same with
/// and without.
pub trait PointShadows: Send + Sync {
    /// What is known of `ray`, which starts on primitive `prim` and ends just before light number `light`, one of those that this
    /// was built for. Any other ray is fine too, one that is not finite included, but nothing is known of it.
    ///
    /// # Panics
    /// There may be no light of that number.
    fn ask(&self, light: usize, prim: u32, ray: &Ray) -> Shadow;

    /// Share of the pairs of a voxel that is not empty and a light that are surely lit or surely dark, 0 to 1; 0 if there is no
    /// pair.
    fn decided(&self) -> f64;

    /// Bytes held beside the geometry itself.
    fn memory(&self) -> Memory;

    /// What was built, in a line for people.
    fn describe(&self) -> String;
}
