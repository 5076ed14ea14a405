//! From the world to a part's own coordinates, and the ray as it enters the part.
//!
//! A part's coordinates run from -1 to 1 along its longest axis, so that f32 is as good for a dragon as for the stadium around
//! it. The ray is moved to where it enters the box in f64, and only then rounded: all that follows works with numbers of at
//! most 1 and needs no bound but constants, wherever the ray starts and however long its direction is.
//!
//! Parameters along the moved ray are called `s`: 0 where it enters or begins. Their unit is a power of two times that of `t`, so
//! that the direction's greatest component is 0.5 to 1; `s` is at most 4 within a box.
//!
//! Error, with `e = 2^-24`: each coordinate of the moved origin is off by `1.1 e` (f32's rounding, and f64's from
//! [`FAR`] boxes away), and each component of the direction by `e / 2` (its rounding, and [`LEAST`] in the place of smaller
//! ones). So a point at `s` is off by less than `1.1 e + 2 e < 4 e` along each axis.

use crate::accel::nearer;
use crate::ray::{Aabb, Ray, greater, lesser};
use glam::DVec3;

/// Cells reach this far beyond their planes when primitives are sorted into them, in the part's coordinates: 2^-18, or `64 e`.
///
/// Walk and sorting together are off by less: see `walk` (`24 e`) and `raster` (`20 e`).
pub(super) const PADDING: f32 = 1.0 / 262_144.0;

/// Least component of a direction whose greatest one is 0.5 to 1: 2^-26.
///
/// With it in the place of a smaller one, the ray is off by `4 e / 4` where it leaves the box, and no crossing is infinite.
pub(super) const LEAST: f32 = 1.0 / 67_108_864.0;

/// Rays that start within this are clipped in f32, in the part's coordinates.
const NEAR: f64 = 256.0;

/// Rays that start further away than this, in the part's coordinates, are first moved near in twice the precision: 2^20.
const FAR: f64 = 1_048_576.0;

/// Parameters of primitives are known within this when they are compared as f32: 2^-20 of the part.
const SLACK: f64 = 1.0 / 1_048_576.0;

/// Where a part lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// The middle of its box, world units. Counts as exact, as does `scale`: walk and builder use the same map.
    pub centre: DVec3,
    /// Part's units for each world unit.
    pub scale: f64,
    /// The box reaches from minus this to this; the greatest component is 1. No primitive is within 2^-11 of its faces.
    pub half: [f32; 3],
}

/// How a ray meets a part.
pub(super) enum Start {
    /// It does not.
    Miss,
    /// The origin is so far away, some 2^48 boxes, that f64 cannot tell where.
    TooFar,
    /// It does, here.
    Inside(Entry),
}

/// A ray where it enters a part.
#[derive(Clone, Copy, Debug)]
pub(super) struct Entry {
    pub origin: [f32; 3],
    /// The greatest component is 0.5 to 1 or -1 to -0.5, none is nearer to 0 than [`LEAST`].
    pub direction: [f32; 3],
    /// One over the sizes of the direction's components.
    pub inverse: [f32; 3],
    /// 1 or -1: the signs of the direction's components.
    pub sign: [f32; 3],
    /// At or beyond the `s` at which the ray ends or leaves the box.
    pub end: f32,
    /// A hit may lie this far before 0 or beyond its parameter, for rounding.
    pub slack: f32,
    /// `s` is `(t - moved) * rate - start`.
    moved: f64,
    start: f64,
    rate: f64,
}

/// A direction as parts see it.
struct Heading {
    /// A power of two.
    rate: f64,
    /// The direction over the rate.
    exact: DVec3,
    direction: [f32; 3],
    inverse: [f32; 3],
    sign: [f32; 3],
}

impl Frame {
    /// The frame around `bounds`.
    ///
    /// The box is padded by 2^-9 of its greatest half, by at least 2^-26 of the largest coordinate, and flat boxes get a
    /// thickness of 2^-7, so that cells have one.
    pub fn new(bounds: &Aabb) -> Self {
        let bounds = if bounds.is_empty() { Aabb { min: glam::Vec3::ZERO, max: glam::Vec3::ZERO } } else { *bounds };
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let largest = min.abs().max(max.abs()).max_element();
        let half = (max - min) * 0.5;
        // 1e-60: below any f32 distance, far above where the inverse would overflow.
        let pad = (half.max_element() / 512.0).max(largest * 2.0_f64.powi(-26)).max(1e-60);
        let half = half + pad;
        let scale = 1.0 / half.max_element();
        let half = (half * scale).max(DVec3::splat(1.0 / 128.0)).as_vec3().to_array();
        Self { centre: (min + max) * 0.5, scale, half }
    }

    /// World to part's coordinates.
    #[inline]
    pub fn local(&self, world: DVec3) -> DVec3 {
        (world - self.centre) * self.scale
    }

    /// Part's to world coordinates.
    pub fn world(&self, local: DVec3) -> DVec3 {
        self.centre + local / self.scale
    }

