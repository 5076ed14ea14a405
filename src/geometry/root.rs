//! The last stage for spheres: where a ray meets one, as a root of a quadratic equation over whole numbers.
//!
//! Every f32 is a whole multiple of 2^-149, and coordinates of like size are multiples of a much larger power of two. Over
//! such a unit, with `f = c - o`, `a = |d|^2`, `b = f . d` and `D = b^2 - a (|f|^2 - r^2)`, the parameters are
//! `(b - sqrt D) / a` and `(b + sqrt D) / a`, and all of `a`, `b` and `D` are integers. Signs of sums with square roots are
//! decided by squaring. Numbers have up to 2 300 bits, and a decision takes up to some microseconds: it is asked for where f64
//! leaves something open, so next to never.

use super::number::Number;
use super::whole::{parts, parts_of_f64};
use super::{Sphere, Triangle};
use crate::ray::Ray;
use glam::Vec3;
use std::cmp::Ordering;

/// `x` in units of `2^exponent`, of which it is a whole multiple; finite.
fn units(x: f32, exponent: i32) -> Number {
    let (mantissa, own) = parts(x);
    if mantissa == 0 { Number::ZERO } else { &Number::from(mantissa) << (own - exponent) as u32 }
}

/// The greatest power of two of which all numbers are multiples; 0 if all are zero.
fn unit(numbers: impl IntoIterator<Item = f32>) -> i32 {
    let exponents = numbers.into_iter().map(|x| parts(x).1).filter(|&e| e != i32::MAX);
    exponents.min().unwrap_or(0)
}

type V = [Number; 3];

fn vector(v: Vec3, exponent: i32) -> V {
    v.to_array().map(|x| units(x, exponent))
}

fn minus(p: &V, q: &V) -> V {
    [&p[0] - &q[0], &p[1] - &q[1], &p[2] - &q[2]]
}

fn dot(p: &V, q: &V) -> Number {
    &p[0] * &q[0] + &p[1] * &q[1] + &p[2] * &q[2]
}

fn cross(p: &V, q: &V) -> V {
    let minor = |j: usize, k: usize| &p[j] * &q[k] - &p[k] * &q[j];
    [minor(1, 2), minor(2, 0), minor(0, 1)]
}

/// The order of `x + y sqrt(radicand)` and zero; the radicand is not below zero.
fn sign_with_root(x: &Number, y: &Number, radicand: &Number) -> Ordering {
    let (whole, root) = (x.sign(), if radicand.sign().is_eq() { Ordering::Equal } else { y.sign() });
    if whole == root || root.is_eq() {
        whole
    } else if whole.is_eq() {
        root
    } else {
        // Of opposite signs: the greater one decides.
        match (x * x).order(&(&(y * y) * radicand)) {
            Ordering::Greater => whole,
            Ordering::Equal => Ordering::Equal,
            Ordering::Less => root,
        }
    }
}

/// The exact parameter at which a ray meets a sphere: `(b + side sqrt D) / a * 2^exponent`, with `a` above zero and `D` not
/// below it.
#[derive(Clone, Debug)]
pub(super) struct Root {
    a: Number,
    b: Number,
    discriminant: Number,
    /// -1 for the lesser root, 1 for the greater one.
    side: Number,
    exponent: i32,
}

impl Root {
    /// The least parameter in the ray's range at which it meets the sphere, which can be hit.
    pub fn first(sphere: &Sphere, ray: &Ray) -> Option<Self> {
        let places = [ray.origin, sphere.centre].into_iter().flat_map(|v| v.to_array());
        let place = unit(places.chain([sphere.radius]));
        let pace = unit(ray.direction.to_array());
        let (d, r) = (vector(ray.direction, pace), units(sphere.radius, place));
        let f = minus(&vector(sphere.centre, place), &vector(ray.origin, place));
        let (a, b) = (dot(&d, &d), dot(&f, &d));
        let discriminant = &b * &b - &a * &(dot(&f, &f) - &r * &r);
        if discriminant.sign().is_lt() {
            return None;
        }
        let lesser = Self { a, b, discriminant, side: Number::from(-1), exponent: place - pace };
        if lesser.in_range(ray) {
            return Some(lesser);
        }
        let greater = Self { side: Number::from(1), ..lesser };
        greater.in_range(ray).then_some(greater)
    }

