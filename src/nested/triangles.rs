//! Packs of eight triangles: the test of Möller and Trumbore with bounds on its errors.
//!
//! After T. Möller and B. Trumbore, "Fast, minimum storage ray/triangle intersection", 1997. Departs from it: nothing is decided
//! that rounding leaves open. What is certainly missed is rejected, what is certainly hit is accepted with an interval of its
//! parameter, and the rest survives, to be tested exactly.

use super::crowd::Wall;
use super::lanes::{Lanes, Row, Vector};
use super::pack::{Pack, PackRay, Seen, Verdict, padded};
use super::sight::{Course, Sight};
use crate::geometry::expansion::two_sum;
use crate::ray::{greater, lesser};
use glam::{DVec3, Vec3};

/// Eight triangles in the part's unit, from the world's origin: their corners exactly.
///
/// With `c` the first corner seen from the ray's origin, `e1` and `e2` the edges from it to the others, `d` the direction
/// and `D = d . (e1 x e2)`, the ray meets the plane at `p = c . (e1 x e2) / D` in the point with the barycentric
/// coordinates `U / D`, `V / D` and `W / D`, where `U = (c x d) . e2`, `V = -(c x d) . e1` and `W = D - U - V`. It meets
/// the triangle if `U`, `V`, `W` have the same sign.
///
/// With `e = 2^-24`, `K` the greatest component of `c` and `L` of all edges, `f` the [fuzz](PackRay::fuzz) of the origin,
/// components of `d` of at most 1, and every operation rounded:
///
/// - `c` is off by `e K + f` a component, the edges by `e L`, `c x d` by `2 (e K + f) + 4 e K`, and is `2 K` at most.
/// - `U` and `V`: `3 L (6 e K + 2 f)` of the cross product, `6 e K L` of the edge, `6 + 10` of products and sums:
///   `40 e K L + 6 f L`.
/// - `e1 x e2` is off by `8 e L^2`, `D` by three times that and `16 e L^2` of products and sums: `40 e L^2`.
/// - `W`: the sum of these, and `12 e L^2 + 18 e K L` for two differences: `98 e K L + 52 e L^2 + 12 f L`.
/// - `c . (e1 x e2)`: `24 e L^2 K` of the cross product, `6 L^2 (e K + f)` of `c`, `16 e L^2 K` of products and sums:
///   `46 e L^2 K + 6 f L^2`.
///
/// [`SIDE`] `(K + L) L + 14 f L` is more than the bounds of `U`, `V` and `W` by a fourteenth, which is far more than the
/// terms of higher order. If two of them have opposite signs for certain, the ray misses; if all three have the same for
/// certain, it hits.
///
/// Where `|D|` is above eight times its bound, the quotient `p` is off by
/// `8/7 (46 e L^2 K + 6 f L^2 + 40 e L^2 |p|) / |D|`, and by `3 e |p|` for the division and for adding the bound to it:
/// with `|D| <= 6 L^2` that is less than another `18 e L^2 |p| / |D|`. Hence [`HEIGHT`], [`DEPTH`] and `7 f`; where `|D|`
/// is less, the interval says nothing.
///
/// Numbers are below 2^28, so that nothing overflows, and [`TINY`] is more than what underflow takes away. A lane that holds no
/// triangle has corners in one point and `L` minus infinity, which makes its bound minus infinity: it is always missed.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrianglePack {
    corners: [[Row; 3]; 3],
    /// `L`.
    longest: Row,
    prims: [u32; 8],
}

const E: f32 = 1.0 / 16_777_216.0;
const SIDE: f32 = 112.0 * E;
const HEIGHT: f32 = 56.0 * E;
const DEPTH: f32 = 72.0 * E;
const TINY: f32 = 1e-36;

/// From roundings of f32 to those of f64.
const DOUBLE: f64 = 1.0 / (1 << 29) as f64;
/// More than what underflow of inputs takes away.
const LEAST: f64 = 1e-40;

