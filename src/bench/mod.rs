//! The benchmark: a fixed list of scenes, three kinds of rays, every accelerator; speed, work, builds, memory, images.
//!
//! [`crate::measure`] makes the rays, checks the answers and takes the times, for one scene at a time.

mod catalogue;
mod contenders;
mod figures;
mod plot;
mod run;
mod study;

pub use catalogue::{BenchScene, Class, Source, View, select};
pub use contenders::usual;
pub use figures::{Figure, figures};
pub use plot::bars;
pub use run::{Options, UNSUITED, run};
pub use study::{KINDS, Mean, SceneResult, Study, geomean};

/// What others are held against unless told otherwise, the fastest of their kind first.
pub const ANCHORS: [&str; 4] = ["obvhs-native-cwbvh:preset=very_slow", "obvhs-native-cwbvh", "embree", "embree-robust"];
