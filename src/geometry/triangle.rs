//! Triangles: the ray test in three stages, each certain of what it decides.
//!
//! 1. f32, sheared so that the ray runs along one axis (Woop, Benthin and Wald 2013, section 3): throws out certain
//!    misses, which are nearly all tests. Inlined into the accelerators' loops.
//! 2. f64, edge functions about the origin: throws out misses, accepts hits, knows `t` within a bound.
//! 3. Exact ([`super::exact`]), where the second stage's bounds leave a sign, the range or the order of two hits open.
//!
//! A value that is not finite makes every comparison of the first two stages false, so that such a triangle reaches the
//! third one, which refuses it.

use super::decided::Decided;
use super::exact::{Crossing, Sides};
use super::meeting::Point;
use super::{Best, Geometry, sphere};
use crate::ray::{Aabb, Ray};
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// A closed, two-sided triangle given by its corners, world units.
pub type Triangle = [Vec3; 3];

/// What the triangle tests of one ray share: the shear that turns its direction into the axis `z`, and what the exact stage
/// has decided. It serves one [`Best`].
#[derive(Debug)]
pub struct TrianglePrep {
    /// Axis of the direction's greatest component.
    z: usize,
    /// The direction's other components over the greatest, in -1..=1.
    shear_x: f32,
    shear_y: f32,
    pub(super) decided: Decided,
}

impl TrianglePrep {
    /// The shear of `ray`, computed in f64 so that directions of any length have one.
    pub(super) fn new(ray: &Ray) -> Self {
        let [dx, dy, dz] = ray.direction.abs().to_array();
        let z = if dx >= dy && dx >= dz { 0 } else { 1 + usize::from(dz > dy) };
        let (x, y) = ((z + 1) % 3, (z + 2) % 3);
        let d = ray.direction.as_dvec3().to_array();
        Self { z, shear_x: (d[x] / d[z]) as f32, shear_y: (d[y] / d[z]) as f32, decided: Decided::default() }
    }

    /// True if the triangle test goes on to its second stage; for measurements.
    #[cfg(feature = "cli")]
    pub(crate) fn passes(&self, ray: &Ray, corners: &Triangle) -> bool {
        !self.misses(ray.origin, corners)
    }

    /// True only if the ray's line certainly misses the closed triangle: all corners lie on one side of it along an
    /// axis, or two of the edge functions `U`, `V`, `W` have opposite signs.
    ///
    /// Corners relative to the origin are sheared to `(x - sx z, y - sy z)`, and the edge functions are cross products
    /// of two of them. With `e = 2^-24`, `p` the greatest of the sheared coordinates and `z` the greatest depth:
    /// coordinates relative to the origin are at most `p + z` and carry an error of `e (p + z)`, the shear's product
    /// one of `3 e z` (shear, depth, rounding), the final difference one of `e p`; so a sheared coordinate is known
    /// within `s = e (2 p + 4 z)`. An edge function is then known within
    /// `4 p s + 2 s^2 + 2 e p^2 + 2 e p^2 = 12 e p^2 + 16 e p z + 2 s^2`, the last two terms
    /// for the rounding of its products and of their difference. `5 e (p + z)`
    /// and `17 e (p + 3 e z) (p + z)` are more than these by a sixteenth at least, which is far more than the terms of
    /// higher order and the rounding of the bounds themselves.
    ///
    /// Underflow adds at most 2^-150 for each product, together less than 2^-126. An overflow or a NaN makes the bound
    /// infinite or NaN: an infinite or NaN coordinate comes with infinite `p` or `z` (the shear is at most 1, so that
    /// its product overflows only where `z` does) or from a corner that is not finite, and `p (p + z)` is at least as
    /// large as any product.
    #[inline]
    fn misses(&self, origin: Vec3, corners: &Triangle) -> bool {
        // The branch goes the same way for all tests of a ray; within it, axes are known and no index is checked.
        match self.z {
            0 => self.misses_along::<1, 2, 0>(origin, corners),
            1 => self.misses_along::<2, 0, 1>(origin, corners),
            _ => self.misses_along::<0, 1, 2>(origin, corners),
        }
    }

