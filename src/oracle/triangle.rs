//! Triangles: bounds in f64, and the truth in whole numbers.
//!
//! With corners A, B, C seen from the origin, the ray's line passes through the closed triangle if `d . (C - B) x B`, `d . (A -
//! C) x C` and `d . (B - A) x A` are all `>= 0` or all `<= 0` and `d . n` is not 0, where `n = (B - A) x (C - A)`. It does so at
//! `t = A . n / d . n`.

use super::line::{Estimate, Line, U, size};
use super::surd::Surd;
use super::whole::{Span, Whole, cross, dot, minus, scaled};
use glam::{DVec3, Vec3};
use num_bigint::BigInt;

/// A triangle that can be hit.
#[derive(Debug)]
pub(super) struct Triangle {
    corners: [Vec3; 3],
    span: Span,
    /// The corners in f64, and the edge opposite to each of them.
    points: [DVec3; 3],
    edges: [DVec3; 3],
    /// Bounds on the size of the edges' components.
    edge_sizes: [f64; 3],
    normal: DVec3,
    /// Bound on the sum of sizes of the terms of a component of the normal.
    normal_size: f64,
}

impl Triangle {
    /// `None` if no ray can hit it: a corner is not finite, or the three lie on a line.
    pub fn new(corners: [Vec3; 3]) -> Option<Self> {
        if !corners.iter().all(|v| v.to_array().iter().all(|x| x.is_finite())) {
            return None;
        }
        let span = Span::of(&corners);
        let [a, b, c] = corners.map(|v| scaled::<BigInt>(v, span.exponent()));
        if cross(&minus(&b, &a), &minus(&c, &a)).iter().all(|x| *x == BigInt::ZERO) {
            return None;
        }
        let points = corners.map(|v| v.as_dvec3());
        let [a, b, c] = points;
        let edges = [c - b, a - c, b - a];
        let edge_sizes = edges.map(size);
        let normal = edges[2].cross(-edges[1]);
        Some(Self {
            corners,
            span,
            points,
            edges,
            edge_sizes,
            normal,
            normal_size: 2.0 * edge_sizes[1] * edge_sizes[2],
        })
    }

    /// Bounds on the parameter of the hit; `None` if there is none.
    ///
    /// Errors, with `u = 2^-53`: a component of an edge or of a corner seen from the origin is off by `u` of itself. A term of
    /// `d . (e x p)` carries these two, a product, a difference, a product and two sums: less than `8 u` of itself, and the six
    /// terms are at most `6 |d| |e| |p|` with greatest components for sizes. The bound below is `64 u |d| |e| |p|`. A component
    /// of the normal carries four roundings on terms whose sizes add up to `normal_size`; `d . n` and `A . n` carry up to four
    /// more, over three components: less than `32 u` of the product of sizes. No product leaves the range of f64: sizes lie
    /// between 2^-149 and 2^130, and there are at most four factors.
    pub fn estimate(&self, line: &Line) -> Option<Estimate> {
        let corners = self.points.map(|p| p - line.o);
        let (mut positive, mut negative, mut open) = (false, false, false);
        // The edge that is opposite to A runs from B, that opposite to B from C, and so on.
        for (edge, from) in [(0, 1), (1, 2), (2, 0)] {
            let p = corners[from];
            let value = line.d.dot(self.edges[edge].cross(p));
            let error = 64.0 * U * line.d_size * self.edge_sizes[edge] * size(p);
            positive |= value > error;
            negative |= value < -error;
            open |= value.abs() <= error;
            if positive && negative {
                return None;
            }
        }
        let (numerator, denominator) = (corners[0].dot(self.normal), line.d.dot(self.normal));
        let numerator_error = 32.0 * U * size(corners[0]) * self.normal_size;
        let denominator_error = 32.0 * U * line.d_size * self.normal_size;
        let surely = denominator.abs() - denominator_error;
        if surely <= 0.0 {
            return line.clip(Estimate { least: f64::NEG_INFINITY, most: f64::INFINITY, certain: false });
        }
        let t = numerator / denominator;
        // Of the quotient itself and of what follows: 8 u.
        let error = (numerator_error + t.abs() * denominator_error) / surely * (1.0 + 16.0 * U) + 8.0 * U * t.abs();
        line.clip(Estimate { least: t - error, most: t + error, certain: !open })
    }

    /// The parameter of the hit within the range; `None` if there is none.
    pub fn exact(&self, line: &Line) -> Option<Surd> {
        let span = self.span.union(line.origin_span);
        let (place, way) = (span.exponent(), line.direction_span.exponent());
        // Coordinates below 2^b seen from the origin, and edges, are below 2^(b + 1). An edge's value has six terms of two of them
        // and the direction, A . n has six terms of three.
        let (bits, way_bits) = (span.bits(), line.direction_span.bits());
        let (numerator, denominator) = if way_bits + 2 * (bits + 1) + 3 < 127 && 3 * (bits + 1) + 3 < 127 {
            let (n, d) = self.hit::<i128>(line, place, way)?;
            (n.big(), d.big())
        } else {
            self.hit::<BigInt>(line, place, way)?
        };
        let t = Surd::ratio(numerator, denominator, place - way);
        line.holds(&t).then_some(t)
    }

    /// `A . n` and `d . n` if the line meets the triangle, in units of two to the power `3 place` and `2 place + way`.
    fn hit<T: Whole>(&self, line: &Line, place: i32, way: i32) -> Option<(T, T)> {
        let o = scaled::<T>(line.origin, place);
        let [a, b, c] = self.corners.map(|v| minus(&scaled(v, place), &o));
        let d = scaled::<T>(line.direction, way);
        let zero = T::default();
        let normal = cross(&minus(&b, &a), &minus(&c, &a));
        let denominator = dot(&d, &normal);
        if denominator == zero {
            return None;
        }
        let value = |to: &[T; 3], from: &[T; 3]| dot(&d, &cross(&minus(to, from), from));
        let values = [value(&c, &b), value(&a, &c), value(&b, &a)];
        let inside = values.iter().all(|x| *x >= zero) || values.iter().all(|x| *x <= zero);
        inside.then(|| (dot(&a, &normal), denominator))
    }
}
