//! Jacks: three crossed bars with balls at their ends, and smaller copies in the eight corners between them.

use super::super::patch::append;
use super::setting::{Setting, surface};
use super::tube::{End, tube};
use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::Result;
use crate::geometry::Sphere;
use glam::{DQuat, DVec3, Vec3};

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-jacks",
    summary: "SPD jacks: crossed bars with balls at their ends, eight smaller ones between them",
    options: "n: size factor, levels (1: 6 spheres and 3 cylinders; 3: 438 and 219); sides of a cylinder (16)",
    slots: "all have slot 0",
    source: "Enzmann, SPD 3.14 jacks",
    keys: &["n", "sides"],
    body,
    stage,
};

/// Share of its frame that a jack fills.
const FILL: f64 = 0.75;

fn body(options: &Options) -> Result<Body> {
    let (n, sides) = (options.n(1, 1..=16)?, options.sides()?);
    let jacks = (8_u64.pow(n) - 1) / 7;
    options.limit_size(jacks * (6 + 3 * 2 * u64::from(sides)))?;
    let turn = DQuat::from_rotation_x((-30_f64).to_radians()) * DQuat::from_rotation_y((-20_f64).to_radians());
    let mut bars = Mesh { name: "bars".into(), ..Mesh::default() };
    let mut spheres = Vec::new();
    // Frames of a level: centre and half size.
    let mut level = vec![(DVec3::ZERO, 1.0)];
    for depth in 0..n {
        for &(centre, size) in &level {
            for axis in [DVec3::X, DVec3::Y, DVec3::Z] {
                let [base, apex] = [-FILL, FILL].map(|along| turn * (centre + along * size * axis));
                let end = |centre| End { centre, radius: 0.1 * FILL * size };
                append(&mut bars, tube(end(base), end(apex), sides));
                let ball = |centre: DVec3| Sphere { centre: centre.as_vec3(), radius: (0.2 * FILL * size) as f32 };
                spheres.extend([(ball(base), 0), (ball(apex), 0)]);
            }
        }
        if depth + 1 < n {
            level = level.iter().flat_map(|&frame| eighths(frame)).collect();
        }
    }
    Ok(Body { meshes: vec![bars], spheres, ..Body::default() })
}

/// The frames of half the size in the corners.
fn eighths((centre, size): (DVec3, f64)) -> impl Iterator<Item = (DVec3, f64)> {
    let sides = [-0.5, 0.5];
    let corners = sides
        .into_iter()
        .flat_map(move |x| sides.into_iter().flat_map(move |y| sides.into_iter().map(move |z| DVec3::new(x, y, z))));
    corners.map(move |corner| (centre + size * corner, size / 2.0))
}

fn stage(_: &Options) -> Stage {
    let setting = Setting {
        from: [0.0, 0.0, -8.0],
        up: [0.0, 1.0, 0.0],
        angle: 25.0,
        lights: &[[-10.0, 3.0, -20.0]],
        background: Vec3::new(0.2, 0.05, 0.2),
        size: 256,
        ..Setting::USUAL
    };
    setting.stage(vec![surface("pink", [0.737, 0.561, 0.561], 0.7, 0.7)], Vec::new())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn counts_are_the_original_ones() {
        for (n, spheres, cylinders) in [(1, 6, 3), (2, 54, 27), (3, 438, 219)] {
            let made = body(&Options { n: Some(n), ..Options::default() }).expect("a usual size");
            assert_eq!((made.spheres.len(), made.meshes[0].triangles.len()), (spheres, cylinders * 32));
            // The largest balls touch the sphere of radius 0.75 + 0.15, and nothing is outside the cube around it.
            let far = made.spheres.iter().map(|(s, _)| s.centre.length() + s.radius).fold(0.0, f32::max);
            assert!(n > 1 || (far - 0.9).abs() < 1e-6, "{far}");
        }
    }

    #[test]
    fn the_whole_is_turned_about_y_then_x() {
        let spheres = body(&Options::default()).expect("the standard size").spheres;
        // The end of the y bar is not moved by the turn about y; that about x by -30 degrees takes y to (0, cos, -sin).
        let (sin, cos) = 30_f32.to_radians().sin_cos();
        assert!((spheres[3].0.centre - 0.75 * Vec3::new(0.0, cos, -sin)).length() < 1e-6);
        // The end of the x bar goes by -20 degrees about y to (cos 20, 0, sin 20), and on.
        let (s, c) = 20_f32.to_radians().sin_cos();
        assert!((spheres[1].0.centre - 0.75 * Vec3::new(c, sin * s, cos * s)).length() < 1e-6);
    }
}
