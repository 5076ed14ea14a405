//! The last stage: signs, order and range decided in exact arithmetic.
//!
//! With `A`, `B`, `C` the corners as seen from the origin, a ray meets a triangle if `U = d . ((C - B) x B)`,
//! `V = d . ((A - C) x C)` and `W = d . ((B - A) x A)` are all `>= 0` or all `<= 0` and `d . n` is not 0, where
//! `n = (B - A) x (C - A)`; it does so at `t = (A . n) / (d . n)`. All of these are polynomials of degree 3 in the
//! inputs. [`super::whole`] evaluates them in integers of 128 bits where these hold them, and [`super::expansion`] without
//! error for all others.

use super::Triangle;
use super::expansion::{Difference, Expansion, difference, triple};
use super::whole::{Quotient, Whole, power_of_two};
use crate::ray::Ray;
use glam::Vec3;
use std::cmp::Ordering;

/// Relative error of [`Crossing::estimate`]: 2^-50 for each of numerator and denominator, 2^-53 for the division.
const ESTIMATE_ERROR: f64 = 1.0 / (1u64 << 48) as f64;

/// `p - q` exactly.
fn subtract(p: Vec3, q: Vec3) -> [Difference; 3] {
    [difference(p.x, q.x), difference(p.y, q.y), difference(p.z, q.z)]
}

/// What the second stage knows of the edge functions `U`, `V` and `W`: -1 or 1 for a certain sign, 0 for none.
pub(crate) type Sides = [i32; 3];

/// Whether the edge functions agree, with `side` for those that are not known. `Some` if they do: the corner at which two of
/// them are zero, edge `i` being opposite to corner `i`.
fn meet(known: Sides, side: impl Fn(usize) -> i32) -> Option<Option<usize>> {
    let mut signs = known;
    for i in 0..3 {
        if signs[i] == 0 {
            signs[i] = side(i);
        }
        if signs.contains(&-1) && signs.contains(&1) {
            return None;
        }
    }
    let corner = (0..3).find(|&i| signs[(i + 1) % 3] == 0 && signs[(i + 2) % 3] == 0);
    Some(corner)
}

/// The exact parameter of a ray on the plane of a triangle.
#[derive(Clone, Debug)]
pub(crate) enum Crossing {
    /// As whole numbers.
    Whole(Quotient),
    /// As expansions, the denominator above zero.
    Expanded { numerator: Expansion, denominator: Expansion },
}

impl Crossing {
    /// Where the ray's line meets the closed triangle, whatever the range, and which corner that is, if it is one. `None` if
    /// it does not, or the triangle is degenerate, parallel to the ray or not finite. Only the sides that are not known are
    /// computed.
    pub fn of_triangle(ray: &Ray, corners: &Triangle, known: Sides) -> Option<(Self, Option<usize>)> {
        if let Some(whole) = Whole::new(ray, corners) {
            let corner = meet(known, |i| whole.side(i))?;
            return Some((Self::Whole(whole.of_plane()?), corner));
        }
        let crossing = Self::expanded(ray, corners)?;
        let d = subtract(ray.direction, Vec3::ZERO);
        let corner = meet(known, |i| {
            // (C - B) x B is B's moment about the origin along the edge from B to C.
            let (from, to) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
            triple(&d, &subtract(to, from), &subtract(from, ray.origin)).sign()
        })?;
        Some((crossing, corner))
    }

    /// Where the ray's line meets the triangle's plane; `None` if the triangle is degenerate, parallel to the ray or
    /// not finite.
    pub fn of_plane(ray: &Ray, corners: &Triangle) -> Option<Self> {
        match Whole::new(ray, corners) {
            Some(whole) => whole.of_plane().map(Self::Whole),
            None => Self::expanded(ray, corners),
        }
    }

    /// [`Crossing::of_plane`] in expansions.
    fn expanded(ray: &Ray, corners: &Triangle) -> Option<Self> {
        let [a, b, c] = *corners;
        if !(a.is_finite() && b.is_finite() && c.is_finite()) {
            return None;
        }
        let (ab, ac) = (subtract(b, a), subtract(c, a));
        let mut denominator = triple(&subtract(ray.direction, Vec3::ZERO), &ab, &ac);
        let sign = denominator.sign();
        if sign == 0 {
            return None;
        }
        let mut numerator = triple(&subtract(a, ray.origin), &ab, &ac);
        if sign < 0 {
            numerator.negate();
            denominator.negate();
        }
        Some(Self::Expanded { numerator, denominator })
    }

