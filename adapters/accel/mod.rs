//! Accelerators of other people behind our trait, one file each.

#[cfg(feature = "obvhs")]
pub mod obvhs;
