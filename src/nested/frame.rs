//! From the world to a part's own coordinates, and the ray as it enters the part.
//!
//! There are two descriptions of one ray. They share a unit of length, which is a power of two times the world's and in which
//! the part's box is 1 to 2 long, and a unit of the parameter, a power of two times that of `t`, in which the direction's
//! greatest component is 0.5 to 1: to change units rounds nothing.
//!
//! **The walk** sees the part from its middle, and the ray from where it enters the box, at `s = 0`. Numbers are at most 1
//! and `s` at most 4 within the box, so that f32 is as good for a dragon as for the stadium around it, and bounds are
//! constants. With `e = 2^-24`, each coordinate of the origin is off by `6.5 e` (computed in f32 from up to [`SEEING`]
//! away: `2 e` for the difference with the middle, `4 e` for a product with the direction, `0.5 e` for their sum; from
//! further away in f64), and each component of the direction by [`LEAST`] in the place of smaller ones. So a point at `s`
//! is off by less than `6.5 e + e < 8 e` along each axis.
//!
//! **The packs** see the part from the world's origin ([`Sight`]): vertices are those given, to the bit, and so is the ray's
//! origin if it is near. What a test subtracts from one another is then exact, and bounds shrink with the distance from the
//! ray's origin: a ray that starts on a surface, eight roundings above it, certainly does not meet what it starts from. A ray
//! from further away starts where it enters the box, rounded to f32; [`Sight::fuzz`] says how far that may be off.

use super::exact::Known;
use super::sight::{Course, Entry, SLACK, Sight, around};
use crate::accel::nearer;
use crate::ray::{Aabb, Ray, greater, lesser};
use glam::{DVec3, Vec3, Vec3A};

/// Cells reach this far beyond their planes when primitives are sorted into them, in the part's coordinates: 2^-18, or `64 e`.
///
/// Walk and sorting together are off by less: see the module (`28 e`) and `raster` (`20 e`).
pub(super) const PADDING: f32 = 1.0 / 262_144.0;

/// Least component of a direction whose greatest one is 0.5 to 1: 2^-26.
///
/// With it in the place of a smaller one, the ray is off by `4 e / 4` where it leaves the box, and no crossing is infinite.
pub(super) const LEAST: f32 = 1.0 / 67_108_864.0;

/// Rays that start within this are asked in f32 whether they miss, in the part's coordinates.
const NEAR: f32 = 256.0;

/// Rays that start further away than this, in the part's coordinates, are first moved near in twice the precision: 2^20.
const FAR: f64 = 1_048_576.0;

/// Rays that start within this see primitives from their own origin, in the part's coordinates; all others from where they enter
/// the box.
const SEEING: f32 = 4.0;

/// Where a part lies.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Frame {
    /// The middle of its box, world units. Counts as exact, as does `scale`: walk and builder use the same map.
    pub centre: DVec3,
    /// Part's units for each world unit: a power of two.
    pub scale: f64,
    /// The box reaches from minus this to this; the greatest component is 0.5 to 1. No primitive is within 2^-11 of its faces.
    pub half: Vec3A,
    /// The centre and the scale once more, for rays that start within `near`.
    middle: Vec3A,
    unit: f32,
    world: f32,
    near: f32,
}

/// How a ray meets a part.
#[allow(clippy::large_enum_variant, reason = "taken apart where it is returned")]
pub(super) enum Start {
    /// It does not.
    Miss,
    /// The origin is so far away, some 2^48 boxes, that f64 cannot tell where.
    TooFar,
    /// It does, here.
    Inside(Entry),
}

/// A direction as parts see it.
struct Heading {
    inverse: Vec3A,
    sign: Vec3A,
    size: Vec3A,
}

