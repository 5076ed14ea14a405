//! What walks need to know of a tree: its subtrees, its leaves, and the planes that part its cells.

use super::frame::Line;
use glam::DVec3;

/// A binary space partition.
pub trait Tree {
    /// Where a subtree hangs; may be NIL, the empty subtree.
    type Node: Copy;
    /// What parts a cell in two.
    type Plane: Plane;
    /// What a leaf holds.
    type Leaf;

    /// The whole.
    fn root(&self) -> Self::Node;

    /// True for the empty subtree: there is nothing to look at.
    fn is_nil(&self, node: Self::Node) -> bool;

    /// A subtree that is not NIL.
    fn look(&self, node: Self::Node) -> Look<Self>;
}

/// What there is at a node.
pub enum Look<T: Tree + ?Sized> {
    /// A plane, the subtree on its low side and that on its high side.
    Inner(T::Plane, [T::Node; 2]),
    /// A list.
    Leaf(T::Leaf),
}

/// A plane in the tree's coordinates.
pub trait Plane: Copy {
    /// The child that lies first along the line, and the parameter at which the line, moved to pass through `point` at
    /// parameter 0, crosses the plane.
    ///
    /// The first child follows from the direction alone: 0, the low side, where the line rises to the plane or runs along
    /// it. In the latter case the parameter is plus infinity if `point` is on the low side, minus infinity if it is on the
    /// high side, NaN if it is on the plane.
    fn cross(&self, line: &Line, point: &[f64; 4]) -> (usize, f64);
}

/// A plane across an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisPlane {
    pub(super) axis: u32,
    pub(super) at: f32,
}

impl Plane for AxisPlane {
    #[inline(always)]
    fn cross(&self, line: &Line, point: &[f64; 4]) -> (usize, f64) {
        let axis = self.axis as usize & 3;
        // 0 * inf is a NaN where the line lies in the plane.
        (line.backward[axis], (f64::from(self.at) - point[axis]) * line.inverse[axis])
    }
}

/// A plane of any direction: its points have the product `at` with `normal`, which has unit length.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Oblique {
    pub normal: DVec3,
    pub at: f64,
}

/// A plane across an axis or of any direction.
///
/// Arvo 1988: only the distance to the plane is computed otherwise, (c - n . o) / (n . d).
///
/// Error: n . o and c are off by 10u(|o| + n) together; n . d is off by 7u of the direction's largest component, which
/// moves the line by 7u(|o| + n) along the normal within the box, whatever sign n . d seems to have.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum AnyPlane {
    /// Across an axis.
    Axis(AxisPlane),
    /// Of any other direction.
    Oblique(Oblique),
}

impl AnyPlane {
    /// A point's product with the normal.
    #[inline]
    pub(super) fn product(&self, p: DVec3) -> f64 {
        match self {
            AnyPlane::Axis(plane) => p[plane.axis as usize],
            AnyPlane::Oblique(plane) => plane.normal.dot(p),
        }
    }

    /// The product of the plane's own points.
    pub(super) fn at(&self) -> f64 {
        match self {
            AnyPlane::Axis(plane) => f64::from(plane.at),
            AnyPlane::Oblique(plane) => plane.at,
        }
    }
}

impl Plane for AnyPlane {
    #[inline(always)]
    fn cross(&self, line: &Line, point: &[f64; 4]) -> (usize, f64) {
        match self {
            AnyPlane::Axis(plane) => plane.cross(line, point),
            AnyPlane::Oblique(Oblique { normal, at }) => {
                let dot = |v: &[f64; 4]| normal.x * v[0] + normal.y * v[1] + normal.z * v[2];
                // + 0.0: the sign of a zero would turn the infinities round.
                let along = dot(&line.direction) + 0.0;
                (usize::from(along < 0.0), (at - dot(point)) / along)
            }
        }
    }
}
