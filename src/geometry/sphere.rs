//! Spheres: the test without cancellation, in f64, and exact where rounding could change the answer.
//!
//! Source: Haines, Günther and Akenine-Möller, "Precision improvements for ray/sphere intersection", Ray Tracing Gems,
//! 2019, chapter 7. With `f = o - c` and `b = -f . d`, the discriminant is `r^2 - |f + (b / |d|^2) d|^2`, taken from
//! the ray's point nearest to the centre, and the root that would cancel is `(|f|^2 - r^2) / q`.
//! Departs from it: where the discriminant or `|f|^2 - r^2` is too near zero for its rounding error, it is computed
//! exactly, so that hits, tangents and the side on which the origin lies are never wrong; and parameters carry a bound on their
//! error, so that ranges, the order of hits and rounding are decided exactly where it leaves them open ([`super::root`]).

use super::decided::Decided;
use super::estimate::{Estimate, Within};
use super::exact::nearest;
use super::expansion::{Difference, Expansion, difference, two_product, two_sum};
use super::meeting::{Point, Which};
use super::root::Root;
use super::{Best, Geometry};
use crate::ray::{Aabb, Cell, Ray};
use glam::{DVec3, Vec3};
use std::cmp::Ordering;

/// The surface of a ball, world units. A ray from the inside meets it where it leaves; one that touches it meets it once.
///
/// A radius of 0 is a point. Never hit: a centre or radius that is not finite, a negative radius, or a sphere that
/// reaches beyond the greatest f32 along an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sphere {
    /// Centre, world units.
    pub centre: Vec3,
    /// Radius, world units, at least 0.
    pub radius: f32,
}

impl Sphere {
    /// True if a ray can hit it.
    fn is_usable(&self) -> bool {
        let reach = self.centre.abs().max_element();
        // NaN components may hide from the greatest one, hence the last condition.
        let (sum, error) = two_sum(f64::from(reach), f64::from(self.radius));
        let most = f64::from(f32::MAX);
        (sum < most || (sum == most && error <= 0.0)) && self.radius >= 0.0 && self.centre.is_finite()
    }

    /// The centre seen from the origin, turned round: `o - c` exactly.
    fn offset(&self, ray: &Ray) -> [Difference; 3] {
        let (o, c) = (ray.origin, self.centre);
        [difference(o.x, c.x), difference(o.y, c.y), difference(o.z, c.z)]
    }

    /// `|o - c|^2 - r^2` with a relative error below 2^-40, zero only if it is: below zero inside the sphere.
    #[inline(never)]
    fn power(&self, ray: &Ray) -> f64 {
        // Twice the working precision (Ogita, Rump and Oishi 2005, algorithm Dot2): within 2^-100 of the greatest
        // term, for differences that f64 holds.
        let (r, offset) = (f64::from(self.radius), self.offset(ray));
        let (mut high, mut low) = two_product(-r, r);
        let (mut size, mut exact) = (-high, true);
        for [error, f] in offset {
            let (square, square_error) = two_product(f, f);
            let (sum, sum_error) = two_sum(high, square);
            (high, low) = (sum, low + (square_error + sum_error));
            (size, exact) = (size.max(square), exact && error == 0.0);
        }
        let power = high + low;
        let threshold = size * (1.0 / (1u64 << 60) as f64);
        if exact && power.abs() > threshold { power } else { self.exact_power(ray).estimate() }
    }

    /// `|o - c|^2 - r^2` exactly.
    #[cold]
    fn exact_power(&self, ray: &Ray) -> Expansion {
        let r = [f64::from(self.radius)];
        let mut sum = Expansion::zero();
        self.offset(ray).iter().for_each(|f| sum.add_product(1.0, f, f));
        sum.add_product(-1.0, &r, &r);
        sum
    }

    /// `(f . d)^2 - |d|^2 (|f|^2 - r^2)` exactly: at most degree 4 in the inputs, so a multiple of 2^-596 below 2^520.
    #[cold]
    fn discriminant(&self, ray: &Ray) -> Expansion {
        let (mut b, mut a) = (Expansion::zero(), Expansion::zero());
        for (f, d) in self.offset(ray).iter().zip(ray.direction.to_array()) {
            let d = [f64::from(d)];
            b.add_product(1.0, f, &d);
            a.add_product(1.0, &d, &d);
        }
        let mut sum = Expansion::zero();
        sum.add_product(1.0, b.terms(), b.terms());
        sum.add_product(-1.0, a.terms(), self.exact_power(ray).terms());
        sum
    }
}

