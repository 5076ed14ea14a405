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

/// Which of the processor's instructions rays may use; answers are the same.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Instructions {
    /// The best ones that are there, asked for once: AVX2 with fused products, or those of [`Instructions::Portable`].
    #[default]
    Detected,
    /// Those that the program was compiled for.
    Portable,
}

impl Instructions {
    /// Names as in specifications, in the order of the variants.
    pub const NAMES: [(&'static str, Instructions); 2] =
        [("detected", Instructions::Detected), ("portable", Instructions::Portable)];
}

/// How to build a [`super::Nested`].
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NestedOptions {
    /// How much building is worth.
    pub quality: Quality,
    /// Bytes that it may take; one that needs more is refused.
    pub memory: u64,
    /// Which instructions it is built and traced with.
    pub instructions: Instructions,
}

impl Default for NestedOptions {
    /// [`Quality::Default`], a quarter of the machine's memory but at most 8 GiB.
    fn default() -> Self {
        Self { quality: Quality::Default, memory: default_budget(), instructions: Instructions::Detected }
    }
}

/// The numbers behind a quality.
///
/// They were chosen by the time of rays through nine scenes, seven of triangles and two of spheres, out of 0.005 to 0.4 cells for each
/// primitive, nodes as dear as 3 to 40 packs and 0.05 to 1 for growth. From 0.05 cells down times are within a few hundredths of one
/// another; finer grids and smaller leaves take up to a fifth longer, and more memory.
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

    /// For any kind of primitives.
    pub fn of(quality: Quality) -> Self {
        match quality {
            Quality::Fast => Self { density: 0.03, node_cost: 40.0, growth: 1.0 },
            Quality::Default => Self { density: 0.03, node_cost: 14.0, growth: 0.6 },
            Quality::Best => Self { density: 0.03, node_cost: 7.0, growth: 0.6 },
        }
    }
}
