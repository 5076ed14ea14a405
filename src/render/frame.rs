//! Directions around a normal.

use glam::DVec3;
use std::f64::consts::TAU;

/// Two unit vectors that make a right-handed orthonormal basis with the unit `normal` as the third.
///
/// Source: Duff et al. 2017, "Building an Orthonormal Basis, Revisited".
pub(super) fn tangents(normal: DVec3) -> [DVec3; 2] {
    let sign = 1f64.copysign(normal.z);
    let a = -1.0 / (sign + normal.z);
    let b = normal.x * normal.y * a;
    [
        DVec3::new(1.0 + sign * normal.x * normal.x * a, sign * b, -sign * normal.x),
        DVec3::new(b, sign + normal.y * normal.y * a, -normal.y),
    ]
}

/// The vector with components (x, y, z) along the tangents and the normal.
pub(super) fn from_local(normal: DVec3, local: DVec3) -> DVec3 {
    let [x, y] = tangents(normal);
    x * local.x + y * local.y + normal * local.z
}

/// Components along the tangents and the normal.
pub(super) fn to_local(normal: DVec3, v: DVec3) -> DVec3 {
    let [x, y] = tangents(normal);
    DVec3::new(v.dot(x), v.dot(y), v.dot(normal))
}

/// A direction around +z at `cosine` of the angle to it and `turn` of a full circle.
pub(super) fn polar(cosine: f64, turn: f64) -> DVec3 {
    let sine = ((1.0 - cosine) * (1.0 + cosine)).max(0.0).sqrt();
    let (s, c) = (turn * TAU).sin_cos();
    DVec3::new(sine * c, sine * s, cosine)
}

/// A direction around +z with density `cosine / pi`.
pub(super) fn cosine_hemisphere(u: [f64; 2]) -> DVec3 {
    polar((1.0 - u[0]).sqrt(), u[1])
}

/// A direction with equal density all around.
#[cfg(test)]
pub(super) fn uniform_sphere(u: [f64; 2]) -> DVec3 {
    polar(1.0 - 2.0 * u[0], u[1])
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn bases_are_orthonormal_and_right_handed() {
        for n in [DVec3::Z, -DVec3::Z, DVec3::X, DVec3::new(1e-9, 0.0, -1.0), DVec3::new(0.3, -0.5, 0.2)] {
            let n = n.normalize();
            let [x, y] = tangents(n);
            // A few roundings of numbers below 1.
            assert!((x.cross(y) - n).length() < 1e-15, "{n}");
            assert!(x.dot(y).abs() < 1e-15 && (x.length() - 1.0).abs() < 1e-15);
            let v = DVec3::new(0.1, -0.7, 2.0);
            assert!((from_local(n, to_local(n, v)) - v).length() < 1e-14, "{n}");
        }
    }
}
