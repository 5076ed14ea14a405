//! Icospheres: balls of triangles of random size at random places.

use super::patch::append;
use super::stock::{daylight, lambert};
use super::{Body, Entry, Mesh, Options, Stage, icosphere, random};
use crate::error::Result;

pub(super) const ENTRY: Entry = Entry {
    name: "icospheres",
    summary: "balls of triangles of random size at random places in a cube of side 10, smooth normals",
    options: "n: number of balls (100); balls: halvings of the icosahedron's edges (2: 320 triangles a ball); seed (1)",
    slots: "ball i has slot i modulo 3",
    source: "the spheres of `random`, each in triangles; ours",
    keys: &["n", "balls", "seed"],
    body,
    stage,
};

fn body(options: &Options) -> Result<Body> {
    let n = options.n(100, 1..=1_000_000)?;
    let level = options.balls()?.unwrap_or(2);
    options.limit(u64::from(n) * icosphere::triangles(level))?;
    let ball = icosphere::unit(level);
    let mut meshes = [0, 1, 2].map(|slot| Mesh { name: format!("balls {slot}"), material: slot, ..Mesh::default() });
    for (i, sphere) in random::spheres(n, options.seed.unwrap_or(1), random::LARGEST).enumerate() {
        append(&mut meshes[i % 3], icosphere::placed(&ball, &sphere));
    }
    Ok(Body { meshes: meshes.into(), ..Body::default() })
}

fn stage(_: &Options) -> Stage {
    daylight(vec![lambert("red", 0.7, 0.2, 0.15), lambert("green", 0.25, 0.6, 0.3), lambert("blue", 0.2, 0.3, 0.7)])
}
