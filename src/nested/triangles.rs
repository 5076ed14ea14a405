//! Packs of eight triangles, each as three affine functions: distance from its plane and two barycentric coordinates.
//!
//! After S. Woop, "A ray tracing hardware architecture for dynamic scenes", 2004: a triangle is the map that turns it into the
//! unit triangle. Departs from it: the map's rows are kept as a unit normal and two gradients, so that one bound on the error
//! holds for all three barycentric coordinates, and only certain misses are rejected and certain hits accepted.

use super::lanes::{Lanes, Row, Vector};
use super::pack::{Pack, PackRay, Seen, padded};
use glam::DVec3;

/// Eight triangles in a part's coordinates.
///
/// With the unit normal `n`, the plane is `n . x = n0`; the barycentric coordinates of the second and third corner are
/// `u = a . x + a0` and `v = b . x + b0`, that of the first is `1 - u - v`.
///
/// What a ray that meets the triangle must look like, with `e = 2^-24`: coordinates of its points are at most 1, `s` at most 4,
/// its origin is off by `1.1 e` an axis and its direction by `e / 2` (see [`super::frame`]), and `|n|_1`, the sum of the
/// components' sizes, is at most 1.74.
///
/// - `D = n . d` is off by `1.74 (1 + 1/2 + 3) e < 8 e` (rounding of `n`; the direction; the sum), `N = n0 - n . o` by
///   `1.74 (1 + 1 + 1.1 + 3 + 2) e < 15 e` (`n0`; `n`; the origin; the sum; the difference).
/// - With the true `s`, `N / D - s = (dN - s dD) / D`: at most `(15 + 4 * 8) e / |D|`, where `D` is the computed one. Rounding
///   of the inverse and of the product adds `2 e s <= 8 e <= 14 e / |D|`. So `s` is known within `61 e q` with `q = 1 / |D|`.
/// - A coordinate of the point at `s` is off by that, and by `(1.1 + 2 + 2 + 1) e` (origin; direction; product; sum), in all less
///   than `(61 + 1.74 * 7) e q`. With `A = |a|_1`, `u` is off by `A` times that and by `A (2 * 5) e` (rounding of `a` and `a0`, which is
///   at most `A`; the sums): less than `A (61 + 1.74 * 17) e q < 91 A e q`. For `1 - u - v` errors add up, with two roundings more.
///
/// So a ray whose smallest barycentric coordinate is below minus the bound, or whose interval of `s` is out of range, misses.
/// For a certain hit the same bounds are asked of computed values: where `8 e q` is at most an eighth and `s` in range, `s`
/// is known within `(15 + 4.2 * 8) 8/7 e q + 15 e q < 71 e q` and `u` within `101 A e q`, whatever the true values are; so a ray
/// whose smallest coordinate is above the bound meets the triangle. [`S_BOUND`] is 80, and twice that for certain hits;
/// [`BARYCENTRIC_BOUND`] is 112, times the sum of both gradients.
///
/// `D = 0` makes `q` infinite and every comparison false: such a lane survives. Nothing else overflows: components of `n` and
/// of the gradients are 0 or above [`TINY`] times the greatest one and directions above 2^-26, so that `|D|` is 0 or above 2^-91, and
/// gradients above 2^30 are not kept, nor are those of triangles whose sine of the smallest angle is so small, below 2^-20,
/// that f64 would get them wrong by more than 2^-30: their bound is infinite.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrianglePack {
    n: [Row; 3],
    n0: Row,
    a: [Row; 3],
    a0: Row,
    b: [Row; 3],
    b0: Row,
    /// [`BARYCENTRIC_BOUND`] `(|a|_1 + |b|_1)`.
    bound: Row,
    prims: [u32; 8],
}

const E: f32 = 1.0 / 16_777_216.0;
const S_BOUND: f32 = 80.0 * E;
const BARYCENTRIC_BOUND: f64 = 112.0 * E as f64;
const TINY: f64 = 1.0 / (1u64 << 40) as f64;

/// One triangle's rows.
#[derive(Clone, Copy)]
struct Map {
    n: [f32; 3],
    n0: f32,
    a: [f32; 3],
    a0: f32,
    b: [f32; 3],
    b0: f32,
    bound: f32,
}

