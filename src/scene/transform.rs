//! Moves meshes: scale, rotation and translation in f64, rounded once.

use super::Mesh;
use glam::{DAffine3, DMat3, DQuat, DVec3, EulerRot, Vec3};

/// Scale, then rotation about x, y and z in this order, degrees, then translation.
pub(super) fn placement(scale: DVec3, rotate: DVec3, translate: DVec3) -> DAffine3 {
    let [x, y, z] = rotate.to_array().map(f64::to_radians);
    // `ZYX` multiplies Rz * Ry * Rx: the rotation about x comes first.
    let rotation = DQuat::from_euler(EulerRot::ZYX, z, y, x);
    DAffine3::from_scale_rotation_translation(scale, rotation, translate)
}

/// True if volumes keep a size that f64 can hold and nothing is infinite.
pub(super) fn is_regular(transform: &DAffine3) -> bool {
    let determinant = transform.matrix3.determinant();
    transform.is_finite() && determinant.is_finite() && determinant != 0.0
}

/// Moves a mesh by a regular transform. Normals follow by the inverse transpose; a mirror image swaps the winding, so
/// that front sides stay front sides.
pub(super) fn apply(mesh: &mut Mesh, transform: &DAffine3) {
    if *transform == DAffine3::IDENTITY {
        return;
    }
    for p in &mut mesh.positions {
        *p = transform.transform_point3(p.as_dvec3()).as_vec3();
    }
    let normal_matrix: DMat3 = transform.matrix3.inverse().transpose();
    for n in &mut mesh.normals {
        *n = unit(normal_matrix * n.as_dvec3());
    }
    if transform.matrix3.determinant() < 0.0 {
        mesh.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    }
}

/// Makes all normals unit vectors; a zero normal stays zero and shades flat.
pub(super) fn make_normals_unit(mesh: &mut Mesh) {
    for n in &mut mesh.normals {
        if n.is_finite() && !n.is_normalized() {
            *n = unit(n.as_dvec3());
        }
    }
}

fn unit(v: DVec3) -> Vec3 {
    v.normalize_or_zero().as_vec3()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn rotation_is_about_x_then_y_then_z() {
        // A quarter turn about x takes y to z, one about y takes z to x, one about z takes x to y.
        let turn = |x, y, z| placement(DVec3::ONE, DVec3::new(x, y, z), DVec3::ZERO);
        for (t, from, to) in [
            (turn(90.0, 0.0, 0.0), DVec3::Y, DVec3::Z),
            (turn(0.0, 90.0, 0.0), DVec3::Z, DVec3::X),
            (turn(0.0, 0.0, 90.0), DVec3::X, DVec3::Y),
            (turn(90.0, 90.0, 0.0), DVec3::Y, DVec3::X),
            (turn(90.0, 90.0, 90.0), DVec3::Y, DVec3::Y),
        ] {
            assert!((t.transform_vector3(from) - to).length() < 1e-15, "{t:?}");
        }
    }

    #[test]
    fn mirror_images_keep_their_front_side_and_normals() {
        let mut mesh = Mesh {
            positions: vec![Vec3::ZERO, Vec3::Y, Vec3::Z],
            triangles: vec![[0, 1, 2]],
            normals: vec![Vec3::X; 3],
            ..Mesh::default()
        };
        apply(&mut mesh, &placement(DVec3::new(-2.0, 1.0, 1.0), DVec3::ZERO, DVec3::X));
        let [a, b, c] = mesh.triangles[0].map(|i| mesh.positions[i as usize]);
        assert_eq!((b - a).cross(c - a).normalize(), Vec3::NEG_X);
        assert_eq!(mesh.normals[0], Vec3::NEG_X);
        assert_eq!(a, Vec3::X);
    }

    #[test]
    fn flat_or_infinite_transforms_are_not_regular() {
        assert!(is_regular(&DAffine3::IDENTITY));
        assert!(!is_regular(&placement(DVec3::new(1.0, 0.0, 1.0), DVec3::ZERO, DVec3::ZERO)));
        assert!(!is_regular(&placement(DVec3::ONE, DVec3::ZERO, DVec3::INFINITY)));
    }
}
