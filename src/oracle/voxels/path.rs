//! The way of one ray through voxels, all of it in whole numbers.
//!
//! All crossings of the ray with the planes between voxels are listed as fractions over one common denominator, sorted, and
//! walked through from the voxel that holds the first point.

use super::{Axis, Voxels, abs, least_exponent, scaled, split};
use crate::oracle::surd::Surd;
use crate::ray::Ray;
use num_bigint::BigInt;
use std::cmp::Ordering;

/// The way of a ray through voxels.
#[derive(Clone, Debug)]
pub struct Path {
    resolution: [u32; 3],
    /// In units of the position.
    axes: [Axis; 3],
    origin: [BigInt; 3],
    /// In units of the direction.
    direction: [BigInt; 3],
    /// Of all parameters, above zero.
    denominator: BigInt,
    /// Parameters count in units of two to this power.
    exponent: i32,
    shared: [bool; 3],
    start: BigInt,
    end: BigInt,
    visits: Vec<Visit>,
}

/// A voxel on the way.
#[derive(Clone, Debug)]
pub struct Visit {
    /// Index along x, y and z, from 0.
    pub voxel: [u32; 3],
    /// The axis whose plane the ray crosses into the voxel; `None` if it starts here.
    pub axis: Option<usize>,
    /// Numerators over the path's denominator.
    entry: BigInt,
    exit: BigInt,
}

impl Visit {
    /// True if the ray meets the voxel in a point alone.
    pub fn is_touch(&self) -> bool {
        self.entry == self.exit
    }
}

/// An end of a visit.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum End {
    /// Where the ray enters.
    Entry,
    /// Where it leaves.
    Exit,
}

impl Path {
    pub(super) fn new(voxels: &Voxels, ray: &Ray) -> Option<Self> {
        let Ray { origin, direction, t_min, t_max } = *ray;
        let finite = origin.to_array().into_iter().chain(direction.to_array()).all(f32::is_finite);
        // The comparison is false for NaN.
        let in_order = t_min <= t_max && t_min != f32::INFINITY && t_max != f32::NEG_INFINITY;
        if !finite || !in_order || direction.to_array() == [0.0; 3] {
            return None;
        }
        let n = voxels.resolution;
        let range = [t_min, t_max].map(f64::from);
        let [o, d] = [origin, direction].map(|v| v.to_array().map(f64::from));
        let direction_exponent = least_exponent(d);
        // Positions are so fine that the ends of the range are whole numbers, too, where they are finite.
        let of_range = least_exponent(range.into_iter().filter(|t| t.is_finite()));
        let position_exponent = voxels.exponent.min(least_exponent(o)).min(of_range.saturating_add(direction_exponent));
        let exponent = position_exponent - direction_exponent;
        let finer = voxels.exponent - position_exponent;
        let axes = voxels.axes.clone().map(|axis| Axis { base: axis.base << finer, step: axis.step << finer, ..axis });
        let origin = o.map(|x| scaled(x, position_exponent));
        let direction = d.map(|x| scaled(x, direction_exponent));
        let zero = BigInt::ZERO;
        let moving: Vec<usize> = (0..3).filter(|&a| direction[a] != zero).collect();
        let parts = [0, 1, 2].map(|a| abs(direction[a].clone()) * &axes[a].over);
        let product = |without: Option<usize>| {
            moving.iter().filter(|&&a| Some(a) != without).fold(BigInt::from(1), |p, &a| p * &parts[a])
        };
        let mut path = Self {
            resolution: n,
            denominator: product(None),
            exponent,
            shared: [false; 3],
            start: BigInt::ZERO,
            end: BigInt::ZERO,
            visits: Vec::new(),
            axes,
            origin,
            direction,
        };
        let others = [0, 1, 2].map(|a| product(Some(a)));
        path.clip(range, &others)?;
        Some(path)
    }

