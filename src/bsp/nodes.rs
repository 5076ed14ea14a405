//! Trees kept in memory: nodes, the lists of the leaves, planes that lie across no axis.

use super::tree::{AnyPlane, AxisPlane, Look, Oblique, Plane, Tree};
use std::marker::PhantomData;

/// Index of the empty subtree.
pub const NIL: u32 = u32::MAX;

/// `Node::kind` of a leaf; lesser ones are axes, greater ones number oblique planes from here on.
const LEAF: u32 = 3;

/// A plane with two subtrees, or a leaf; 16 bytes.
#[derive(Clone, Copy, Debug)]
pub struct Node {
    kind: u32,
    /// Where a plane across an axis lies.
    at: f32,
    /// Low and high subtree; of a leaf where its list begins and ends.
    links: [u32; 2],
}

/// A tree of which every subtree is in one array.
#[derive(Clone, Debug, Default)]
pub struct Nodes {
    pub all: Vec<Node>,
    /// The lists of all leaves.
    pub prims: Vec<u32>,
    pub oblique: Vec<Oblique>,
}

impl Node {
    /// The leaf of `prims[from..to]`.
    pub fn leaf(from: u32, to: u32) -> Self {
        Self { kind: LEAF, at: 0.0, links: [from, to] }
    }

    /// `plane` with the subtrees on its low and its high side.
    pub fn inner(plane: &AnyPlane, links: [u32; 2], oblique: &mut Vec<Oblique>) -> Self {
        match *plane {
            AnyPlane::Axis(AxisPlane { axis, at }) => Self { kind: axis, at, links },
            AnyPlane::Oblique(plane) => {
                oblique.push(plane);
                // Less than the number of nodes, which is checked.
                Self { kind: LEAF + oblique.len() as u32, at: 0.0, links }
            }
        }
    }
}

/// What a tree is like.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Shape {
    pub inner: u64,
    pub leaves: u64,
    /// Empty subtrees.
    pub nil: u64,
    pub depth: u32,
}

impl Nodes {
    /// Index of the root.
    pub fn root(&self) -> u32 {
        if self.all.is_empty() { NIL } else { 0 }
    }

    /// Counts everything. Children lie behind their parents.
    pub fn shape(&self) -> Shape {
        let mut shape = Shape::default();
        let mut depth = vec![0_u32; self.all.len()];
        for (i, node) in self.all.iter().enumerate() {
            shape.depth = shape.depth.max(depth[i]);
            if node.kind == LEAF {
                shape.leaves += 1;
                continue;
            }
            shape.inner += 1;
            let below = depth[i] + 1;
            for link in node.links {
                match depth.get_mut(link as usize) {
                    Some(child) => *child = below,
                    None => shape.nil += 1,
                }
            }
        }
        shape
    }

    /// Bytes of nodes and planes.
    pub fn bytes(&self) -> u64 {
        (size_of_val(&self.all[..]) + size_of_val(&self.oblique[..])) as u64
    }
}

/// How a node's plane is read: trees with planes across axes alone do not ask for others.
pub trait Planes: Plane + Send + Sync + 'static {
    fn of(node: &Node, oblique: &[Oblique]) -> Self;
}

impl Planes for AxisPlane {
    #[inline(always)]
    fn of(node: &Node, _: &[Oblique]) -> Self {
        AxisPlane { axis: node.kind, at: node.at }
    }
}

impl Planes for AnyPlane {
    #[inline(always)]
    fn of(node: &Node, oblique: &[Oblique]) -> Self {
        if node.kind < LEAF {
            AnyPlane::Axis(AxisPlane { axis: node.kind, at: node.at })
        } else {
            AnyPlane::Oblique(oblique[(node.kind - LEAF - 1) as usize])
        }
    }
}

/// [`Nodes`] with planes `P`, as walks see them.
pub struct Kept<'a, P> {
    nodes: &'a Nodes,
    planes: PhantomData<P>,
}

impl<'a, P> Kept<'a, P> {
    pub fn new(nodes: &'a Nodes) -> Self {
        Self { nodes, planes: PhantomData }
    }
}

impl<'a, P: Planes> Tree for Kept<'a, P> {
    type Node = u32;
    type Plane = P;
    type Leaf = &'a [u32];

    #[inline(always)]
    fn root(&self) -> u32 {
        self.nodes.root()
    }

    #[inline(always)]
    fn is_nil(&self, node: u32) -> bool {
        node == NIL
    }

    #[inline(always)]
    fn look(&self, node: u32) -> Look<Self> {
        let nodes: &'a Nodes = self.nodes;
        let node = &nodes.all[node as usize];
        if node.kind == LEAF {
            Look::Leaf(&nodes.prims[node.links[0] as usize..node.links[1] as usize])
        } else {
            Look::Inner(P::of(node, &nodes.oblique), node.links)
        }
    }
}