    /// The quotient and a bound on its error.
    pub fn estimate(&self) -> (f64, f64) {
        let t = match self {
            Self::Whole(quotient) => quotient.estimate(),
            Self::Expanded { numerator, denominator } => numerator.estimate() / denominator.estimate(),
        };
        (t, t.abs() * ESTIMATE_ERROR)
    }

    /// Compares with `t`, a multiple of 2^-620 below 2^400 or infinite, so that no product leaves f64's range.
    pub fn cmp_parameter(&self, t: f64) -> Ordering {
        if t.is_infinite() {
            return 0f64.total_cmp(&t);
        }
        match self {
            Self::Whole(quotient) => quotient.cmp_finite(t),
            Self::Expanded { numerator, denominator } => {
                let mut gap = numerator.clone();
                gap.add_product(-1.0, &[t], denominator.terms());
                gap.sign().cmp(&0)
            }
        }
    }

    /// Compares with another crossing.
    pub fn cmp_crossing(&self, other: &Self) -> Ordering {
        if let (Self::Whole(ours), Self::Whole(theirs)) = (self, other) {
            return ours.cmp_quotient(theirs);
        }
        let ((n, d), (other_n, other_d)) = (self.fraction(), other.fraction());
        let mut gap = Expansion::zero();
        gap.add_product(1.0, n.terms(), other_d.terms());
        gap.add_product(-1.0, other_n.terms(), d.terms());
        gap.sign().cmp(&0)
    }

    /// Numerator and denominator as expansions. Those of whole numbers are multiples of 2^-276 below 2^402: no product with
    /// another's leaves f64's range.
    fn fraction(&self) -> (Expansion, Expansion) {
        match self {
            Self::Whole(quotient) => {
                let scale = power_of_two(quotient.exponent);
                (Expansion::of_integer(quotient.numerator, scale), Expansion::of_integer(quotient.denominator, 1.0))
            }
            Self::Expanded { numerator, denominator } => (numerator.clone(), denominator.clone()),
        }
    }

    /// True if the parameter lies in the ray's range, ends included.
    pub fn in_range(&self, ray: &Ray) -> bool {
        self.cmp_parameter(f64::from(ray.t_min)).is_ge() && self.cmp_parameter(f64::from(ray.t_max)).is_le()
    }

    /// The nearest f32; see [`nearest`].
    pub fn round(&self) -> f32 {
        nearest(self.estimate().0 as f32, |t| self.cmp_parameter(t))
    }
}

