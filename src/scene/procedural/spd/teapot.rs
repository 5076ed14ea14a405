//! Teapot: the Utah teapot on a chessboard.

use super::super::teapot;
use super::setting::{Setting, surface};
use super::{Body, Entry, Mesh, Options, Stage};
use crate::error::Result;
use glam::Vec3;

pub(in super::super) const ENTRY: Entry = Entry {
    name: "spd-teapot",
    summary: "SPD teapot: the Utah teapot of 9120 triangles on a chessboard of 144 squares; z up",
    options: "n: size factor, steps along each edge of the patches, and squares along the board's (12)",
    slots: "all have slot 0",
    source: "Haines, SPD 3.14 teapot; Newell 1975",
    keys: &["n"],
    body,
    stage,
};

/// The pot that [`teapot::mesh`] makes, turned from y up to z up.
fn body(options: &Options) -> Result<Body> {
    let n = options.n(12, 1..=2048)?;
    let steps = u64::from(n);
    // 64 n^2 - 8 n of the pot, 2 n^2 of the board.
    options.limit_size(66 * steps * steps - 8 * steps)?;
    let mut pot = teapot::mesh(n);
    // Plus zero: no negative zeros.
    let upright = |p: &mut Vec3| *p = Vec3::new(p.x, 0.0 - p.z, p.y);
    pot.positions.iter_mut().for_each(upright);
    pot.normals.iter_mut().for_each(upright);
    Ok(Body { meshes: vec![pot], ..Body::default() })
}

/// The squares of one colour on -4..4 at z = 0: those whose column and row add up to an odd number, or an even one.
fn squares(n: u32, odd: bool) -> Mesh {
    let mut mesh = Mesh { name: if odd { "odd squares" } else { "even squares" }.into(), ..Mesh::default() };
    let place = |i: u32| (4.0 * (2.0 * f64::from(i) / f64::from(n) - 1.0)) as f32;
    for x in 0..n {
        for y in (0..n).filter(|y| ((x + y) % 2 == 1) == odd) {
            let first = mesh.positions.len() as u32;
            let corners = [(x, y), (x + 1, y), (x + 1, y + 1), (x, y + 1)];
            mesh.positions.extend(corners.map(|(x, y)| Vec3::new(place(x), place(y), 0.0)));
            mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
        }
    }
    mesh
}

fn stage(options: &Options) -> Stage {
    let setting = Setting { from: [4.86, 7.2, 5.4], lights: &[[-3.1, 9.8, 12.1], [11.3, 5.1, 8.8]], ..Setting::USUAL };
    // The body has refused a size that is out of range.
    let n = options.n(12, 1..=2048).unwrap_or(1);
    let board = [(true, "white", [1.0; 3]), (false, "grey", [0.5; 3])];
    let board = board.map(|(odd, name, colour)| (squares(n, odd), surface(name, colour, 0.5, 0.5)));
    setting.stage(vec![surface("glaze", [1.0, 0.5, 0.1], 0.75, 0.25)], board.to_vec())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ray::Aabb;

    #[test]
    fn standard_size_has_the_original_count_and_bounds() {
        let pot = &body(&Options::default()).expect("the standard size").meshes[0];
        let squares: usize = [true, false].map(|odd| squares(12, odd).triangles.len() / 2).iter().sum();
        assert_eq!((pot.triangles.len(), squares), (9120, 144));
        let bounds = Aabb::of_points(&pot.positions);
        assert_eq!((bounds.min.z, bounds.max.z), (0.0, 3.15));
        // Handle and spout: the handle ends at -3 by Bezier's convex hull, the spout beyond 3.
        assert!(bounds.min.x > -3.01 && bounds.min.x < -2.9 && bounds.max.x > 3.2 && bounds.max.x < 3.525);
    }
}
