//! Accelerators of other people behind our trait, one file each.
//!
//! [`obvhs`] takes the boxes of the crate obvhs and our own exact test. All others are peers to compare with: they run as
//! their authors intend, with triangle tests of their own, and answer as well as those do.

#[cfg(feature = "bvh")]
pub mod bvh;
#[cfg(feature = "embree")]
pub mod embree;
#[cfg(feature = "obvhs")]
pub mod obvhs;
#[cfg(feature = "obvhs")]
pub mod obvhs_native;
#[cfg(feature = "parry")]
pub mod parry;
pub mod soup;