    /// True for the lesser of the two roots.
    pub fn is_lesser(&self) -> bool {
        self.side.sign().is_lt()
    }

    fn in_range(&self, ray: &Ray) -> bool {
        self.cmp_parameter(f64::from(ray.t_min)).is_ge() && self.cmp_parameter(f64::from(ray.t_max)).is_le()
    }

    /// Compares with `numerator / denominator * 2^exponent`, the denominator above zero.
    fn cmp_fraction(&self, numerator: &Number, denominator: &Number, exponent: i32) -> Ordering {
        // b + side sqrt D - a n / m, times m, over the lesser of the two powers.
        let gap = self.exponent - exponent;
        let (ours, theirs) = (denominator << gap.max(0) as u32, &(&self.a * numerator) << (-gap).max(0) as u32);
        sign_with_root(&(&self.b * &ours - theirs), &(&self.side * &ours), &self.discriminant)
    }

    /// Compares with a number.
    pub fn cmp_parameter(&self, t: f64) -> Ordering {
        if t.is_infinite() {
            return 0f64.total_cmp(&t);
        }
        let (mantissa, power) = parts_of_f64(t);
        self.cmp_fraction(&mantissa.into(), &1.into(), power)
    }

    /// Compares with another root for the same ray.
    pub fn cmp_root(&self, other: &Self) -> Ordering {
        // p + s sqrt D - s' sqrt D' against zero, since `a` is the ray's; over the lesser of the two powers.
        let gap = self.exponent - other.exponent;
        if gap < 0 {
            return other.cmp_root(self).reverse();
        }
        let (b, discriminant) = (&self.b << gap as u32, &self.discriminant << (2 * gap as u32));
        let p = &b - &other.b;
        let ours = sign_with_root(&p, &self.side, &discriminant);
        let theirs = if other.discriminant.sign().is_eq() { Ordering::Equal } else { other.side.sign() };
        if ours != theirs || ours.is_eq() {
            return ours.cmp(&theirs);
        }
        // Of like signs: their squares decide.
        let rest = &(&p * &p + discriminant.clone()) - &other.discriminant;
        let order = sign_with_root(&rest, &(&(&p << 1) * &self.side), &discriminant);
        if ours.is_gt() { order } else { order.reverse() }
    }

