//! Packs of eight spheres: the point of the ray nearest to the centre, with bounds on the errors.

use super::lanes::{Lanes, Row, Vector};
use super::pack::{Pack, PackRay, Seen, Verdict, padded};
use super::sight::{Course, Sight};
use glam::{DVec3, Vec3};

/// Eight spheres in the part's unit, from the world's origin: centre and radius exactly.
///
/// With `c` the centre seen from the ray's origin and `d` the direction, the ray is nearest to the centre at
/// `m = (c . d) / |d|^2`, at the distance `|g|`, `g = c - m d`, and meets the sphere half a chord,
/// `sqrt((r^2 - g^2) / |d|^2)`, before and behind that.
///
/// With `e = 2^-24`, `K` the greatest component of `c` and `f` the [fuzz](PackRay::fuzz) of the origin: `c` is off by
/// `e K + f` a component, `c . d` by `3 (e K + f) + 3 e K + 5 e K`, and `m`, the square of `d` being 1/4 at least and `|m|`
/// at most `3.5 K`, by `q = 70 e K + 12 f`. That `g` is not at the nearest point adds `3 q^2` at most to its square;
/// otherwise it is off by `1.74 (e K + f)` of `c` and `9.2 e K` of product and difference, in all less than `12 e K + 2 f`.
/// So where the ray meets the sphere, `g^2 <= (r + 12 e K + 2 f)^2 + 3 q^2`, but for the rounding of these squares, `8 e`
/// of themselves. `R` is the radius with that added: [`WIDER`], [`NEARER`].
///
/// Most spheres are far from the ray, so a first look asks less: `K` is below 5, as rays start within four halves of the
/// part or in it, and radii are below 1. With that in the place of `K` and `r` only the radius itself is loaded; what is
/// left is looked at as above.
///
/// What the inflation, the true line's place and rounding change of `R^2 - g^2` is below
/// `4 R (12 e K + 2 f + 4 e R) + 8 e R^2 + 6 q^2`. Where `R^2 - g^2` is above a sixteenth of `R^2` and `R` above [`SMALL`]
/// `K + 192 f`, half the chord is `R / 4` or longer, so it is off by four times that over `R`: less than
/// `(192 e K + 32 f + 96 e R) + (130 e K + 30 f)`. With the rounding of `m` and of the sum, [`CHORD`] `(K + R)` and `96 f`
/// bound the error of the hit's parameter; and the sphere itself is met, as what the inflation adds is far less than that
/// sixteenth.
///
/// A sphere whose surface is before the ray's origin and whose centre is behind it is missed by a ray that does not run
/// backwards. That is asked by `c^2 - r^2`, off by `6 K (e K + f) + 3 f^2 + 11 e K^2` and `2 e r^2`, and by `c . d`: so a
/// ray that starts on a sphere certainly does not meet it ([`OUTSIDE`]).
///
/// What underflows in squares and products is less than [`TINY`], which is added to each of them; its square root, and what
/// it changes of the chord of a sphere with a radius above [`SPECK`], are less than that.
///
/// A lane that holds none has a radius of minus infinity and is outside, its square being taken with its sign.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpherePack {
    centre: [Row; 3],
    radius: Row,
    prims: [u32; 8],
}

const E: f32 = 1.0 / 16_777_216.0;
const WIDER: f32 = 16.0 * E;
const NEARER: f32 = 128.0 * E;
/// The greatest distance from the ray's origin along an axis, and the greatest radius.
const MOST: f32 = 5.0;
const LARGEST: f32 = 1.0;
const SMALL: f32 = 1536.0 * E;
const CHORD: f32 = 512.0 * E;
const OUTSIDE: f32 = 28.0 * E;
const TINY: f32 = 1e-36;
const SPECK: f32 = 1e-15;

/// From roundings of f32 to those of f64.
const DOUBLE: f64 = 1.0 / (1 << 29) as f64;

impl SpherePack {
    /// What is added to any radius at a first look, of a ray whose origin is off by `fuzz`, and to its square.
    #[inline(always)]
    pub fn wider(fuzz: f32) -> [f32; 2] {
        let off = 24.0 * fuzz + MOST * NEARER;
        [2.0 * fuzz + (MOST + LARGEST) * WIDER, off * off + TINY]
    }

    /// At most eight spheres, as index, centre and radius.
    pub fn new(spheres: impl Iterator<Item = (u32, Vec3, f32)>) -> Self {
        let none = Row([0.0; 8]);
        let mut pack =
            Self { centre: [none; 3], radius: Row([f32::NEG_INFINITY; 8]), prims: padded(std::iter::empty()) };
        for (lane, (prim, centre, radius)) in spheres.take(8).enumerate() {
            for (axis, row) in pack.centre.iter_mut().enumerate() {
                row.0[lane] = centre[axis];
            }
            pack.radius.0[lane] = radius;
            pack.prims[lane] = prim;
        }
        pack
    }
}