    #[inline(always)]
    fn misses_along<const X: usize, const Y: usize, const Z: usize>(&self, origin: Vec3, corners: &Triangle) -> bool {
        const E: f32 = 1.0 / (1 << 24) as f32;
        let origin: &[f32; 3] = origin.as_ref();
        let shear = |corner: &Vec3| {
            let corner: &[f32; 3] = corner.as_ref();
            let z = corner[Z] - origin[Z];
            let x = (corner[X] - origin[X]) - self.shear_x * z;
            let y = (corner[Y] - origin[Y]) - self.shear_y * z;
            (x, y, z.abs())
        };
        let ((ax, ay, az), (bx, by, bz), (cx, cy, cz)) = (shear(&corners[0]), shear(&corners[1]), shear(&corners[2]));
        let z = max3(az, bz, cz);
        let (low_x, high_x) = (min3(ax, bx, cx), max3(ax, bx, cx));
        let (low_y, high_y) = (min3(ay, by, cy), max3(ay, by, cy));
        let p = max(max(high_x, -low_x), max(high_y, -low_y));
        // The greatest distance by which all corners clear the ray; one comparison and one branch.
        let margin = 5.0 * E * (p + z) + f32::MIN_POSITIVE;
        if max(max(low_x, -high_x), max(low_y, -high_y)) > margin {
            return true;
        }
        let (u, v, w) = (cx * by - cy * bx, ax * cy - ay * cx, bx * ay - by * ax);
        let bound = 17.0 * E * ((p + 3.0 * E * z) * (p + z)) + f32::MIN_POSITIVE;
        max3(u, v, w) > bound && min3(u, v, w) < -bound
    }
}

/// The greater one, `b` if one is NaN: one instruction.
#[inline(always)]
fn max(a: f32, b: f32) -> f32 {
    if a > b { a } else { b }
}

#[inline(always)]
fn max3(a: f32, b: f32, c: f32) -> f32 {
    max(max(a, b), c)
}

#[inline(always)]
fn min3(a: f32, b: f32, c: f32) -> f32 {
    let ab = if a < b { a } else { b };
    if ab < c { ab } else { c }
}

/// Tests triangle `prim` of `set`, whose corners are given; see [`Geometry::test`].
#[inline]
pub(super) fn test<G: Geometry + ?Sized>(
    set: &G,
    prim: u32,
    corners: &Triangle,
    ray: &Ray,
    prep: &TrianglePrep,
    best: &mut Best,
) {
    if !prep.misses(ray.origin, corners) {
        confirm(set, prim, corners, ray, prep, best);
    }
}

/// Half the distance from 1 to the next f64, times the roundings of a sum of products: see [`confirm`].
const BOUND: f64 = 56.0 * (f64::EPSILON / 2.0);

/// Where the ray of direction `d` crosses the plane through `a`, seen from the origin, with the edges `ac = a - c` and `ba = b -
/// a`: the parameter and a bound on its error; `None` if it may be parallel.
#[inline(always)]
fn cross_plane(d: DVec3, a: DVec3, ac: DVec3, ba: DVec3) -> Option<(f64, f64)> {
    // n = (B - A) x (C - A) = (A - C) x (B - A); t = (A . n) / (d . n).
    let n = ac.cross(ba);
    let (numerator, denominator) = (a.dot(n), d.dot(n));
    let n_bound = BOUND * size(ac) * size(ba);
    let d_error = n_bound * size(d);
    if denominator.abs() > 2.0 * d_error {
        let n_error = n_bound * size(a);
        let t = numerator / denominator;
        // If N / D is the exact quotient, |t - N / D| <= (n_error + |t| d_error) / (|denominator| - d_error). The rest is for
        // the division, for the rounding of this line and for that of t - err and t + err later on.
        let err =
            (n_error + t.abs() * d_error) / (denominator.abs() - d_error) * 1.0001 + t.abs() * (2.0 * f64::EPSILON);
        Some((t, err))
    } else {
        None
    }
}

