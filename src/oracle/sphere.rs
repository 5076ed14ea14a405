//! Spheres: bounds in f64, and the truth in whole numbers under a square root.
//!
//! With `f = o - c`, the ray's line meets the sphere at the roots of `a t^2 - 2 b t + |f|^2 - r^2` with `a = |d|^2` and
//! `b = -f . d`, so at `t = (b -+ sqrt(D)) / a` with `D = b^2 - a (|f|^2 - r^2)`, which is `a r^2 - |f x d|^2`, too.

use super::line::{Estimate, Line, U, size};
use super::surd::Surd;
use super::whole::{Span, Whole, dot, minus, scaled};
use glam::Vec3;
use num_bigint::BigInt;

/// A sphere that can be hit.
#[derive(Debug)]
pub(super) struct Sphere {
    centre: Vec3,
    radius: f32,
    span: Span,
}

impl Sphere {
    /// `None` if no ray can hit it: something is not finite, the radius is negative, or it reaches beyond the greatest f32.
    pub fn new(centre: Vec3, radius: f32) -> Option<Self> {
        let finite = centre.to_array().iter().all(|x| x.is_finite()) && radius.is_finite();
        if !finite || radius < 0.0 {
            return None;
        }
        let most = BigInt::scaled(f32::MAX, -149);
        let fits = |x: f32| BigInt::scaled(x.abs(), -149) + BigInt::scaled(radius, -149) <= most;
        let span = Span::of(&[centre]).with(radius);
        centre.to_array().into_iter().all(fits).then_some(Self { centre, radius, span })
    }

    /// Bounds on the parameter of the hit; `None` if there is none.
    ///
    /// Errors, with `u = 2^-53`, `m` the product of the greatest components of `f` and `d`: a component of `f` is off by `u` of
    /// itself. A component of `f x d` is at most `2 m` and off by `6 u m` (difference, product, difference), its square by `28 u
    /// m^2`, the sum of three by `108 u m^2`. `a` is off by `3 u` of itself, `r^2` is exact, their product is off by `4 u`. With
    /// the last difference: `120 u m^2 + 5 u a r^2`; the bound below is twice that. `b` is off by `4 u` of each of three terms,
    /// the bound is `16 u m`. No product leaves the range of f64: the least square is 2^-596, the greatest below 2^520.
    pub fn estimate(&self, line: &Line) -> Option<Estimate> {
        let f = line.o - self.centre.as_dvec3();
        let (a, m) = (line.d.length_squared(), size(f) * line.d_size);
        let inside = a * f64::from(self.radius) * f64::from(self.radius);
        let outside = f.cross(line.d).length_squared();
        let discriminant = inside - outside;
        let error = 256.0 * U * (m * m) + 16.0 * U * inside;
        if discriminant < -error {
            return None;
        }
        let exists = discriminant > error;
        let root = (
            (discriminant - error).max(0.0).sqrt() * (1.0 - 8.0 * U),
            (discriminant + error).max(0.0).sqrt() * (1.0 + 8.0 * U),
        );
        let b = -f.dot(line.d);
        // Of b, and of the sums with it.
        let slack = 16.0 * U * m + 8.0 * U * (b.abs() + root.1);
        let down = |x: f64| x - 16.0 * U * x.abs();
        let up = |x: f64| x + 16.0 * U * x.abs();
        let near = (down((b - root.1 - slack) / a), up((b - root.0 + slack) / a));
        let far = (down((b + root.0 - slack) / a), up((b + root.1 + slack) / a));
        if near.0 >= line.t_min {
            return line.clip(Estimate { least: near.0, most: near.1, certain: exists });
        }
        if near.1 < line.t_min {
            return line.clip(Estimate { least: far.0, most: far.1, certain: exists });
        }
        line.clip(Estimate { least: near.0, most: far.1, certain: false })
    }

    /// The parameter of the first hit within the range; `None` if there is none.
    pub fn exact(&self, line: &Line) -> Option<Surd> {
        let place = self.span.union(line.origin_span).exponent();
        let way = line.direction_span.exponent();
        let f = minus(&scaled::<BigInt>(line.origin, place), &scaled(self.centre, place));
        let d = scaled::<BigInt>(line.direction, way);
        let radius = BigInt::scaled(self.radius, place);
        let (a, b) = (dot(&d, &d), -dot(&f, &d));
        let discriminant = &b * &b - &a * (dot(&f, &f) - &radius * &radius);
        if discriminant < BigInt::ZERO {
            return None;
        }
        let root = |sign: i32| Surd::new(b.clone(), sign, discriminant.clone(), a.clone(), place - way);
        [-1, 1].map(root).into_iter().find(|t| line.holds(t))
    }
}
