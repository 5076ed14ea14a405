//! Knot: a tube along a trefoil knot, with smooth normals.

use super::patch::{Edge, patch};
use super::stock::{daylight, lambert};
use super::{Body, Entry, Options, Stage};
use crate::error::Result;
use glam::DVec3;
use std::f64::consts::TAU;

pub(super) const ENTRY: Entry = Entry {
    name: "knot",
    summary: "a tube of triangles along a trefoil knot, smooth normals, about 6 wide",
    options: "n: steps along the knot (256); n / 8 around the tube: n^2 / 4 triangles",
    slots: "all have slot 0",
    source: "the (2, 3) torus knot",
    keys: &["n"],
    body,
    stage,
};

/// Radius of the tube; of the torus that carries the knot: 2 and 1.
const TUBE: f64 = 0.4;

fn body(options: &Options) -> Result<Body> {
    let n = options.n(256, 24..=8192)?;
    options.limit(u64::from(n).pow(2) / 4)?;
    let mesh = patch("knot", (n, Edge::Closed), (n / 8, Edge::Closed), |u, v| {
        let (centre, [side, up]) = frame(TAU * u);
        let (sin, cos) = (TAU * v).sin_cos();
        let normal = cos * side + sin * up;
        (centre + TUBE * normal, normal)
    });
    Ok(Body { meshes: vec![mesh], ..Body::default() })
}

/// The point of the knot at angle `t`, and two unit vectors across it, turned so that the patch's front looks outwards.
fn frame(t: f64) -> (DVec3, [DVec3; 2]) {
    let ((s2, c2), (s3, c3)) = ((2.0 * t).sin_cos(), (3.0 * t).sin_cos());
    let r = 2.0 + c3;
    let point = DVec3::new(r * c2, r * s2, s3);
    let tangent = DVec3::new(-3.0 * s3 * c2 - 2.0 * r * s2, -3.0 * s3 * s2 + 2.0 * r * c2, 3.0 * c3).normalize();
    // The torus's own normal never runs along the knot.
    let outward = DVec3::new(c3 * c2, c3 * s2, s3);
    let side = (outward - outward.dot(tangent) * tangent).normalize();
    (point, [side, side.cross(tangent)])
}

fn stage(_: &Options) -> Stage {
    daylight(vec![lambert("copper", 0.7, 0.4, 0.25)])
}
