//! From the world to a part's own coordinates, and the ray as it enters the part.
//!
//! There are two descriptions of one ray. They share a unit of length, which is a power of two times the world's and in which
//! the part's box is 1 to 2 long, and a unit of the parameter, a power of two times that of `t`, in which the direction's
//! greatest component is 0.5 to 1: to change units rounds nothing.
//!
//! **The walk** sees the part from its middle, and the ray from where it enters the box, at `s = 0`. Numbers are at most 1 and
//! `s` at most 4 within the box, so that f32 is as good for a dragon as for the stadium around it, and bounds are constants. With `e =
//! 2^-24`, each coordinate of the origin is off by `1.1 e` (f32's rounding, and f64's from [`FAR`] boxes away), and each
//! component of the direction by [`LEAST`] in the place of smaller ones. So a point at `s` is off by less than `1.1 e + e < 4 e`
//! along each axis.
//!
//! **The packs** see the part from the world's origin ([`Sight`]): vertices are those given, to the bit, and so is the ray's
//! origin if it is near. What a test subtracts from one another is then exact, and bounds shrink with the distance from the
//! ray's origin: a ray that starts on a surface, eight roundings above it, certainly does not meet what it starts from. A ray
//! from further away starts where it enters the box, rounded to f32; [`Sight::fuzz`] says how far that may be off.

use super::exact::Known;
use super::step::least;
use crate::accel::nearer;
use crate::ray::{Aabb, Ray, greater, lesser};
use glam::{DVec3, Vec3};

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

/// Rays that start within this see primitives from their own origin, in the part's coordinates; all others from where they enter
/// the box.
const SEEING: f64 = 4.0;

/// Between the walk's `s` and the packs' `p` is a difference known within this, 2^-19 or `32 e`: it is at most 10, and it and the
/// difference are rounded.
const SLACK: f32 = 1.0 / 524_288.0;

/// Where a part lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// The middle of its box, world units. Counts as exact, as does `scale`: walk and builder use the same map.
    pub centre: DVec3,
    /// Part's units for each world unit: a power of two.
    pub scale: f64,
    /// The box reaches from minus this to this; the greatest component is 0.5 to 1. No primitive is within 2^-11 of its faces.
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
    /// One over the sizes of the direction's components, each taken as [`LEAST`] at least.
    pub inverse: [f32; 3],
    /// 1 or -1: the signs of the direction's components.
    pub sign: [f32; 3],
    /// The sizes of the direction's components, as in `inverse`.
    pub size: [f32; 3],
    /// At or beyond the `s` at which the ray ends or leaves the box.
    pub end: f32,
    /// The ray as packs see it.
    pub sight: Sight,
    /// `p` is about `s` and this.
    shift: f32,
    /// `p` is `(t - moved) * rate - start`, off by `slack`.
    moved: f64,
    start: f64,
    rate: f64,
    slack: f64,
}

/// A ray as packs see it, from the world's origin; its parameter is called `p`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sight {
    pub origin: [f32; 3],
    /// The greatest component is 0.5 to 1 or -1 to -0.5.
    pub direction: [f32; 3],
    /// Each coordinate of the origin is off by this at most.
    pub fuzz: f32,
    /// The ray's own origin and direction, exactly, and the parameter from that origin to this one; a NaN if that is not
    /// known to f64.
    pub own: DVec3,
    pub course: DVec3,
    pub start: f64,
    /// At or before the `p` of the ray's begin, and at or beyond it.
    pub begin: [f32; 2],
    /// At or before the `p` of the ray's end, and at or beyond it.
    pub end: [f32; 2],
}

/// A direction as parts see it.
struct Heading {
    /// A power of two.
    rate: f64,
    /// The direction over the rate.
    exact: DVec3,
    inverse: [f32; 3],
    sign: [f32; 3],
    size: [f32; 3],
}

impl Frame {
    /// The frame around `bounds`.
    ///
    /// The box is padded by 2^-9 of its greatest half, by at least 2^-26 of the largest coordinate, and flat boxes get a
    /// thickness of 2^-7, so that cells have one. It is padded more on one side: things are often symmetric, and whatever lies in
    /// a plane of symmetry would otherwise lie in a plane between cells and be listed on both sides of it.
    pub fn new(bounds: &Aabb) -> Self {
        let bounds = if bounds.is_empty() { Aabb { min: Vec3::ZERO, max: Vec3::ZERO } } else { *bounds };
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let largest = min.abs().max(max.abs()).max_element();
        let half = (max - min) * 0.5;
        // 1e-60: below any f32 distance, far above where the inverse would overflow.
        let pad = (half.max_element() / 512.0).max(largest * 2.0_f64.powi(-26)).max(1e-60);
        let aside = DVec3::new(0.29, 0.37, 0.43) * pad;
        let half = half + pad + aside;
        // The greatest power of two with which the greatest component is at most 1.
        let up = half.max_element().to_bits().wrapping_sub(1);
        let scale = f64::from_bits((2045 << 52) - (up & (2047 << 52)));
        let half = (half * scale).max(DVec3::splat(1.0 / 128.0)).as_vec3().to_array();
        Self { centre: (min + max) * 0.5 + aside, scale, half }
    }

