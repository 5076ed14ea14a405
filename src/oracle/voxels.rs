//! The voxels that a ray meets, in whole numbers: no rounding anywhere.

mod path;

pub use path::{End, Path, Visit};

use crate::ray::{Aabb, Ray};
use glam::DVec3;
use num_bigint::BigInt;

/// A box cut into equal voxels by planes that are exact numbers.
///
/// A voxel holds its lower face on each axis and not its upper one, but the last voxel of an axis holds both.
#[derive(Clone, Debug)]
pub struct Voxels {
    resolution: [u32; 3],
    axes: [Axis; 3],
    /// Positions count in units of two to this power.
    exponent: i32,
}

/// Plane `k` lies at `(base + k step) / over`; `step` and `over` are above zero.
#[derive(Clone, Debug)]
struct Axis {
    base: BigInt,
    step: BigInt,
    over: BigInt,
}

impl Voxels {
    /// Plane `k` of an axis lies at `min + k (max - min) / n`, for `k` from 0 to the axis's resolution `n`.
    ///
    /// The corners are finite, world units, `min` is below `max` along each axis, and no resolution is 0; else paths mean nothing.
    pub fn of_box(bounds: &Aabb, resolution: [u32; 3]) -> Self {
        let corners = [bounds.min, bounds.max].map(|v| v.to_array().map(f64::from));
        let exponent = least_exponent(corners.as_flattened().iter().copied());
        let axes = [0, 1, 2].map(|a| {
            let [min, max] = corners.map(|corner| scaled(corner[a], exponent));
            Axis { base: &min * resolution[a], step: max - min, over: resolution[a].into() }
        });
        Self { resolution, axes, exponent }
    }

    /// Plane `k` of an axis lies at `lo + k / inverse`.
    ///
    /// Both are finite, `inverse` is above zero along each axis, and no resolution is 0; else paths mean nothing.
    pub fn of_map(lo: DVec3, inverse: DVec3, resolution: [u32; 3]) -> Self {
        let parts = [0, 1, 2].map(|a| (split(lo[a]), split(inverse[a])));
        let exponent = parts.iter().map(|((m, e), (_, down))| if *m == 0 { -down } else { (*e).min(-down) }).min();
        let exponent = exponent.unwrap_or(0);
        let axes = parts.map(|((m, e), (over, down))| Axis {
            base: if m == 0 { BigInt::ZERO } else { (BigInt::from(m) << (e - exponent)) * over },
            step: BigInt::from(1) << (-down - exponent),
            over: over.into(),
        });
        Self { resolution, axes, exponent }
    }

    /// Where `ray` passes; `None` if it is none, as [`Ray::intake`] has it, or does not meet the closed box within its range.
    pub fn path(&self, ray: &Ray) -> Option<Path> {
        Path::new(self, ray)
    }
}

/// `x = m * 2^e` with an odd `m`, or 0 and 0. `x` is finite.
fn split(x: f64) -> (i64, i32) {
    if x == 0.0 {
        return (0, 0);
    }
    let bits = x.to_bits();
    let (field, fraction) = ((bits >> 52 & 0x7ff) as i32, (bits & ((1 << 52) - 1)) as i64);
    let (mantissa, exponent) = if field == 0 { (fraction, -1074) } else { (fraction | 1 << 52, field - 1075) };
    let zeros = mantissa.trailing_zeros();
    let odd = mantissa >> zeros;
    (if x < 0.0 { -odd } else { odd }, exponent + zeros as i32)
}

/// `x / 2^exponent`, a whole number.
fn scaled(x: f64, exponent: i32) -> BigInt {
    let (mantissa, e) = split(x);
    if mantissa == 0 { BigInt::ZERO } else { BigInt::from(mantissa) << (e - exponent) }
}

/// The least exponent of finite numbers other than zero; 0 if there is none.
fn least_exponent(values: impl IntoIterator<Item = f64>) -> i32 {
    values.into_iter().filter(|x| *x != 0.0).map(|x| split(x).1).min().unwrap_or(0)
}

fn abs(x: BigInt) -> BigInt {
    if x < BigInt::ZERO { -x } else { x }
}

#[cfg(test)]
mod tests;
