//! Sombrero: a height field of damped ripples.

use super::super::patch::{Edge, patch};
use super::setting::{Setting, surface};
use super::{Body, Entry, Options, Stage};
use crate::error::Result;
use glam::DVec3;
use std::f64::consts::TAU;

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-sombrero",
    summary: "SPD sombrero: a height field of damped ripples, 1922 triangles; y up",
    options: "n: size factor, 32 samples along an edge doubled n - 1 times (1)",
    slots: "all have slot 0",
    source: "Enzmann, SPD 3.14 sombrero",
    keys: &["n"],
    body,
    stage,
};

fn body(options: &Options) -> Result<Body> {
    let n = options.n(1, 1..=20)?;
    let samples = 16_u64 << n;
    options.limit_size(2 * (samples - 1) * (samples - 1))?;
    let cells = (16 << n) - 1;
    // The last sample of the function is one step short of 4, as in the original, but the mesh reaches it.
    let place = |u: f64| 8.0 * u - 4.0;
    let short = f64::from(cells) / f64::from(cells + 1);
    // u runs along z and v along x, so that the front is above and the diagonals rise in both.
    let mut mesh = patch("sombrero", (cells, Edge::Open), (cells, Edge::Open), |u, v| {
        let height = ripples(place(v * short), place(u * short));
        (DVec3::new(place(v), height - 3.0, place(u)), DVec3::ZERO)
    });
    mesh.normals = Vec::new();
    Ok(Body { meshes: vec![mesh], ..Body::default() })
}

fn ripples(x: f64, y: f64) -> f64 {
    let r = x.hypot(y);
    (TAU * r).cos() * (-r).exp()
}

fn stage(_: &Options) -> Stage {
    let setting = Setting { from: [0.0, 5.0, -8.0], angle: 40.0, lights: &[[10.0, 10.0, -10.0]], ..Setting::USUAL };
    setting.stage(vec![surface("felt", [1.0, 0.1, 0.1], 0.8, 0.0)], Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_size_has_the_original_count_and_peak() {
        let meshes = body(&Options::default()).expect("the standard size").meshes;
        let mesh = &meshes[0];
        assert_eq!(mesh.triangles.len(), 1922);
        // Sample (16, 16) of the function is at the origin, where it is 1; it is drawn at -4 + 16 * 8 / 31.
        let top = mesh.positions.iter().copied().max_by(|a, b| a.y.total_cmp(&b.y)).expect("positions");
        let off = -4.0 + 128.0 / 31.0;
        assert!((top - glam::Vec3::new(off, -2.0, off)).length() < 1e-5, "{top}");
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            assert!((b - a).cross(c - a).y > 0.0);
        }
    }
}
