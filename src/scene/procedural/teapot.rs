//! Teapot: the Utah teapot from its 32 bicubic patches.

use super::patch::{Edge, append, patch};
use super::stock::{daylight, lambert};
use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::Result;
use glam::DVec3;

pub(super) const ENTRY: Entry = Entry {
    name: "teapot",
    summary: "the Utah teapot with its bottom, smooth normals, 3.15 high, y up",
    options: "n: steps along each edge of the 32 patches (12: 9120 triangles)",
    slots: "all have slot 0",
    source: "Newell 1975, with Blinn's bottom and height; counts as Haines' SPD: 64 n^2 - 8 n triangles",
    keys: &["n"],
    body,
    stage,
};

/// Control points (radius, height) of the four-fold symmetric parts, outwards and down from the lid's knob.
/// The ratio is that of the inner control points of a quarter circle to its radius: .56, but on top of the knob .5625.
const PROFILES: [([[f64; 2]; 4], f64); 6] = [
    ([[0.0, 3.15], [0.8, 3.15], [0.0, 2.85], [0.2, 2.7]], 0.5625),
    ([[0.2, 2.7], [0.4, 2.55], [1.3, 2.55], [1.3, 2.4]], 0.56),
    ([[1.4, 2.4], [1.3375, 2.53125], [1.4375, 2.53125], [1.5, 2.4]], 0.56),
    ([[1.5, 2.4], [1.75, 1.875], [2.0, 1.35], [2.0, 0.9]], 0.56),
    ([[2.0, 0.9], [2.0, 0.45], [1.5, 0.225], [1.5, 0.15]], 0.56),
    ([[1.5, 0.15], [1.5, 0.075], [1.425, 0.0], [0.0, 0.0]], 0.56),
];

/// Control points of one half of handle and spout: rows across, each (x, y, z) with z up; the other half mirrors y.
const HALVES: [[[[f64; 3]; 4]; 4]; 4] = [
    // Handle, upper part.
    [
        [[-1.6, 0.0, 2.025], [-1.6, -0.3, 2.025], [-1.5, -0.3, 2.25], [-1.5, 0.0, 2.25]],
        [[-2.3, 0.0, 2.025], [-2.3, -0.3, 2.025], [-2.5, -0.3, 2.25], [-2.5, 0.0, 2.25]],
        [[-2.7, 0.0, 2.025], [-2.7, -0.3, 2.025], [-3.0, -0.3, 2.25], [-3.0, 0.0, 2.25]],
        [[-2.7, 0.0, 1.8], [-2.7, -0.3, 1.8], [-3.0, -0.3, 1.8], [-3.0, 0.0, 1.8]],
    ],
    // Handle, lower part.
    [
        [[-2.7, 0.0, 1.8], [-2.7, -0.3, 1.8], [-3.0, -0.3, 1.8], [-3.0, 0.0, 1.8]],
        [[-2.7, 0.0, 1.575], [-2.7, -0.3, 1.575], [-3.0, -0.3, 1.35], [-3.0, 0.0, 1.35]],
        [[-2.5, 0.0, 1.125], [-2.5, -0.3, 1.125], [-2.65, -0.3, 0.9375], [-2.65, 0.0, 0.9375]],
        [[-2.0, 0.0, 0.9], [-2.0, -0.3, 0.9], [-1.9, -0.3, 0.6], [-1.9, 0.0, 0.6]],
    ],
    // Spout, lower part.
    [
        [[1.7, 0.0, 1.425], [1.7, -0.66, 1.425], [1.7, -0.66, 0.6], [1.7, 0.0, 0.6]],
        [[2.6, 0.0, 1.425], [2.6, -0.66, 1.425], [3.1, -0.66, 0.825], [3.1, 0.0, 0.825]],
        [[2.3, 0.0, 2.1], [2.3, -0.25, 2.1], [2.4, -0.25, 2.025], [2.4, 0.0, 2.025]],
        [[2.7, 0.0, 2.4], [2.7, -0.25, 2.4], [3.3, -0.25, 2.4], [3.3, 0.0, 2.4]],
    ],
    // Spout, mouth.
    [
        [[2.7, 0.0, 2.4], [2.7, -0.25, 2.4], [3.3, -0.25, 2.4], [3.3, 0.0, 2.4]],
        [[2.8, 0.0, 2.475], [2.8, -0.25, 2.475], [3.525, -0.25, 2.49375], [3.525, 0.0, 2.49375]],
        [[2.9, 0.0, 2.475], [2.9, -0.15, 2.475], [3.45, -0.15, 2.5125], [3.45, 0.0, 2.5125]],
        [[2.8, 0.0, 2.4], [2.8, -0.15, 2.4], [3.2, -0.15, 2.4], [3.2, 0.0, 2.4]],
    ],
];

