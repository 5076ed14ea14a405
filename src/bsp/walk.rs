//! The partitioning walk: one loop for the three listings.
//!
//! J. Arvo, "Linear-time voxel walking for octrees", Ray Tracing News 1988: a subtree is entered with the part of the ray
//! that lies in its cell; a plane that parts this interval sends the first part to the child that comes first along the
//! ray and keeps the rest on a stack for the other. Every node is visited at most once, and in a regular tree nodes are few
//! for each leaf, so that a ray through N leaves an axis takes O(N) and not O(N log N). Departures from the print, each
//! because of what it would otherwise get wrong:
//!
//! - The child that comes first follows from the sense of the direction, not from the side on which the origin lies. That
//!   side says nothing if the origin is on the plane: the printed listings then search only one child, the one behind for
//!   one of the two senses, and lose all hits. Nor does it matter where the plane is from the origin: the order of the
//!   children along the line is the same for negative parameters.
//! - A plane at or before the interval's begin leaves the far child alone, one at or beyond its end the near child alone;
//!   "alone" is right at equality, for all that lies within rounding of a plane is in the lists of both sides.
//! - Along an axis of no movement the crossing is infinitely far on the side that is not met; in the plane itself it is a
//!   NaN, which counts as beyond the end. The print compares with it.
//! - A hit is never thrown away for lying beyond its leaf: one at the leaf's exit may be rounded beyond it and need not be
//!   in the next list. The winner is the ray's; it is accepted when an interval starts at or beyond it.
//!
//! Why this finds every hit: the intervals of the leaves visited cover the whole clipped ray. A point at parameter t is
//! within the walk's error ([`Line::start`]) of the cell of every node whose interval holds t: the root's is the cube, and
//! if t is in the interval of the child that lies before a crossing, the point is before the plane or off it by no more
//! than the crossing is. Lists are made for cells padded by more than that.

use super::frame::{Line, STACK};
use super::tree::{Look, Plane, Tree};
use std::marker::PhantomData;

/// What is done along a walk.
pub trait Visit<L> {
    /// A node is entered, inner or leaf.
    fn node(&mut self);

    /// A leaf, or NIL, is reached. Gives the parameter beyond which nothing is of interest: the winner's.
    fn leaf(&mut self, leaf: Option<L>) -> f64;
}

/// A way through a tree along a ray.
pub trait Walk: Send + Sync + 'static {
    /// True if only trees will do that halve x, y and z in turn.
    const REGULAR_ONLY: bool;

    /// Visits the leaves that the line meets in their order along it.
    fn walk<T: Tree, V: Visit<T::Leaf>>(tree: &T, line: &Line, visit: &mut V);
}

/// Which children an interval meets.
pub enum Cut<L> {
    /// The first one alone.
    Near,
    /// The second one alone.
    Far,
    /// Both: the second one later.
    Both(L),
}

/// The state of a partitioning walk: which part of the ray lies in the present cell, in the form of one of the listings.
pub trait Listing: Copy + Send + Sync + 'static {
    /// See [`Walk::REGULAR_ONLY`].
    const REGULAR_ONLY: bool;

    /// What is kept of a state while its subtree waits.
    type Later: Copy + Default;

    /// The clipped ray in the root.
    fn new(line: &Line) -> Self;

    /// Goes to a child's part: which child comes first along the line, and which of them are met.
    fn cut<P: Plane>(&mut self, line: &Line, plane: &P) -> (usize, Cut<Self::Later>);

    /// Takes up what was put off, as far as the parameter `end`; false if it starts there or beyond.
    fn resume(&mut self, line: &Line, later: &Self::Later, end: f64) -> bool;
}

/// The partitioning walk with the listing `L`.
#[derive(Clone, Copy, Debug)]
pub struct Partition<L>(PhantomData<L>);

impl<L: Listing> Walk for Partition<L> {
    const REGULAR_ONLY: bool = L::REGULAR_ONLY;

    #[inline(always)]
    fn walk<T: Tree, V: Visit<T::Leaf>>(tree: &T, line: &Line, visit: &mut V) {
        let mut node = tree.root();
        let mut state = L::new(line);
        let mut nodes = [node; STACK];
        let mut later = [L::Later::default(); STACK];
        let mut waiting = 0;
        loop {
            let leaf = loop {
                if tree.is_nil(node) {
                    break None;
                }
                visit.node();
                match tree.look(node) {
                    Look::Leaf(leaf) => break Some(leaf),
                    Look::Inner(plane, children) => {
                        let (first, cut) = state.cut(line, &plane);
                        node = match cut {
                            Cut::Near => children[first & 1],
                            Cut::Far => children[first & 1 ^ 1],
                            Cut::Both(rest) => {
                                // No deeper than the tree, which is no deeper than the stack.
                                nodes[waiting % STACK] = children[first & 1 ^ 1];
                                later[waiting % STACK] = rest;
                                waiting += 1;
                                children[first & 1]
                            }
                        };
                    }
                }
            };
            let end = visit.leaf(leaf);
            if waiting == 0 {
                return;
            }
            waiting -= 1;
            node = nodes[waiting % STACK];
            if !state.resume(line, &later[waiting % STACK], end) {
                return;
            }
        }
    }
}
