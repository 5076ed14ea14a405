//! Which part of a patch lies in a box: by halving the patch until its parts are small against the box.

use super::net::{Net, Rect, Split};
use super::{BezierPatch, SIDE};
use crate::ray::{Aabb, Cell};
use glam::{DVec3, Vec3};

/// Halvings after which a part is taken as it is.
const DEEPEST: u32 = 24;

/// Parts are no longer halved below this share of the box.
const SMALL: f64 = 0.25;

/// A part of a patch: one net for each coordinate.
struct Part {
    nets: [Net; 3],
    rect: Rect,
}

impl Part {
    fn of(patch: &BezierPatch, rect: &Rect) -> Self {
        let net = |axis: usize| Net(patch.points.map(|row| row.map(|p| f64::from(p[axis])))).part(rect);
        Self { nets: [net(0), net(1), net(2)], rect: *rect }
    }

    /// The box around the control points.
    fn bounds(&self) -> (DVec3, DVec3) {
        let [x, y, z] = self.nets.each_ref().map(Net::range);
        (DVec3::new(x.0, y.0, z.0), DVec3::new(x.1, y.1, z.1))
    }

    fn halves(self) -> [Self; 2] {
        let strides = self.nets.each_ref().map(Net::strides);
        let (u, v) = strides.iter().fold((0.0_f64, 0.0_f64), |most, s| (most.0.max(s.0), most.1.max(s.1)));
        let (split, [low, high]): (Split, _) =
            if u >= v { (Net::split_u, self.rect.halves_u()) } else { (Net::split_v, self.rect.halves_v()) };
        let [(x0, x1), (y0, y1), (z0, z1)] = self.nets.each_ref().map(split);
        [Self { nets: [x0, y0, z0], rect: low }, Self { nets: [x1, y1, z1], rect: high }]
    }
}

/// The squares into which a patch is cut once and for all, row by row, and how far their arithmetic may be off.
pub(super) fn squares() -> impl Iterator<Item = Rect> {
    let step = |i: usize| (i as f64 / SIDE as f64, (i + 1) as f64 / SIDE as f64);
    (0..SIDE * SIDE).map(move |n| Rect { u: step(n % SIDE), v: step(n / SIDE) })
}

/// What rounding may move a control point by.
fn error(patch: &BezierPatch) -> f64 {
    patch.reach * (1.0 / (1_u64 << 46) as f64)
}

/// Boxes around the [`squares`] of a patch.
pub(super) fn boxes(patch: &BezierPatch) -> [Aabb; SIDE * SIDE] {
    let error = error(patch);
    let all = Aabb::of_points(patch.points.as_flattened());
    let mut boxes = [all; SIDE * SIDE];
    for (aabb, rect) in boxes.iter_mut().zip(squares()) {
        let (low, high) = Part::of(patch, &rect).bounds();
        // Rounded outwards, and never outside the box of all control points.
        let (low, high) = ((low - error).as_vec3(), (high + error).as_vec3());
        let [low, high] = [low.to_array().map(f32::next_down), high.to_array().map(f32::next_up)];
        *aabb = Aabb { min: Vec3::from(low).max(all.min), max: Vec3::from(high).min(all.max) };
    }
    boxes
}

/// Calls `visit` with parts of the parameters that together cover all of the patch in the closed box `cell`, until it
/// returns false. `boxes` are those of [`boxes`].
pub(super) fn cover(patch: &BezierPatch, boxes: &[Aabb], cell: &Cell, mut visit: impl FnMut(&Rect) -> bool) {
    let error = error(patch);
    let cell = Cell { min: cell.min - error, max: cell.max + error };
    for (_, rect) in boxes.iter().zip(squares()).filter(|(aabb, _)| cell.meets(aabb)) {
        if !descend(Part::of(patch, &rect), &cell, DEEPEST, &mut visit) {
            return;
        }
    }
}

/// False if `visit` wants no more.
fn descend(part: Part, cell: &Cell, depth: u32, visit: &mut impl FnMut(&Rect) -> bool) -> bool {
    let (min, max) = part.bounds();
    if !(min.cmple(cell.max).all() && max.cmpge(cell.min).all()) {
        return true;
    }
    let inside = min.cmpge(cell.min).all() && max.cmple(cell.max).all();
    let small = (max - min).cmple((cell.max - cell.min) * SMALL).all();
    if inside || small || depth == 0 {
        return visit(&part.rect);
    }
    part.halves().into_iter().all(|half| descend(half, cell, depth - 1, visit))
}