/// Where the ray meets a triangle that it certainly meets; see [`Geometry::locate`].
#[inline]
pub(super) fn locate(corners: &Triangle, ray: &Ray) -> Option<(f64, f64)> {
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    cross_plane(ray.direction.as_dvec3(), a - ray.origin.as_dvec3(), a - c, b - a)
}

/// The second stage.
///
/// Every quantity is a sum of six products of three differences of inputs. With `u = 2^-53` each product carries at
/// most eight roundings (three differences, two products, three sums), so a sum is known within
/// `8 u * 6 * (greatest components of the three factors)`; [`BOUND`] adds a sixth for higher orders and the bound's own rounding. Values
/// are multiples of 2^-447 below 2^390 for every finite input: nothing over- or underflows.
#[inline(never)]
pub(super) fn confirm<G: Geometry + ?Sized>(
    set: &G,
    prim: u32,
    corners: &Triangle,
    ray: &Ray,
    prep: &TrianglePrep,
    best: &mut Best,
) {
    if best.prim() == Some(prim) || prep.decided.is_beaten(prim, corners, best.prim()) {
        return;
    }
    let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
    let [a, b, c] = corners.map(|p| p.as_dvec3());
    let (cb, ac, ba) = (c - b, a - c, b - a);
    let (a, b, c) = (a - o, b - o, c - o);
    let (cb_size, ac_size, ba_size) = (size(cb), size(ac), size(ba));
    let d_bound = BOUND * size(d);
    // (C - B) x B instead of C x B: the error grows with the edge's length and not with the distance alone.
    let (u, u_bound) = (d.dot(cb.cross(b)), d_bound * cb_size * size(b));
    let (v, v_bound) = (d.dot(ac.cross(c)), d_bound * ac_size * size(c));
    let (w, w_bound) = (d.dot(ba.cross(a)), d_bound * ba_size * size(a));
    let above = (u > u_bound, v > v_bound, w > w_bound);
    let below = (u < -u_bound, v < -v_bound, w < -w_bound);
    if (above.0 | above.1 | above.2) && (below.0 | below.1 | below.2) {
        return;
    }
    let inside = above == (true, true, true) || below == (true, true, true);
    let sides = || {
        [(above.0, below.0), (above.1, below.1), (above.2, below.2)].map(|(up, down)| i32::from(up) - i32::from(down))
    };

    let crossing = if inside { cross_plane(d, a, ac, ba) } else { None };
    let Some((t, err)) = crossing else {
        if !is_plainly_parallel(d, ac, ba) {
            decide(set, prim, corners, ray, prep, sides(), best);
        }
        return;
    };
    match place(t, err, ray, best) {
        Place::Nearest => best.replace(t, err, prim),
        Place::Useless => {}
        Place::Open => decide(set, prim, corners, ray, prep, sides(), best),
    }
}

/// Greatest absolute component.
#[inline(always)]
fn size(v: DVec3) -> f64 {
    let v = v.abs();
    let xy = if v.x > v.y { v.x } else { v.y };
    if xy > v.z { xy } else { v.z }
}

/// True only if `d . (p x q)` is zero because each of its products is.
fn is_plainly_parallel(d: DVec3, p: DVec3, q: DVec3) -> bool {
    let permanent =
        DVec3::new(p.y * q.z, p.z * q.x, p.x * q.y).abs() + DVec3::new(p.z * q.y, p.x * q.z, p.y * q.x).abs();
    d.abs().dot(permanent) == 0.0
}

/// What is known of a parameter within `t - err ..= t + err`.
enum Place {
    /// In range and before the winner.
    Nearest,
    /// Out of range or behind the winner.
    Useless,
    /// Undecided.
    Open,
}

#[inline]
fn place(t: f64, err: f64, ray: &Ray, best: &Best) -> Place {
    let (low, high) = (t - err, t + err);
    let (t_min, t_max) = (f64::from(ray.t_min), f64::from(ray.t_max));
    if high < t_min || low > t_max || low > best.upper() {
        Place::Useless
    } else if low >= t_min && high <= t_max && high < best.t() - best.err() {
        Place::Nearest
    } else {
        Place::Open
    }
}

