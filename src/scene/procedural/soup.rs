//! Soups: unconnected triangles at random places; small ones, large ones that overlap, and slivers.

use super::stock::{daylight, lambert};
use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::Result;
use crate::random::Random;
use glam::DVec3;

pub(super) const SOUP: Entry = Entry {
    name: "soup",
    summary: "small unconnected triangles at random places in a cube of side 10",
    options: "n: number of triangles (10000); seed (1)",
    slots: "all have slot 0",
    source: "ours",
    keys: &["n", "seed"],
    body: small,
    stage,
};

pub(super) const BIG: Entry = Entry {
    name: "big-soup",
    summary: "unconnected triangles of up to a fifth of a cube of side 10 at random places: most overlap many others",
    body: big,
    ..SOUP
};

pub(super) const STICKS: Entry = Entry {
    name: "sticks",
    summary: "slivers, 3 long and 0.01 wide, at random places and in random directions in a cube of side 10",
    body: sticks,
    ..SOUP
};

/// Corners within `5 n^(-1/3)` of the middle on each axis: about the distance of neighbours apart.
fn small(options: &Options) -> Result<Body> {
    let near = 5.0 / (options.n.unwrap_or(N) as f64).cbrt();
    soup(options, |rng, middle| [0; 3].map(|_| middle + anywhere(rng, near)))
}

/// Corners within 1 of the middle on each axis.
fn big(options: &Options) -> Result<Body> {
    soup(options, |rng, middle| [0; 3].map(|_| middle + anywhere(rng, 1.0)))
}

/// Two corners at the ends, the third 0.01 from one of these in any direction.
fn sticks(options: &Options) -> Result<Body> {
    soup(options, |rng, middle| {
        let (along, aside) = (1.5 * rng.direction(), 0.01 * rng.direction());
        [middle - along, middle + along, middle + along + aside]
    })
}

const N: u64 = 10_000;

/// Triangles about middles that are uniform in -5..5 on each axis.
fn soup(options: &Options, triangle: impl Fn(&mut Random, DVec3) -> [DVec3; 3]) -> Result<Body> {
    let n = options.n(N, 1..=50_000_000)?;
    options.limit(n.into())?;
    let mut rng = Random::new(options.seed.unwrap_or(1));
    let corners = (0..n).flat_map(|_| {
        let middle = anywhere(&mut rng, 5.0);
        triangle(&mut rng, middle).map(|p| p.as_vec3())
    });
    let positions = corners.collect();
    let triangles = (0..n).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    Ok(Body { meshes: vec![Mesh { name: "soup".into(), positions, triangles, ..Mesh::default() }], ..Body::default() })
}

/// Uniform within `far` of the origin on each axis.
fn anywhere(rng: &mut Random, far: f64) -> DVec3 {
    DVec3::from([0; 3].map(|_| rng.within(-far, far)))
}

fn stage(_: &Options) -> Stage {
    daylight(vec![lambert("paper", 0.7, 0.66, 0.55)])
}