    /// Compares with where the ray meets a triangle's plane, to which it is not parallel.
    pub fn cmp_plane(&self, ray: &Ray, corners: &Triangle) -> Ordering {
        let place = unit(corners.iter().chain([&ray.origin]).flat_map(|v| v.to_array()));
        let pace = unit(ray.direction.to_array());
        let [a, b, c] = corners.map(|p| vector(p, place));
        let n = cross(&minus(&b, &a), &minus(&c, &a));
        let numerator = dot(&minus(&a, &vector(ray.origin, place)), &n);
        let denominator = dot(&vector(ray.direction, pace), &n);
        match denominator.sign() {
            Ordering::Less => self.cmp_fraction(&-&numerator, &-&denominator, place - pace),
            _ => self.cmp_fraction(&numerator, &denominator, place - pace),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn root(centre: [f32; 3], radius: f32, ray: &Ray) -> Root {
        Root::first(&Sphere { centre: Vec3::from(centre), radius }, ray).expect("a hit")
    }

    #[test]
    fn numbers_are_whole_multiples_of_their_unit() {
        let same = |x: f32, exponent, expected: Number| units(x, exponent).order(&expected).is_eq();
        assert!(same(f32::from_bits(1), -149, 1.into()) && same(-f32::MIN_POSITIVE, -149, (-1 << 23).into()));
        assert!(same(1.5, -149, &Number::from(3) << 148) && same(-0.0, 3, Number::ZERO));
        assert_eq!(unit([0.0, -0.0]), 0);
        assert_eq!(unit([6.0, 0.0, 1.25]), -2);
    }

    #[test]
    fn roots_are_ordered_as_real_numbers() {
        let along = |t_min| Ray::new(Vec3::ZERO, Vec3::new(2.0, 0.0, 0.0)).with_range(t_min, f32::INFINITY);
        let ray = along(0.0);
        // 2 t = 10 - sqrt(25 - 9) = 6 exactly.
        let six = root([10.0, 3.0, 0.0], 5.0, &ray);
        assert_eq!(six.cmp_parameter(3.0), Ordering::Equal);
        assert_eq!(six.cmp_parameter(3.0f64.next_up()), Ordering::Less);
        assert_eq!(six.cmp_parameter(f64::NEG_INFINITY), Ordering::Greater);
        // 2 t = 10 - sqrt 2 and 2 t = 9 - (sqrt 2 - 1) with other squares: never equal to a number of 53 bits.
        let left = root([10.0, 0.0, 7.0], 51f32.sqrt(), &ray);
        assert_ne!(left.cmp_parameter((10.0 - 2f64.sqrt()) / 2.0), Ordering::Equal);
        // The same place on spheres of different size: 13 - 5 = 8 = 18 - 10.
        assert_eq!(root([13.0, 0.0, 0.0], 5.0, &ray).cmp_root(&root([18.0, 0.0, 0.0], 10.0, &ray)), Ordering::Equal);
        assert_eq!(six.cmp_root(&root([13.0, 0.0, 0.0], 5.0, &ray)), Ordering::Less);
        assert_eq!(
            six.cmp_plane(&ray, &[[6.0, 1.0, 0.0], [6.0, 0.0, 3.0], [6.0, 7.0, 7.0]].map(Vec3::from)),
            Ordering::Equal
        );
        // From inside, the greater root; from beyond it, none.
        assert_eq!(root([10.0, 3.0, 0.0], 5.0, &along(3.5)).cmp_parameter(7.0), Ordering::Equal);
        assert!(Root::first(&Sphere { centre: Vec3::new(10.0, 3.0, 0.0), radius: 5.0 }, &along(7.5)).is_none());
        // Two greater roots: 10 + 4 = 9 + 5.
        let (a, b) = (root([10.0, 3.0, 0.0], 5.0, &along(6.5)), root([9.0, 0.0, 0.0], 5.0, &along(6.5)));
        assert_eq!(a.cmp_root(&b), Ordering::Equal);
    }

    #[test]
    fn squares_decide_what_floating_point_cannot() {
        let ray = Ray::new(Vec3::new(0.0, 0.0, 0.0), Vec3::X);
        // Tangent exactly, and by one unit in the last place less and more.
        for (offset, hits) in [(1.0f32, true), (1.0f32.next_up(), false), (1.0f32.next_down(), true)] {
            let found = Root::first(&Sphere { centre: Vec3::new(4.0, offset, 0.0), radius: 1.0 }, &ray);
            assert_eq!(found.is_some(), hits, "{offset}");
        }
        // sqrt 2 + sqrt 3 against sqrt(5 + 2 sqrt 6) and the like, in all signs: p + s sqrt D - s' sqrt D'.
        let of = |b: i64, side: i64, d: i64| Root {
            a: 1.into(),
            b: b.into(),
            discriminant: d.into(),
            side: side.into(),
            exponent: 0,
        };
        for (b, s, d, other_b, other_s, other_d) in (0..4000i64)
            .map(|i| (i % 7 - 3, i / 7 % 2 * 2 - 1, i / 14 % 9, i / 126 % 5 - 2, i / 630 % 2 * 2 - 1, i / 1260 % 9))
        {
            let value = |b: i64, s: i64, d: i64| b as f64 + s as f64 * (d as f64).sqrt();
            let (x, y) = (value(b, s, d), value(other_b, other_s, other_d));
            let expected = if (x - y).abs() < 1e-9 { Ordering::Equal } else { x.total_cmp(&y) };
            assert_eq!(of(b, s, d).cmp_root(&of(other_b, other_s, other_d)), expected, "{x} {y}");
        }
    }
}