pub(super) type Bicubic = [[DVec3; 4]; 4];

fn body(options: &Options) -> Result<Body> {
    let n = options.n(12, 1..=2048)?;
    options.limit(64 * u64::from(n).pow(2))?;
    Ok(Body { meshes: vec![mesh(n)], ..Body::default() })
}

/// The pot about the y axis, bottom at 0, `n` steps along each patch edge.
pub(super) fn mesh(n: u32) -> Mesh {
    let mut all = Mesh { name: "teapot".into(), ..Mesh::default() };
    for control in patches() {
        append(&mut all, patch("", (n, Edge::Open), (n, Edge::Open), |u, v| evaluate(&control, u, v)));
    }
    // Patches that end on the axis have triangles without area there.
    let positions = &all.positions;
    all.triangles.retain(|t| {
        let on_axis = |i: u32| positions[i as usize].x == 0.0 && positions[i as usize].z == 0.0;
        t.iter().filter(|&&i| on_axis(i)).count() < 2
    });
    all
}

/// All 32 patches; the front of each (first index right, second up) looks outwards.
pub(super) fn patches() -> Vec<Bicubic> {
    let mut all = Vec::new();
    for (profile, inner) in PROFILES {
        for quarter in 0..4 {
            all.push(std::array::from_fn(|j| {
                let [r, height] = profile[3 - j];
                let arc = [[r, 0.0], [r, inner * r], [inner * r, r], [0.0, r]];
                std::array::from_fn(|i| {
                    let [x, z] = turn(quarter, arc[3 - i]);
                    DVec3::new(x, height, z)
                })
            }));
        }
    }
    for half in HALVES {
        let mirrored = |sign: f64| half.map(|row| row.map(|[x, y, z]| DVec3::new(x, z, -sign * y)));
        all.push(mirrored(1.0));
        // A mirror image is turned inside out: run each row backwards.
        all.push(mirrored(-1.0).map(|mut row| {
            row.reverse();
            row
        }));
    }
    all
}

/// Quarter turns, exact.
fn turn(quarters: u32, [x, z]: [f64; 2]) -> [f64; 2] {
    (0..quarters).fold([x, z], |[x, z], _| [-z + 0.0, x])
}

/// Point and normal at (u, v); where a row of control points is one point, the normal of a point nearby.
fn evaluate(control: &Bicubic, u: f64, v: f64) -> (DVec3, DVec3) {
    let point = |u, v| combine(&bernstein(v), &control.map(|row| combine(&bernstein(u), &row)));
    let normal = |u, v| {
        let du = combine(&bernstein(v), &control.map(|row| combine(&slope(u), &row)));
        let dv = combine(&slope(v), &control.map(|row| combine(&bernstein(u), &row)));
        du.cross(dv)
    };
    let n = normal(u, v);
    let nudged = if n.length() > 1e-9 { n } else { normal(u, v + 1e-4 * (0.5 - v).signum()) };
    (point(u, v), nudged)
}

fn combine(weights: &[f64; 4], points: &[DVec3; 4]) -> DVec3 {
    weights[0] * points[0] + weights[1] * points[1] + weights[2] * points[2] + weights[3] * points[3]
}

fn bernstein(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 3.0 * s * s * t, 3.0 * s * t * t, t * t * t]
}

fn slope(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [-3.0 * s * s, 3.0 * s * (s - 2.0 * t), 3.0 * t * (2.0 * s - t), 3.0 * t * t]
}

pub(super) fn stage(_: &Options) -> Stage {
    daylight(vec![lambert("glaze", 0.7, 0.4, 0.15)])
}
