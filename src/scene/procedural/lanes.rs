//! Lanes: small spheres that form a cube of lanes.

use super::stock::{daylight, lambert};
use super::{Body, Entry, Options, Stage};
use crate::error::Result;
use crate::geometry::Sphere;
use glam::Vec3;

pub(super) const ENTRY: Entry = Entry {
    name: "lanes",
    summary: "n x n x n small spheres, a lattice with straight empty lanes along all axes",
    options: "n: spheres along an edge (10)",
    slots: "the sphere in column i, row j, layer k has slot i + j + k",
    source: "Semwal & Kvarnstrom 1997, scene Lanes (their numbers are not printed)",
    keys: &["n"],
    body,
    stage,
};

/// Spheres of radius 0.2 at spacing 1, centred on the origin: lanes of width 0.6 are empty from end to end.
fn body(options: &Options) -> Result<Body> {
    let n = options.n(10, 1..=368)?;
    options.limit(u64::from(n).pow(3))?;
    let place = |i: u32| i as f32 - (n - 1) as f32 / 2.0;
    let mut spheres = Vec::new();
    for k in 0..n {
        for j in 0..n {
            spheres.extend((0..n).map(|i| {
                let centre = Vec3::new(place(i), place(j), place(k));
                (Sphere { centre, radius: 0.2 }, i + j + k)
            }));
        }
    }
    Ok(Body { spheres, ..Body::default() })
}

fn stage(_: &Options) -> Stage {
    daylight(vec![lambert("ochre", 0.7, 0.5, 0.2), lambert("teal", 0.2, 0.55, 0.55), lambert("white", 0.7, 0.7, 0.7)])
}