    /// Finds the ends, then all voxels between them.
    fn clip(&mut self, range: [f64; 2], others: &[BigInt; 3]) -> Option<()> {
        let zero = BigInt::ZERO;
        let end_of = |t: f64| t.is_finite().then(|| scaled(t, self.exponent) * &self.denominator);
        // The latest of the entries and the earliest of the exits; lower axes last among equals.
        let mut start: Option<(BigInt, Option<usize>)> = end_of(range[0]).map(|t| (t, None));
        let mut end = end_of(range[1]);
        for a in (0..3).rev() {
            let n = self.resolution[a];
            if self.direction[a] == zero {
                if self.beyond(a, 0).is_lt() || self.beyond(a, n).is_gt() {
                    return None;
                }
                continue;
            }
            let (near, far) = if self.direction[a] > zero { (0, n) } else { (n, 0) };
            let (near, far) = (self.crossing(a, near, others), self.crossing(a, far, others));
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
        // A ray moves along some axis, so both are known.
        let ((start, entered), end) = (start?, end?);
        if start > end {
            return None;
        }
        (self.start, self.end) = (start, end);
        self.walk(entered, others);
        Some(())
    }

    /// Lists the voxels from the one that holds the first point.
    fn walk(&mut self, entered: Option<usize>, others: &[BigInt; 3]) {
        let zero = BigInt::ZERO;
        let mut voxel = [0, 1, 2].map(|a| {
            let (position, unit) = self.local(a, &self.start, &self.denominator);
            let index = &position / &unit;
            // In its lower face lies a ray that does not move along the axis; what is below has as much of it.
            let on_plane = &index * &unit == position;
            let Ok(index) = u32::try_from(index) else { unreachable!("the first point lies in the box") };
            let inside = index > 0 && index < self.resolution[a];
            self.shared[a] = inside && on_plane && self.direction[a] == zero;
            index.min(self.resolution[a] - 1)
        });
        // Planes between voxels from the first voxel on, in the order of their crossings; z before y before x among equals.
        let mut crossings: Vec<(BigInt, usize)> = Vec::new();
        for a in (0..3).rev().filter(|&a| self.direction[a] != zero) {
            let up = self.direction[a] > zero;
            let step = &self.axes[a].step * &others[a];
            let planes = if up { self.resolution[a] - 1 - voxel[a] } else { voxel[a] };
            let mut t = self.crossing(a, if up { voxel[a] + 1 } else { voxel[a] }, others);
            for _ in 0..planes {
                if t > self.end {
                    break;
                }
                crossings.push((t.clone(), a));
                t += &step;
            }
        }
        crossings.sort_by(|x, y| x.0.cmp(&y.0).then(y.1.cmp(&x.1)));
        let (mut entry, mut axis) = (self.start.clone(), entered);
        for (t, a) in crossings {
            self.visits.push(Visit { voxel, entry, exit: t.clone(), axis });
            if self.direction[a] > zero {
                voxel[a] += 1;
            } else {
                voxel[a] -= 1;
            }
            (entry, axis) = (t, Some(a));
        }
        self.visits.push(Visit { voxel, entry, exit: self.end.clone(), axis });
    }

    /// The numerator of the crossing with plane `k` of an axis along which the ray moves.
    fn crossing(&self, a: usize, k: u32, others: &[BigInt; 3]) -> BigInt {
        let Axis { base, step, over } = &self.axes[a];
        let t = (base + step * k - &self.origin[a] * over) * &others[a];
        if self.direction[a] > BigInt::ZERO { t } else { -t }
    }

    /// Where the origin lies by plane `k`.
    fn beyond(&self, a: usize, k: u32) -> Ordering {
        let Axis { base, step, over } = &self.axes[a];
        (&self.origin[a] * over).cmp(&(base + step * k))
    }

    /// The ray at `numerator / denominator`, in voxels from plane 0 of an axis: a fraction, its denominator above zero.
    fn local(&self, a: usize, numerator: &BigInt, denominator: &BigInt) -> (BigInt, BigInt) {
        let Axis { base, step, over } = &self.axes[a];
        let position = &self.origin[a] * denominator + numerator * &self.direction[a];
        (position * over - base * denominator, step * denominator)
    }

    /// A finite parameter as a fraction in the path's units.
    fn fraction(&self, t: f64) -> (BigInt, BigInt) {
        let (mantissa, exponent) = split(t);
        let (m, shift) = (BigInt::from(mantissa), exponent - self.exponent);
        if mantissa == 0 {
            (m, 1.into())
        } else if shift >= 0 {
            (m << shift, 1.into())
        } else {
            (m, BigInt::from(1) << -shift)
        }
    }

    /// The voxels in order, at least one.
    ///
    /// From the voxel that holds the first point every plane between voxels is crossed that the ray meets up to its last
    /// point in the box, that point included. Planes met at the same parameter are crossed one after the other, z before y
    /// before x, so a voxel may be met in a point alone. Where [`Path::shared`] says so, voxels beside these have the same
    /// part of the ray; no other voxel has a part of it that is longer than a point.
    pub fn visits(&self) -> &[Visit] {
        &self.visits
    }

    /// Voxels along x, y and z.
    pub fn resolution(&self) -> [u32; 3] {
        self.resolution
    }

    /// The axes along which the ray does not move and lies in a plane between voxels: the lower face of all that are visited,
    /// the upper one of those below.
    pub fn shared(&self) -> [bool; 3] {
        self.shared
    }

    /// The parameter of an end, the nearest f64.
    pub fn parameter(&self, visit: &Visit, end: End) -> f64 {
        Surd::ratio(self.numerator(visit, end).clone(), self.denominator.clone(), self.exponent).to_f64()
    }

    /// How far the finite `t` is from the parameter of an end, relative to that; 0 only if it is equal.
    pub fn relative_error(&self, visit: &Visit, end: End, t: f64) -> f64 {
        let exact = self.numerator(visit, end);
        let (n, d) = self.fraction(t);
        let difference = abs(n * &self.denominator - exact * &d);
        match (difference == BigInt::ZERO, *exact == BigInt::ZERO) {
            (true, _) => 0.0,
            (false, true) => f64::INFINITY,
            (false, false) => Surd::ratio(difference, abs(exact * d), 0).to_f64(),
        }
    }

    fn numerator<'a>(&self, visit: &'a Visit, end: End) -> &'a BigInt {
        match end {
            End::Entry => &visit.entry,
            End::Exit => &visit.exit,
        }
    }

    /// The length of a visit along the axis on which the ray crosses most voxels, in voxels.
    pub fn chord(&self, visit: &Visit) -> f64 {
        self.voxels_between(&visit.entry, &visit.exit)
    }

    /// The length of the whole path, as [`Path::chord`] measures it.
    pub fn length(&self) -> f64 {
        self.voxels_between(&self.start, &self.end)
    }

    fn voxels_between(&self, from: &BigInt, to: &BigInt) -> f64 {
        let along = |a: usize| {
            let moved = (to - from) * abs(self.direction[a].clone()) * &self.axes[a].over;
            Surd::ratio(moved, &self.axes[a].step * &self.denominator, 0).to_f64()
        };
        (0..3).map(along).fold(0.0, f64::max)
    }

    /// How far the ray at the finite `t` is from plane `k` of an axis, in voxels.
    pub fn distance(&self, axis: usize, k: u32, t: f64) -> f64 {
        let (n, d) = self.fraction(t);
        let (position, unit) = self.local(axis, &n, &d);
        Surd::ratio(abs(position - &unit * k), unit, 0).to_f64()
    }

    /// Whether the ray meets the closed voxel within its range.
    pub fn touches(&self, voxel: [u32; 3]) -> bool {
        let (mut start, mut end) =
            ((self.start.clone(), self.denominator.clone()), (self.end.clone(), self.denominator.clone()));
        for (a, &index) in voxel.iter().enumerate() {
            let zero = BigInt::ZERO;
            if self.direction[a] == zero {
                if self.beyond(a, index).is_lt() || self.beyond(a, index + 1).is_gt() {
                    return false;
                }
                continue;
            }
            let up = self.direction[a] > zero;
            let plane = |k: u32| {
                let Axis { base, step, over } = &self.axes[a];
                let (t, over) = (base + step * k - &self.origin[a] * over, over * &self.direction[a]);
                if up { (t, over) } else { (-t, -over) }
            };
            let (near, far) = (plane(index + u32::from(!up)), plane(index + u32::from(up)));
            if &near.0 * &start.1 > &start.0 * &near.1 {
                start = near;
            }
            if &far.0 * &end.1 < &end.0 * &far.1 {
                end = far;
            }
        }
        start.0 * end.1 <= end.0 * start.1
    }

    /// Whether the whole of a visit lies in a box of voxels, `low` to `high` with both ends included, that is inflated by
    /// `padding` voxels. Indices below 0 and beyond the resolution are voxels outside of the box.
    pub fn lies_in(&self, visit: &Visit, low: [i64; 3], high: [i64; 3], padding: f64) -> bool {
        let (m, e) = split(padding);
        let (padding, one) =
            if e >= 0 { (BigInt::from(m) << e, BigInt::from(1)) } else { (BigInt::from(m), BigInt::from(1) << -e) };
        // The box and a part of a ray are convex.
        [&visit.entry, &visit.exit].into_iter().all(|t| {
            (0..3).all(|a| {
                let (position, unit) = self.local(a, t, &self.denominator);
                let position = position * &one;
                position >= (&one * low[a] - &padding) * &unit && position <= (&one * (high[a] + 1) + &padding) * &unit
            })
        })
    }
}