/// What the test computes in f64 of a triangle.
#[derive(Clone, Copy)]
struct Facet {
    c: DVec3,
    e1: DVec3,
    e2: DVec3,
    /// `c . (e1 x e2)`, `D`, `K` and `L`.
    volume: f64,
    determinant: f64,
    away: f64,
    longest: f64,
}

/// What it computes of the edges.
#[derive(Clone, Copy)]
struct Sides {
    low: f64,
    high: f64,
    bound: f64,
}

/// What it computes of the plane.
#[derive(Clone, Copy)]
struct Plane {
    /// The parameter where the ray meets it, and its bound, which holds where the ray is steep enough.
    p: f64,
    bound: f64,
    steep: bool,
}

impl TrianglePack {
    /// At most eight triangles, with their indices.
    pub fn new(triangles: impl Iterator<Item = (u32, [Vec3; 3])>) -> Self {
        let none = Row([0.0; 8]);
        let mut pack =
            Self { corners: [[none; 3]; 3], longest: Row([f32::NEG_INFINITY; 8]), prims: padded(std::iter::empty()) };
        for (lane, (prim, corners)) in triangles.take(8).enumerate() {
            let [a, b, c] = corners;
            for (rows, corner) in pack.corners.iter_mut().zip(corners) {
                for (axis, row) in rows.iter_mut().enumerate() {
                    row.0[lane] = corner[axis];
                }
            }
            let longest = (b - a).abs().max((c - a).abs()).max_element();
            // Rounded up by more than the rounding of the differences.
            pack.longest.0[lane] = longest * (1.0 + 4.0 * E);
            pack.prims[lane] = prim;
        }
        pack
    }

    /// A triangle as f64 sees it from the ray's own origin: all of it is exact.
    #[inline(always)]
    fn at(&self, lane: usize, ray: &Course) -> Facet {
        let [[ax, ay, az], [bx, by, bz], [fx, fy, fz]] = &self.corners;
        let a = DVec3::new(ax.0[lane].into(), ay.0[lane].into(), az.0[lane].into());
        let b = DVec3::new(bx.0[lane].into(), by.0[lane].into(), bz.0[lane].into());
        let far = DVec3::new(fx.0[lane].into(), fy.0[lane].into(), fz.0[lane].into());
        let (c, e1, e2) = (a - ray.origin, a - b, far - a);
        let normal = e2.cross(e1);
        Facet {
            c,
            e1,
            e2,
            volume: c.dot(normal),
            determinant: normal.dot(ray.direction),
            away: greater(greater(c.x.abs(), c.y.abs()), c.z.abs()),
            longest: f64::from(self.longest.0[lane]),
        }
    }
}

impl Facet {
    /// Bounds on the errors of the plane's numbers: what grows with `p` and what does not.
    #[inline(always)]
    fn bounds(&self) -> [f64; 2] {
        let square = self.longest * self.longest;
        let depth = square * (DOUBLE * f64::from(DEPTH));
        [depth, square * (self.away * (DOUBLE * f64::from(HEIGHT))) + LEAST]
    }

    /// True if the plane is certainly behind the ray's own origin, for a ray that begins there or later.
    #[inline(always)]
    fn behind(&self) -> bool {
        let [depth, height] = self.bounds();
        let size = self.determinant.abs();
        // The parameter times the size; a bound of an eighth of it, and the height.
        let ahead = if self.determinant < 0.0 { -self.volume } else { self.volume };
        8.0 * depth < size && 0.875 * ahead + height < 0.0
    }

    /// The least and the greatest of `U`, `V`, `W`, and their bound: with `e` being 2^-53 as in f32.
    #[inline(always)]
    fn sides(&self, ray: &Course) -> Sides {
        let across = self.c.cross(ray.direction);
        let (u, v) = (across.dot(self.e2), across.dot(self.e1));
        let w = self.determinant - u - v;
        Sides {
            low: lesser(lesser(u, v), w),
            high: greater(greater(u, v), w),
            bound: self.longest * (DOUBLE * f64::from(SIDE) * (self.away + self.longest.abs())) + LEAST,
        }
    }

