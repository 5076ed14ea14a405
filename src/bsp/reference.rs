//! A primitive's part in a cell: what the builder sorts.

use super::frame::{Frame, PADDING};
use super::tree::{AnyPlane, Oblique};
use crate::geometry::{Geometry, Triangle};
use crate::ray::Cell;
use glam::DVec3;

/// A box in the tree's coordinates, both corners included.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    pub min: DVec3,
    pub max: DVec3,
}

impl Extent {
    pub const EMPTY: Extent = Extent { min: DVec3::INFINITY, max: DVec3::NEG_INFINITY };

    pub fn union(&self, other: &Self) -> Self {
        Self { min: self.min.min(other.min), max: self.max.max(other.max) }
    }

    /// Half the surface.
    pub fn area(&self) -> f64 {
        let e = self.max - self.min;
        e.x * (e.y + e.z) + e.y * e.z
    }

    /// The parts on both sides of the plane `at` across `axis`.
    pub fn halves(&self, axis: usize, at: f64) -> [Self; 2] {
        let (mut low, mut high) = (*self, *self);
        low.max[axis] = at;
        high.min[axis] = at;
        [low, high]
    }

    fn padded(&self) -> Self {
        Self { min: self.min - PADDING, max: self.max + PADDING }
    }
}

/// A primitive and a box around its part in a cell that is padded by [`PADDING`].
#[derive(Clone, Copy, Debug)]
pub struct Reference {
    pub prim: u32,
    pub part: Extent,
}

/// What the builder asks of a geometry, behind a pointer, so that it is compiled once for all of them.
pub trait Shapes {
    /// See [`Geometry::overlaps`].
    fn overlaps(&self, prim: u32, cell: &Cell) -> bool;

    /// See [`Geometry::triangle`].
    fn triangle(&self, prim: u32) -> Option<Triangle>;
}

/// The shapes of a geometry.
pub struct Of<'a, G>(pub &'a G);

impl<G: Geometry> Shapes for Of<'_, G> {
    fn overlaps(&self, prim: u32, cell: &Cell) -> bool {
        self.0.overlaps(prim, cell)
    }

    fn triangle(&self, prim: u32) -> Option<Triangle> {
        self.0.triangle(prim)
    }
}

/// Sorts references into the two cells that a plane makes of one.
#[derive(Clone, Copy)]
pub struct Sorter<'a> {
    pub shapes: &'a dyn Shapes,
    pub frame: &'a Frame,
}

