//! Overlap: spheres so large that most are inside others.

use super::{Body, Entry, Options, random};
use crate::error::Result;

pub(super) const ENTRY: Entry = Entry {
    name: "overlap",
    summary: "spheres of random size at random places in a cube of side 10, four times as large as those of `random`",
    options: random::ENTRY.options,
    slots: random::ENTRY.slots,
    source: "after Semwal & Kvarnstrom 1997, scene Random; ours",
    keys: &["n", "seed"],
    body,
    stage: random::stage,
};

/// Their volumes are 2.4 times that of the cube together, whatever their number is.
fn body(options: &Options) -> Result<Body> {
    random::cloud(options, 4.0 * random::LARGEST)
}
