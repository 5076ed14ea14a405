//! Finds where a ray meets a patch: subdivision until a part can be shown to have at most one root, then Newton's method.
//!
//! The roots are those of two bicubic polynomials, the residuals of [`Pencil`]. A part of the patch, known by its 16
//! control values for each, is
//!
//! - dropped if the control values of a linear combination of the residuals exclude 0, or those of the depth the ray's
//!   range; the combinations are the residuals themselves and the rows of the adjugate of the Jacobian at the centre
//!   times the residuals, which keep their meaning where the Jacobian is singular: across a silhouette;
//! - left to Newton's method if the Jacobian times that adjugate is strictly diagonally dominant over the whole part, so
//!   that the map is one-to-one there (any two points differ by such a matrix times their distance);
//! - halved along its longer side otherwise, as seen along the ray, the nearer half first; or, when it is smaller than
//!   2^-30 of the patch, taken for a hit: the ray touches the patch there, or passes a point where an edge has no length.
//!
//! Newton's method can fail, but nothing is lost by it: the part is halved then. A root found is polished until it no
//! longer depends on where the search began ([`polish`]). So the answer depends on ray and patch alone, and neither on
//! the seed nor on which parts were left out because they lie in other voxels.

use super::double::{Polished, Root, Sharp, polish};
use super::net::{Net, Rect, Split};
use super::pencil::Pencil;
use super::{BezierPatch, Method, Tally};
use crate::geometry::Best;
use crate::ray::Ray;

/// Control values are taken to be nonzero from this share of the patch's size on: halving 80 times loses less.
const MARGIN: f64 = 1.0 / (1_u64 << 48) as f64;

/// Parts are no longer halved below this share of the patch's size.
const LEAF: f64 = 1.0 / (1_u64 << 30) as f64;

/// Newton's method may end this far outside a part, in parameters: rounding.
const OUTSIDE: f64 = 1.0 / (1_u64 << 40) as f64;

/// After so many parts the rest is given up: an end for what cannot be resolved, such as a patch that is nothing but a
/// curve which its diagonals run across. No surface comes near it.
const MOST_PARTS: u32 = 1 << 18;

/// Newton's method ends after so many iterations.
pub(super) const MOST_ITERATIONS: u32 = 12;

/// Where to look first, and where to look at all.
#[derive(Clone, Copy, Debug)]
pub(super) struct Hint {
    pub start: (f64, f64),
    pub rect: Rect,
}

/// A part of the patch: the two residuals and the depth over it.
struct Part {
    nets: [Net; 3],
    rect: Rect,
}

/// What a part can hold.
enum Holds {
    Nothing,
    OneAtMost,
    Anything,
}

/// How [`newton`] ended.
pub(super) struct Run {
    /// Where it converged, wherever that is; `None` if it did not.
    pub root: Option<(f64, f64)>,
    pub iterations: u32,
}

/// Newton's method for the two residuals from `start`.
pub(super) fn newton(nets: &[Net; 3], start: (f64, f64)) -> Run {
    const CONVERGED: f64 = 1.0 / (1_u64 << 30) as f64;
    let (mut u, mut v) = start;
    for iterations in 1..=MOST_ITERATIONS {
        let (f, fu, fv) = nets[0].value_and_slopes(u, v);
        let (g, gu, gv) = nets[1].value_and_slopes(u, v);
        let determinant = fu * gv - fv * gu;
        let (du, dv) = ((fv * g - gv * f) / determinant, (gu * f - fu * g) / determinant);
        (u, v) = (u + du, v + dv);
        // False for NaN as well.
        if !(u.abs() <= 3.0 && v.abs() <= 3.0) {
            return Run { root: None, iterations };
        }
        if du.abs() <= CONVERGED && dv.abs() <= CONVERGED {
            return Run { root: Some((u, v)), iterations };
        }
    }
    Run { root: None, iterations: MOST_ITERATIONS }
}