/// The third stage; `sides` are the edge functions whose signs are certain.
#[cold]
#[inline(never)]
fn decide<G: Geometry + ?Sized>(
    set: &G,
    prim: u32,
    corners: &Triangle,
    ray: &Ray,
    prep: &TrianglePrep,
    sides: Sides,
    best: &mut Best,
) {
    super::stages::note_decision();
    prep.decided.note(prim);
    let winner = best.prim().map(|prim| (prim, set.triangle(prim)));
    if let Some((winner, Some(other))) = winner
        && corners.iter().all(|p| other.contains(p))
        && other.iter().all(|p| corners.contains(p))
    {
        // The same set of points ties without arithmetic.
        if prim < winner {
            best.replace(best.t(), best.err(), prim);
        }
        return;
    }
    let Some((crossing, corner)) = Crossing::of_triangle(ray, corners, sides) else { return };
    let (t, err) = crossing.estimate();
    match place(t, err, ray, best) {
        Place::Useless => return,
        Place::Nearest => {}
        Place::Open => {
            if !crossing.in_range(ray) {
                return;
            }
            if let Some((winner, other)) = winner {
                let order = match (other, set.sphere(winner)) {
                    (Some(other), _) => match Crossing::of_plane(ray, &other) {
                        Some(other) => crossing.cmp_crossing(&other),
                        None => unreachable!("a winner is neither degenerate nor parallel to the ray"),
                    },
                    (None, Some(sphere)) => {
                        let point = prep.decided.point(winner, || Point::of_winner(set, ray, best));
                        if point.is_some_and(|point| point.is_on_plane(corners)) {
                            Ordering::Equal
                        } else {
                            sphere::winner(&sphere, ray).cmp_plane(ray, corners).reverse()
                        }
                    }
                    (None, None) => crossing.cmp_parameter(best.t()), // something else: its parameter counts as exact
                };
                if order.then(prim.cmp(&winner)) != Ordering::Less {
                    if let (Ordering::Equal, Some(i)) = (order, corner) {
                        prep.decided.note_point(winner, Point::proven(corners[i], ray));
                    }
                    return;
                }
            }
        }
    }
    best.replace(t, err, prim);
    if let Some(i) = corner {
        prep.decided.note_point(prim, Point::proven(corners[i], ray));
    }
}

/// The winner's exact parameter rounded to f32; see [`Geometry::round`]. The winner is the triangle `corners`.
pub(super) fn round(corners: &Triangle, ray: &Ray, best: &Best) -> f32 {
    let (low, high) = ((best.t() - best.err()) as f32, (best.t() + best.err()) as f32);
    if low == high {
        return low + 0.0; // -0 becomes 0
    }
    match Crossing::of_plane(ray, corners) {
        Some(crossing) => crossing.round(),
        None => unreachable!("a triangle that was hit is neither degenerate nor parallel to the ray"),
    }
}

/// The corners' bits, the least corner first, so that the order in which they are listed does not matter; zeros have one sign.
pub(super) fn fingerprint(corners: &Triangle) -> [u32; 9] {
    let mut bits = corners.map(|p| (p + Vec3::ZERO).to_array().map(f32::to_bits));
    bits.sort_unstable();
    let [[a, b, c], [d, e, f], [g, h, i]] = bits;
    [a, b, c, d, e, f, g, h, i]
}

impl Geometry for [Triangle] {
    type Prep = TrianglePrep;

    #[inline]
    fn len(&self) -> u32 {
        u32::try_from(<[Triangle]>::len(self)).unwrap_or(u32::MAX - 1)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        Aabb::of_points(&self[prim as usize])
    }

    #[inline]
    fn prepare(&self, ray: &Ray) -> TrianglePrep {
        TrianglePrep::new(ray)
    }

    #[inline]
    fn test(&self, prim: u32, ray: &Ray, prep: &TrianglePrep, best: &mut Best) {
        test(self, prim, &self[prim as usize], ray, prep, best);
    }

    fn confirm(&self, prim: u32, ray: &Ray, prep: &TrianglePrep, best: &mut Best) {
        confirm(self, prim, &self[prim as usize], ray, prep, best);
    }

