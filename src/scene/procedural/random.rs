//! Random: spheres of random size at random places.

use super::stock::{daylight, lambert, mirror};
use super::{Body, Entry, Options, Stage};
use crate::error::Result;
use crate::geometry::Sphere;
use crate::random::Random;
use glam::DVec3;

pub(super) const ENTRY: Entry = Entry {
    name: "random",
    summary: "spheres of random size at random places in a cube of side 10",
    options: "n: number of spheres (1000); seed (1)",
    slots: "sphere i has slot i",
    source: "Semwal & Kvarnstrom 1997, scene Random (their numbers are not printed)",
    keys: &["n", "seed"],
    body,
    stage,
};

/// Largest radius times the cube root of the number of spheres.
pub(super) const LARGEST: f64 = 3.0;

/// Radii of up to `3 n^(-1/3)`, so that about 4 % of the cube is filled whatever n is.
fn body(options: &Options) -> Result<Body> {
    cloud(options, LARGEST)
}

/// As [`spheres`], by the entry's options.
pub(super) fn cloud(options: &Options, largest: f64) -> Result<Body> {
    let n = options.n(1000, 1..=50_000_000)?;
    options.limit(n.into())?;
    let spheres = spheres(n, options.seed.unwrap_or(1), largest);
    Ok(Body { spheres: spheres.zip(0..).collect(), ..Body::default() })
}

/// Centres uniform in -5..5 on each axis; radii uniform in 0.25..1 times `largest n^(-1/3)` (spheres may overlap and stick
/// out of the cube).
pub(super) fn spheres(n: u32, seed: u64, largest: f64) -> impl Iterator<Item = Sphere> {
    let mut rng = Random::new(seed);
    let largest = largest / f64::from(n).cbrt();
    (0..n).map(move |_| {
        let [x, y, z] = [0; 3].map(|_| rng.within(-5.0, 5.0));
        let radius = largest * rng.within(0.25, 1.0);
        Sphere { centre: DVec3::new(x, y, z).as_vec3(), radius: radius as f32 }
    })
}

pub(super) fn stage(_: &Options) -> Stage {
    daylight(vec![
        lambert("red", 0.7, 0.2, 0.15),
        lambert("green", 0.25, 0.6, 0.3),
        lambert("blue", 0.2, 0.3, 0.7),
        mirror("mirror", 0.8),
    ])
}
