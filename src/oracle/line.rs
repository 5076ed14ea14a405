//! One ray as the oracle sees it, and bounds on parameters in f64.

use super::surd::Surd;
use super::whole::{Span, parts};
use crate::ray::Ray;
use glam::{DVec3, Vec3};
use num_bigint::BigInt;

/// Half the distance from 1 to the next f64.
pub(super) const U: f64 = f64::EPSILON / 2.0;

/// A ray that can hit something.
pub(super) struct Line {
    pub origin: Vec3,
    pub direction: Vec3,
    /// The same in f64.
    pub o: DVec3,
    pub d: DVec3,
    /// Greatest component of the direction.
    pub d_size: f64,
    pub origin_span: Span,
    pub direction_span: Span,
    pub t_min: f64,
    pub t_max: f64,
}

impl Line {
    /// `None` if the ray hits nothing by definition.
    pub fn new(ray: &Ray) -> Option<Self> {
        let Ray { origin, direction, t_min, t_max } = *ray;
        let finite = |v: Vec3| v.to_array().iter().all(|x| x.is_finite());
        // The comparison is false for NaN.
        let in_order = t_min <= t_max;
        if !finite(origin) || !finite(direction) || direction.to_array() == [0.0; 3] || !in_order {
            return None;
        }
        let d = direction.as_dvec3();
        Some(Self {
            origin,
            direction,
            o: origin.as_dvec3(),
            d,
            d_size: size(d),
            origin_span: Span::of(&[origin]),
            direction_span: Span::of(&[direction]),
            t_min: t_min.into(),
            t_max: t_max.into(),
        })
    }

    /// Whether `t` lies in the closed range.
    pub fn holds(&self, t: &Surd) -> bool {
        let after = |bound: f64| match bound {
            f64::INFINITY => false,
            f64::NEG_INFINITY => true,
            _ => t.order(&finite(bound as f32)).is_ge(),
        };
        let before = |bound: f64| match bound {
            f64::INFINITY => true,
            f64::NEG_INFINITY => false,
            _ => t.order(&finite(bound as f32)).is_le(),
        };
        after(self.t_min) && before(self.t_max)
    }

    /// The part of an estimate in the range, or `None` if there certainly is none.
    pub fn clip(&self, estimate: Estimate) -> Option<Estimate> {
        let Estimate { least, most, certain } = estimate;
        if most < self.t_min || least > self.t_max {
            return None;
        }
        Some(Estimate { certain: certain && least >= self.t_min && most <= self.t_max, ..estimate })
    }
}

/// A finite f32, exactly.
fn finite(x: f32) -> Surd {
    let (mantissa, exponent) = parts(x);
    Surd::ratio(mantissa.into(), BigInt::from(1), exponent)
}

/// Greatest component in size.
pub(super) fn size(v: DVec3) -> f64 {
    v.x.abs().max(v.y.abs()).max(v.z.abs())
}

/// Where a primitive is hit, if it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Estimate {
    /// Its parameter, if it is hit, is between these.
    pub least: f64,
    pub most: f64,
    /// Whether it certainly is hit, within the ray's range.
    pub certain: bool,
}
