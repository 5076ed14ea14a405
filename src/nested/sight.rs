//! The descriptions of a ray in a part: [`Entry`] for the walk, [`Sight`] for boxes and packs, [`Course`] for f64; `frame` makes
//! them.

use crate::ray::{greater, lesser};
use glam::{DVec3, Vec3A};

/// Between the walk's `s` and the packs' `p` is a difference known within this, 2^-19 or `32 e`: it is at most 10, and it and the
/// difference are rounded.
pub(super) const SLACK: f32 = 1.0 / 524_288.0;

/// A ray where it enters a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub origin: Vec3A,
    /// One over the sizes of the direction's components, each taken as [`LEAST`](super::frame::LEAST) at least.
    pub inverse: Vec3A,
    /// 1 or -1: the signs of the direction's components.
    pub sign: Vec3A,
    /// The sizes of the direction's components, as in `inverse`.
    pub size: Vec3A,
    /// At or beyond the `s` at which the ray ends or leaves the box.
    pub end: f32,
    /// `p` is about `s` and this.
    pub shift: f32,
    /// The ray as packs see it.
    pub sight: Sight,
}

/// A ray as packs see it, from the world's origin; its parameter is called `p`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub origin: Vec3A,
    /// The greatest component is 0.5 to 1 or -1 to -0.5.
    pub direction: Vec3A,
    /// Each coordinate of the origin is off by this at most.
    pub fuzz: f32,
    /// `p` for each unit of `t`: a power of two.
    pub rate: f32,
    /// At or before the `p` of the ray's begin, and at or beyond it.
    pub begin: [f32; 2],
    /// At or before the `p` of the ray's end, and at or beyond it.
    pub end: [f32; 2],
    /// What f64 needs of a ray that is not seen from its own origin.
    pub apart: Option<Course>,
}

/// A ray as f64 sees it: from its own origin, exactly.
#[derive(Clone, Copy, Debug)]
pub(super) struct Course {
    pub origin: DVec3,
    pub direction: DVec3,
    /// The parameter from that origin to the one of the packs; a NaN if that is not known to f64.
    pub start: f64,
    /// `p` is `(t - moved) * rate - begin`, off by `slack`.
    pub moved: f64,
    pub begin: f64,
    pub rate: f64,
    pub slack: f64,
}

impl Sight {
    /// True if the ray is seen from its own origin and has no part before it.
    #[inline(always)]
    pub fn is_from_origin(&self) -> bool {
        self.apart.is_none() && self.begin[0] >= 0.0
    }

    /// The ray as f64 sees it.
    #[inline(always)]
    pub fn course(&self) -> Course {
        match self.apart {
            Some(course) => course,
            None => Course {
                origin: self.origin.as_dvec3(),
                direction: self.direction.as_dvec3(),
                start: 0.0,
                moved: 0.0,
                begin: 0.0,
                rate: self.rate.into(),
                slack: 0.0,
            },
        }
    }
}

impl Entry {
    /// The `p` of a parameter `t` of the ray: at or before it, and at or beyond it.
    #[inline(always)]
    pub fn around(&self, t: f64) -> [f32; 2] {
        let Course { moved, begin, rate, slack, .. } = self.sight.course();
        around((t - moved) * rate - begin, slack)
    }

    /// The parameter of the ray at a `p` known within a bound, with its own; not for rays that were moved.
    #[inline(always)]
    pub fn parameter(&self, p: f64, bound: f64) -> (f64, f64) {
        let Course { begin, rate, .. } = self.sight.course();
        let t = (p + begin) / rate;
        (t, bound / rate + t.abs() * (2.0 * f64::EPSILON))
    }

    /// At or beyond the `s` of a `p`.
    #[inline(always)]
    pub fn walked(&self, p: f32) -> f32 {
        (p - self.shift) + SLACK
    }
}

/// Around a `p`, as f32.
#[inline(always)]
pub(super) fn around(p: f64, slack: f64) -> [f32; 2] {
    // Beyond any primitive of the part; infinities have no differences.
    const MOST: f64 = 1e30;
    let p = lesser(greater(p, -MOST), MOST);
    // More than f32's rounding and f64's.
    let slack = p.abs() * f64::from(f32::EPSILON) + slack + 1e-36;
    [(p - slack) as f32, (p + slack) as f32]
}
