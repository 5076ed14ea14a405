//! Numbers of about 106 bits as sums of two f64, and the residual and depth of a patch computed in them.
//!
//! Source: Dekker, "A floating-point technique for extending the available precision", 1971; sums after Shewchuk 1997.

use super::BezierPatch;
use super::net::Net;
use super::pencil::Pencil;
use crate::geometry::expansion::{two_product, two_sum};

/// The sum of two f64; the second is at most half a unit in the last place of the first.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Double {
    high: f64,
    low: f64,
}

impl Double {
    /// `x` itself.
    pub fn of(x: f64) -> Self {
        Self { high: x, low: 0.0 }
    }

    /// `a + b`, renormalised.
    pub fn sum(a: f64, b: f64) -> Self {
        let (high, low) = two_sum(a, b);
        Self { high, low }
    }

    /// `a + b + c + d` with a relative error of about 2^-104 of the greatest of them but for those that cancel exactly:
    /// the two greatest first, then the small ones.
    pub fn sum_of_four(a: f64, b: f64, c: f64, d: f64) -> Self {
        let (high, error) = two_sum(a, b);
        let (small, tail) = two_sum(c, d);
        let (middle, rest) = two_sum(error, small);
        let (high, low) = two_sum(high, middle);
        Self::sum(high, low + (tail + rest))
    }

    pub fn add(self, other: Self) -> Self {
        let (high, error) = two_sum(self.high, other.high);
        let (low, tail) = two_sum(self.low, other.low);
        let (high, error) = two_sum(high, error + low);
        Self::sum(high, error + tail)
    }

    pub fn multiply(self, other: Self) -> Self {
        let (high, error) = two_product(self.high, other.high);
        Self::sum(high, error + (self.high * other.low + self.low * other.high))
    }

    pub fn value(self) -> f64 {
        self.high + self.low
    }

    /// The number as f64, the same for all numbers but a few within a small distance of each other: rounded to multiples
    /// of `quantum`, a power of two, and to f64.
    ///
    /// Numbers with few digits come from special positions, a ray that starts on the surface, say; they must not lie on
    /// the border between two results, or an error of 2^-95 decides. So the borders are moved to numbers that no special
    /// position gives, by a share of the last place.
    pub fn settle(self, quantum: f64) -> f64 {
        const SHARE: f64 = 0.137_036;
        let moved = self.high + (self.low + SHARE * (self.high * (f64::EPSILON / 2.0)));
        let grid = 6_755_399_441_055_744.0 * quantum; // 2^52 + 2^51
        if moved.abs() < 1_125_899_906_842_624.0 * quantum {
            (moved + SHARE * quantum + grid) - grid + 0.0
        } else {
            moved
        }
    }
}

/// The cubic Bernstein polynomials at `t`.
fn bernstein(t: f64) -> [Double; 4] {
    let (t, s) = (Double::of(t), Double::sum(1.0, -t));
    let (tt, ss) = (t.multiply(t), s.multiply(s));
    let three = Double::of(3.0);
    [ss.multiply(s), three.multiply(ss.multiply(t)), three.multiply(tt.multiply(s)), tt.multiply(t)]
}

/// A patch seen along a ray, at one point, in double f64.
pub(super) struct Sharp {
    /// The two residuals.
    pub residual: [f64; 2],
    /// Coordinate along the pencil's axis.
    pub depth: Double,
}

impl Sharp {
    /// The residuals and the depth at (u, v), taken as exact, within about 2^-98 of the greatest control value.
    pub fn at(patch: &BezierPatch, pencil: &Pencil, u: f64, v: f64) -> Self {
        let (across, along) = (bernstein(u), bernstein(v));
        let mut sums = [Double::default(); 3];
        for (row, weight) in patch.points.iter().zip(along) {
            let mut parts = [Double::default(); 3];
            for (p, w) in row.iter().zip(across) {
                let [f, g] = pencil.sharp(*p);
                let h = Double::of(f64::from(p[pencil.axis]));
                for (part, x) in parts.iter_mut().zip([f, g, h]) {
                    *part = part.add(w.multiply(x));
                }
            }
            for (sum, part) in sums.iter_mut().zip(parts) {
                *sum = sum.add(weight.multiply(part));
            }
        }
        let [f, g, depth] = sums;
        Self { residual: [f.value(), g.value()], depth }
    }
}

