//! Giant: a sphereflake on a sphere two thousand times as large.

use super::stock::lambert;
use super::{Body, Entry, Options, Stage, flakes};
use crate::error::Result;
use crate::geometry::Sphere;
use glam::Vec3;

pub(super) const ENTRY: Entry = Entry {
    name: "giant-sphere",
    summary: "sphereflake on a sphere of radius 1000 instead of a floor, z up",
    options: "depth: levels below the first sphere of the flake (4: 7381 spheres, and the giant)",
    slots: "the giant has slot 0, level l of the recursion has slot l + 1",
    source: "after Haines, Ray Tracing News 1(3), 1988, teapot in a stadium, in spheres; dimensions are ours",
    keys: &["depth"],
    body,
    stage,
};

/// Its top, 0.5 below the middle of the flake, is where the first sphere touches it.
const GIANT: Sphere = Sphere { centre: Vec3::new(0.0, 0.0, -1000.5), radius: 1000.0 };

fn body(options: &Options) -> Result<Body> {
    let flake = flakes::spheres(options.depth(4, 0..=7)?);
    let spheres = std::iter::once((GIANT, 0)).chain(flake.into_iter().map(|(sphere, level)| (sphere, level + 1)));
    Ok(Body { spheres: spheres.collect(), ..Body::default() })
}

fn stage(options: &Options) -> Stage {
    let mut stage = flakes::alone(options);
    stage.palette.insert(0, lambert("ground", 0.8, 0.6, 0.264));
    stage
}
