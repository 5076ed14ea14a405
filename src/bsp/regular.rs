//! The complete regular tree, which takes no memory: what the nodes and leaves of a ray are counted in.

use super::frame::{Frame, LEVELS, Line, SIZE, Start};
use super::interval::Interval;
use super::midpoint::Midpoint;
use super::relocate::{Climb, Retraverse};
use super::segment::Segment;
use super::tree::{AxisPlane, Look, Tree};
use super::walk::{Partition, Visit, Walk};
use crate::error::{Error, Result};
use crate::ray::Ray;
use glam::DVec3;

/// The unit cube, each axis halved a number of times, x, y and z in turn; every leaf is there.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Regular {
    levels: u32,
}

/// A way through a tree.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Form {
    /// Partitioning, Arvo's first listing: the point moves.
    Segment,
    /// Partitioning, his second listing: the interval is parted.
    Interval,
    /// Partitioning, Jansen's form: six crossings are halved.
    Midpoint,
    /// Every leaf from the root.
    Retraverse,
    /// Every leaf from the nearest common ancestor.
    Climb,
}

impl Form {
    /// All of them, with their names.
    pub const ALL: [(&'static str, Form); 5] = [
        ("segment", Form::Segment),
        ("interval", Form::Interval),
        ("midpoint", Form::Midpoint),
        ("retraverse", Form::Retraverse),
        ("climb", Form::Climb),
    ];
}

/// What a walk meets.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Met {
    /// A node, inner or leaf.
    Node,
    /// A leaf, by its place on each axis; it was met as a node before.
    Leaf([u32; 3]),
}

impl Regular {
    /// Most leaves along an axis.
    pub const MOST: u32 = 1 << LEVELS;

    /// The tree with `n` leaves along each axis.
    ///
    /// # Errors
    /// `n` is not a power of two within 1 to [`Regular::MOST`].
    pub fn new(n: u32) -> Result<Self> {
        if !n.is_power_of_two() || n > Self::MOST {
            let most = Self::MOST;
            return Err(Error::invalid(format!("{n} leaves an axis are no power of two within 1 to {most}")));
        }
        Ok(Self { levels: n.ilog2() })
    }

    /// Walks along `ray`, which is in the coordinates of the unit cube, and calls `visit` for all that is met, in order, until a
    /// leaf for which it gives false; what it gives for nodes does not matter. False if the ray starts too far away, some 10^15
    /// cubes, to be walked; a ray that hits nothing by definition meets nothing.
    pub fn walk(&self, ray: &Ray, form: Form, visit: &mut impl FnMut(Met) -> bool) -> bool {
        let frame = Frame { lo: DVec3::ZERO, inverse: SIZE, filled: DVec3::splat(SIZE) };
        let Some(ray) = ray.intake() else { return true };
        let line = match Line::start(&frame, &ray) {
            Start::Miss => return true,
            Start::TooFar => return false,
            Start::Inside(line) => line,
        };
        let visit = &mut Told(visit);
        match form {
            Form::Segment => Partition::<Segment>::walk(self, &line, visit),
            Form::Interval => Partition::<Interval>::walk(self, &line, visit),
            Form::Midpoint => Partition::<Midpoint>::walk(self, &line, visit),
            Form::Retraverse => Retraverse::walk(self, &line, visit),
            Form::Climb => Climb::walk(self, &line, visit),
        }
        true
    }
}

struct Told<'a, F>(&'a mut F);

impl<F: FnMut(Met) -> bool> Visit<[u32; 3]> for Told<'_, F> {
    #[inline(always)]
    fn node(&mut self) {
        (self.0)(Met::Node);
    }

    #[inline(always)]
    fn leaf(&mut self, leaf: Option<[u32; 3]>) -> f64 {
        let go_on = leaf.is_none_or(|leaf| (self.0)(Met::Leaf(leaf)));
        if go_on { f64::INFINITY } else { f64::NEG_INFINITY }
    }
}

/// A cell: its least corner on the lattice and the halvings that lead to it.
#[derive(Clone, Copy, Debug)]
pub struct Place {
    corner: [u32; 3],
    depth: u32,
}

impl Tree for Regular {
    type Node = Place;
    type Plane = AxisPlane;
    type Leaf = [u32; 3];

    fn root(&self) -> Place {
        Place { corner: [0; 3], depth: 0 }
    }

    #[inline(always)]
    fn is_nil(&self, _: Place) -> bool {
        false
    }

    #[inline(always)]
    fn look(&self, Place { corner, depth }: Place) -> Look<Self> {
        let level = depth / 3;
        if level == self.levels {
            return Look::Leaf(corner.map(|x| x >> (LEVELS - self.levels)));
        }
        let axis = depth % 3;
        let low = Place { corner, depth: depth + 1 };
        let mut high = low;
        high.corner[axis as usize] += 1 << (LEVELS - 1 - level);
        // Whole numbers up to 2^20 are exact.
        Look::Inner(AxisPlane { axis, at: high.corner[axis as usize] as f32 }, [low, high])
    }
}
