//! City: blocks of random height on a plain.

use super::patch::append;
use super::stock::{box_mesh, floor, lambert, look, sun};
use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::Result;
use crate::random::Random;
use crate::scene::RenderDefaults;
use glam::{DVec3, Vec3};

pub(super) const ENTRY: Entry = Entry {
    name: "city",
    summary: "n x n blocks of twelve triangles, most low, some high, on a plain of two; y up",
    options: "n: blocks along an edge (24); seed (1)",
    slots: "0 plain, 1 blocks",
    source: "ours",
    keys: &["n", "seed"],
    body,
    stage,
};

/// Blocks at spacing 1, 0.4 to 0.8 wide, heights of `0.2 (1 - u)^(-1/2)` for uniform u, at most 8. They reach 0.1 below
/// the plain, so that no surfaces coincide.
fn body(options: &Options) -> Result<Body> {
    let n = options.n(24, 1..=600)?;
    options.limit(12 * u64::from(n).pow(2) + 2)?;
    let mut rng = Random::new(options.seed.unwrap_or(1));
    let middle = f64::from(n - 1) / 2.0;
    let mut blocks = Mesh { name: "blocks".into(), material: 1, ..Mesh::default() };
    for row in 0..n {
        for column in 0..n {
            let (x, z) = (f64::from(column) - middle, f64::from(row) - middle);
            let [wide, deep] = [0; 2].map(|_| rng.within(0.2, 0.4));
            let height = (0.2 / (1.0 - rng.unit()).sqrt()).min(8.0);
            let side = |far: bool| if far { 1.0 } else { -1.0 };
            let corner = |right, up, near| {
                DVec3::new(x + wide * side(right), if up { height } else { -0.1 }, z + deep * side(near))
            };
            append(&mut blocks, box_mesh("", corner));
        }
    }
    Ok(Body { meshes: vec![floor(0.0, n as f32 / 2.0), blocks], ..Body::default() })
}

fn stage(options: &Options) -> Stage {
    let size = options.n.unwrap_or(24) as f64;
    Stage {
        palette: vec![lambert("plain", 0.35, 0.4, 0.3), lambert("blocks", 0.6, 0.58, 0.55)],
        props: Vec::new(),
        lights: vec![sun(-0.5, -0.7, -0.3, 2.2)],
        environment: Vec3::new(0.3, 0.35, 0.45),
        camera: look([0.55 * size, 0.25 * size + 3.0, 0.65 * size], [0.0; 3], DVec3::Y, 40.0),
        defaults: RenderDefaults::default(),
    }
}