/// What the sphere tests of one ray share, and what the exact stage has decided. It serves one [`Best`].
#[derive(Debug)]
pub struct SpherePrep {
    /// The direction at unit length.
    unit: Vec3,
    origin: DVec3,
    direction: DVec3,
    /// Squared length of the direction, and its inverse. Between 2^-298 and 2^258 for f32 directions.
    squared: f64,
    inverse: f64,
    decided: Decided,
}

impl SpherePrep {
    pub(super) fn new(ray: &Ray) -> Self {
        let direction = ray.direction.as_dvec3();
        let squared = direction.length_squared();
        let unit = (direction / squared.sqrt()).as_vec3();
        Self {
            unit,
            origin: ray.origin.as_dvec3(),
            direction,
            squared,
            inverse: 1.0 / squared,
            decided: Decided::default(),
        }
    }

    /// True only if the ray's line certainly misses the sphere: the first stage, in f32.
    ///
    /// With `e = 2^-24`, `n` the unit direction and `f` the origin from the centre, the line misses if `|f|^2 - (f .
    /// n)^2 > r^2`. `f . n` is known within `5 e |f|` (difference, `n`, product, two sums), so its square within `12 e
    /// |f|^2`; `|f|^2` within `5 e |f|^2`, `r^2` within `e r^2`; the sums and the bound add less than `4 e (|f|^2 +
    /// r^2)`. Underflow adds less than 2^-126. An `|f|^2` that overflows or is NaN makes a NaN, which is not greater
    /// than anything.
    #[inline]
    fn misses(&self, origin: Vec3, sphere: &Sphere) -> bool {
        const K: f32 = 32.0 / (1 << 24) as f32;
        let f = origin - sphere.centre;
        let (ff, b, rr) = (f.length_squared(), f.dot(self.unit), sphere.radius * sphere.radius);
        ff - K * ff > b * b + (rr * (1.0 + K) + f32::MIN_POSITIVE)
    }
}

/// Half the distance from 1 to the next f64.
const U: f64 = f64::EPSILON / 2.0;

/// Tests sphere `prim` of `set`; see [`Geometry::test`]. `decided` is what all tests of the ray share of it.
#[inline]
pub(super) fn test<G: Geometry + ?Sized>(
    set: &G,
    prim: u32,
    sphere: &Sphere,
    ray: &Ray,
    (prep, decided): (&SpherePrep, &Decided),
    best: &mut Best,
) {
    if !prep.misses(ray.origin, sphere) {
        confirm(set, prim, sphere, ray, (prep, decided), best);
    }
}

/// The second stage.
#[inline(never)]
fn confirm<G: Geometry + ?Sized>(
    set: &G,
    prim: u32,
    sphere: &Sphere,
    ray: &Ray,
    (prep, decided): (&SpherePrep, &Decided),
    best: &mut Best,
) {
    if best.prim() == Some(prim) || decided.is_known(prim) {
        return;
    }
    let Some((near, far)) = roots(sphere, ray, prep) else { return };
    let first = match (near.within(ray), far.within(ray)) {
        (Within::Yes, _) => Some(near),
        (Within::No, Within::Yes) => Some(far),
        (Within::No, Within::No) => return,
        _ => None,
    };
    match first {
        Some(Estimate { t, err }) if t - err > best.upper() => {}
        Some(Estimate { t, err }) if t + err < best.t() - best.err() => best.replace(t, err, prim),
        _ => decide(set, prim, sphere, ray, (near, far), decided, best),
    }
}