/// The f32 nearest to a number that is near `guess` and that `cmp` compares with others, ties to even; `inf` or `-inf` from
/// the middle of the greatest f32 and 2^128 on; never -0.
pub(super) fn nearest(guess: f32, cmp: impl Fn(f64) -> Ordering) -> f32 {
    // 2^128 stands for the infinities here: it is what f32 would have next.
    let wide = |x: f32| if x.is_infinite() { power_of_two(128).copysign(f64::from(x)) } else { f64::from(x) };
    // Middles of neighbours are multiples of 2^-150 with 25 bits: exact in f64.
    let middle = |x: f32, y: f32| (wide(x) + wide(y)) / 2.0;
    let mut nearest = guess;
    loop {
        let (below, above) = (nearest.next_down(), nearest.next_up());
        // At a middle itself the value with the even last bit wins.
        let odd = nearest.to_bits() & 1 == 1;
        let lies = |side: Ordering, t: f64| {
            let order = cmp(t);
            order == side || (odd && order == Ordering::Equal)
        };
        if nearest > f32::NEG_INFINITY && lies(Ordering::Less, middle(below, nearest)) {
            nearest = below;
        } else if nearest < f32::INFINITY && lies(Ordering::Greater, middle(nearest, above)) {
            nearest = above;
        } else {
            return nearest + 0.0; // -0 becomes 0
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::geometry::tests::Random;

    fn fixed(numerator: f64, denominator: f64) -> Crossing {
        let of = |x| {
            let mut e = Expansion::zero();
            e.add(x);
            e
        };
        Crossing::Expanded { numerator: of(numerator), denominator: of(denominator) }
    }

    #[test]
    fn rounding_agrees_with_hardware_where_the_quotient_is_exact() {
        let least = f64::from(f32::from_bits(1));
        let max = f64::from(f32::MAX);
        let beyond = max + 2f64.powi(103); // midway to 2^128: ties to even, which is infinity
        for t in [
            0.0,
            1.0,
            -1.0,
            0.1,
            -0.1,
            least,
            0.5 * least,
            0.75 * least,
            1.5 * least,
            2.5 * least,
            -0.5 * least,
            max,
            beyond,
            -beyond,
            beyond.next_down(),
            1e39,
            -1e300,
            16_777_217.0,
            16_777_219.0,
            -33_554_434.0,
            f64::from(f32::MIN_POSITIVE).next_down(),
        ] {
            assert_eq!(fixed(t, 1.0).round().to_bits(), (t as f32 + 0.0).to_bits(), "{t:e}");
        }
        assert_eq!(fixed(1.0, 3.0).round(), 1.0 / 3.0);
    }

    #[test]
    fn rounding_sees_what_the_estimate_cannot() {
        // 1 + 2^-24 is midway between 1 and its successor; 2^-200 more or less decides.
        for (tail, expected) in [(-2f64.powi(-200), 1.0), (0.0, 1.0), (2f64.powi(-200), 1.0 + f32::EPSILON)] {
            let Crossing::Expanded { mut numerator, denominator } = fixed(1.0 + 2f64.powi(-24), 1.0) else {
                unreachable!("a fixed quotient is expanded")
            };
            numerator.add(tail);
            assert_eq!(Crossing::Expanded { numerator, denominator }.round(), expected, "{tail:e}");
        }
    }

    #[test]
    fn order_is_that_of_the_quotients() {
        let third = fixed(1.0, 3.0);
        assert_eq!(third.cmp_crossing(&fixed(2.0, 6.0)), Ordering::Equal);
        assert_eq!(third.cmp_crossing(&fixed(2f64.powi(60) + 512.0, 3.0 * 2f64.powi(60))), Ordering::Less);
        assert_eq!(third.cmp_parameter(1.0 / 3.0), Ordering::Greater); // the nearest f64 lies below
        assert_eq!(third.cmp_parameter(f64::INFINITY), Ordering::Less);
        assert_eq!(third.cmp_parameter(f64::NEG_INFINITY), Ordering::Greater);
        assert_eq!(fixed(0.0, 3.0).cmp_parameter(-0.0), Ordering::Equal);
    }

    #[test]
    fn whole_numbers_and_expansions_agree() {
        let mut random = Random::new(23);
        let (mut whole, mut ties) = (0, 0);
        let mut last: Option<(Crossing, Crossing)> = None;
        let mut corners = [Vec3::ZERO; 3];
        let rounds = if cfg!(miri) { 45 } else { 20_000 };
        for round in 0..rounds {
            // Lattices of few points, whose planes meet in corners, and mantissas of many bits.
            let bits = [2, 4, 24][round % 3];
            let scale = 2f32.powi(random.within(60) as i32);
            let mut v = || Vec3::from_array(random.vector(1 << bits).map(|x| x as f32)) * scale;
            let (shared, ray) = (corners[0], Ray::new(v(), v()));
            corners = [v(), v(), v()];
            if ray.direction == Vec3::ZERO {
                continue;
            }
            let Some(form) = Whole::new(&ray, &corners) else { continue };
            whole += 1;
            let (ours, theirs) = (form.of_plane().map(Crossing::Whole), Crossing::expanded(&ray, &corners));
            assert_eq!(ours.is_some(), theirs.is_some(), "{ray:?} {corners:?}");
            let d = subtract(ray.direction, Vec3::ZERO);
            for i in 0..3 {
                let (from, to) = (corners[(i + 1) % 3], corners[(i + 2) % 3]);
                let side = triple(&d, &subtract(to, from), &subtract(from, ray.origin)).sign();
                assert_eq!(form.side(i), side, "{ray:?} {corners:?}");
            }
            let (Some(ours), Some(theirs)) = (ours, theirs) else { continue };
            assert_eq!(ours.round(), theirs.round(), "{ray:?} {corners:?}");
            assert_eq!(ours.cmp_crossing(&theirs), Ordering::Equal, "{ray:?} {corners:?}");
            let (t, err) = ours.estimate();
            for t in [t, t - err, t + err, f64::from(t as f32), 0.0, 1.0] {
                assert_eq!(ours.cmp_parameter(t), theirs.cmp_parameter(t), "{t} {ray:?} {corners:?}");
            }
            let fan = [shared, corners[1], corners[2]];
            if let (Some(a), Some(b)) = (Crossing::of_plane(&ray, &fan), Crossing::expanded(&ray, &fan)) {
                let order = theirs.cmp_crossing(&b);
                assert_eq!(ours.cmp_crossing(&a), order, "{ray:?} {corners:?} {fan:?}");
                assert_eq!(ours.cmp_crossing(&b), order, "{ray:?} {corners:?} {fan:?}");
                ties += usize::from(order == Ordering::Equal);
            }
            if let Some((a, b)) = &last {
                assert_eq!(ours.cmp_crossing(a), theirs.cmp_crossing(b));
            }
            last = Some((ours, theirs));
        }
        assert!(whole > rounds / 2 && ties > rounds / 1000, "{whole} in whole numbers, {ties} ties");
    }
}
