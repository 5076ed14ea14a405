//! How finely a nested grid is cut and what it may take.

use crate::accel::default_budget;

/// How much building is worth.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Fewer and larger leaves: built in the least time.
    Fast,
    /// For pictures of a few samples a pixel and more.
    #[default]
    Default,
    /// The least time a ray.
    Best,
}

impl Quality {
    /// Names as in specifications, in the order of the variants.
    pub const NAMES: [(&'static str, Quality); 3] =
        [("fast", Quality::Fast), ("default", Quality::Default), ("best", Quality::Best)];
}

/// How to build a [`super::Nested`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NestedOptions {
    /// How much building is worth.
    pub quality: Quality,
    /// Bytes that it may take; one that needs more is refused.
    pub memory: u64,
}

impl Default for NestedOptions {
    /// [`Quality::Default`], a quarter of the machine's memory but at most 8 GiB.
    fn default() -> Self {
        Self { quality: Quality::Default, memory: default_budget() }
    }
}

/// The numbers behind a quality, for one kind of primitives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Settings {
    /// Cells of the grid on top for each primitive.
    pub density: f64,
    /// How many packs may be tested in the time that a node takes.
    pub node_cost: f32,
    /// How many packs may be tested for each pack more that is kept.
    pub growth: f32,
}

impl Settings {
    /// One cell that is never cut: for primitives that are tested without a grid.
    pub const LOOSE: Settings = Settings { density: 0.0, node_cost: f32::INFINITY, growth: 0.0 };

    /// For triangles and whatever is as expensive.
    pub fn triangles(quality: Quality) -> Self {
        match quality {
            Quality::Fast => Self { density: 0.12, node_cost: 96.0, growth: 0.3 },
            Quality::Default => Self { density: 0.2, node_cost: 12.0, growth: 0.1 },
            Quality::Best => Self { density: 0.3, node_cost: 8.0, growth: 0.05 },
        }
    }

    /// For spheres.
    pub fn spheres(quality: Quality) -> Self {
        Self { density: 0.2, ..Self::triangles(quality) }
    }
}