impl Frame {
    /// The frame around `bounds`.
    ///
    /// The box is padded by 2^-9 of its greatest half, by at least 2^-26 of the largest coordinate, and flat boxes get a
    /// thickness of 2^-7, so that cells have one. It is padded more on one side: things are often symmetric, and whatever lies in
    /// a plane of symmetry would otherwise lie in a plane between cells and be listed on both sides of it.
    pub fn new(bounds: &Aabb) -> Self {
        let ([min, max], pad) = (bounds.corners(), bounds.padding(2.0_f64.powi(-26)));
        let aside = DVec3::new(0.29, 0.37, 0.43) * pad;
        let middle = ((min + max) * 0.5 + aside).as_vec3();
        let centre = middle.as_dvec3();
        let half = (max - centre).max(centre - min) + pad;
        // The greatest power of two with which the greatest component is at most 1.
        let up = half.max_element().to_bits().wrapping_sub(1);
        let scale = f64::from_bits((2045 << 52) - (up & (2047 << 52)));
        let half = (half * scale).max(DVec3::splat(1.0 / 128.0)).as_vec3();
        let unit = scale as f32;
        let usual = (1e-18..1e18).contains(&unit);
        Self {
            centre,
            scale,
            half: half.into(),
            middle: middle.into(),
            unit,
            world: 1.0 / unit,
            near: if usual { NEAR } else { -1.0 },
        }
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

    /// A box in the world as the packs see it, larger by a margin, and rounded outwards where rounded.
    #[inline]
    pub fn bounds(&self, aabb: &Aabb, margin: f64) -> [Vec3A; 2] {
        if margin == 0.0 && self.near > 0.0 {
            // A power of two: exact but where it underflows, far below the least distance from 0.
            let sized = |p: Vec3, sign: f32| {
                let sized = Vec3A::from(p) * self.unit;
                Vec3A::select(sized.abs().cmplt(Vec3A::splat(SPECK)), Vec3A::splat(sign * SPECK), sized)
            };
            return [sized(aabb.min, -1.0), sized(aabb.max, 1.0)];
        }
        let sized = |p: Vec3, sign: f32| {
            let margin = f64::from(sign) * margin;
            Vec3A::from(p.to_array().map(|x| outwards(f64::from(x) * self.scale + margin, sign)))
        };
        [sized(aabb.min, -1.0), sized(aabb.max, 1.0)]
    }

    /// A corner of a cell as the packs see it, padded along each axis in the sense of `sign`.
    pub fn outwards(&self, corner: [f32; 3], sign: f32) -> Vec3A {
        let centre = self.centre * self.scale;
        [0, 1, 2].map(|a| outwards(centre[a] + f64::from(corner[a] + sign * PADDING), sign)).into()
    }

    /// Part's to world coordinates.
    pub fn world(&self, local: DVec3) -> DVec3 {
        self.centre + local / self.scale
    }

    /// Where `ray`, which comes from [`Ray::intake`], enters the box at parameters before those of `winner`, if there is one.
    #[inline(always)]
    pub fn enter(&self, ray: &Ray, winner: Option<Known>) -> Start {
        let mut entry = match self.near(ray) {
            Start::Inside(entry) => entry,
            Start::Miss => return Start::Miss,
            // What is not inlined takes nothing by reference that is in registers here.
            Start::TooFar => match self.afar(ray) {
                Start::Inside(entry) => entry,
                other => return other,
            },
        };
        if let Some(Known { lower, upper, .. }) = winner {
            let ([sure, _], [_, end]) = (entry.around(lower), entry.around(upper));
            entry.sight.end = [lesser(entry.sight.end[0], sure), lesser(entry.sight.end[1], end)];
            entry.end = lesser(entry.end, entry.walked(entry.sight.end[1]));
            if entry.end < 0.0 {
                return Start::Miss;
            }
        }
        Start::Inside(entry)
    }

    /// A ray that starts within [`NEAR`], in f32; [`Start::TooFar`] of others that do not certainly miss.
    ///
    /// Where the ray enters and leaves need not be known well, as long as the point there is: there is a margin of 2^-11 around the
    /// primitives. In f32 and for origins within [`NEAR`], distances from faces over components are off by `4 e NEAR` of the
    /// part, and [`LEAST`] in the place of a smaller component moves the ray by `NEAR e / 4`: 2^-13 in all.
    #[inline(always)]
    fn near(&self, ray: &Ray) -> Start {
        let (origin, direction) = (Vec3A::from(ray.origin), Vec3A::from(ray.direction));
        let (from, seen) = ((origin - self.middle) * self.unit, origin * self.unit);
        // The greatest power of two in the direction.
        let power = direction.abs().max_element().to_bits() & 0x7f80_0000;
        let usual = power.wrapping_sub((127 - 60) << 23) < 120 << 23;
        // All are powers of two.
        let (shrink, grow) =
            (f32::from_bits((253_u32 << 23).wrapping_sub(power)), f32::from_bits(power.wrapping_add(1 << 23)));
        let course = direction * shrink;
        let distance = from.abs().max_element();
        if !(usual & (distance <= self.near)) {
            return Start::TooFar;
        }
        let (heading, rate) = (Heading::new(course), self.unit * grow);
        let ahead = from * heading.sign;
        let (low, high) = ((-self.half - ahead) * heading.inverse, (self.half - ahead) * heading.inverse);
        let (begin, finish) = (ray.t_min * rate, ray.t_max * rate);
        let start = greater(low.max_element(), begin);
        let leave = high.min_element();
        let end = lesser(leave, finish);
        if start > end {
            return Start::Miss;
        }
        // Units change exactly, but where numbers are too small.
        let exact = (seen * self.world).cmpeq(origin) & (course * grow).cmpeq(direction);
        if !((distance <= SEEING) & (begin >= 0.0) & exact.all()) {
            return self.outside(ray, start, leave);
        }
        let (begin, end_p) = ([begin; 2], [finish; 2]);
        let sight = Sight { origin: seen, direction: course, fuzz: 0.0, rate, begin, end: end_p, apart: None };
        Start::Inside(heading.entry(from + start * course, end - start, start, sight))
    }

    /// A ray that enters the box at a `start` and leaves it at `leave`, known as in [`Frame::near`], and is not seen from
    /// its own origin.
    ///
    /// The point at `start` is that of f64: it is off by `u NEAR`, with `u = 2^-53`, and by its rounding to f32.
    #[inline(never)]
    fn outside(&self, ray: &Ray, start: f32, leave: f32) -> Start {
        let (origin, scaled) = (self.local(ray.origin.as_dvec3()), ray.direction.as_dvec3() * self.scale);
        let (course, rate) = halved(scaled);
        let from = Departure { origin, course, rate, moved: 0.0, slack: 0.0 };
        // `finish` is none too early, and where the ray leaves the box is not of interest to 2^-13.
        self.depart(ray, &from, start.into(), (leave - start).into())
    }

    /// Any other ray, in f64.
    #[cold]
    #[inline(never)]
    fn afar(&self, ray: &Ray) -> Start {
        let origin = self.local(ray.origin.as_dvec3());
        if origin.abs().max_element() <= FAR {
            return self.afar_moved(origin, ray, 0.0);
        }
        let (origin, moved, axis) = nearer(ray, self.centre, self.centre);
        let origin = origin * self.scale;
        let size = origin.abs().max_element();
        if origin[axis].abs() > 4.0 && size > FAR {
            return Start::TooFar;
        }
        // Beside the box while it is level with it: along no other axis does it move faster.
        if size > 16.0 {
            return if origin[axis].abs() <= 4.0 { Start::Miss } else { self.afar_moved(origin, ray, moved) };
        }
        self.afar_moved(origin, ray, moved)
    }

    /// As [`Frame::afar`], for a ray that has been moved by a parameter.
    ///
    /// With `u = 2^-53`, the origin in the part's coordinates is off by `2 u FAR`, and so are the parameters of entry and exit,
    /// up to a factor of 8: 2^-29 in all, against the margin of 2^-11.
    fn afar_moved(&self, origin: DVec3, ray: &Ray, moved: f64) -> Start {
        let (course, rate) = halved(ray.direction.as_dvec3() * self.scale);
        // More than the rounding of a difference with `moved`.
        let slack = 4.0 * f64::EPSILON * moved.abs() * rate;
        let mut start = (f64::from(ray.t_min) - moved) * rate - slack;
        let mut end = (f64::from(ray.t_max) - moved) * rate + slack;
        for axis in 0..3 {
            let (o, d, half) = (origin[axis], course[axis], f64::from(self.half[axis]));
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
        if start > end {
            return Start::Miss;
        }
        self.depart(ray, &Departure { origin, course, rate, moved, slack: 2.0 * slack }, start, end - start)
    }

    /// The ray as seen from where it enters the box, at the parameter `start` of its course, to be left `inside` further on.
    #[inline(always)]
    fn depart(&self, ray: &Ray, from: &Departure, start: f64, inside: f64) -> Start {
        let Departure { origin, course, rate, moved, slack } = *from;
        let at = origin + start * course;
        let seen = (at + self.centre * self.scale).as_vec3();
        let p = |t: f32| around((f64::from(t) - moved) * rate - start, slack);
        let (heading, finish) = (Heading::new(course.as_vec3a()), p(ray.t_max));
        let sight = Sight {
            origin: seen.into(),
            direction: course.as_vec3a(),
            // Half a unit in the last place, and more than f64's rounding.
            fuzz: (seen.abs().max_element() + 0.25) * f32::EPSILON * 0.5,
            rate: 0.0,
            begin: p(ray.t_min),
            end: finish,
            apart: Some(Course {
                origin: ray.origin.as_dvec3() * self.scale,
                direction: course,
                start: if moved == 0.0 { start } else { f64::NAN },
                moved,
                begin: start,
                rate,
                slack,
            }),
        };
        Start::Inside(heading.entry(at.as_vec3a(), lesser(inside as f32, finish[1]), 0.0, sight))
    }
}

/// A direction over the power of two that brings its greatest component to 0.5 to 1, and that power.
#[inline(always)]
fn halved(direction: DVec3) -> (DVec3, f64) {
    // Never subnormal, as f32 has at least 2^-149 and scales are above 2^-130.
    let bits = direction.abs().max_element().to_bits() & !((1 << 52) - 1);
    (direction * f64::from_bits((2045 << 52) - bits), f64::from_bits(bits + (1 << 52)))
}

/// A ray that is not seen from its own origin: in the part's coordinates, and moved by a parameter.
struct Departure {
    origin: DVec3,
    course: DVec3,
    rate: f64,
    moved: f64,
    slack: f64,
}

impl Heading {
    /// That of a direction whose greatest component is 0.5 to 1 or -1 to -0.5.
    #[inline(always)]
    fn new(direction: Vec3A) -> Self {
        let size = direction.abs().max(Vec3A::splat(LEAST));
        Self { inverse: Vec3A::ONE / size, sign: Vec3A::ONE.copysign(direction), size }
    }

    /// The entry of a ray that is in the part from a point on and leaves it, or ends, `inside` further on.
    #[inline(always)]
    fn entry(self, at: Vec3A, inside: f32, shift: f32, sight: Sight) -> Entry {
        let Self { inverse, sign, size } = self;
        Entry { origin: at, inverse, sign, size, end: inside + SLACK, shift, sight }
    }
}

/// Planes of boxes are no nearer to 0 than this, so that no difference with an origin underflows.
const SPECK: f32 = 1e-30;

/// The next f32 at or beyond `x` in the sense of `sign`, but for [`SPECK`].
fn outwards(x: f64, sign: f32) -> f32 {
    let near = x as f32 * sign;
    let near = if f64::from(near) < x * f64::from(sign) { near.next_up() } else { near };
    sign * if near.abs() < SPECK { SPECK } else { near }
}
