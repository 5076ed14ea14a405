//! Triangles: the ray test in three stages, each certain of what it decides.
//!
//! 1. f32, sheared so that the ray runs along one axis (Woop, Benthin and Wald 2013, section 3): throws out certain
//!    misses, which are nearly all tests. Inlined into the accelerators' loops: `filter.rs`.
//! 2. f64, edge functions about the origin: throws out misses, accepts hits, knows `t` within a bound.
//! 3. Exact ([`super::exact`]), where the second stage's bounds leave a sign, the range or the order of two hits open.
//!
//! A value that is not finite makes every comparison of the first two stages false, so that such a triangle reaches the
//! third one, which refuses it.

mod filter;

pub use filter::TrianglePrep;

use super::exact::{Crossing, Sides};
use super::meeting::Point;
use super::{Best, Geometry, sphere};
use crate::ray::{Aabb, Ray};
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// A closed, two-sided triangle given by its corners, world units: corners and edges belong to it.
///
/// Never hit: a triangle with a corner that is not finite or with its corners on a line, and any triangle by a ray that is parallel
/// to its plane.
pub type Triangle = [Vec3; 3];

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
/// Every quantity is a sum of six products of three differences of inputs. With `u = 2^-53` each product carries at most
/// eight roundings (three differences, two products, three sums), so a sum is known within
/// `8 u * 6 * (greatest components of the three factors)`; [`BOUND`] adds a sixth for higher orders and the bound's own
/// rounding. Values are multiples of 2^-447 below 2^390 for every finite input: nothing over- or underflows.
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
mod tests;
