//! Accelerators of other people behind our trait, one file each.