    /// Where the ray meets the plane.
    #[inline(always)]
    fn plane(&self, ray: &Course) -> Plane {
        let ([depth, height], size) = (self.bounds(), self.determinant.abs());
        let p = self.volume / self.determinant;
        Plane { p: p - ray.start, bound: (height + p.abs() * depth) / size, steep: 8.0 * depth < size }
    }
}

impl Sides {
    /// True if the ray's line certainly misses.
    #[inline(always)]
    fn outside(&self) -> bool {
        (self.high > self.bound) & (self.low < -self.bound)
    }
}

impl Pack for TrianglePack {
    #[inline(always)]
    fn look<S: Lanes>(&self, ray: &PackRay<S>, end: S) -> Seen<S> {
        let a = Vector::<S>::of(&self.corners[0]);
        let c = a.minus(&ray.origin);
        // The first edge backwards, which saves changes of sign.
        let e1 = a.minus(&Vector::of(&self.corners[1]));
        let e2 = Vector::of(&self.corners[2]).minus(&a);
        let longest = S::of(&self.longest);
        let across = c.cross(&ray.direction);
        let normal = e2.cross(&e1);
        let (u, v) = (across.dot(&e2), across.dot(&e1));
        let determinant = normal.dot(&ray.direction);
        let w = determinant - u - v;
        let (low, high) = (u.min(v).min(w), u.max(v).max(w));
        let away = c.size();
        let reach = (S::splat(14.0) * ray.fuzz).plus_product(away + longest.abs(), S::splat(SIDE));
        let bound = S::splat(TINY).plus_product(longest, reach);
        let below = S::splat(0.0) - bound;
        let outside = bound.less(high) & low.less(below);
        let left = !S::bits(outside) & 0xff;
        if left == 0 {
            return Seen::nothing();
        }
        let inverse = S::splat(1.0) / determinant;
        let p = c.dot(&normal) * inverse;
        let square = longest * longest;
        let depth = square * S::splat(DEPTH);
        let height =
            S::splat(TINY).plus_product(square, (S::splat(7.0) * ray.fuzz).plus_product(away, S::splat(HEIGHT)));
        let steep = (S::splat(8.0) * depth).less(determinant.abs());
        let margin = height.plus_product(p.abs(), depth) * inverse.abs();
        let out_of_range = steep & (end.less(p - margin) | (p + margin).less(ray.least));
        Seen {
            survivors: left & !S::bits(out_of_range),
            certain: steep & (bound.less(low) | high.less(below)),
            p,
            bound: margin,
        }
    }

    #[inline(always)]
    fn look_rounded<S: Lanes>(&self, ray: &PackRay<S>, end: S) -> Seen<S> {
        let zero = S::splat(0.0);
        let a = Vector::<S>::of(&self.corners[0]);
        let c = a.minus(&ray.origin);
        let e1 = a.minus(&Vector::of(&self.corners[1]));
        let e2 = Vector::of(&self.corners[2]).minus(&a);
        let (across, normal) = (c.cross(&ray.direction), e2.cross(&e1));
        let (u, v) = (across.dot(&e2), across.dot(&e1));
        let determinant = normal.dot(&ray.direction);
        let w = determinant - u - v;
        let outside = zero.less(u.max(v).max(w)) & u.min(v).min(w).less(zero);
        let left = !S::bits(outside) & 0xff;
        if left == 0 {
            return Seen::nothing();
        }
        let p = c.dot(&normal) * (S::splat(1.0) / determinant);
        // Lanes without a triangle have no determinant, and a NaN for `p`.
        let in_range = !S::bits(end.less(p) | p.less(ray.begin)) & S::bits(p.less(S::splat(f32::INFINITY)));
        Seen { survivors: left & in_range, certain: zero.less(zero), p, bound: zero }
    }

