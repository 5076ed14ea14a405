//! Teapot in a stadium: a small dense object in a large coarse scene.

use super::patch::{Edge, patch};
use super::stock::{lambert, look, sun};
use super::{Body, Entry, Options, Stage, teapot};
use crate::error::Result;
use crate::scene::RenderDefaults;
use glam::{DVec3, Vec3};
use std::f64::consts::TAU;

pub(super) const ENTRY: Entry = Entry {
    name: "teapot-stadium",
    summary: "the teapot, 3 high, on the field of a stadium 4000 wide",
    options: "n: steps along each edge of the teapot's patches (12: 9120 triangles)",
    slots: "0 teapot, 1 field, 2 stands",
    source: "Haines, Ray Tracing News 1(3), 1988: the uniform grid's worst case; dimensions are ours",
    keys: &["n"],
    body,
    stage,
};

/// The field's height: below the pot's bottom, which is at 0, so that no surfaces coincide.
const FIELD: f64 = -0.5;
const SIDES: u32 = 96;
const TIERS: u32 = 24;

fn body(options: &Options) -> Result<Body> {
    let n = options.n(12, 1..=2048)?;
    // The pot, the field, and two rows of quadrilaterals for each tier.
    options.limit(64 * u64::from(n).pow(2) + u64::from(SIDES + 4 * SIDES * TIERS))?;
    let around = |angle: f64, radius: f64, height: f64| {
        let (sin, cos) = (TAU * angle).sin_cos();
        DVec3::new(radius * cos, height, -radius * sin)
    };
    let flat = |p: DVec3| (p, DVec3::ZERO);
    // The field reaches below the first tier; one step from the centre outwards.
    let mut field =
        patch("field", (SIDES, Edge::Closed), (1, Edge::Open), |u, v| flat(around(u, 400.0 * (1.0 - v), FIELD)));
    field.triangles.retain(|t| t.iter().filter(|&&i| i >= SIDES).count() < 2);
    // Steps: even rows are the foot of a riser, odd rows its head.
    let mut stands = patch("stands", (SIDES, Edge::Closed), (2 * TIERS, Edge::Open), |u, v| {
        let row = (v * f64::from(2 * TIERS)).round();
        let (riser, tread) = ((row / 2.0).ceil(), (row / 2.0).floor());
        let width = (2000.0 - 400.0) / f64::from(TIERS);
        flat(around(u, 400.0 + width * tread, FIELD + 40.0 * riser))
    });
    // The bowl is seen from inside.
    stands.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    (field.normals, stands.normals) = (Vec::new(), Vec::new());
    (field.material, stands.material) = (1, 2);
    Ok(Body { meshes: vec![teapot::mesh(n), field, stands], ..Body::default() })
}

fn stage(_: &Options) -> Stage {
    Stage {
        palette: vec![
            lambert("glaze", 0.7, 0.4, 0.15),
            lambert("grass", 0.2, 0.45, 0.15),
            lambert("concrete", 0.5, 0.5, 0.5),
        ],
        props: Vec::new(),
        lights: vec![sun(-0.4, -0.8, -0.45, 2.2)],
        environment: Vec3::new(0.3, 0.35, 0.45),
        camera: look([3.0, 4.5, 9.0], [0.0, 1.5, 0.0], DVec3::Y, 40.0),
        defaults: RenderDefaults::default(),
    }
}
