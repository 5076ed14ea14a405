//! Bumpy: a ball with bumps, with smooth normals.

use super::patch::{Edge, patch};
use super::stock::{daylight, lambert};
use super::{Body, Entry, Options, Stage};
use crate::error::Result;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

pub(super) const ENTRY: Entry = Entry {
    name: "bumpy",
    summary: "a ball of radius 1 with bumps of 0.1, triangles with smooth normals",
    options: "n: steps from pole to pole (80); 2 n around: 4 n (n - 1) triangles",
    slots: "all have slot 0",
    source: "radius 1 + 0.1 sin(5x) sin(5y) sin(5z) of the direction (x, y, z)",
    keys: &["n"],
    body,
    stage,
};

fn body(options: &Options) -> Result<Body> {
    let n = options.n(80, 3..=8192)?;
    options.limit(4 * u64::from(n).pow(2))?;
    let mut mesh = patch("bumpy ball", (2 * n, Edge::Closed), (n, Edge::Open), |u, v| {
        // The poles exactly: every sample of a polar row is the same point.
        let (s, c) = match v {
            0.0 => (0.0, 1.0),
            1.0 => (0.0, -1.0),
            _ => (PI * v).sin_cos(),
        };
        let (sin, cos) = (TAU * u).sin_cos();
        // Plus zero: no negative zeros at the poles.
        point(DVec3::new(s * cos + 0.0, c, s * sin + 0.0))
    });
    // One triangle of each cell at a pole has two equal corners.
    let positions = &mesh.positions;
    mesh.triangles.retain(|t| {
        let [a, b, c] = t.map(|i| positions[i as usize]);
        a != b && b != c && c != a
    });
    Ok(Body { meshes: vec![mesh], ..Body::default() })
}

/// The surface over a unit direction, with a normal: the gradient of |p| - radius(p / |p|).
fn point(d: DVec3) -> (DVec3, DVec3) {
    let ([sx, cx], [sy, cy], [sz, cz]) = (wave(d.x), wave(d.y), wave(d.z));
    let radius = 1.0 + 0.1 * sx * sy * sz;
    let slope = 0.5 * DVec3::new(cx * sy * sz, sx * cy * sz, sx * sy * cz);
    let along = slope - slope.dot(d) * d;
    (radius * d, d - along / radius)
}

fn wave(x: f64) -> [f64; 2] {
    let (s, c) = (5.0 * x).sin_cos();
    [s, c]
}

fn stage(_: &Options) -> Stage {
    daylight(vec![lambert("clay", 0.6, 0.45, 0.35)])
}