/// One patch and one ray.
pub(super) struct Search<'a> {
    pub patch: &'a BezierPatch,
    pub ray: &'a Ray,
    pub pencil: &'a Pencil,
    pub prim: u32,
    pub method: Method,
    pub best: &'a mut Best,
    pub tally: Tally,
    /// (u, v) of the winner, if it is one of this patch.
    pub at: Option<(f64, f64)>,
}

/// What the parts of one search share.
struct Shared {
    nets: [Net; 3],
    hint: Hint,
    /// Greatest extent of the patch, in the unit of the residuals.
    size: f64,
    /// Depth of the range's begin, made lower by what is not certain.
    nearest: f64,
    /// Depth of the range's end, made higher.
    farthest: f64,
}

impl Search<'_> {
    /// Offers every root of the patch that could win and lies in the rectangle of `hint`; others may be offered too.
    pub fn run(&mut self, hint: Hint) {
        self.tally.tests += 1;
        let nets = self.pencil.nets(self.patch);
        let extents = nets.each_ref().map(|net| net.range());
        let size = extents.iter().fold(0.0_f64, |size, (low, high)| size.max(high - low));
        // NaN would pass; control points are finite here.
        if extents[..2].iter().any(|&(low, high)| low > size * MARGIN || high < -size * MARGIN) {
            return;
        }
        let (begin, slack) = self.pencil.depth_of(f64::from(self.ray.t_min), self.patch);
        let (end, end_slack) = self.pencil.depth_of(f64::from(self.ray.t_max), self.patch);
        let shared = Shared {
            nets,
            hint,
            size,
            nearest: begin - slack - size * MARGIN,
            farthest: end + end_slack + size * MARGIN,
        };
        if shared.hint.rect != Rect::ALL {
            // What the voxel's part alone can decide, it decides.
            let rect = shared.hint.rect;
            let part = Part { nets: shared.nets.each_ref().map(|net| net.part(&rect)), rect };
            match self.holds(&part, &shared) {
                Holds::Nothing => return,
                Holds::OneAtMost if self.method == Method::Newton && self.iterate(&part, &shared) => return,
                _ => {}
            }
        }
        let mut parts = 0;
        self.search(Part { nets: shared.nets, rect: Rect::ALL }, &shared, &mut parts);
    }

    fn search(&mut self, part: Part, shared: &Shared, parts: &mut u32) {
        *parts += 1;
        if !part.rect.meets(&shared.hint.rect) {
            return;
        }
        match self.holds(&part, shared) {
            Holds::Nothing => return,
            Holds::OneAtMost if self.method == Method::Newton && self.iterate(&part, shared) => return,
            _ => {}
        }
        let [f, g, depth] = part.nets.each_ref().map(|net| net.strides());
        let (mut along_u, mut along_v) = (f.0.max(g.0), f.1.max(g.1));
        let small = shared.size * LEAF;
        if along_u.max(along_v) <= small {
            // Seen along the ray, the part is a point: it may still be a stretch of the ray.
            (along_u, along_v) = depth;
        }
        if along_u.max(along_v) <= small {
            self.touch(&part, shared);
            return;
        }
        if *parts >= MOST_PARTS {
            return;
        }
        self.tally.subdivisions += 1;
        let (split, [low, high]): (Split, _) = if along_u >= along_v {
            (Net::split_u, part.rect.halves_u())
        } else {
            (Net::split_v, part.rect.halves_v())
        };
        let [(f0, f1), (g0, g1), (h0, h1)] = part.nets.each_ref().map(split);
        let first = Part { nets: [f0, g0, h0], rect: low };
        let second = Part { nets: [f1, g1, h1], rect: high };
        let (near, far) = if h1.range().0 < h0.range().0 { (second, first) } else { (first, second) };
        self.search(near, shared, parts);
        self.search(far, shared, parts);
    }

    fn holds(&self, part: &Part, shared: &Shared) -> Holds {
        let margin = shared.size * MARGIN;
        let excludes = |(low, high): (f64, f64), margin: f64| low > margin || high < -margin;
        let [f, g, h] = &part.nets;
        if excludes(f.range(), margin) || excludes(g.range(), margin) || self.is_useless(h.range(), shared) {
            return Holds::Nothing;
        }
        let ((fu, fv), (gu, gv)) = (f.slopes_at_centre(), g.slopes_at_centre());
        // Rows of the adjugate: the first is 0 along v, the second along u.
        let along_u = f.combine(gv, -fv, g);
        let along_v = f.combine(-gu, fu, g);
        let (weight_u, weight_v) = (gv.abs() + fv.abs(), gu.abs() + fu.abs());
        if excludes(along_u.range(), margin * weight_u) || excludes(along_v.range(), margin * weight_v) {
            return Holds::Nothing;
        }
        let dominates = |own: (f64, f64), other: (f64, f64), margin: f64| {
            let own = if own.0 > 0.0 { own.0 } else { -own.1 };
            own > 1.125 * other.1.max(-other.0) + margin
        };
        let one = dominates(along_u.slope_range_u(), along_u.slope_range_v(), 8.0 * margin * weight_u)
            && dominates(along_v.slope_range_v(), along_v.slope_range_u(), 8.0 * margin * weight_v);
        if one { Holds::OneAtMost } else { Holds::Anything }
    }

    /// True if no root at a depth in the range can win.
    fn is_useless(&self, (low, high): (f64, f64), shared: &Shared) -> bool {
        if high < shared.nearest || low > shared.farthest {
            return true;
        }
        if !self.best.is_hit() {
            return false;
        }
        let (winner, slack) = self.pencil.depth_of(self.best.t(), self.patch);
        low > winner + slack + shared.size * MARGIN
    }

    /// Newton's method on a part with one root at most; false if that does not settle what is in it.
    fn iterate(&mut self, part: &Part, shared: &Shared) -> bool {
        let start = if part.rect.contains(shared.hint.start, 0.0) { shared.hint.start } else { part.rect.centre() };
        let run = newton(&shared.nets, start);
        self.tally.runs += 1;
        self.tally.iterations += u64::from(run.iterations);
        let settled = run.root.is_some_and(|at| self.settle(part, at, shared));
        self.tally.failures += u64::from(!settled);
        settled
    }

    /// Offers the root near `at`, if it is one of the patch; false if it is none of the part.
    fn settle(&mut self, part: &Part, at: (f64, f64), shared: &Shared) -> bool {
        // How far Newton's method in f64 may be off: far more than it is unless the ray grazes the patch.
        const NEAR: f64 = 1.0 / (1_u64 << 20) as f64;
        if !part.rect.contains(at, NEAR) {
            return false;
        }
        let depth = shared.nets[2].value_and_slopes(at.0, at.1).0;
        let off = shared.size * NEAR;
        if part.rect.contains(at, 0.0) && self.is_useless((depth - off, depth + off), shared) {
            return true;
        }
        match polish(self.patch, self.pencil, &shared.nets, at) {
            Polished::Root(root) => {
                self.offer(root);
                part.rect.contains((root.u, root.v), OUTSIDE)
            }
            Polished::Outside(u, v) => part.rect.contains((u, v), OUTSIDE),
            Polished::Diverged => false,
        }
    }

    /// A part too small to be halved: a hit at its centre, or at the patch's border where it reaches it.
    fn touch(&mut self, part: &Part, shared: &Shared) {
        let place = |(low, high): (f64, f64)| match (low == 0.0, high == 1.0) {
            (true, false) => 0.0,
            (false, true) => 1.0,
            _ => 0.5 * (low + high),
        };
        let (u, v) = (place(part.rect.u), place(part.rect.v));
        if self.method == Method::Subdivision {
            match polish(self.patch, self.pencil, &shared.nets, part.rect.centre()) {
                Polished::Root(root) => return self.offer(root),
                Polished::Outside(..) => return,
                Polished::Diverged => {}
            }
        }
        let sharp = Sharp::at(self.patch, self.pencil, u, v);
        self.offer(Root { u, v, t: self.pencil.parameter(sharp.depth, self.patch) });
    }

    fn offer(&mut self, root: Root) {
        let before = *self.best;
        self.best.offer(self.ray, root.t, self.prim);
        if *self.best != before {
            self.at = Some((root.u, root.v));
        }
    }
}
