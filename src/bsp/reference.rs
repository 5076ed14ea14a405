//! A primitive's part in a cell: what the builder sorts.

use super::frame::{Frame, PADDING};
use super::tree::{AnyPlane, AxisPlane, Oblique};
use crate::geometry::polygon::Polygon;
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

    /// Half the surface.
    pub fn area(&self) -> f64 {
        let e = self.max - self.min;
        e.x * (e.y + e.z) + e.y * e.z
    }

    /// Least and greatest product of a point of the box with `normal`.
    pub fn reach(&self, normal: DVec3) -> (f64, f64) {
        let (a, b) = (normal * self.min, normal * self.max);
        let (low, high) = (a.min(b), a.max(b));
        (low.x + low.y + low.z, high.x + high.y + high.z)
    }

    /// Boxes around what lies on the low and the high side of `plane`, or beyond it by no more than `padding`.
    pub fn sides(&self, plane: &AnyPlane, padding: f64) -> [Self; 2] {
        let (mut low, mut high) = (*self, *self);
        match plane {
            AnyPlane::Axis(AxisPlane { axis, at }) => {
                let (axis, at) = (*axis as usize, f64::from(*at));
                low.max[axis] = low.max[axis].min(at + padding);
                high.min[axis] = high.min[axis].max(at - padding);
            }
            AnyPlane::Oblique(Oblique { normal, at }) => {
                // Along an axis the plane bounds what is left when the others give all that they can.
                let (least, most) = self.reach(*normal);
                for axis in 0..3 {
                    let n = normal[axis];
                    if n != 0.0 {
                        let (a, b) = (n * self.min[axis], n * self.max[axis]);
                        let at_most = (at + padding - (least - a.min(b))) / n;
                        let at_least = (at - padding - (most - a.max(b))) / n;
                        let (below, above) = if n > 0.0 { (at_most, at_least) } else { (at_least, at_most) };
                        let (upper, lower) = if n > 0.0 { (&mut low, &mut high) } else { (&mut high, &mut low) };
                        upper.max[axis] = upper.max[axis].min(below);
                        lower.min[axis] = lower.min[axis].max(above);
                    }
                }
            }
        }
        [low, high]
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

/// What a part is inflated by for the question whether its primitive is there at all.
const HAIR: f64 = PADDING / 4.0;

impl Sorter<'_> {
    /// The reference's parts on the low and the high side of `plane`; `None` where there is certainly nothing within
    /// [`PADDING`] of that side.
    ///
    /// Triangles are clipped, so a reference is as tight as a box can be; others are asked by [`Geometry::overlaps`].
    pub fn parts(&self, reference: &Reference, plane: &AnyPlane) -> [Option<Reference>; 2] {
        let (low, high) = self.reach(reference, plane);
        let at = plane.at();
        if high < at - PADDING {
            return [Some(*reference), None];
        }
        if low > at + PADDING {
            return [None, Some(*reference)];
        }
        let &Reference { prim, part } = reference;
        match self.shapes.triangle(prim) {
            Some(triangle) => {
                let whole = within(triangle.map(|p| self.frame.local(p.as_dvec3())), &part);
                [1.0, -1.0].map(|sign| {
                    let side = whole.cut(|p| sign * (plane.product(p) - at) - PADDING);
                    extent(&side).map(|part| Reference { prim, part })
                })
            }
            // To the world and back a corner moves by less than 2^-7, see [`Frame::new`]; a primitive may be smaller than that.
            None => part.sides(plane, PADDING).map(|part| {
                let world = Cell { min: self.frame.world(part.min - HAIR), max: self.frame.world(part.max + HAIR) };
                let there = part.min.cmple(part.max).all() && self.shapes.overlaps(prim, &world);
                there.then_some(Reference { prim, part })
            }),
        }
    }

    /// Least and greatest product of the part's points with the plane's normal, or somewhat beyond.
    pub fn reach(&self, reference: &Reference, plane: &AnyPlane) -> (f64, f64) {
        let part = &reference.part;
        match plane {
            AnyPlane::Axis(plane) => (part.min[plane.axis as usize], part.max[plane.axis as usize]),
            AnyPlane::Oblique(Oblique { normal, .. }) => {
                let (mut low, mut high) = part.reach(*normal);
                if let Some(triangle) = self.shapes.triangle(reference.prim) {
                    let at = triangle.map(|p| normal.dot(self.frame.local(p.as_dvec3())));
                    low = low.max(at[0].min(at[1]).min(at[2]));
                    high = high.min(at[0].max(at[1]).max(at[2]));
                }
                (low, high)
            }
        }
    }
}

/// A triangle cut by seven planes.
type Part = Polygon<10>;

