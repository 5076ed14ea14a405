//! From the world to a part's own coordinates, and the ray as it enters the part.
//!
//! There are two descriptions of one ray. They share a unit of length, which is a power of two times the world's and in which
//! the part's box is 1 to 2 long, and a unit of the parameter, a power of two times that of `t`, in which the direction's
//! greatest component is 0.5 to 1: to change units rounds nothing.
//!
//! **The walk** sees the part from its middle, and the ray from where it enters the box, at `s = 0`. Numbers are at most 1 and
//! `s` at most 4 within the box, so that f32 is as good for a dragon as for the stadium around it, and bounds are constants. With `e =
//! 2^-24`, each coordinate of the origin is off by `6.5 e` (computed in f32 from up to [`SEEING`] away: `2 e` for the difference with the
//! middle, `4 e` for a product with the direction, `0.5 e` for their sum; from further away in f64), and each
//! component of the direction by [`LEAST`] in the place of smaller ones. So a point at `s` is off by less than `6.5 e + e < 8 e`
//! along each axis.
//!
//! **The packs** see the part from the world's origin ([`Sight`]): vertices are those given, to the bit, and so is the ray's
//! origin if it is near. What a test subtracts from one another is then exact, and bounds shrink with the distance from the
//! ray's origin: a ray that starts on a surface, eight roundings above it, certainly does not meet what it starts from. A ray
//! from further away starts where it enters the box, rounded to f32; [`Sight::fuzz`] says how far that may be off.

