//! Lattice: mirror balls in a cubic grid, joined by matte bars; the eye is inside.

use super::super::patch::append;
use super::setting::{Setting, surface};
use super::tube::{End, tube};
use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::Result;
use crate::geometry::Sphere;
use glam::DVec3;

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-lattice",
    summary: "SPD lattice: 2197 balls in a cubic grid, joined by 6084 bars, seen from inside",
    options: "n: size factor, cells along an edge (12); sides of a cylinder (16)",
    slots: "0 balls, 1 bars along x, 2 along y, 3 along z",
    source: "Costa, SPD 3.14 lattice",
    keys: &["n", "sides"],
    body,
    stage,
};

/// Radii of balls and bars, in cells.
const BALL: f64 = 0.25;
const BAR: f64 = 0.0625;

fn body(options: &Options) -> Result<Body> {
    let (n, sides) = (options.n(12, 1..=1000)?, options.sides()?);
    let nodes = u64::from(n + 1);
    options.limit_size(nodes.pow(3) + 3 * u64::from(n) * nodes.pow(2) * 2 * u64::from(sides))?;
    let cell = 1.0 / f64::from(n);
    // Bars end a little inside of the balls.
    let trim = 0.99 * BALL * (1.0 - (BAR / BALL).sqrt());
    let mut spheres = Vec::new();
    let mut bars = [1, 2, 3].map(|material| Mesh { name: "bars".into(), material, ..Mesh::default() });
    let end = |centre: DVec3| End { centre: cell * centre, radius: cell * BAR };
    for x in 0..=n {
        for y in 0..=n {
            for z in 0..=n {
                let node = DVec3::new(x.into(), y.into(), z.into());
                spheres.push((Sphere { centre: (cell * node).as_vec3(), radius: (cell * BALL) as f32 }, 0));
                for (axis, (i, mesh)) in DVec3::AXES.into_iter().zip([x, y, z].into_iter().zip(&mut bars)) {
                    if i < n {
                        append(mesh, tube(end(node + trim * axis), end(node + (1.0 - trim) * axis), sides));
                    }
                }
            }
        }
    }
    Ok(Body { meshes: bars.into(), spheres, ..Body::default() })
}

fn stage(options: &Options) -> Stage {
    // The body has refused a size that is out of range.
    let n = options.n(12, 1..=1000).unwrap_or(1);
    let cells = f64::from(n);
    // Half way between two layers of balls.
    let (x, half) = ((f64::from(n / 2) + 0.5) / cells, 0.5 / cells);
    let setting = Setting {
        from: [x, 1.0, 1.0 - half],
        at: [x, -1.0, -1.0 - half],
        up: [0.2, 1.0, 0.0],
        angle: 60.0,
        lights: &[
            [2.0, 0.5, 0.5],
            [-1.0, 0.5, 0.5],
            [0.5, 2.0, 0.5],
            [0.5, -1.0, 0.5],
            [0.5, 0.5, 2.0],
            [0.5, 0.5, -1.0],
        ],
        // The point looked at is outside.
        focus: Some([0.5; 3]),
        ..Setting::USUAL
    };
    let palette = vec![
        surface("ball", [0.9, 0.9, 0.9], 0.5, 0.5),
        surface("bar along x", [0.9, 0.1, 0.1], 0.99, 0.0),
        surface("bar along y", [0.1, 0.9, 0.1], 0.99, 0.0),
        surface("bar along z", [0.1, 0.1, 0.9], 0.99, 0.0),
    ];
    setting.stage(palette, Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Aabb;

    #[test]
    fn counts_and_bounds_are_the_original_ones() {
        for (n, balls, bars) in [(1, 8, 12), (2, 27, 54), (5, 216, 540), (12, 2197, 6084)] {
            let made = body(&Options { n: Some(n), ..Options::default() }).expect("a usual size");
            let triangles: usize = made.meshes.iter().map(|m| m.triangles.len()).sum();
            assert_eq!((made.spheres.len(), triangles), (balls, bars * 32), "{n}");
            // Balls of a quarter cell around the corners of the unit cube.
            let bounds = made
                .spheres
                .iter()
                .fold(Aabb::EMPTY, |b, (s, _)| b.union(&Aabb { min: s.centre - s.radius, max: s.centre + s.radius }));
            let out = 0.25 / n as f32;
            assert!((bounds.min + out).abs().max_element() < 1e-6, "{bounds:?}");
            assert!((bounds.max - 1.0 - out).abs().max_element() < 1e-6, "{bounds:?}");
        }
    }

    #[test]
    fn bars_end_inside_the_balls() {
        let made = body(&Options { n: Some(1), ..Options::default() }).expect("a small size");
        // Their rims are seen from nowhere outside.
        for p in made.meshes.iter().flat_map(|m| &m.positions) {
            let depth = made.spheres.iter().map(|(s, _)| s.radius - s.centre.distance(*p)).fold(f32::MIN, f32::max);
            assert!(depth > 0.0, "{p} {depth}");
        }
    }
}
