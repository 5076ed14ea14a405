//! Cones and cylinders as triangles.

use super::super::patch::{Edge, patch};
use super::{Mesh, Options};
use crate::error::Result;
use glam::DVec3;
use std::f64::consts::TAU;

/// Sides of a cone or cylinder unless told otherwise, as in SPD's tessellated output.
const SIDES: u64 = 16;

/// A disc of a tube's axis.
#[derive(Clone, Copy)]
pub(super) struct End {
    pub centre: DVec3,
    pub radius: f64,
}

impl Options {
    /// Sides of each cone and cylinder.
    pub(super) fn sides(&self) -> Result<u32> {
        super::super::options::within("sides", self.sides.unwrap_or(SIDES), 3..=256)
    }
}

/// The open surface between two discs that lie apart: `2 * sides` triangles with corners on the surface, smooth normals,
/// fronts outwards.
pub(super) fn tube(base: End, apex: End, sides: u32) -> Mesh {
    let span = apex.centre - base.centre;
    let axis = span.normalize();
    let side = axis.any_orthonormal_vector();
    let up = axis.cross(side);
    // The normal leans to the thinner end.
    let lean = (base.radius - apex.radius) / span.length() * axis;
    patch("", (sides, Edge::Closed), (1, Edge::Open), |u, v| {
        let (sin, cos) = (TAU * u).sin_cos();
        let out = cos * side + sin * up;
        let end = if v == 0.0 { base } else { apex };
        (end.centre + end.radius * out, out + lean)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn corners_and_normals_lie_on_the_cone() {
        let base = End { centre: DVec3::new(1.0, 2.0, 3.0), radius: 0.5 };
        let apex = End { centre: DVec3::new(-1.0, 4.0, 2.0), radius: 0.25 };
        let mesh = tube(base, apex, 16);
        assert_eq!((mesh.positions.len(), mesh.triangles.len()), (32, 32));
        let axis = DVec3::new(-2.0, 2.0, -1.0) / 3.0;
        // The half angle's tangent is 0.25 / 3.
        let lean = (0.25_f64 / 3.0).atan().sin();
        for (p, n) in mesh.positions.iter().zip(&mesh.normals) {
            let from_base = p.as_dvec3() - base.centre;
            let along = from_base.dot(axis);
            let radius = (from_base - along * axis).length();
            assert!((radius - (0.5 - 0.25 * along / 3.0)).abs() < 1e-6, "{along} {radius}");
            assert!((n.as_dvec3().dot(axis) - lean).abs() < 1e-6);
        }
        for t in &mesh.triangles {
            let [a, b, c] = t.map(|i| mesh.positions[i as usize]);
            let front = (b - a).cross(c - a);
            assert!(t.iter().all(|&i| mesh.normals[i as usize].dot(front) > 0.0));
        }
    }
}