use super::exact::Known;
use super::sight::{Course, Entry, SLACK, Sight, around};
use super::step::{least, most};
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
    pub half: [f32; 3],
    /// The centre, the scale and the half once more, for rays that start within `near`.
    middle: Vec3A,
    unit: f32,
    world: f32,
    room: Vec3A,
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
    direction: Vec3A,
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
        let bounds = if bounds.is_empty() { Aabb { min: Vec3::ZERO, max: Vec3::ZERO } } else { *bounds };
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        let largest = min.abs().max(max.abs()).max_element();
        let extent = ((max - min) * 0.5).max_element();
        // 1e-60: below any f32 distance, far above where the inverse would overflow.
        let pad = (extent / 512.0).max(largest * 2.0_f64.powi(-26)).max(1e-60);
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
            half: half.to_array(),
            middle: middle.into(),
            unit,
            world: 1.0 / unit,
            room: half.into(),
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
        let gate = match self.near(ray) {
            Gate::At(at) => at,
            Gate::Miss => return Start::Miss,
            // What is not inlined takes nothing by reference that is in registers here.
            _ => match self.afar(ray) {
                Gate::At(at) => at,
                Gate::Miss => return Start::Miss,
                Gate::TooFar => return Start::TooFar,
            },
        };
        let Heading { direction, inverse, sign, size } = gate.heading;
        let At { at: origin, end, shift, seen, fuzz, rate, begin, finish, apart, .. } = gate;
        let sight = Sight { origin: seen, direction, fuzz, rate, begin, end: finish, apart };
        let mut entry = Entry { origin, inverse, sign, size, end: end + SLACK, shift, sight };
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

    /// A ray that starts within [`SEEING`] and has no part before that, in f32; [`Gate::TooFar`] of others that do not certainly miss.
    ///
    /// Where the ray enters and leaves need not be known well, as long as the point there is: there is a margin of 2^-11 around the
    /// primitives. In f32 and for origins within [`NEAR`], distances from faces over components are off by `4 e NEAR` of the
    /// part, and [`LEAST`] in the place of a smaller component moves the ray by `NEAR e / 4`: 2^-13 in all.
    #[inline(always)]
    fn near(&self, ray: &Ray) -> Gate {
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
            return Gate::TooFar;
        }
        let (heading, rate) = (Heading::new(course), self.unit * grow);
        let ahead = from * heading.sign;
        let (low, high) = ((-self.room - ahead) * heading.inverse, (self.room - ahead) * heading.inverse);
        let (begin, finish) = (ray.t_min * rate, ray.t_max * rate);
        let start = most(low.max_element(), begin);
        let end = least(high.min_element(), finish);
        if start > end {
            return Gate::Miss;
        }
        // Units change exactly, but where numbers are too small.
        let exact = (seen * self.world).cmpeq(origin) & (course * grow).cmpeq(direction);
        if !((distance <= SEEING) & (begin >= 0.0) & exact.all()) {
            return Gate::TooFar;
        }
        Gate::At(At {
            at: from + start * heading.direction,
            heading,
            end: end - start,
            shift: start,
            seen,
            fuzz: 0.0,
            rate,
            begin: [begin; 2],
            finish: [finish; 2],
            apart: None,
        })
    }

    /// Any other ray, in f64.
    #[cold]
    #[inline(never)]
    fn afar(&self, ray: &Ray) -> Gate {
        let origin = self.local(ray.origin.as_dvec3());
        if origin.abs().max_element() <= FAR {
            return self.afar_moved(origin, ray, 0.0);
        }
        let (origin, moved, axis) = nearer(ray, self.centre, self.centre);
        let origin = origin * self.scale;
        let size = origin.abs().max_element();
        if origin[axis].abs() > 4.0 && size > FAR {
            return Gate::TooFar;
        }
        // Beside the box while it is level with it: along no other axis does it move faster.
        if size > 16.0 {
            return if origin[axis].abs() <= 4.0 { Gate::Miss } else { self.afar_moved(origin, ray, moved) };
        }
        self.afar_moved(origin, ray, moved)
    }

    /// As [`Frame::afar`], for a ray that has been moved by a parameter.
    ///
    /// With `u = 2^-53`, the origin in the part's coordinates is off by `2 u FAR`, and so are the parameters of entry and exit,
    /// up to a factor of 8: 2^-29 in all, against the margin of 2^-11.
    fn afar_moved(&self, origin: DVec3, ray: &Ray, moved: f64) -> Gate {
        let direction = ray.direction.as_dvec3() * self.scale;
        let size = direction.abs();
        // Twice the greatest power of two in it; never subnormal, as f32 has at least 2^-149 and scales are above 2^-130.
        let bits = size.max_element().to_bits() & !((1 << 52) - 1);
        let rate = f64::from_bits(bits + (1 << 52));
        let course = direction * f64::from_bits((2045 << 52) - bits);
        // More than the rounding of a difference with `moved`.
        let slack = 4.0 * f64::EPSILON * moved.abs() * rate;
        let mut start = (f64::from(ray.t_min) - moved) * rate - slack;
        let mut end = (f64::from(ray.t_max) - moved) * rate + slack;
        for axis in 0..3 {
            let (o, d, half) = (origin[axis], course[axis], f64::from(self.half[axis]));
            if d == 0.0 {
                if o.abs() >= half {
                    return Gate::Miss;
                }
                continue;
            }
            let (a, b) = ((-half - o) / d, (half - o) / d);
            start = greater(lesser(a, b), start);
            end = lesser(greater(a, b), end);
        }
        if start > end {
            return Gate::Miss;
        }
        let at = origin + start * course;
        let seen = (at + self.centre * self.scale).as_vec3();
        let slack = 2.0 * slack;
        let p = |t: f32| around((f64::from(t) - moved) * rate - start, slack);
        Gate::At(At {
            at: at.as_vec3a(),
            heading: Heading::new(course.as_vec3a()),
            end: (end - start) as f32,
            shift: 0.0,
            seen: seen.into(),
            // Half a unit in the last place, and more than f64's rounding.
            fuzz: (seen.abs().max_element() + 0.25) * f32::EPSILON * 0.5,
            rate: 0.0,
            begin: p(ray.t_min),
            finish: p(ray.t_max),
            apart: Some(Course {
                origin: ray.origin.as_dvec3() * self.scale,
                direction: course,
                start: if moved == 0.0 { start } else { f64::NAN },
                moved,
                begin: start,
                rate,
                slack,
            }),
        })
    }
}

/// Whether and how a ray meets a part's box.
#[allow(clippy::large_enum_variant, reason = "taken apart where it is returned")]
enum Gate {
    Miss,
    /// It starts too far away to tell.
    TooFar,
    At(At),
}

/// A ray where it enters a box.
struct At {
    at: Vec3A,
    heading: Heading,
    /// At or beyond the `s` of its end or where it leaves.
    end: f32,
    /// The rest is as in [`Entry`] and [`Sight`].
    shift: f32,
    seen: Vec3A,
    fuzz: f32,
    rate: f32,
    begin: [f32; 2],
    finish: [f32; 2],
    apart: Option<Course>,
}

impl Heading {
    /// That of a direction whose greatest component is 0.5 to 1 or -1 to -0.5.
    #[inline(always)]
    fn new(direction: Vec3A) -> Self {
        let size = direction.abs().max(Vec3A::splat(LEAST));
        Self { direction, inverse: Vec3A::ONE / size, sign: Vec3A::ONE.copysign(direction), size }
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
