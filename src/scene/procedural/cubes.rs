//! Cubes: lanes made of triangles.

use super::stock::{box_mesh, daylight, lambert};
use super::{Body, Entry, Options, Stage};
use crate::error::Result;
use glam::DVec3;

pub(super) const ENTRY: Entry = Entry {
    name: "cubes",
    summary: "n x n x n small cubes of twelve triangles, a lattice with straight empty lanes along all axes",
    options: "n: cubes along an edge (10)",
    slots: "the cube in column i, row j, layer k has slot i + j + k",
    source: "after Semwal & Kvarnstrom 1997, scene Lanes, in triangles",
    keys: &["n"],
    body,
    stage,
};

/// Cubes of edge 0.4 at spacing 1, centred on the origin; one mesh for each slot.
fn body(options: &Options) -> Result<Body> {
    let n = options.n(10, 1..=200)?;
    options.limit(12 * u64::from(n).pow(3))?;
    let place = |i: u32| f64::from(i) - f64::from(n - 1) / 2.0;
    let mut meshes = Vec::new();
    // Cubes with the same i + j + k share a slot, hence a mesh.
    for slot in 0..=3 * (n - 1) {
        let mut all = super::Mesh { name: format!("cubes {slot}"), material: slot, ..super::Mesh::default() };
        for k in 0..n.min(slot + 1) {
            for j in 0..n.min(slot - k + 1) {
                let i = slot - k - j;
                if i < n {
                    let centre = DVec3::new(place(i), place(j), place(k));
                    let side = |high: bool| if high { 0.2 } else { -0.2 };
                    let cube = box_mesh("", |x, y, z| centre + DVec3::new(side(x), side(y), side(z)));
                    super::patch::append(&mut all, cube);
                }
            }
        }
        meshes.push(all);
    }
    Ok(Body { meshes, ..Body::default() })
}

fn stage(_: &Options) -> Stage {
    daylight(vec![lambert("brick", 0.65, 0.3, 0.2), lambert("sand", 0.7, 0.6, 0.4), lambert("slate", 0.3, 0.35, 0.45)])
}
