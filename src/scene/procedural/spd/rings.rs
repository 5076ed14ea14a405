//! Rings: a pyramid of objects of six linked pentagonal rings, in front of a wall.

use super::super::patch::append;
use super::setting::{Setting, surface};
use super::tube::{End, tube};
use super::{Body, Entry, Mesh, Options, Stage, quad};
use crate::error::Result;
use crate::geometry::Sphere;
use glam::{DQuat, DVec3};
use std::f64::consts::{FRAC_PI_3, FRAC_PI_8, PI};

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-rings",
    summary: "SPD rings: 140 objects of six linked rings, 4200 spheres and 4200 cylinders, and a wall; z up",
    options: "n: size factor, layers (7); sides of a cylinder (16)",
    slots: "ring i of each object has slot i, 0 to 5",
    source: "Haines 1987, SPD 3.14 rings",
    keys: &["n", "sides"],
    body,
    stage,
};

/// Of spheres and cylinders.
const RADIUS: f64 = 0.07412;

/// Distance of layers: the pyramid fills the view of 45 degrees.
fn spacing() -> f64 {
    1.0 / FRAC_PI_8.sin()
}

fn body(options: &Options) -> Result<Body> {
    let (n, sides) = (options.n(7, 1..=10_000)?, options.sides()?);
    let layers = u64::from(n);
    let joints = 5 * layers * (layers + 1) * (2 * layers + 1);
    options.limit_size(joints * (1 + 2 * u64::from(sides)) + 2)?;
    let rings = rings();
    let mut tubes: Vec<Mesh> =
        (0..6).map(|material| Mesh { name: format!("ring {material}"), material, ..Mesh::default() }).collect();
    let mut spheres = Vec::new();
    for layer in 0..n {
        let across = |i: u32| 2.0 * f64::from(i) - f64::from(layer);
        for z in 0..=layer {
            for x in 0..=layer {
                let centre = DVec3::new(across(x), spacing() * f64::from(layer + 1), across(z));
                for ((ring, mesh), colour) in rings.iter().zip(&mut tubes).zip(0..) {
                    for (i, joint) in ring.iter().enumerate() {
                        let [base, apex] =
                            [*joint, ring[(i + 4) % 5]].map(|p| End { centre: centre + p, radius: RADIUS });
                        append(mesh, tube(base, apex, sides));
                        spheres.push((Sphere { centre: base.centre.as_vec3(), radius: RADIUS as f32 }, colour));
                    }
                }
            }
        }
    }
    Ok(Body { meshes: tubes, spheres, ..Body::default() })
}

/// Joints of the six rings of an object that fits into a unit ball: midpoints of a dodecahedron's edges.
fn rings() -> [[DVec3; 5]; 6] {
    let flat: [DVec3; 5] = std::array::from_fn(|i| {
        let (sin, cos) = (2.0 * PI / 5.0 * i as f64).sin_cos();
        DVec3::new(cos, sin, 0.0) / (1.0 + RADIUS)
    });
    // The angle between neighbouring faces of a dodecahedron.
    let tilt = DQuat::from_rotation_x(2.0 * (FRAC_PI_3.cos() / (PI / 5.0).sin()).acos());
    std::array::from_fn(|ring| {
        if ring == 0 {
            return flat;
        }
        let turn = DQuat::from_rotation_z(PI / 5.0 * (2.0 * (ring - 1) as f64 + 1.0));
        flat.map(|p| turn * (tilt * p))
    })
}

fn stage(options: &Options) -> Stage {
    // The body has refused a size that is out of range.
    let n = f64::from(options.n(7, 1..=10_000).unwrap_or(1));
    let spacing = spacing();
    let eye = DVec3::new(-1.0, -spacing, 0.5);
    let setting = Setting {
        from: eye.to_array(),
        at: (eye + DVec3::Y).to_array(),
        lights: &[[3.0, -spacing, 3.0], [-4.0, -spacing, 1.0], [2.0, -spacing, -4.0]],
        // The point looked at is right before the eye.
        focus: Some([0.0, spacing * (n + 1.0) / 2.0, 0.0]),
        ..Setting::USUAL
    };
    // Spans the view and 1 % more.
    let y = spacing * (n + 1.0);
    let half = 1.01 * (y + spacing) * FRAC_PI_8.tan();
    let corner = |x: f64, z: f64| [eye.x + x * half, y, eye.z + z * half];
    let wall = quad("wall", [corner(1.0, 1.0), corner(-1.0, 1.0), corner(-1.0, -1.0), corner(1.0, -1.0)]);
    let colours = [
        ("red", [1.0, 0.0, 0.0]),
        ("green", [0.0, 1.0, 0.0]),
        ("blue", [0.0, 0.0, 1.0]),
        ("cyan", [0.0, 1.0, 1.0]),
        ("magenta", [1.0, 0.0, 1.0]),
        ("yellow", [1.0, 1.0, 0.0]),
    ];
    let palette = colours.map(|(name, colour)| surface(name, colour, 0.5, 0.2)).to_vec();
    setting.stage(palette, vec![(wall, surface("wall", [1.0; 3], 1.0, 0.0))])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn standard_size_has_the_original_count_and_sum() {
        let made = body(&Options::default()).expect("the standard size");
        let triangles: usize = made.meshes.iter().map(|m| m.triangles.len()).sum();
        assert_eq!((made.spheres.len(), triangles), (4200, 4200 * 32));
        let sum: f64 = made.spheres.iter().map(|(s, _)| f64::from(s.centre.y)).sum();
        // The sum in f64; rounding 4200 values below 20 to f32 moves it by 4e-3 at the most.
        assert!((sum - 61460.722).abs() < 4e-3, "{sum}");
    }

    #[test]
    fn joints_are_the_thirty_edges_midpoints() {
        let joints: Vec<DVec3> = rings().concat();
        for (i, p) in joints.iter().enumerate() {
            assert!((p.length() - 1.0 / (1.0 + RADIUS)).abs() < 1e-12);
            // An icosidodecahedron: the nearest of the other joints are the circumradius over the golden ratio away.
            let near = joints.iter().enumerate().filter(|(j, _)| *j != i).map(|(_, q)| p.distance(*q));
            let golden = (1.0 + 5_f64.sqrt()) / 2.0;
            let nearest = near.fold(f64::INFINITY, f64::min);
            assert!((nearest * golden * (1.0 + RADIUS) - 1.0).abs() < 1e-9, "{i} {nearest}");
        }
    }
}