/// A root and how far along the ray it is.
#[derive(Clone, Copy, Debug)]
pub(super) struct Root {
    pub u: f64,
    pub v: f64,
    /// Ray parameter, settled.
    pub t: f64,
}

/// A root is on the patch if it is this near to it in u and v: far above the error of [`polish`].
const ON_BORDER: f64 = 1.0 / (1_u64 << 60) as f64;

/// What is at the end of Newton's method.
pub(super) enum Polished {
    Root(Root),
    /// A root that is not on the patch, at this (u, v).
    Outside(f64, f64),
    /// Nothing that it converges to.
    Diverged,
}

/// The root near (u, v) and its parameter, the same whichever starting point led there.
///
/// The residual is exact to about 2^-98; a step of 2^-46 or less with a Jacobian in f64 then leaves an error of about
/// 2^-92. `nets` are the two residuals and the depth in f64.
pub(super) fn polish(patch: &BezierPatch, pencil: &Pencil, nets: &[Net; 3], start: (f64, f64)) -> Polished {
    const SMALL: f64 = 1.0 / (1_u64 << 46) as f64;
    let (mut u, mut v) = start;
    for _ in 0..8 {
        let sharp = Sharp::at(patch, pencil, u, v);
        let [f, g, h] = [&nets[0], &nets[1], &nets[2]].map(|net| net.slopes(u, v));
        let determinant = f.0 * g.1 - f.1 * g.0;
        let du = (f.1 * sharp.residual[1] - g.1 * sharp.residual[0]) / determinant;
        let dv = (g.0 * sharp.residual[0] - f.0 * sharp.residual[1]) / determinant;
        if !(du.abs() < 1.0 && dv.abs() < 1.0) {
            return Polished::Diverged;
        }
        if du.abs() <= SMALL && dv.abs() <= SMALL {
            let inside = |x: f64, dx: f64| x + dx >= -ON_BORDER && (x - 1.0) + dx <= ON_BORDER;
            if !(inside(u, du) && inside(v, dv)) {
                return Polished::Outside(u + du, v + dv);
            }
            // The net of the depth is that of the coordinate times the direction's.
            let moved = (h.0 * du + h.1 * dv) / pencil.direction;
            let depth = sharp.depth.add(Double::of(moved));
            let t = pencil.parameter(depth, patch);
            return Polished::Root(Root { u: (u + du).clamp(0.0, 1.0), v: (v + dv).clamp(0.0, 1.0), t });
        }
        (u, v) = (u + du, v + dv);
    }
    Polished::Diverged
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Exact integers below 2^100 as the sum of two f64.
    fn of(n: i128) -> Double {
        let high = n as f64;
        Double::sum(high, (n - high as i128) as f64)
    }

    #[test]
    fn sums_and_products_agree_with_integers() {
        let mut random = crate::geometry::tests::Random::new(3);
        for _ in 0..20_000 {
            let mut draw = |bits: i128| random.within(1 << bits);
            let (a, b, c) = (draw(100), draw(100), draw(52));
            let near = |x: Double, exact: i128, size: f64| {
                let (high, low) = (x.high as i128, x.low as i128);
                assert!(((exact - high - low) as f64).abs() <= size * 2f64.powi(-102), "{exact}");
            };
            near(of(a).add(of(b)), a + b, a.abs().max(b.abs()) as f64);
            let d = draw(60);
            near(of(c).multiply(of(d)), c * d, (c * d).abs() as f64);
        }
        let four = Double::sum_of_four(1.0, -1.0, 2f64.powi(-60), 2f64.powi(-160));
        assert_eq!((four.high, four.low), (2f64.powi(-60), 2f64.powi(-160)));
    }

    #[test]
    fn special_numbers_settle_the_same_from_both_sides() {
        let quantum = 2f64.powi(-70);
        for x in [0.0, 1.0, -1.0, 0.5 * quantum, 1.5 * quantum, -0.5 * quantum, 1.0 + f64::EPSILON, 3e10, 0.75] {
            for shift in [0.0, f64::EPSILON / 2.0 * x] {
                let settle =
                    |noise: f64| Double::sum(x, 0.0).add(Double::of(shift)).add(Double::of(noise)).settle(quantum);
                let size = x.abs().max(1.0) * 2f64.powi(-100);
                assert_eq!(settle(size).to_bits(), settle(-size).to_bits(), "{x:e} {shift:e}");
                assert!((settle(0.0) - x).abs() <= quantum.max(x.abs() * f64::EPSILON));
            }
        }
    }
}
