//! Balls of triangles: an icosahedron whose faces are halved along each edge, again and again.

use super::options::within;
use super::{Mesh, Options};
use crate::error::Result;
use crate::geometry::Sphere;
use glam::DVec3;
use std::collections::HashMap;

impl Options {
    /// Halvings for each sphere that is to be of triangles; `None`: spheres stay spheres.
    pub(super) fn balls(&self) -> Result<Option<u32>> {
        self.balls.map(|level| within("balls", level, 0..=7)).transpose()
    }
}

/// Triangles of a ball after `level` halvings.
pub(super) fn triangles(level: u32) -> u64 {
    20 << (2 * level)
}

/// A ball of radius 1 about the origin, inscribed, with smooth normals. `level` is at most 7 or so.
pub(super) fn unit(level: u32) -> Mesh {
    let (mut points, mut faces) = icosahedron();
    for _ in 0..level {
        let mut middles = HashMap::new();
        let mut middle = |a: u32, b: u32| {
            *middles.entry((a.min(b), a.max(b))).or_insert_with(|| {
                points.push((points[a as usize] + points[b as usize]).normalize());
                points.len() as u32 - 1
            })
        };
        let quarters = faces.iter().flat_map(|&[a, b, c]| {
            let [ab, bc, ca] = [middle(a, b), middle(b, c), middle(c, a)];
            [[a, ab, ca], [b, bc, ab], [c, ca, bc], [ab, bc, ca]]
        });
        faces = quarters.collect();
    }
    let positions: Vec<_> = points.iter().map(|p| p.as_vec3()).collect();
    Mesh { name: "ball".into(), normals: positions.clone(), positions, triangles: faces, ..Mesh::default() }
}

/// `ball`, which is [`unit`], in the place of `sphere`.
pub(super) fn placed(ball: &Mesh, sphere: &Sphere) -> Mesh {
    let place = |p: &glam::Vec3| (sphere.centre.as_dvec3() + f64::from(sphere.radius) * p.as_dvec3()).as_vec3();
    Mesh { positions: ball.positions.iter().map(place).collect(), ..ball.clone() }
}

/// Corners at distance 1 and outward faces.
fn icosahedron() -> (Vec<DVec3>, Vec<[u32; 3]>) {
    let golden = (1.0 + 5.0_f64.sqrt()) / 2.0;
    let signs = [(-1.0, -1.0), (-1.0, 1.0), (1.0, -1.0), (1.0, 1.0)];
    let turned = |p: DVec3| [p, DVec3::new(p.z, p.x, p.y), DVec3::new(p.y, p.z, p.x)];
    // Edges have length 2; the next distance between corners is more than 3.
    let corners: Vec<DVec3> = signs.iter().flat_map(|&(s, t)| turned(DVec3::new(0.0, s, t * golden))).collect();
    let joined = |i: u32, j: u32| corners[i as usize].distance(corners[j as usize]) < 2.5;
    let mut faces = Vec::new();
    for i in 0..12 {
        for j in i + 1..12 {
            for k in (j + 1..12).filter(|&k| joined(i, j) && joined(j, k) && joined(k, i)) {
                let [a, b, c] = [i, j, k].map(|n| corners[n as usize]);
                faces.push(if a.dot(b.cross(c)) > 0.0 { [i, j, k] } else { [i, k, j] });
            }
        }
    }
    (corners.iter().map(|p| p.normalize()).collect(), faces)
}