/// The third stage; the ray's line meets the sphere at about `near` and `far`.
#[cold]
#[inline(never)]
fn decide<G: Geometry + ?Sized>(
    set: &G,
    prim: u32,
    sphere: &Sphere,
    ray: &Ray,
    (near, far): (Estimate, Estimate),
    decided: &Decided,
    best: &mut Best,
) {
    decided.note(prim);
    let winner = best.prim().map(|winner| (winner, set.triangle(winner), set.sphere(winner)));
    if let Some((winner, None, Some(other))) = winner
        && other == *sphere
    {
        // The same set of points ties without arithmetic.
        if prim < winner {
            best.replace(best.t(), best.err(), prim);
        }
        return;
    }
    if let Some((winner, ..)) = winner
        && let Some(point) = decided.point(winner, || Point::of_winner(set, ray, best))
    {
        // The winner's parameter is in range: the sphere ties unless it is met before.
        let ties = match point.root_of(sphere, ray, &near, &far) {
            Some(Which::Lesser) => true,
            Some(Which::Greater) => matches!(near.within(ray), Within::No),
            None => false,
        };
        if ties {
            if prim < winner {
                best.replace(best.t(), best.err(), prim);
                decided.note_point(prim, point);
            }
            return;
        }
    }
    let Some(root) = Root::first(sphere, ray) else { return };
    let order = match winner {
        None => Ordering::Less,
        Some((winner, other, ball)) => {
            let order = match (other, ball) {
                (Some(corners), _) => root.cmp_plane(ray, &corners),
                (None, Some(ball)) => root.cmp_root(&self::winner(&ball, ray)),
                // Something else: its parameter counts as exact.
                (None, None) => root.cmp_parameter(best.t()),
            };
            order.then(prim.cmp(&winner))
        }
    };
    if order == Ordering::Less {
        let Estimate { t, err } = if root.is_lesser() { near } else { far };
        best.replace(t, err, prim);
    }
}

/// The exact parameter of a winner: it is met in the ray's range.
pub(super) fn winner(sphere: &Sphere, ray: &Ray) -> Root {
    match Root::first(sphere, ray) {
        Some(root) => root,
        None => unreachable!("the winner is met in the ray's range"),
    }
}

/// Both parameters at which the line meets the sphere, the lesser first; `None` if it does not.
///
/// Error of the discriminant with `u = 2^-53`: `b` carries four roundings (difference, product, two sums), so it is
/// known within `4 u |f| |d|`; the squared length and its inverse carry four more, product and product with `d` two,
/// which makes `10 u |f|`; the sum with `f`, known within `u |f|`, adds `u |f|`. So `nearest` is known within
/// `12 u |f|`, its squared length within `24 u |f| |nearest| + 144 u^2 |f|^2 + 3 u |nearest|^2`, and the difference from
/// `r^2`, which is exact, adds `u |discriminant|`. With that error `e` of `r^2 - |nearest|^2`, the square root of `S`, the
/// difference times `|d|^2`, is known within `(e |d|^2 + 4 u S) / sqrt S`, which is twice the derivative's worth: enough, as
/// `e` is at most a 64th. Sums and quotients add up from there.
#[inline]
pub(super) fn roots(sphere: &Sphere, ray: &Ray, prep: &SpherePrep) -> Option<(Estimate, Estimate)> {
    if !sphere.is_usable() {
        return None;
    }
    let f = prep.origin - sphere.centre.as_dvec3();
    let r = f64::from(sphere.radius);
    let b = -f.dot(prep.direction);
    let nearest = f + (b * prep.inverse) * prep.direction;
    let (ff, ll, rr) = (f.length_squared(), nearest.length_squared(), r * r);
    let error = U * (26.0 * (ff * ll).sqrt() + 5.0 * (ll + rr)) + 160.0 * U * U * ff;
    let b_error = 5.0 * U * (ff * prep.squared).sqrt();
    let mut scaled = prep.squared * (rr - ll);
    let mut scaled_error = prep.squared * error + 4.0 * U * scaled.abs();
    // 64 times the error, so that what remains of it is far below f32 in the square root too.
    if (rr - ll).abs() <= 64.0 * error {
        scaled = sphere.discriminant(ray).estimate();
        scaled_error = scaled.abs() * (1.0 / (1u64 << 49) as f64);
    }
    if scaled < 0.0 {
        return None;
    } else if scaled == 0.0 {
        let t = Estimate::new(b / prep.squared, b_error / prep.squared);
        return Some((t, t));
    }
    let root = scaled.sqrt();
    let q = b + root.copysign(b);
    let q_error = (b_error + scaled_error / root) / q.abs() + 8.0 * U;
    let (mut power, mut power_error) = (ff - rr, 1.0 / (1u64 << 30) as f64);
    // Its error is below 6 u |f|^2: 2^-30 of it at this threshold.
    if power.abs() < ff * (1.0 / (1 << 20) as f64) {
        power = sphere.power(ray);
        power_error = 1.0 / (1u64 << 40) as f64;
    } else {
        power_error = power_error.min(8.0 * U * ff / power.abs());
    }
    let (s, t) = (power / q, q / prep.squared);
    let s = Estimate::new(s, s.abs() * (q_error + power_error) * 1.0001);
    let t = Estimate::new(t, t.abs() * q_error * 1.0001);
    // With the square root added, `q` belongs to the greater root; with it subtracted, to the lesser one.
    Some(if b.is_sign_negative() { (t, s) } else { (s, t) })
}

