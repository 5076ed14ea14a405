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

/// What is made of the cells of the grid on top that hold more than a pack.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Below {
    /// Trees of boxes, eight to a group; the grid on top is as fine as suits them.
    #[default]
    Boxes,
    /// Nodes of 4 x 4 x 4 cells, where these are worth their time and memory, and boxes in their cells. Rays take longer on
    /// surfaces: see docs/bench.md.
    Nodes,
}

impl Below {
    /// Names as in specifications, in the order of the variants.
    pub const NAMES: [(&'static str, Below); 2] = [("boxes", Below::Boxes), ("nodes", Below::Nodes)];
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
    /// What is below the grid on top.
    pub below: Below,
    /// Cells of the grid on top for each primitive; 0, and whatever is below it or a NaN, for one in all, and no more than
    /// 512 along an axis. `None`: by how the primitives fill the box.
    pub density: Option<f64>,
}

impl Default for NestedOptions {
    /// [`Quality::Default`], a quarter of the machine's memory but at most 8 GiB.
    fn default() -> Self {
        Self {
            quality: Quality::Default,
            memory: default_budget(),
            instructions: Instructions::Detected,
            below: Below::Boxes,
            density: None,
        }
    }
}

/// The numbers behind the options.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Settings {
    /// Cells of the grid on top for each primitive, if it is not left to how these [fill](super::fill) the box.
    pub density: Option<f64>,
    /// Whether cells are cut.
    pub nodes: Option<Nodes>,
    /// Lists of boxes of at most so many are split in halves, longer ones where it is best.
    pub halved: usize,
}

/// When a cell is cut into a node.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Nodes {
    /// How many packs may be tested in the time that a node takes.
    pub cost: f32,
    /// How many packs may be tested for each pack more that is kept.
    pub growth: f32,
}

impl Settings {
    /// One cell that is never cut: for primitives that are tested without a grid.
    pub const LOOSE: Settings = Settings { density: Some(0.0), nodes: None, halved: 16 };

    /// For any kind of primitives.
    ///
    /// The numbers of nodes were chosen by the time of rays through nine scenes, out of 0.005 to 0.4 cells for each
    /// primitive, nodes as dear as 3 to 40 packs and 0.05 to 1 for growth.
    pub fn of(options: &NestedOptions) -> Self {
        let (halved, nodes) = match options.quality {
            Quality::Fast => (usize::MAX, Nodes { cost: 40.0, growth: 1.0 }),
            Quality::Default => (16, Nodes { cost: 14.0, growth: 0.6 }),
            Quality::Best => (8, Nodes { cost: 7.0, growth: 0.6 }),
        };
        match options.below {
            Below::Boxes => Self { density: options.density, nodes: None, halved },
            Below::Nodes => Self { density: Some(options.density.unwrap_or(0.03)), nodes: Some(nodes), halved },
        }
    }
}