impl Pack for SpherePack {
    const SPHERES: bool = true;

    #[inline(always)]
    fn look<S: Lanes>(&self, ray: &PackRay<S>, end: S) -> Seen<S> {
        let (zero, two) = (S::splat(0.0), S::splat(2.0));
        let c = Vector::<S>::of(&self.centre).minus(&ray.origin);
        let along = c.dot(&ray.direction);
        let m = along * ray.inverse_square;
        let g = c.less_by(m, &ray.direction);
        let (beside, radius) = (g.dot(&g), S::of(&self.radius));
        // Minus infinity stays what it is.
        let wide = radius + ray.wider;
        let misses = ray.nearer.plus_product(wide, wide.abs()).less(beside);
        let left = !S::bits(misses) & 0xff;
        if left == 0 {
            return Seen::nothing();
        }
        let away = c.size();
        let wide = (radius + two * ray.fuzz).plus_product(away + radius, S::splat(WIDER));
        let off = (S::splat(24.0) * ray.fuzz).plus_product(away, S::splat(NEARER));
        let tiny = S::splat(TINY);
        let square = (wide * wide.abs()).plus_product(off, off) + tiny;
        let within = square - beside;
        let misses = within.less(zero);
        let chord = (within.max(zero) * ray.inverse_square).sqrt();
        let bound = (S::splat(96.0) * ray.fuzz + S::splat(SPECK)).plus_product(away + wide, S::splat(CHORD));
        let outside = c.dot(&c) - radius * radius;
        let unsure = (S::splat(8.0) * ray.fuzz).plus_product(away, S::splat(OUTSIDE)) * (away + ray.fuzz);
        let unsure = unsure.plus_product(radius * radius, S::splat(4.0 * E)) + tiny;
        let sideways = (S::splat(4.0) * ray.fuzz + tiny).plus_product(away, S::splat(12.0 * E));
        let receding = unsure.less(outside) & (along + sideways).less(ray.ahead);
        let out_of_range = misses | receding | end.less(m - chord - bound) | (m + chord + bound).less(ray.least);
        let small = (S::splat(192.0) * ray.fuzz + S::splat(SPECK)).plus_product(away, S::splat(SMALL));
        Seen {
            survivors: left & !S::bits(out_of_range),
            certain: (square * S::splat(0.0625)).less(within) & small.less(wide),
            p: m - chord,
            bound,
        }
    }

    /// The same test with the same bounds, `e` being 2^-53, from the ray's own origin: all inputs are exact. Where the first of the
    /// two hits is certainly before the ray's begin, it judges the second.
    #[inline(never)]
    fn judge(&self, lane: usize, sight: &Sight, end: f32) -> Verdict {
        let Course { origin, direction: d, start, .. } = sight.course();
        let c = DVec3::from_array(self.centre.each_ref().map(|row| f64::from(row.0[lane]))) - origin;
        let (radius, away) = (f64::from(self.radius.0[lane]), c.abs().max_element());
        let (inverse_square, along) = (1.0 / d.dot(d), c.dot(d));
        let m = along * inverse_square;
        let g = c - m * d;
        let wide = radius + (away + radius) * (DOUBLE * f64::from(WIDER));
        let off = away * (DOUBLE * f64::from(NEARER));
        let tiny = f64::from(TINY);
        let square = wide * wide + off * off + tiny;
        let within = square - g.dot(g);
        if within < 0.0 {
            return Verdict::Miss;
        }
        // A ray from the outside that has no part before its origin and leads away: see above.
        let unsure =
            away * away * (DOUBLE * f64::from(OUTSIDE)) + radius * radius * (4.0 * DOUBLE * f64::from(E)) + tiny;
        let outside = c.dot(c) - radius * radius > unsure;
        let forwards = f64::from(sight.begin[1]) + start >= 0.0;
        if outside && forwards && along < -away * (12.0 * DOUBLE * f64::from(E)) - tiny {
            return Verdict::Miss;
        }
        let chord = (within * inverse_square).sqrt();
        let bound = (away + wide) * (DOUBLE * f64::from(CHORD)) + f64::from(SPECK);
        let certain = within > square * 0.0625 && wide > away * (DOUBLE * f64::from(SMALL)) + f64::from(SPECK);
        let (first, second) = (m - chord - start, m + chord - start);
        match sight.judge(first, bound, end, certain) {
            Verdict::Miss if first < f64::from(end) && certain => sight.judge(second, bound, end, certain),
            Verdict::Miss if first < f64::from(end) => Verdict::Open,
            verdict => verdict,
        }
    }

    #[inline(always)]
    fn prims(&self) -> &[u32; 8] {
        &self.prims
    }
}
