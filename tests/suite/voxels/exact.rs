//! The voxel sequence in whole numbers: no rounding anywhere, and another algorithm than the library's.
//!
//! All crossings of a ray with the planes between voxels are listed as fractions over one common denominator, sorted, and
//! walked through from the voxel that holds the first point.

use num_bigint::BigInt;
use skipgrid::grid::{Face, VoxelGrid};
use skipgrid::{Aabb, Ray};

/// A visited voxel. The parameters are numerators over [`Sequence::denominator`].
pub struct Visit {
    pub voxel: [u32; 3],
    pub entry: BigInt,
    pub exit: BigInt,
    pub face: Option<Face>,
}

pub struct Sequence {
    pub visits: Vec<Visit>,
    /// Above zero.
    pub denominator: BigInt,
    /// Fractions count in units of two to this power.
    pub exponent: i64,
}

/// `x = m * 2^e` with a whole `m`; `e` is no larger than it must be, and that of 0 is left out.
fn parts(x: f64) -> Option<(i64, i64)> {
    assert!(x.is_finite());
    if x == 0.0 {
        return None;
    }
    let bits = x.to_bits();
    let (sign, field) = (if x < 0.0 { -1 } else { 1 }, (bits >> 52 & 0x7ff) as i64);
    assert!(field > 0, "no value here is that small");
    let mantissa = (bits & ((1 << 52) - 1) | 1 << 52) as i64;
    let zeros = i64::from(mantissa.trailing_zeros());
    Some((sign * (mantissa >> zeros), field - 1075 + zeros))
}

/// `x / 2^exponent`, a whole number.
fn whole(x: f64, exponent: i64) -> BigInt {
    parts(x)
        .map_or(BigInt::ZERO, |(m, e)| BigInt::from(m) << usize::try_from(e - exponent).expect("the least exponent"))
}

fn least_exponent(values: impl IntoIterator<Item = f32>) -> i64 {
    values.into_iter().filter_map(|x| parts(f64::from(x))).map(|(_, e)| e).min().unwrap_or(0)
}

fn abs(x: BigInt) -> BigInt {
    if x < BigInt::ZERO { -x } else { x }
}