    /// World to part's coordinates.
    #[inline]
    pub fn local(&self, world: DVec3) -> DVec3 {
        (world - self.centre) * self.scale
    }

    /// World coordinates in the part's unit, as packs have them: exact, or infinite where that is below what f32 has, so that
    /// every comparison with them fails.
    #[inline]
    pub fn sized(&self, world: Vec3) -> Vec3 {
        let exact = world.as_dvec3() * self.scale;
        let sized = exact.as_vec3();
        if sized.as_dvec3() == exact { sized } else { Vec3::INFINITY }
    }

    /// Part's to world coordinates.
    pub fn world(&self, local: DVec3) -> DVec3 {
        self.centre + local / self.scale
    }

    /// Where `ray`, which comes from [`Ray::intake`], enters the box at parameters before those of `winner`, if there is one.
    ///
    /// Where the ray enters and leaves need not be known well, as long as the point there is: there is a margin of 2^-11 around
    /// the primitives. In f32 and for origins within [`NEAR`], distances from faces over components are off by `4 e NEAR` of the
    /// part, and [`LEAST`] in the place of a smaller component moves the ray by `NEAR e / 4`: 2^-13 in all.
    #[inline(always)]
    pub fn enter(&self, ray: &Ray, winner: Option<Known>) -> Start {
        let origin = self.local(ray.origin.as_dvec3());
        let size = origin.abs();
        let distance = greater(greater(size.x, size.y), size.z);
        let heading = self.heading(ray);
        if distance > NEAR {
            // What is not inlined takes nothing by reference that is in registers here, and gives little back.
            return match self.afar(ray) {
                Afar::Miss => Start::Miss,
                Afar::TooFar => Start::TooFar,
                Afar::Inside(origin, inside) => self.begin(ray, origin, &heading, &inside, winner),
            };
        }
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
        let end = lesser(f64::from(far), f64::from(ray.t_max) * heading.rate);
        if start > end {
            return Start::Miss;
        }
        let inside = Inside { start, end, moved: 0.0, slack: 0.0, sees: distance <= SEEING };
        self.begin(ray, origin, &heading, &inside, winner)
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
        let mut heading = Heading { rate, exact, inverse: [0.0; 3], sign: [0.0; 3], size: [0.0; 3] };
        for axis in 0..3 {
            let d = exact[axis] as f32;
            let size = if d.abs() < LEAST { LEAST } else { d.abs() };
            heading.sign[axis] = 1.0_f32.copysign(d);
            heading.inverse[axis] = 1.0 / size;
            heading.size[axis] = size;
        }
        heading
    }

    #[cold]
    #[inline(never)]
    fn afar(&self, ray: &Ray) -> Afar {
        let origin = self.local(ray.origin.as_dvec3());
        if origin.abs().max_element() <= FAR {
            return self.afar_moved(origin, ray, 0.0);
        }
        let (origin, moved, axis) = nearer(ray, self.centre, self.centre);
        let origin = origin * self.scale;
        let size = origin.abs().max_element();
        if origin[axis].abs() > 4.0 && size > FAR {
            return Afar::TooFar;
        }
        // Beside the box while it is level with it: along no other axis does it move faster.
        if size > 16.0 {
            return if origin[axis].abs() <= 4.0 { Afar::Miss } else { self.afar_moved(origin, ray, moved) };
        }
        self.afar_moved(origin, ray, moved)
    }

