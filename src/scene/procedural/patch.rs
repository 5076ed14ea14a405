//! Meshes over a rectangle of parameters.

use super::Mesh;
use glam::DVec3;

/// Whether the last row of samples is the first one again.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(in crate::scene) enum Edge {
    Open,
    Closed,
}

/// Number of cells along a parameter, and whether it closes.
pub(in crate::scene) type Steps = (u32, Edge);

/// Samples `point(u, v)`, u and v from 0 to 1, and joins the samples by two triangles for each cell, counter-clockwise
/// where u runs right and v up. `point` gives the position and any normal that is not zero; a zero normal shades flat.
pub(in crate::scene) fn patch(name: &str, u: Steps, v: Steps, point: impl Fn(f64, f64) -> (DVec3, DVec3)) -> Mesh {
    // A closed parameter reuses its first samples, so that no gap can open.
    let samples = |(n, edge): Steps| n + u32::from(edge == Edge::Open);
    let (columns, rows) = (samples(u), samples(v));
    let mut mesh = Mesh { name: name.into(), ..Mesh::default() };
    for j in 0..rows {
        for i in 0..columns {
            let (position, normal) = point(f64::from(i) / f64::from(u.0), f64::from(j) / f64::from(v.0));
            mesh.positions.push(position.as_vec3());
            mesh.normals.push(normal.normalize_or_zero().as_vec3());
        }
    }
    let index = |i: u32, j: u32| (j % rows) * columns + i % columns;
    for j in 0..v.0 {
        for i in 0..u.0 {
            let [a, b, c, d] = [index(i, j), index(i + 1, j), index(i + 1, j + 1), index(i, j + 1)];
            mesh.triangles.extend([[a, b, c], [a, c, d]]);
        }
    }
    mesh
}

/// Adds `other` to `mesh`; both have normals, or neither has.
pub(super) fn append(mesh: &mut Mesh, other: Mesh) {
    let first = mesh.positions.len() as u32;
    mesh.positions.extend(other.positions);
    mesh.normals.extend(other.normals);
    mesh.triangles.extend(other.triangles.iter().map(|t| t.map(|i| i + first)));
}
