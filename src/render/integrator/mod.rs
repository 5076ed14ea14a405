//! What a ray brings back: one file for each way to answer.

pub(super) mod features;
pub(super) mod path;
pub(super) mod whitted;
