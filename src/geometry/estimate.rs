//! Parameters in f64 that are known within a bound: of spheres, and of points that they share with other primitives.

use crate::ray::Ray;

/// A parameter and a bound on its error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Estimate {
    pub t: f64,
    pub err: f64,
}

/// Where a parameter lies with respect to the ray's range.
pub(super) enum Within {
    /// Certainly in it.
    Yes,
    /// Certainly not.
    No,
    /// Undecided.
    Open,
}

impl Estimate {
    /// `t`, known within `err`; the rest is for the rounding of sums of the two.
    pub fn new(t: f64, err: f64) -> Self {
        Self { t, err: err + t.abs() * (2.0 * f64::EPSILON) }
    }

    /// False only if the two certainly differ.
    pub fn meets(&self, other: &Self) -> bool {
        self.t - self.err <= other.t + other.err && other.t - other.err <= self.t + self.err
    }

    /// Whether the parameter lies in the range of `ray`.
    pub fn within(&self, ray: &Ray) -> Within {
        let (low, high) = (self.t - self.err, self.t + self.err);
        let (t_min, t_max) = (f64::from(ray.t_min), f64::from(ray.t_max));
        if low >= t_min && high <= t_max {
            Within::Yes
        } else if high < t_min || low > t_max {
            Within::No
        } else {
            Within::Open
        }
    }
}