    fn locate(&self, prim: u32, ray: &Ray) -> Option<(f64, f64)> {
        locate(&self[prim as usize], ray)
    }

    fn round(&self, ray: &Ray, best: &Best) -> f32 {
        match best.prim() {
            Some(prim) => round(&self[prim as usize], ray, best),
            None => best.t() as f32,
        }
    }

    #[inline]
    fn triangle(&self, prim: u32) -> Option<Triangle> {
        Some(self[prim as usize])
    }

    fn fingerprint(&self, prim: u32) -> Option<[u32; 9]> {
        Some(fingerprint(&self[prim as usize]))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tests::Random;

    /// Rays next to corners and edges, at every scale, from near and far.
    fn stiff(random: &mut Random) -> (Ray, [Triangle; 2]) {
        let unit = |random: &mut Random| Vec3::from_array(random.vector(1 << 24).map(|x| x as f32 / (1 << 24) as f32));
        let power = |random: &mut Random, n: i128| 2f32.powi(random.within(n) as i32);
        let scale = 2f32.powi([0, 0, -147, -120, -70, 63, 124, 126][random.next() as usize % 8]);
        let place = unit(random) * [0.0, 1.0, 1e3, 1e7][random.next() as usize % 4];
        // Axes of very different lengths make slivers.
        let stretch = Vec3::new(power(random, 12), 1.0, power(random, 3));
        let mut corner = || (place + unit(random) * stretch) * scale;
        let corners = [corner(), corner(), corner(), corner()];
        let triangles = [[corners[0], corners[1], corners[2]], [corners[2], corners[1], corners[3]]];
        let (a, b) = (corners[random.next() as usize % 4], corners[random.next() as usize % 4]);
        let target = a + (b - a) * [0.0, 0.5, 1.0, 0.3][random.next() as usize % 4];
        let origin = match random.next() % 5 {
            0 => Vec3::ZERO,
            1 => target + unit(random) * scale,
            2 => target + unit(random) * scale * 1e5,
            3 => corners[3],
            _ => Vec3::from_array([(); 3].map(|()| f32::from_bits(random.next() as u32))),
        };
        let direction = match random.next() % 4 {
            0 => target - origin,
            1 => (target - origin) * power(random, 140),
            2 => (target - origin).signum(),
            _ => (target - origin).normalize_or(Vec3::X),
        };
        (
            Ray::new(origin, direction).with_range([0.0, f32::NEG_INFINITY][random.next() as usize % 2], f32::INFINITY),
            triangles,
        )
    }

    #[test]
    fn the_filter_decides_as_the_last_stage_does() {
        let mut random = Random::new(17);
        let (mut tested, mut hits, mut rejected) = (0, 0, 0);
        for _ in 0..60_000 {
            let (ray, set) = stiff(&mut random);
            let Some(ray) = ray.intake() else { continue };
            tested += 1;
            let exact = |prim: u32| {
                let crossing = Crossing::of_triangle(&ray, &set[prim as usize], [0; 3]);
                crossing.map(|(crossing, _)| crossing).filter(|c| c.in_range(&ray))
            };
            let expected = match (exact(0), exact(1)) {
                (Some(a), Some(b)) if a.cmp_crossing(&b).is_gt() => Some((1, b.round())),
                (Some(a), _) => Some((0, a.round())),
                (None, b) => b.map(|b| (1, b.round())),
            };
            for order in [[0, 1], [1, 0]] {
                let (prep, mut best) = (TrianglePrep::new(&ray), Best::NONE);
                for prim in order {
                    set[..].test(prim, &ray, &prep, &mut best);
                    rejected += usize::from(prep.misses(ray.origin, &set[prim as usize]));
                }
                let found = best.prim().map(|prim| (prim, set[..].round(&ray, &best)));
                assert_eq!(found, expected, "{ray:?} {set:?}");
            }
            hits += usize::from(expected.is_some());
        }
        assert!(
            tested > 30_000 && hits > 5_000 && rejected > 20_000,
            "{tested} rays, {hits} hits, {rejected} rejected"
        );
    }
}
