//! Teapot of patches: the Utah teapot's 32 bicubic patches themselves.

use super::{Body, Entry, Options, Stage, teapot};
use crate::error::Result;

pub(super) const ENTRY: Entry = Entry {
    name: "teapot-patches",
    summary: "the Utah teapot as 32 bicubic Bézier patches, not tessellated; else as teapot",
    options: "",
    slots: "all have slot 0",
    source: "Newell 1975, with Blinn's bottom and height",
    keys: &[],
    body,
    stage,
};

fn body(_: &Options) -> Result<Body> {
    let round = |p: glam::DVec3| p.as_vec3();
    let patches = teapot::patches().into_iter().map(|control| (control.map(|row| row.map(round)), 0));
    Ok(Body { patches: patches.collect(), ..Body::default() })
}

fn stage(options: &Options) -> Stage {
    teapot::stage(options)
}
