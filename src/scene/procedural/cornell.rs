//! Cornell: a box with coloured walls, a light in the ceiling and two blocks.

use super::stock::{box_mesh, lambert, look};
use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::Result;
use crate::scene::{Material, RenderDefaults};
use glam::{DVec3, Vec3};

pub(super) const ENTRY: Entry = Entry {
    name: "cornell",
    summary: "a box 10 wide with a red and a green wall, an area light and two blocks",
    options: "",
    slots: "0 white, 1 red wall, 2 green wall, 3 light, 4 blocks",
    source: "after Goral et al. 1984; dimensions are ours, with gaps where the original's surfaces coincide",
    keys: &[],
    body,
    stage,
};

/// The room is -5..5 in x and z and 0..10 in y, open towards +z; fronts look inwards.
fn body(_: &Options) -> Result<Body> {
    let quad = |name: &str, material: u32, corners: [[f32; 3]; 4]| Mesh {
        name: name.into(),
        positions: corners.map(Vec3::from_array).to_vec(),
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        material,
        ..Mesh::default()
    };
    let meshes = vec![
        quad("floor", 0, [[-5.0, 0.0, 5.0], [5.0, 0.0, 5.0], [5.0, 0.0, -5.0], [-5.0, 0.0, -5.0]]),
        quad("ceiling", 0, [[-5.0, 10.0, -5.0], [5.0, 10.0, -5.0], [5.0, 10.0, 5.0], [-5.0, 10.0, 5.0]]),
        quad("back wall", 0, [[-5.0, 0.0, -5.0], [5.0, 0.0, -5.0], [5.0, 10.0, -5.0], [-5.0, 10.0, -5.0]]),
        quad("left wall", 1, [[-5.0, 0.0, 5.0], [-5.0, 0.0, -5.0], [-5.0, 10.0, -5.0], [-5.0, 10.0, 5.0]]),
        quad("right wall", 2, [[5.0, 0.0, -5.0], [5.0, 0.0, 5.0], [5.0, 10.0, 5.0], [5.0, 10.0, -5.0]]),
        quad("light", 3, [[-1.5, 9.9, -1.5], [1.5, 9.9, -1.5], [1.5, 9.9, 1.5], [-1.5, 9.9, 1.5]]),
        block("tall block", [-1.8, 0.0, -1.8], [3.0, 6.0, 3.0], 18.0),
        block("low block", [1.8, 0.0, 1.6], [3.0, 3.0, 3.0], -17.0),
    ];
    Ok(Body { meshes, ..Body::default() })
}

/// A block that stands 0.02 above `foot`, turned about its axis by `degrees`.
fn block(name: &str, foot: [f64; 3], size: [f64; 3], degrees: f64) -> Mesh {
    let (sin, cos) = degrees.to_radians().sin_cos();
    let (foot, size) = (DVec3::from_array(foot), DVec3::from_array(size));
    let side = |high: bool| if high { 0.5 } else { -0.5 };
    let mut mesh = box_mesh(name, |x, y, z| {
        let (px, pz) = (side(x) * size.x, side(z) * size.z);
        foot + DVec3::new(cos * px + sin * pz, 0.02 + if y { size.y } else { 0.0 }, cos * pz - sin * px)
    });
    mesh.material = 4;
    mesh
}

fn stage(_: &Options) -> Stage {
    let light = Material { emission: Vec3::splat(10.0), ..lambert("light", 0.0, 0.0, 0.0) };
    Stage {
        palette: vec![
            lambert("white", 0.73, 0.73, 0.73),
            lambert("red", 0.65, 0.06, 0.06),
            lambert("green", 0.12, 0.46, 0.1),
            light,
            lambert("block", 0.7, 0.7, 0.7),
        ],
        props: Vec::new(),
        lights: Vec::new(),
        environment: Vec3::ZERO,
        camera: look([0.0, 5.0, 19.5], [0.0, 5.0, 0.0], DVec3::Y, 38.0),
        defaults: RenderDefaults::default(),
    }
}