    /// As [`Frame::enter`], in f64 and for a ray that has been moved by a parameter.
    ///
    /// With `u = 2^-53`, the origin in the part's coordinates is off by `2 u FAR`, and so are the parameters of entry and exit,
    /// up to a factor of 8: 2^-29 in all, against the margin of 2^-11.
    fn afar_moved(&self, origin: DVec3, ray: &Ray, moved: f64) -> Afar {
        let heading = self.heading(ray);
        // More than the rounding of a difference with `moved`.
        let slack = 4.0 * f64::EPSILON * moved.abs() * heading.rate;
        let mut start = (f64::from(ray.t_min) - moved) * heading.rate - slack;
        let mut end = (f64::from(ray.t_max) - moved) * heading.rate + slack;
        for axis in 0..3 {
            let (o, d, half) = (origin[axis], heading.exact[axis], f64::from(self.half[axis]));
            if d == 0.0 {
                if o.abs() >= half {
                    return Afar::Miss;
                }
                continue;
            }
            let (a, b) = ((-half - o) / d, (half - o) / d);
            start = greater(lesser(a, b), start);
            end = lesser(greater(a, b), end);
        }
        if start > end {
            return Afar::Miss;
        }
        Afar::Inside(origin, Inside { start, end, moved, slack: 2.0 * slack, sees: false })
    }

    /// The ray from where it enters the box, `origin` being where it starts or where it was moved to.
    #[inline(always)]
    fn begin(&self, ray: &Ray, origin: DVec3, heading: &Heading, inside: &Inside, winner: Option<Known>) -> Start {
        let at = origin + inside.start * heading.exact;
        let d = heading.exact;
        let mut sight = Sight {
            origin: [0.0; 3],
            direction: [d.x as f32, d.y as f32, d.z as f32],
            fuzz: 0.0,
            own: ray.origin.as_dvec3() * self.scale,
            course: d,
            start: 0.0,
            begin: [0.0; 2],
            end: [0.0; 2],
        };
        let mut shift = 0.0;
        let mut start = inside.start;
        if inside.sees {
            // A power of two: exact.
            sight.origin = sight.own.as_vec3().to_array();
            shift = start as f32;
            start = 0.0;
        } else {
            let seen = (at + self.centre * self.scale).as_vec3();
            sight.origin = seen.to_array();
            sight.start = if inside.moved == 0.0 { start } else { f64::NAN };
            // Half a unit in the last place, and more than f64's rounding.
            sight.fuzz = (seen.abs().max_element() + 0.25) * f32::EPSILON * 0.5;
        }
        let mut entry = Entry {
            origin: [at.x as f32, at.y as f32, at.z as f32],
            inverse: heading.inverse,
            sign: heading.sign,
            size: heading.size,
            end: (inside.end - inside.start) as f32 + SLACK,
            sight,
            shift,
            moved: inside.moved,
            start,
            rate: heading.rate,
            slack: inside.slack,
        };
        entry.sight.begin = entry.around(f64::from(ray.t_min));
        entry.sight.end = entry.around(f64::from(ray.t_max));
        if let Some(Known { lower, upper, .. }) = winner {
            let ([sure, _], [_, end]) = (entry.around(lower), entry.around(upper));
            entry.sight.end = [least(entry.sight.end[0], sure), least(entry.sight.end[1], end)];
            entry.end = least(entry.end, entry.walked(entry.sight.end[1]));
            if entry.end < 0.0 {
                return Start::Miss;
            }
        }
        Start::Inside(entry)
    }
}

/// As [`Start`], of a ray from far away: from where it was moved to.
enum Afar {
    Miss,
    TooFar,
    Inside(DVec3, Inside),
}

/// Where a ray is in a box.
struct Inside {
    /// Parameters of entry and exit, in the unit of `s`, from the origin.
    start: f64,
    end: f64,
    moved: f64,
    slack: f64,
    /// True if primitives are seen from the ray's own origin.
    sees: bool,
}

impl Entry {
    /// The `p` of a parameter `t` of the ray: at or before it, and at or beyond it.
    #[inline(always)]
    pub fn around(&self, t: f64) -> [f32; 2] {
        // Beyond any primitive of the part; infinities have no differences.
        const MOST: f64 = 1e30;
        let p = (t - self.moved) * self.rate - self.start;
        let p = lesser(greater(p, -MOST), MOST);
        // More than f32's rounding and f64's.
        let slack = p.abs() * f64::from(f32::EPSILON) + self.slack + 1e-36;
        [(p - slack) as f32, (p + slack) as f32]
    }

    /// The parameter of the ray at a `p` known within a bound, with its own; not for rays that were moved.
    pub fn parameter(&self, p: f64, bound: f64) -> (f64, f64) {
        let t = (p + self.start) / self.rate;
        (t, bound / self.rate + t.abs() * (2.0 * f64::EPSILON))
    }

    /// At or beyond the `s` of a `p`.
    #[inline(always)]
    pub fn walked(&self, p: f32) -> f32 {
        (p - self.shift) + SLACK
    }
}