impl Map {
    /// A lane that holds none: `u` is -1 wherever the ray goes, and `D` is never 0.
    const NONE: Map = Map { n: [1.0, 0.0, 0.0], n0: 0.0, a: [0.0; 3], a0: -1.0, b: [0.0; 3], b0: -1.0, bound: 0.0 };

    /// A lane that always survives.
    const OPEN: Map = Map { n0: 1.0, n: [0.0; 3], a0: 0.0, b0: 0.0, bound: f32::INFINITY, ..Map::NONE };

    /// The map of a triangle with these corners.
    fn of(corners: &[DVec3; 3]) -> Self {
        let [p, q, r] = *corners;
        let (e1, e2) = (q - p, r - p);
        let n = e1.cross(e2);
        let square = n.length_squared();
        let size = square.sqrt();
        let longest = e1.length().max(e2.length()).max((r - q).length());
        let (a, b) = (e2.cross(n) / square, n.cross(e1) / square);
        let sum = |v: DVec3| v.abs().element_sum();
        let gradients = sum(a) + sum(b);
        // Written so that a NaN leaves the lane open.
        let sound = size > longest * longest / 1_048_576.0 && gradients < 1_073_741_824.0;
        if !sound {
            return Self::OPEN;
        }
        let n = n / size;
        let rounded = |v: DVec3| {
            let least = v.abs().max_element() * TINY;
            v.to_array().map(|x| if x.abs() < least { 0.0 } else { x as f32 })
        };
        Self {
            n: rounded(n),
            n0: n.dot(p) as f32,
            a: rounded(a),
            a0: -a.dot(p) as f32,
            b: rounded(b),
            b0: -b.dot(p) as f32,
            // f32 rounds it by less than there is to spare.
            bound: (BARYCENTRIC_BOUND * gradients) as f32,
        }
    }
}

impl TrianglePack {
    /// At most eight triangles, with their indices.
    pub fn new(triangles: impl ExactSizeIterator<Item = (u32, [DVec3; 3])> + Clone) -> Self {
        let mut maps = [Map::NONE; 8];
        maps.iter_mut().zip(triangles.clone()).for_each(|(map, (_, corners))| *map = Map::of(&corners));
        let rows = |f: fn(&Map) -> [f32; 3]| [0, 1, 2].map(|axis| Row::of(|i| f(&maps[i])[axis]));
        let row = |f: fn(&Map) -> f32| Row::of(|i| f(&maps[i]));
        Self {
            n: rows(|m| m.n),
            n0: row(|m| m.n0),
            a: rows(|m| m.a),
            a0: row(|m| m.a0),
            b: rows(|m| m.b),
            b0: row(|m| m.b0),
            bound: row(|m| m.bound),
            prims: padded(triangles.map(|(prim, _)| prim)),
        }
    }
}

impl Pack for TrianglePack {
    #[inline(always)]
    fn look<S: Lanes>(&self, ray: &PackRay<S>, end: S) -> Seen<S> {
        let n = Vector::<S>::of(&self.n);
        let inverse = S::splat(1.0) / n.dot(&ray.direction);
        let s = (S::of(&self.n0) - n.dot(&ray.origin)) * inverse;
        let at = ray.origin.beyond(s, &ray.direction);
        let u = Vector::of(&self.a).dot(&at) + S::of(&self.a0);
        let v = Vector::of(&self.b).dot(&at) + S::of(&self.b0);
        let q = inverse.abs();
        let inside = u.min(v).min(S::splat(1.0) - u - v);
        let margin = S::of(&self.bound) * q;
        let bound = S::splat(S_BOUND) * q;
        let misses = (inside + margin).less(S::splat(0.0)) | end.less(s - bound) | (s + bound).less(ray.least);
        Seen {
            survivors: !S::bits(misses) & 0xff,
            certain: margin.less(inside) & bound.less(S::splat(0.5)),
            s,
            bound: bound + bound,
        }
    }

    #[inline(always)]
    fn prims(&self) -> &[u32; 8] {
        &self.prims
    }
}