/// The part of a triangle in a box, or a hair outside: a sliver's part may have a box so thin that rounding would leave nothing
/// in it. 2^-20 is thousands of times the rounding of a corner, 2^-32, and a trifle beside [`PADDING`].
fn within(triangle: [DVec3; 3], cell: &Extent) -> Part {
    const HAIR: f64 = 1.0 / 1_048_576.0;
    let mut part = Part::new(&triangle);
    for axis in 0..3 {
        part = part.cut(|p| p[axis] - cell.max[axis] - HAIR);
        part = part.cut(|p| cell.min[axis] - p[axis] - HAIR);
    }
    part
}

/// The box around a polygon, `None` if nothing is left of it.
fn extent(part: &Part) -> Option<Extent> {
    let around = part.corners().iter().fold(Extent::EMPTY, |e, &p| Extent { min: e.min.min(p), max: e.max.max(p) });
    (!part.corners().is_empty()).then_some(around)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::random::Random;
    use crate::ray::Aabb;
    use glam::Vec3;

    /// Every point of a triangle that is within half the padding of a side is in that side's part, at any depth.
    #[test]
    fn parts_hold_every_point_of_the_triangle_on_their_side() {
        let mut random = Random::new(4);
        let frame = Frame::new(&Aabb { min: Vec3::splat(-1.0), max: Vec3::splat(1.0) });
        let (mut straddling, mut dropped, mut inside) = (0, 0, 0);
        for i in 0..600 {
            let size = [0.1, 0.01, 1e-4, 1e-6][i % 4];
            let place = 0.9 * random.direction();
            let mut corner = || (place + size * random.direction()).as_vec3();
            let mut triangle = [corner(), corner(), corner()];
            if i % 3 == 0 {
                // A sliver, or nothing but a line.
                triangle[2] = triangle[0] + (triangle[1] - triangle[0]) * 0.3;
            }
            let set = vec![triangle];
            let sorter = Sorter { shapes: &Of(&set), frame: &frame };
            let bounds = set.bounds(0);
            let part = Extent { min: frame.local(bounds.min.as_dvec3()), max: frame.local(bounds.max.as_dvec3()) };
            let [a, b, c] = triangle.map(|p| frame.local(p.as_dvec3()));
            let points: Vec<DVec3> = (0..200)
                .map(|_| {
                    let (u, v) = (random.unit(), random.unit());
                    let (u, v) = if u + v > 1.0 { (1.0 - u, 1.0 - v) } else { (u, v) };
                    a + u * (b - a) + v * (c - a)
                })
                .collect();
            let mut level = vec![(Reference { prim: 0, part }, points)];
            for _ in 0..6 {
                let mut next = Vec::new();
                for (reference, points) in level {
                    // Through the part, or nearly.
                    let normal = random.direction();
                    let axis = random.below(6) as u32;
                    let (low, high) = if axis < 3 {
                        reference.part.reach(DVec3::AXES[axis as usize])
                    } else {
                        reference.part.reach(normal)
                    };
                    let at = low + random.within(-0.1, 1.1) * (high - low);
                    let plane = match axis {
                        0..3 => AnyPlane::Axis(AxisPlane { axis, at: at as f32 }),
                        _ => AnyPlane::Oblique(Oblique { normal, at }),
                    };
                    let parts = sorter.parts(&reference, &plane);
                    straddling += u32::from(parts.iter().all(Option::is_some));
                    for (sign, side) in [1.0, -1.0].into_iter().zip(parts) {
                        let near = |p: &DVec3| sign * (plane.product(*p) - plane.at()) <= PADDING / 2.0;
                        let points: Vec<DVec3> = points.iter().copied().filter(near).collect();
                        inside += points.len();
                        let Some(Reference { part: Extent { min, max }, .. }) = side else {
                            assert!(points.is_empty(), "{triangle:?}: {plane:?}");
                            dropped += 1;
                            continue;
                        };
                        for p in &points {
                            // The rounding of these points and of the corners.
                            let off = (min - *p).max(*p - max).max_element();
                            assert!(off < 1e-8, "{triangle:?}: {p} off by {off}: {plane:?}");
                        }
                        next.extend(side.map(|side| (side, points)));
                    }
                }
                level = next;
            }
        }
        assert!(straddling > 1000 && dropped > 1000 && inside > 100_000, "{straddling} {dropped} {inside}");
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
        let sides = |x: f64| sorter.parts(&Reference { prim: 0, part }, &plane(x)).map(|side| side.is_some());
        assert_eq!(sides(1.0), [true, false]);
        assert_eq!(sides(0.5), [true, true]);
        assert_eq!(sides(-0.1), [false, true]);
    }
}
