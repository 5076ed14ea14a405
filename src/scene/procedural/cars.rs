//! Cars: bodies and wheels of triangular patches, parked in rows.

use super::patch::{Edge, append, patch};
use super::stock::{daylight, floor, lambert};
use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::Result;
use crate::random::Random;
use crate::scene::transform::{apply, placement};
use glam::DVec3;
use std::f64::consts::TAU;

pub(super) const ENTRY: Entry = Entry {
    name: "cars",
    summary: "parked cars of triangular patches, about 4500 triangles each, smooth normals",
    options: "n: number of cars (4); seed: of how they are parked (1)",
    slots: "body of car i has slot 2 i, its wheels 2 i + 1",
    source: "after Semwal & Kvarnstrom 1997, scene Cars (only \"triangular patches\" is said of it); the shape is ours",
    keys: &["n", "seed"],
    body,
    stage,
};

/// Side view of the body: x from tail to nose, height of the sill, height of the top, half width. Metres.
const OUTLINE: [[f64; 4]; 10] = [
    [-2.15, 0.55, 0.60, 0.55],
    [-2.10, 0.38, 0.88, 0.76],
    [-1.55, 0.30, 1.00, 0.84],
    [-1.05, 0.26, 1.36, 0.86],
    [-0.30, 0.25, 1.46, 0.87],
    [0.40, 0.25, 1.38, 0.87],
    [1.00, 0.26, 1.00, 0.86],
    [1.70, 0.30, 0.88, 0.82],
    [2.10, 0.36, 0.74, 0.72],
    [2.15, 0.50, 0.55, 0.50],
];

fn body(options: &Options) -> Result<Body> {
    let n = options.n(4, 1..=10_000)?;
    // A car has about 4500.
    options.limit(5000 * u64::from(n))?;
    let mut rng = Random::new(options.seed.unwrap_or(1));
    let (shell, wheels) = (shell(), wheels());
    let in_row = f64::from(n).sqrt().ceil().max(1.0);
    let mut meshes = Vec::new();
    for car in 0..n {
        let (row, column) = ((f64::from(car) / in_row).floor(), f64::from(car) % in_row);
        let turn = DVec3::new(0.0, rng.within(-8.0, 8.0), 0.0);
        let (x, z) = (6.0 * (row - (in_row - 1.0) / 2.0), 3.0 * (column - (in_row - 1.0) / 2.0));
        let place = DVec3::new(x + rng.within(-0.3, 0.3), 0.0, z + rng.within(-0.2, 0.2));
        let parked = placement(DVec3::ONE, turn, place);
        for (slot, part) in [(2 * car, &shell), (2 * car + 1, &wheels)] {
            let mut mesh = Mesh { name: format!("{} {car}", part.name), material: slot, ..part.clone() };
            apply(&mut mesh, &parked);
            meshes.push(mesh);
        }
    }
    Ok(Body { meshes, ..Body::default() })
}

/// A closed skin of 3000 triangles or so: superellipses across, the outline along.
fn shell() -> Mesh {
    let at = |u: f64, v: f64| {
        let [x, sill, top, half] = outline(u);
        let (sin, cos) = (TAU * v).sin_cos();
        let (middle, rise) = ((sill + top) / 2.0, (top - sill) / 2.0);
        DVec3::new(x, middle + rise * round_off(sin), half * round_off(cos) * (1.0 - 0.18 * sin.max(0.0)))
    };
    let mut mesh = patch("body", (64, Edge::Open), (24, Edge::Closed), |u, v| (at(u, v), across(at, u, v)));
    for (u, flip) in [(0.0, true), (1.0, false)] {
        append(&mut mesh, cap(u, flip, at));
    }
    mesh
}

/// Flat end of the skin.
fn cap(u: f64, flip: bool, at: impl Fn(f64, f64) -> DVec3) -> Mesh {
    let normal = if flip { DVec3::NEG_X } else { DVec3::X };
    let [x, sill, top, _] = outline(u);
    let middle = DVec3::new(x, (sill + top) / 2.0, 0.0);
    let mut mesh =
        patch("cap", (24, Edge::Closed), (1, Edge::Open), |v, r| (if r == 0.0 { at(u, v) } else { middle }, normal));
    // The inner ring is one point.
    mesh.triangles.retain(|t| t.iter().filter(|&&i| i >= 24).count() < 2);
    if !flip {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
    mesh
}

fn wheels() -> Mesh {
    let mut mesh = Mesh { name: "wheels".into(), ..Mesh::default() };
    for (x, z) in [(-1.35, -0.78), (-1.35, 0.78), (1.35, -0.78), (1.35, 0.78)] {
        // A torus about the axle; tread and rim in one.
        append(
            &mut mesh,
            patch("wheel", (24, Edge::Closed), (8, Edge::Closed), |u, v| {
                let ((su, cu), (sv, cv)) = ((TAU * u).sin_cos(), (TAU * v).sin_cos());
                let normal = DVec3::new(cv * cu, cv * su, sv);
                let hub = DVec3::new(x + 0.22 * cu, 0.31 + 0.22 * su, z);
                (hub + 0.09 * normal, normal)
            }),
        );
    }
    mesh
}

/// The outline at `u`, 0 to 1, by Catmull and Rom's spline.
fn outline(u: f64) -> [f64; 4] {
    let last = OUTLINE.len() - 1;
    let s = u * last as f64;
    let i = (s.floor().max(0.0) as usize).min(last - 1);
    let t = s - i as f64;
    let at = |k: usize| OUTLINE[k.clamp(1, last + 1) - 1];
    let [p, q, r, w] = [at(i), at(i + 1), at(i + 2), at(i + 3)];
    std::array::from_fn(|k| {
        let (b, c) = ((r[k] - p[k]) / 2.0, (w[k] - q[k]) / 2.0);
        let (t2, t3) = (t * t, t * t * t);
        q[k] * (2.0 * t3 - 3.0 * t2 + 1.0) + b * (t3 - 2.0 * t2 + t) + r[k] * (3.0 * t2 - 2.0 * t3) + c * (t3 - t2)
    })
}

/// Makes a circle's coordinate a superellipse's of exponent 3.
fn round_off(x: f64) -> f64 {
    x.abs().powf(2.0 / 3.0).copysign(x)
}

/// Outward normal of the skin by central differences.
fn across(at: impl Fn(f64, f64) -> DVec3, u: f64, v: f64) -> DVec3 {
    let h = 1e-4;
    let du = at((u + h).min(1.0), v) - at((u - h).max(0.0), v);
    let dv = at(u, v + h) - at(u, v - h);
    du.cross(dv)
}

fn stage(options: &Options) -> Stage {
    let mut stage = daylight(vec![
        lambert("red", 0.6, 0.08, 0.06),
        lambert("rubber", 0.05, 0.05, 0.05),
        lambert("blue", 0.1, 0.2, 0.55),
        lambert("rubber", 0.05, 0.05, 0.05),
        lambert("white", 0.75, 0.75, 0.72),
        lambert("rubber", 0.05, 0.05, 0.05),
    ]);
    let side = (options.n.unwrap_or(4) as f64).sqrt().ceil() as f32;
    // Below the tyres, which touch 0.
    stage.props.push((floor(-0.02, 3.0 * side + 1.0), lambert("asphalt", 0.25, 0.25, 0.26)));
    stage
}
