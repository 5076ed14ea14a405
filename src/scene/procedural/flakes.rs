//! Flakes: the sphereflake, nine smaller spheres around each sphere; "balls" of Haines' SPD.

use super::stock::{lambert, look, mirror};
use super::{Body, Entry, Options, Stage};
use crate::error::Result;
use crate::geometry::Sphere;
use crate::scene::{Light, Mesh, RenderDefaults};
use glam::{DQuat, DVec3, Vec3};

pub(super) const ENTRY: Entry = Entry {
    name: "flakes",
    summary: "sphereflake: nine spheres of a third the size around each sphere, z up",
    options: "depth: levels below the first sphere (4: 7381 spheres)",
    slots: "level l of the recursion has slot l",
    source: "Haines, \"A Proposal for Standard Graphics Environments\" (1987), balls; its floor, camera and lights",
    keys: &["depth"],
    body,
    stage,
};

/// Of one kind of primitive, for accelerators that take no scene of both.
pub(super) const ALONE: Entry =
    Entry { name: "sphereflake", summary: "flakes without the floor: spheres alone, z up", stage: alone, ..ENTRY };

/// Directions from a sphere that points to +z to its nine children, rounded as in the original.
#[expect(clippy::approx_constant, reason = "the digits are the original's")]
const CHILDREN: [[f64; 3]; 9] = [
    [0.408248, 0.408248, 0.816497],
    [0.965926, 0.258819, 0.0],
    [0.258819, 0.965926, 0.0],
    [-0.557678, 0.149429, 0.816497],
    [-0.707107, 0.707107, 0.0],
    [-0.965926, -0.258819, 0.0],
    [0.149429, -0.557678, 0.816497],
    [-0.258819, -0.965926, 0.0],
    [0.707107, -0.707107, 0.0],
];

fn body(options: &Options) -> Result<Body> {
    Ok(Body { spheres: spheres(options.depth(4, 0..=7)?), ..Body::default() })
}

/// `depth` levels below the sphere of radius 0.5 about the origin, which points to +z; with their levels.
pub(super) fn spheres(depth: u32) -> Vec<(Sphere, u32)> {
    let mut level = vec![(DVec3::ZERO, 0.5, DVec3::Z)];
    let mut spheres = Vec::new();
    for slot in 0..=depth {
        let sphere = |&(c, r, _): &(DVec3, f64, DVec3)| (Sphere { centre: c.as_vec3(), radius: r as f32 }, slot);
        spheres.extend(level.iter().map(sphere));
        if slot < depth {
            level = level.iter().flat_map(|&parent| children(parent)).collect();
        }
    }
    spheres
}

/// Children touch their parent: a third of its radius, 4/3 of it away.
fn children((centre, radius, direction): (DVec3, f64, DVec3)) -> impl Iterator<Item = (DVec3, f64, DVec3)> {
    let turn = if direction.z >= 0.9999 {
        DQuat::IDENTITY
    } else if direction.z <= -0.9999 {
        DQuat::from_rotation_y(std::f64::consts::PI)
    } else {
        DQuat::from_rotation_arc(DVec3::Z, direction.normalize())
    };
    CHILDREN.iter().map(move |&v| {
        let towards = turn * DVec3::from_array(v);
        (centre + 4.0 / 3.0 * radius * towards, radius / 3.0, towards)
    })
}

/// The square of side 24 that the first sphere touches.
pub(super) fn floor() -> Mesh {
    let corner = |x: f32, y: f32| Vec3::new(x, y, -0.5);
    Mesh {
        name: "floor".into(),
        positions: vec![corner(-12.0, -12.0), corner(12.0, -12.0), corner(12.0, 12.0), corner(-12.0, 12.0)],
        triangles: vec![[0, 1, 2], [0, 2, 3]],
        ..Mesh::default()
    }
}

fn stage(options: &Options) -> Stage {
    Stage { props: vec![(floor(), lambert("floor", 0.8, 0.6, 0.264))], ..alone(options) }
}

/// Without the floor.
pub(super) fn alone(_: &Options) -> Stage {
    // The original's lights do not weaken with distance; these give about as much at theirs.
    let lights = [[4.0, 3.0, 2.0], [1.0, -4.0, 4.0], [-3.0, 1.0, 5.0]];
    let light = |p| Light::Point { position: DVec3::from_array(p), intensity: Vec3::splat(16.0) };
    Stage {
        palette: vec![lambert("ball", 0.5, 0.45, 0.35), mirror("polished ball", 0.7)],
        props: Vec::new(),
        lights: lights.map(light).to_vec(),
        environment: Vec3::new(0.078, 0.361, 0.753),
        camera: look([2.1, 1.3, 1.7], [0.0; 3], DVec3::Z, 45.0),
        defaults: RenderDefaults::default(),
    }
}
