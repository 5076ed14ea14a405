//! Affine transformations of instances in the forms that Embree takes them.

use crate::device::Fault;
use crate::types::format;
use glam::{DAffine3, DMat3, DQuat, DVec3};
use skipgrid::Aabb;

/// Reads a matrix.
///
/// # Errors
/// The format is none of the four that Embree knows.
///
/// # Safety
/// `numbers` points to as many f32 as the format has.
pub unsafe fn read(numbers: *const f32, layout: u32) -> Result<DAffine3, Fault> {
    // Where row `r` of column `c` stands.
    let place: fn(usize, usize) -> usize = match layout {
        format::FLOAT3X4_ROW_MAJOR | format::FLOAT4X4_ROW_MAJOR => |r, c| 4 * r + c,
        format::FLOAT3X4_COLUMN_MAJOR => |r, c| 3 * c + r,
        format::FLOAT4X4_COLUMN_MAJOR => |r, c| 4 * c + r,
        _ => return Err(Fault::operation(format!("{layout:#x} is no format of a transformation"))),
    };
    let number = |r: usize, c: usize| {
        // SAFETY: as the caller promises.
        f64::from(unsafe { numbers.add(place(r, c)).read_unaligned() })
    };
    let column = |c: usize| DVec3::new(number(0, c), number(1, c), number(2, c));
    Ok(DAffine3 { matrix3: DMat3::from_cols(column(0), column(1), column(2)), translation: column(3) })
}

/// Writes a matrix.
///
/// # Errors
/// The format is none of the four that Embree knows.
///
/// # Safety
/// `numbers` points to room for as many f32 as the format has.
pub unsafe fn write(transform: &DAffine3, numbers: *mut f32, layout: u32) -> Result<(), Fault> {
    let (rows, by_column) = match layout {
        format::FLOAT3X4_ROW_MAJOR => (3, false),
        format::FLOAT4X4_ROW_MAJOR => (4, false),
        format::FLOAT3X4_COLUMN_MAJOR => (3, true),
        format::FLOAT4X4_COLUMN_MAJOR => (4, true),
        _ => return Err(Fault::operation(format!("{layout:#x} is no format of a transformation"))),
    };
    let m = transform.matrix3;
    let columns = [m.x_axis, m.y_axis, m.z_axis, transform.translation];
    for (c, column) in columns.iter().enumerate() {
        for r in 0..rows {
            let value = if r < 3 { column[r] as f32 } else { f32::from(u8::from(c == 3)) };
            let place = if by_column { rows * c + r } else { 4 * r + c };
            // SAFETY: as the caller promises.
            unsafe { numbers.add(place).write_unaligned(value) };
        }
    }
    Ok(())
}

/// `RTCQuaternionDecomposition`: a translation after a rotation after an upper triangular matrix with a shift.
#[derive(Clone, Copy, Debug)]
#[repr(C, align(16))]
pub struct Decomposition {
    /// Along the axes.
    pub scale: [f32; 3],
    /// xy, xz, yz.
    pub skew: [f32; 3],
    /// Before the rotation.
    pub shift: [f32; 3],
    /// Real part first.
    pub quaternion: [f32; 4],
    /// After the rotation.
    pub translation: [f32; 3],
}

impl Decomposition {
    /// The matrix that it stands for.
    pub fn matrix(&self) -> DAffine3 {
        let [[sx, sy, sz], [xy, xz, yz], shift, translation] =
            [self.scale, self.skew, self.shift, self.translation].map(|v| v.map(f64::from));
        let inner = DAffine3 {
            matrix3: DMat3::from_cols(DVec3::new(sx, 0.0, 0.0), DVec3::new(xy, sy, 0.0), DVec3::new(xz, yz, sz)),
            translation: DVec3::from_array(shift),
        };
        let [r, i, j, k] = self.quaternion.map(f64::from);
        let rotation = DAffine3::from_quat(DQuat::from_xyzw(i, j, k, r).normalize());
        DAffine3::from_translation(DVec3::from_array(translation)) * rotation * inner
    }
}

/// A box around the image of a box, a little wider, so that rounding the ray into the instance's space cannot leave it.
///
/// The ray is transformed in f64 and rounded to f32, so that it is off by 2^-24 of its coordinates there; 2^-20 of the largest
/// coordinate of the box is enough for origins up to eight times as far, beyond which f32 cannot place a hit more sharply anyway.
pub fn image(transform: &DAffine3, aabb: &Aabb) -> Aabb {
    if aabb.is_empty() {
        return Aabb::EMPTY;
    }
    let ends = [aabb.min.as_dvec3(), aabb.max.as_dvec3()];
    let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for corner in 0..8 {
        let pick = |axis: usize| ends[(corner >> axis) & 1][axis];
        let point = transform.transform_point3(DVec3::new(pick(0), pick(1), pick(2)));
        (min, max) = (min.min(point), max.max(point));
    }
    let pad = min.abs().max(max.abs()).max_element() * 2f64.powi(-20);
    let found = Aabb { min: (min - pad).as_vec3(), max: (max + pad).as_vec3() };
    if found.min.is_finite() && found.max.is_finite() { found } else { Aabb::EMPTY }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_layout_comes_back_as_it_went() {
        let transform = DAffine3::from_cols_array(&std::array::from_fn(|i| 1.0 + i as f64));
        for layout in [
            format::FLOAT3X4_ROW_MAJOR,
            format::FLOAT4X4_ROW_MAJOR,
            format::FLOAT3X4_COLUMN_MAJOR,
            format::FLOAT4X4_COLUMN_MAJOR,
        ] {
            let mut numbers = [f32::NAN; 16];
            // SAFETY: sixteen are the most that any format has.
            let back = unsafe {
                write(&transform, numbers.as_mut_ptr(), layout).unwrap();
                read(numbers.as_ptr(), layout).unwrap()
            };
            assert_eq!(back, transform, "{layout:#x}");
        }
        // The first row of a row-major matrix.
        let mut numbers = [0f32; 16];
        // SAFETY: as above.
        unsafe { write(&transform, numbers.as_mut_ptr(), format::FLOAT3X4_ROW_MAJOR).unwrap() };
        assert_eq!(numbers[..4], [1.0, 4.0, 7.0, 10.0]);
        // SAFETY: nothing is read in an unknown format.
        assert!(unsafe { read(numbers.as_ptr(), format::FLOAT3) }.is_err());
    }

    #[test]
    fn images_of_boxes_hold_the_images_of_their_corners() {
        let transform = DAffine3::from_rotation_z(0.5) * DAffine3::from_translation(DVec3::new(10.0, 0.0, -3.0));
        let aabb = Aabb { min: glam::Vec3::ZERO, max: glam::Vec3::ONE };
        let found = image(&transform, &aabb);
        let corner = transform.transform_point3(DVec3::new(1.0, 0.0, 1.0)).as_vec3();
        assert!(found.min.cmplt(corner).all() && found.max.cmpgt(corner).all(), "{found:?} {corner}");
        assert!(image(&transform, &Aabb::EMPTY).is_empty());
    }
}
