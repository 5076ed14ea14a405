//! What a validation was run with.

use serde::Serialize;

/// What the report says about the run itself. It has no date: like all files that are written, the page carries no clock but
/// the times that were measured.
#[derive(Clone, Debug, Default, PartialEq, Eq, Serialize)]
pub struct Environment {
    /// Program and version.
    pub program: String,
    /// Processor, threads and build.
    pub machine: String,
    /// How the program was called.
    pub command: String,
    /// Worker threads; `None`: as many as there are cores.
    pub threads: Option<usize>,
    /// Independent renders of ours against a picture with noise.
    pub replicates: u32,
    /// Samples for each pixel in each of them.
    pub spp: u32,
}
