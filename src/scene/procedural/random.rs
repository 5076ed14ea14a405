//! Random: spheres of random size at random places.

use super::{Body, Entry, Options, Stage, daylight, lambert, mirror};
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

/// Centres uniform in -5..5 on each axis; radii uniform in 0.25..1 times `3 n^(-1/3)`, so that about 4 % of the cube is
/// filled whatever n is (spheres may overlap and stick out of the cube).
fn body(options: &Options) -> Result<Body> {
    let n = options.n(1000, 1..=50_000_000)?;
    options.limit(n.into())?;
    let mut rng = Random::new(options.seed.unwrap_or(1));
    let largest = 3.0 / f64::from(n).cbrt();
    let spheres = (0..n).map(|i| {
        let [x, y, z] = [0; 3].map(|_| rng.within(-5.0, 5.0));
        let radius = largest * rng.within(0.25, 1.0);
        (Sphere { centre: DVec3::new(x, y, z).as_vec3(), radius: radius as f32 }, i)
    });
    Ok(Body { spheres: spheres.collect(), ..Body::default() })
}

fn stage(_: &Options) -> Stage {
    daylight(vec![
        lambert("red", 0.7, 0.2, 0.15),
        lambert("green", 0.25, 0.6, 0.3),
        lambert("blue", 0.2, 0.3, 0.7),
        mirror("mirror", 0.8),
    ])
}