    /// Where `ray`, which comes from [`Ray::intake`], enters the box at parameters up to `upper`.
    ///
    /// Where the ray enters and leaves need not be known well, as long as the point there is: there is a margin of 2^-11 around
    /// the primitives. In f32 and for origins within [`NEAR`], distances from faces over components are off by `4 e NEAR` of the
    /// part, and [`LEAST`] in the place of a smaller component moves the ray by `NEAR e / 4`: 2^-13 in all.
    #[inline(always)]
    pub fn enter(&self, ray: &Ray, upper: f64) -> Start {
        let origin = self.local(ray.origin.as_dvec3());
        let size = origin.abs();
        if greater(greater(size.x, size.y), size.z) > NEAR {
            return self.enter_from_afar(ray, upper);
        }
        let heading = self.heading(ray);
        let place = [origin.x as f32, origin.y as f32, origin.z as f32];
        let (mut near, mut far) = (f32::NEG_INFINITY, f32::INFINITY);
        for axis in 0..3 {
            let from = place[axis] * heading.sign[axis];
            let (low, high) = (-self.half[axis] - from, self.half[axis] - from);
            let (low, high) = (low * heading.inverse[axis], high * heading.inverse[axis]);
            near = if low > near { low } else { near };
            far = if high < far { high } else { far };
        }
        let start = greater(f64::from(near), f64::from(ray.t_min) * heading.rate);
        let end = lesser(f64::from(far), lesser(f64::from(ray.t_max), upper) * heading.rate);
        if start > end {
            return Start::Miss;
        }
        Start::Inside(Entry::new(origin, &heading, (start, end), 0.0, 0.0))
    }

    /// The direction of `ray`, in the unit of its parameters.
    #[inline(always)]
    fn heading(&self, ray: &Ray) -> Heading {
        let direction = ray.direction.as_dvec3() * self.scale;
        let size = direction.abs();
        // Twice the greatest power of two in it; never subnormal, as f32 has at least 2^-149 and scales are above 2^-130.
        let bits = greater(greater(size.x, size.y), size.z).to_bits() & !((1 << 52) - 1);
        let rate = f64::from_bits(bits + (1 << 52));
        let exact = direction * f64::from_bits((2045 << 52) - bits);
        let mut heading = Heading {
            rate,
            exact,
            direction: [exact.x as f32, exact.y as f32, exact.z as f32],
            inverse: [0.0; 3],
            sign: [0.0; 3],
        };
        for axis in 0..3 {
            let d = heading.direction[axis];
            let size = if d.abs() < LEAST { LEAST } else { d.abs() };
            heading.sign[axis] = 1.0_f32.copysign(d);
            heading.direction[axis] = size.copysign(d);
            heading.inverse[axis] = 1.0 / size;
        }
        heading
    }

    #[cold]
    #[inline(never)]
    fn enter_from_afar(&self, ray: &Ray, upper: f64) -> Start {
        let origin = self.local(ray.origin.as_dvec3());
        if origin.abs().max_element() <= FAR {
            return self.enter_moved(origin, ray, 0.0, upper);
        }
        let (origin, moved, axis) = nearer(ray, self.centre, self.centre);
        let origin = origin * self.scale;
        let size = origin.abs().max_element();
        if origin[axis].abs() > 4.0 && size > FAR {
            return Start::TooFar;
        }
        // Beside the box while it is level with it: along no other axis does it move faster.
        if size > 16.0 {
            return if origin[axis].abs() <= 4.0 { Start::Miss } else { self.enter_moved(origin, ray, moved, upper) };
        }
        self.enter_moved(origin, ray, moved, upper)
    }

    /// As [`Frame::enter`], in f64 and for a ray that has been moved by a parameter.
    ///
    /// With `u = 2^-53`, the origin in the part's coordinates is off by `2 u FAR`, and so are the parameters of entry and exit,
    /// up to a factor of 8: 2^-29 in all, against the margin of 2^-11.
    fn enter_moved(&self, origin: DVec3, ray: &Ray, moved: f64, upper: f64) -> Start {
        let heading = self.heading(ray);
        // More than the rounding of a difference with `moved`.
        let slack = 4.0 * f64::EPSILON * moved.abs() * heading.rate;
        let mut start = (f64::from(ray.t_min) - moved) * heading.rate - slack;
        let mut end = (lesser(f64::from(ray.t_max), upper) - moved) * heading.rate + slack;
        for axis in 0..3 {
            let (o, d, half) = (origin[axis], heading.exact[axis], f64::from(self.half[axis]));
            if d == 0.0 {
                if o.abs() >= half {
                    return Start::Miss;
                }
                continue;
            }
            let (a, b) = ((-half - o) / d, (half - o) / d);
            start = greater(lesser(a, b), start);
            end = lesser(greater(a, b), end);
        }
        if start <= end {
            Start::Inside(Entry::new(origin, &heading, (start, end), moved, 2.0 * slack))
        } else {
            Start::Miss
        }
    }
}

impl Entry {
    /// A ray from `origin` between two parameters, in the unit of `s`; `slack` is what they are off by.
    #[inline(always)]
    fn new(origin: DVec3, heading: &Heading, (start, end): (f64, f64), moved: f64, slack: f64) -> Self {
        let at = origin + start * heading.exact;
        let slack = SLACK + slack;
        Self {
            origin: [at.x as f32, at.y as f32, at.z as f32],
            direction: heading.direction,
            inverse: heading.inverse,
            sign: heading.sign,
            end: ((end - start) + slack) as f32,
            slack: slack as f32,
            moved,
            start,
            rate: heading.rate,
        }
    }

    /// At or beyond the `s` of a parameter `t` of the ray.
    #[inline]
    pub fn beyond(&self, t: f64) -> f32 {
        // The slack is more than the rounding to f32 of a number up to 4; beyond that nothing is.
        ((t - self.moved) * self.rate - self.start) as f32 + self.slack
    }
    /// At or before the `s` of a parameter `t` of the ray.
    #[inline]
    pub fn before(&self, t: f64) -> f32 {
        self.beyond(t) - 2.0 * self.slack
    }
}