    #[inline(never)]
    fn judge(&self, lane: usize, sight: &Sight, end: f32) -> Verdict {
        let ray = sight.course();
        let seen = self.at(lane, &ray);
        // What a ray starts from, mostly.
        if sight.is_from_origin() && seen.behind() {
            return Verdict::Miss;
        }
        let sides = seen.sides(&ray);
        if sides.outside() {
            return Verdict::Miss;
        }
        let Plane { p, bound, steep } = seen.plane(&ray);
        if !steep {
            return Verdict::Open;
        }
        sight.judge(p, bound, end, sides.low > sides.bound || sides.high < -sides.bound)
    }

    /// Scalar loops without branches: the compiler makes vectors of them.
    #[inline(always)]
    fn missed(&self, sight: &Sight, end: f32) -> u32 {
        let ray = sight.course();
        let mut missed = 0;
        for lane in 0..8 {
            missed |= u32::from(self.at(lane, &ray).sides(&ray).outside()) << lane;
        }
        if missed == 0xff {
            return missed;
        }
        let (begin, end) = (f64::from(sight.begin[0]), f64::from(end));
        for lane in 0..8 {
            let Plane { p, bound, steep } = self.at(lane, &ray).plane(&ray);
            missed |= u32::from(steep & ((p + bound < begin) | (p - bound > end))) << lane;
        }
        missed
    }

    #[inline(always)]
    fn crossed(&self, sight: &Sight) -> u32 {
        let ray = sight.course();
        let mut crossed = 0;
        for lane in 0..8 {
            crossed |= u32::from(self.at(lane, &ray).plane(&ray).steep) << lane;
        }
        crossed
    }

    fn corner(&self, lane: usize, sight: &Sight) -> Option<[f32; 3]> {
        let ray = sight.course();
        let d = ray.direction.to_array();
        self.corners.iter().map(|rows| rows.each_ref().map(|row| row.0[lane])).find(|corner| {
            let mut c = [0.0; 3];
            for axis in 0..3 {
                let (difference, error) = two_sum(f64::from(corner[axis]), -ray.origin[axis]);
                // With 24 bits each, factors have exact products.
                if error != 0.0 || f64::from(difference as f32) != difference {
                    return false;
                }
                c[axis] = difference;
            }
            [(0, 1), (1, 2), (2, 0)].iter().all(|&(i, j)| c[i] * d[j] == c[j] * d[i])
        })
    }

    #[inline(always)]
    fn beside<S: Lanes>(&self, wall: &Wall) -> u32 {
        let (at, normal) = (Vector::<S>::splat(wall.corner.into()), Vector::splat(wall.normal.into()));
        let (zero, least) = (S::splat(0.0), S::splat(f32::from_bits(1)));
        let (mut above, mut below) = (0xff, 0xff);
        for rows in &self.corners {
            let c = Vector::<S>::of(rows).minus(&at);
            let (height, size) = (c.dot(&normal), c.size());
            let bound = S::splat(TINY).plus_product(size, S::splat(wall.slack));
            let there = S::bits(size.less(least));
            above &= S::bits(bound.less(height)) | there;
            below &= S::bits(height.less(zero - bound)) | there;
        }
        above | below
    }

    #[inline(always)]
    fn common<S: Lanes>(&self, lane: usize) -> Option<[f32; 3]> {
        let (mut most, mut common) = (2, None);
        for [x, y, z] in &self.corners {
            let corner = [x.0[lane & 7], y.0[lane & 7], z.0[lane & 7]];
            let count = self.lanes_at::<S>(&corner).count_ones();
            if count > most {
                (most, common) = (count, Some(corner));
            }
        }
        common
    }

    #[inline(always)]
    fn lanes_at<S: Lanes>(&self, corner: &[f32; 3]) -> u32 {
        let Vector { x, y, z } = Vector::<S>::splat((*corner).into());
        let mut lanes = 0;
        for rows in &self.corners {
            let Vector { x: a, y: b, z: c } = Vector::<S>::of(rows);
            let differs = a.less(x) | x.less(a) | b.less(y) | y.less(b) | c.less(z) | z.less(c);
            lanes |= !S::bits(differs);
        }
        lanes & 0xff
    }

    #[inline(always)]
    fn prims(&self) -> &[u32; 8] {
        &self.prims
    }
}