/// The winner's exact parameter rounded to f32; see [`Geometry::round`]. The winner is `sphere`.
pub(super) fn round(sphere: &Sphere, ray: &Ray, best: &Best) -> f32 {
    let (low, high) = ((best.t() - best.err()) as f32, (best.t() + best.err()) as f32);
    if low == high {
        return low + 0.0; // -0 becomes 0
    }
    let root = winner(sphere, ray);
    nearest(best.t() as f32, |t| root.cmp_parameter(t))
}

impl Geometry for [Sphere] {
    type Prep = SpherePrep;

    #[inline]
    fn len(&self) -> u32 {
        u32::try_from(<[Sphere]>::len(self)).unwrap_or(u32::MAX - 1)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        let sphere = &self[prim as usize];
        if !sphere.is_usable() {
            return Aabb::EMPTY;
        }
        // Outward from the exact sum, which is value plus error.
        let down = |c: f32| {
            let [error, value] = difference(c, sphere.radius);
            let near = value as f32;
            if f64::from(near) > value || (f64::from(near) == value && error < 0.0) { near.next_down() } else { near }
        };
        let up = |c: f32| -down(-c);
        let [x, y, z] = sphere.centre.to_array();
        Aabb { min: Vec3::new(down(x), down(y), down(z)), max: Vec3::new(up(x), up(y), up(z)) }
    }

    #[inline]
    fn prepare(&self, ray: &Ray) -> SpherePrep {
        SpherePrep::new(ray)
    }

    #[inline]
    fn test(&self, prim: u32, ray: &Ray, prep: &SpherePrep, best: &mut Best) {
        test(self, prim, &self[prim as usize], ray, (prep, &prep.decided), best);
    }

    fn round(&self, ray: &Ray, best: &Best) -> f32 {
        match best.prim() {
            Some(prim) => round(&self[prim as usize], ray, best),
            None => best.t() as f32,
        }
    }

    #[inline]
    fn sphere(&self, prim: u32) -> Option<Sphere> {
        Some(self[prim as usize])
    }

    /// Ends in bits that no triangle has which can be hit: those of a NaN.
    fn fingerprint(&self, prim: u32) -> Option<[u32; 9]> {
        let Sphere { centre, radius } = self[prim as usize];
        let [x, y, z] = (centre + Vec3::ZERO).to_array().map(f32::to_bits);
        let none = u32::MAX;
        Some([x, y, z, (radius + 0.0).to_bits(), none, none, none, none, none])
    }

    /// False if the box lies outside the ball or strictly inside it: only the surface counts.
    fn overlaps(&self, prim: u32, cell: &Cell) -> bool {
        let sphere = &self[prim as usize];
        if !sphere.is_usable() {
            return false;
        }
        // Differences, squares and sums of what is at least 0 carry six roundings in all: 8 u covers them.
        const SLACK: f64 = 8.0 * U;
        let centre = sphere.centre.as_dvec3();
        let rr = f64::from(sphere.radius) * f64::from(sphere.radius);
        let (below, above) = (cell.min - centre, centre - cell.max);
        let least = below.max(above).max(DVec3::ZERO).length_squared();
        let greatest = below.abs().max(above.abs()).length_squared();
        !(least * (1.0 - SLACK) > rr || greatest * (1.0 + SLACK) < rr)
    }
}

#[cfg(test)]
mod tests;