impl Sorter<'_> {
    /// The reference's parts on the low and the high side of `plane`, in the box `cell`; `None` where there is certainly
    /// nothing within [`PADDING`] of that side.
    ///
    /// Triangles are clipped to the padded child's box, so a reference is as tight as can be; others are asked by
    /// [`Geometry::overlaps`]. At planes across no axis the part is not cut: the corners decide on which sides it is.
    pub fn parts(&self, reference: &Reference, plane: &AnyPlane, cell: &Extent) -> [Option<Reference>; 2] {
        match plane {
            AnyPlane::Axis(plane) => {
                let (axis, at) = (plane.axis as usize, f64::from(plane.at));
                let Extent { min, max } = reference.part;
                if max[axis] < at - PADDING {
                    return [Some(*reference), None];
                }
                if min[axis] > at + PADDING {
                    return [None, Some(*reference)];
                }
                cell.halves(axis, at).map(|child| self.within(reference, &child.padded()))
            }
            AnyPlane::Oblique(plane) => {
                let (low, high) = self.reach(reference, plane);
                [low <= plane.at + PADDING, high >= plane.at - PADDING].map(|there| there.then_some(*reference))
            }
        }
    }

    /// Least and greatest product of the part's points with the plane's normal, or somewhat beyond.
    pub fn reach(&self, reference: &Reference, plane: &Oblique) -> (f64, f64) {
        let Extent { min, max } = reference.part;
        let (middle, half) = (plane.normal.dot(0.5 * (min + max)), plane.normal.abs().dot(0.5 * (max - min)));
        let (mut low, mut high) = (middle - half, middle + half);
        if let Some(triangle) = self.shapes.triangle(reference.prim) {
            let at = triangle.map(|p| plane.normal.dot(self.frame.local(p.as_dvec3())));
            low = low.max(at[0].min(at[1]).min(at[2]));
            high = high.min(at[0].max(at[1]).max(at[2]));
        }
        (low, high)
    }

    fn within(&self, reference: &Reference, cell: &Extent) -> Option<Reference> {
        let part = Extent { min: reference.part.min.max(cell.min), max: reference.part.max.min(cell.max) };
        if !part.min.cmple(part.max).all() {
            return None;
        }
        let prim = reference.prim;
        match self.shapes.triangle(prim) {
            Some(triangle) => {
                let clipped = self.clip(&triangle, cell)?;
                // Both hold it.
                let part = Extent { min: part.min.max(clipped.min), max: part.max.min(clipped.max) };
                // Crossed bounds are those of a point, by rounding.
                let part = Extent { min: part.min.min(part.max), max: part.max.max(part.min) };
                Some(Reference { prim, part })
            }
            None => {
                let world = Cell { min: self.frame.world(cell.min), max: self.frame.world(cell.max) };
                self.shapes.overlaps(prim, &world).then_some(Reference { prim, part })
            }
        }
    }

    /// The box around the part of a triangle in a box; `None` if there is none (Sutherland & Hodgman 1974).
    fn clip(&self, triangle: &Triangle, cell: &Extent) -> Option<Extent> {
        // Each of six planes adds a corner at most; rounding may add some that lie within rounding of others.
        let mut corners = [DVec3::ZERO; 12];
        let mut len = 3;
        for (corner, p) in corners.iter_mut().zip(triangle) {
            *corner = self.frame.local(p.as_dvec3());
        }
        for axis in 0..3 {
            for (sign, bound) in [(1.0, cell.max[axis]), (-1.0, cell.min[axis])] {
                let outside = |p: DVec3| (p[axis] - bound) * sign;
                if corners[..len].iter().all(|&p| outside(p) <= 0.0) {
                    continue;
                }
                let (old, mut kept) = (corners, 0);
                let mut keep = |p: DVec3| {
                    if kept < corners.len() {
                        corners[kept] = p;
                        kept += 1;
                    }
                };
                for i in 0..len {
                    let (p, q) = (old[i], old[(i + 1) % len]);
                    let (a, b) = (outside(p), outside(q));
                    if a <= 0.0 {
                        keep(p);
                    }
                    if (a < 0.0 && b > 0.0) || (a > 0.0 && b < 0.0) {
                        keep(p + (q - p) * (a / (a - b)));
                    }
                }
                len = kept;
            }
        }
        let part = corners[..len].iter().fold(Extent::EMPTY, |e, &p| e.union(&Extent { min: p, max: p }));
        (len > 0).then_some(part)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::bsp::frame::SIZE;
    use crate::bsp::tree::AxisPlane;
    use crate::random::Random;
    use crate::ray::Aabb;
    use glam::Vec3;

    /// Every point of a triangle that is within half the padding of a side is in that side's part.
    #[test]
    fn parts_hold_every_point_of_the_triangle_on_their_side() {
        let mut random = Random::new(4);
        let frame = Frame::new(&Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) });
        let whole = Extent { min: DVec3::ZERO, max: DVec3::splat(SIZE) };
        let (mut straddling, mut dropped, mut inside) = (0, 0, 0);
        for i in 0..400 {
            let size = [1.0, 0.1, 1e-3, 1e-5][i % 4];
            let place = 0.9 * random.direction();
            let mut corner = || (place + size * 0.1 * random.direction()).as_vec3();
            let set = vec![[corner(), corner(), corner()]];
            let sorter = Sorter { shapes: &Of(&set), frame: &frame };
            let bounds = set.bounds(0);
            let part = Extent { min: frame.local(bounds.min.as_dvec3()), max: frame.local(bounds.max.as_dvec3()) };
            let mut level = vec![(Reference { prim: 0, part }, whole)];
            let points: Vec<DVec3> = (0..200)
                .map(|_| {
                    let (u, v) = (random.unit(), random.unit());
                    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                    let [a, b, c] = set[0].map(|p| frame.local(p.as_dvec3()));
                    a + u * (b - a) + v * (c - a)
                })
                .collect();
            for _ in 0..5 {
                let mut next = Vec::new();
                for (reference, cell) in level {
                    // Through the triangle, or nearly.
                    let axis = random.below(3);
                    let Extent { min, max } = reference.part;
                    let at = (min[axis] + random.within(-0.1, 1.1) * (max[axis] - min[axis])) as f32;
                    if f64::from(at) <= cell.min[axis] || f64::from(at) >= cell.max[axis] {
                        continue;
                    }
                    let plane = AnyPlane::Axis(AxisPlane { axis: axis as u32, at });
                    let parts = sorter.parts(&reference, &plane, &cell);
                    straddling += u32::from(parts.iter().all(Option::is_some));
                    for (part, child) in parts.into_iter().zip(cell.halves(axis, f64::from(at))) {
                        let near = child.padded();
                        let reach =
                            |e: &Extent, p: &DVec3, by: f64| p.cmpge(e.min - by).all() && p.cmple(e.max + by).all();
                        for p in points.iter().filter(|p| reach(&child, p, PADDING / 2.0)) {
                            // Rounding: 2^-30.
                            assert!(part.is_some_and(|r| reach(&r.part, p, 1e-9)), "{:?}: {p} {child:?}", set[0]);
                            inside += 1;
                        }
                        match part {
                            Some(part) => {
                                assert!(reach(&near, &part.part.min, 1e-9) && reach(&near, &part.part.max, 1e-9));
                                next.push((part, child));
                            }
                            None => dropped += 1,
                        }
                    }
                }
                level = next;
            }
        }
        assert!(straddling > 500 && dropped > 500 && inside > 10_000, "{straddling} {dropped} {inside}");
    }

    #[test]
    fn corners_decide_on_which_side_of_an_oblique_plane_a_triangle_is() {
        let frame = Frame::new(&Aabb { min: Vec3::ZERO, max: Vec3::ONE });
        // Its box reaches across x + y = 1, the triangle does not.
        let set = vec![[Vec3::ZERO, Vec3::new(0.9, 0.0, 0.0), Vec3::new(0.0, 0.9, 0.5)]];
        let normal = DVec3::new(1.0, 1.0, 0.0).normalize();
        let plane = |x: f64| {
            let at = normal.dot(frame.local(DVec3::new(x, 0.0, 0.0)));
            AnyPlane::Oblique(Oblique { normal, at })
        };
        let sorter = Sorter { shapes: &Of(&set), frame: &frame };
        let part = Extent { min: frame.local(DVec3::ZERO), max: frame.local(DVec3::new(0.9, 0.9, 0.5)) };
        let sides = |x: f64| sorter.parts(&Reference { prim: 0, part }, &plane(x), &part).map(|side| side.is_some());
        assert_eq!(sides(1.0), [true, false]);
        assert_eq!(sides(0.5), [true, true]);
        assert_eq!(sides(-0.1), [false, true]);
    }
}
