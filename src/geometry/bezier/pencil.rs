//! A ray as the intersection of two planes, whose residuals are exact for every finite ray and point.
//!
//! With `k` the axis of the direction's greatest component, the point `p` lies on the ray's line exactly if
//! `(p_i - o_i) d_k = (p_k - o_k) d_i` for the two other axes `i`: both residuals are linear in `p`, so those of a
//! patch's control points are the control values of the residual over the patch. Written `(p_i d_k - p_k d_i) -
//! (o_i d_k - o_k d_i)`, every product is one of two f32 and exact in f64: a far origin cancels without loss.

use super::BezierPatch;
use super::double::Double;
use super::net::Net;
use crate::geometry::expansion::two_sum;
use crate::ray::Ray;
use glam::Vec3;

/// What the patch tests of one ray share.
#[derive(Clone, Copy, Debug)]
pub struct Pencil {
    /// `k`
    pub(super) axis: usize,
    others: [usize; 2],
    /// `d_k`
    pub(super) direction: f64,
    slopes: [f64; 2],
    /// `o_k`
    origin: f64,
    /// `o_i d_k - o_k d_i` exactly, as sums of two.
    moments: [(f64, f64); 2],
}

impl Pencil {
    pub(super) fn new(ray: &Ray) -> Self {
        let [dx, dy, dz] = ray.direction.abs().to_array();
        let axis = if dx >= dy && dx >= dz { 0 } else { 1 + usize::from(dz > dy) };
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let (o, d) = (ray.origin.as_dvec3(), ray.direction.as_dvec3());
        let moment = |i: usize| two_sum(o[i] * d[axis], -(o[axis] * d[i]));
        Self {
            axis,
            others,
            direction: d[axis],
            slopes: others.map(|i| d[i]),
            origin: o[axis],
            moments: others.map(moment),
        }
    }

    /// The residuals of a point, in f64: relative error 2^-52, and 2^-104 of its products.
    fn residual(&self, p: Vec3, which: usize) -> f64 {
        let (a, b, (high, low)) = self.products(p, which);
        let (x, x_error) = two_sum(a, -b);
        let (y, y_error) = two_sum(x, -high);
        y + (y_error + (x_error - low))
    }

    /// The same in double f64.
    pub(super) fn sharp(&self, p: Vec3) -> [Double; 2] {
        [0, 1].map(|which| {
            let (a, b, (high, low)) = self.products(p, which);
            let (x, x_error) = two_sum(a, -b);
            Double::sum_of_four(x, -high, x_error, -low)
        })
    }

    fn products(&self, p: Vec3, which: usize) -> (f64, f64, (f64, f64)) {
        let across = f64::from(p[self.others[which]]) * self.direction;
        let along = f64::from(p[self.axis]) * self.slopes[which];
        (across, along, self.moments[which])
    }

    /// The two residuals over a patch, and its depth from its first control point: `(p_k - p00_k) d_k`, in the same
    /// unit, which grows with the parameter as `t d_k^2`.
    pub(super) fn nets(&self, patch: &BezierPatch) -> [Net; 3] {
        let first = f64::from(patch.points[0][0][self.axis]);
        let depth = |p: Vec3| (f64::from(p[self.axis]) - first) * self.direction;
        let map = |f: &dyn Fn(Vec3) -> f64| Net(patch.points.map(|row| row.map(f)));
        [map(&|p| self.residual(p, 0)), map(&|p| self.residual(p, 1)), map(&depth)]
    }

    /// The depth of [`Pencil::nets`] at parameter `t`, and a bound on the error of comparing with it.
    pub(super) fn depth_of(&self, t: f64, patch: &BezierPatch) -> (f64, f64) {
        const SLACK: f64 = 1.0 / (1_u64 << 48) as f64;
        let first = f64::from(patch.points[0][0][self.axis]);
        let (far, at) = (t * self.direction, self.origin - first);
        let size = far.abs() + self.origin.abs() + first.abs() + patch.reach;
        // An infinite parameter compares rightly and needs no slack.
        let slack = if size.is_finite() { size * self.direction.abs() * SLACK } else { 0.0 };
        let depth = if t.is_infinite() { t } else { (far + at) * self.direction };
        (depth, slack)
    }

    /// The parameter at a depth, the same for all depths within 2^-90 of the patch's reach.
    pub(super) fn parameter(&self, depth: Double, patch: &BezierPatch) -> f64 {
        depth.add(Double::of(-self.origin)).settle(patch.quantum) / self.direction + 0.0
    }
}