/// The voxels of `ray`, a ray that is one: `VoxelGrid::voxels` says which.
pub fn sequence(grid: &VoxelGrid, ray: &Ray) -> Sequence {
    let Aabb { min, max } = grid.bounds();
    let n = grid.resolution();
    let range = [ray.t_min, ray.t_max];
    let direction_exponent = least_exponent(ray.direction.to_array());
    // Positions are so fine that the ends of the range are whole numbers, too, where they are finite.
    let of_positions = least_exponent([min, max, ray.origin].iter().flat_map(|v| v.to_array()));
    let of_range = least_exponent(range.into_iter().filter(|t| t.is_finite()));
    let position_exponent = of_positions.min(of_range + direction_exponent);
    let exponent = position_exponent - direction_exponent;
    let position = |x: f32| whole(f64::from(x), position_exponent);
    let d = ray.direction.to_array().map(|x| whole(f64::from(x), direction_exponent));
    let zero = BigInt::ZERO;
    let moving: Vec<usize> = (0..3).filter(|&a| d[a] != zero).collect();
    let denominators: Vec<BigInt> = (0..3).map(|a| abs(d[a].clone()) * n[a]).collect();
    let product = |without: Option<usize>| {
        moving.iter().filter(|&&a| Some(a) != without).fold(BigInt::from(1), |p, &a| p * &denominators[a])
    };
    let denominator = product(None);
    let empty = |denominator| Sequence { visits: Vec::new(), denominator, exponent };
    // The numerator of the crossing with plane k of axis a.
    let crossing = |a: usize, k: u32| {
        let gap = position(min[a]) * (n[a] - k) + position(max[a]) * k - position(ray.origin[a]) * n[a];
        let t = gap * product(Some(a));
        if d[a] > zero { t } else { -t }
    };
    // The latest of the entries and the earliest of the exits; lower axes last among equals.
    let end_of = |t: f32| t.is_finite().then(|| whole(f64::from(t), exponent) * &denominator);
    if ray.t_min == f32::INFINITY || ray.t_max == f32::NEG_INFINITY {
        return empty(denominator);
    }
    let mut start: Option<(BigInt, Option<usize>)> = end_of(ray.t_min).map(|t| (t, None));
    let mut end = end_of(ray.t_max);
    for a in (0..3).rev() {
        if d[a] == zero {
            if ray.origin[a] < min[a] || ray.origin[a] > max[a] {
                return empty(denominator);
            }
            continue;
        }
        let (near, far) = if d[a] > zero { (0, n[a]) } else { (n[a], 0) };
        let (near, far) = (crossing(a, near), crossing(a, far));
        let later = match &start {
            None => true,
            Some((t, None)) => near > *t,
            Some((t, Some(_))) => near >= *t,
        };
        if later {
            start = Some((near, Some(a)));
        }
        if end.as_ref().is_none_or(|t| far < *t) {
            end = Some(far);
        }
    }
    let (start, entered) = start.expect("a ray moves along some axis");
    let end = end.expect("a ray moves along some axis");
    if start > end {
        return empty(denominator);
    }
    // The voxel that holds the first point: o + t d as a fraction of the box, times n, rounded down.
    let mut voxel = [0, 1, 2].map(|a| {
        let inside = (position(ray.origin[a]) - position(min[a])) * &denominator + &start * &d[a];
        let of_box = (position(max[a]) - position(min[a])) * &denominator;
        assert!(inside >= zero && inside <= of_box, "the first point lies in the box");
        let index = u32::try_from(inside * n[a] / of_box).expect("at most n");
        index.min(n[a] - 1)
    });
    // Planes between voxels from the first voxel on, in the order of their crossings; z before y before x among equals.
    let mut crossings: Vec<(BigInt, usize)> = Vec::new();
    for a in (0..3).rev().filter(|a| moving.contains(a)) {
        let step = abs(position(max[a]) - position(min[a])) * product(Some(a));
        let planes = if d[a] > zero { n[a] - 1 - voxel[a] } else { voxel[a] };
        let mut t = crossing(a, if d[a] > zero { voxel[a] + 1 } else { voxel[a] });
        for _ in 0..planes {
            if t > end {
                break;
            }
            assert!(t >= start);
            crossings.push((t.clone(), a));
            t += &step;
        }
    }
    crossings.sort_by(|x, y| x.0.cmp(&y.0).then(y.1.cmp(&x.1)));
    let face = |a: usize| match (a, d[a] > zero) {
        (0, true) => Face::NegX,
        (0, false) => Face::PosX,
        (1, true) => Face::NegY,
        (1, false) => Face::PosY,
        (_, true) => Face::NegZ,
        (_, false) => Face::PosZ,
    };
    let mut visits = Vec::new();
    let (mut entry, mut through) = (start, entered.map(face));
    for (t, a) in crossings {
        visits.push(Visit { voxel, entry, exit: t.clone(), face: through });
        if d[a] > zero {
            voxel[a] += 1;
        } else {
            voxel[a] -= 1;
        }
        (entry, through) = (t, Some(face(a)));
    }
    visits.push(Visit { voxel, entry, exit: end, face: through });
    Sequence { visits, denominator, exponent }
}

impl Sequence {
    /// Whether `x` is within 2^-52 (1 + 2^-48) of the fraction with this numerator, relative.
    pub fn is_close(&self, x: f64, numerator: &BigInt) -> bool {
        let Some((m, e)) = parts(x) else { return *numerator == BigInt::ZERO };
        let (mut ours, mut exact) = (BigInt::from(m) * &self.denominator, numerator.clone());
        let shift = e - self.exponent;
        if shift > 0 {
            ours <<= shift as usize
        } else {
            exact <<= -shift as usize
        }
        let error = abs(ours - &exact);
        error << 100usize <= abs(exact) * ((1u64 << 48) + 1)
    }
}
