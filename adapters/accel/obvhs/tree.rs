//! obvhs' two trees behind one interface, and what keeps the wide one within its stack.

use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::PlocBuilder;
use obvhs::ray::RayHit;
use std::time::Duration;

/// One of obvhs' two trees, as far as this adapter needs it.
pub(super) trait Tree: Send + Sync + Sized {
    /// Builds the tree over boxes of the frame, at least one.
    fn build(boxes: &[obvhs::aabb::Aabb], params: BvhBuildParams) -> Self;
    /// Calls `leaf` with the position in the leaf order of each candidate; it returns the new end of the ray or `inf`.
    fn closest(&self, ray: obvhs::ray::Ray, leaf: impl FnMut(usize) -> f32);
    /// As `closest`, and ends when `leaf` returns something before the end of the ray; true if it did.
    fn any(&self, ray: obvhs::ray::Ray, leaf: impl FnMut(usize) -> f32) -> bool;
    /// The box of each position in the leaf order.
    fn order(&self) -> &[u32];
    fn node_bytes(&self) -> usize;
    /// What is unusual about it, to follow a description.
    fn note(&self) -> &'static str {
        ""
    }
}

impl Tree for Bvh2 {
    fn build(boxes: &[obvhs::aabb::Aabb], params: BvhBuildParams) -> Self {
        let mut tree = build_bvh2(boxes, params, &mut Duration::default());
        // obvhs sizes its stack before reinsertion, which may add levels.
        tree.max_depth = tree.max_depth.max(tree.depth(0) + 1);
        tree
    }
    #[inline]
    fn closest(&self, ray: obvhs::ray::Ray, mut leaf: impl FnMut(usize) -> f32) {
        self.ray_traverse(ray, &mut RayHit::none(), |_, id| leaf(id));
    }
    #[inline]
    fn any(&self, ray: obvhs::ray::Ray, mut leaf: impl FnMut(usize) -> f32) -> bool {
        !self.ray_traverse_miss(ray, |_, id| leaf(id))
    }
    fn order(&self) -> &[u32] {
        &self.primitive_indices
    }
    fn node_bytes(&self) -> usize {
        size_of_val(self.nodes.as_slice())
    }
}

/// An eight-wide tree, if obvhs can walk it.
///
/// `CwBvh` is walked with a stack of 32 levels; a deeper tree, such as one over sizes from 1 to 10^8, silently loses hits
/// (and panics where debug assertions are on). That one stays two-wide: [`Bvh2`]'s stack grows.
pub(super) enum Wide {
    Compressed(CwBvh),
    Deep(Bvh2),
}

/// The levels that obvhs asks of a `CwBvh` in debug builds.
const MOST_LEVELS: u32 = 32;

/// Levels of nodes below the root.
fn depth(tree: &CwBvh) -> u32 {
    let mut deepest = 0;
    let mut open: Vec<(usize, u32)> = if tree.nodes.is_empty() { Vec::new() } else { vec![(0, 0)] };
    while let Some((index, level)) = open.pop() {
        deepest = deepest.max(level);
        let node = &tree.nodes[index];
        let inner = (0..8).filter(|&child| !node.is_child_empty(child) && !node.is_leaf(child));
        open.extend(inner.map(|child| (node.child_node_index(child) as usize, level + 1)));
    }
    deepest
}

impl Tree for Wide {
    /// obvhs' `build_cwbvh`, step by step, without the validation that panics in debug builds.
    fn build(boxes: &[obvhs::aabb::Aabb], params: BvhBuildParams) -> Self {
        let (precision, threshold) = (params.sort_precision, params.search_depth_threshold);
        let all = (0..boxes.len() as u32).collect();
        let mut ploc = PlocBuilder::with_capacity(boxes.len());
        let mut narrow = ploc.build(params.ploc_search_distance, boxes, all, precision, threshold);
        ReinsertionOptimizer::default().run(&mut narrow, params.reinsertion_batch_ratio, None);
        let tree = bvh2_to_cwbvh(&narrow, params.max_prims_per_leaf.clamp(1, 3), true, false);
        if depth(&tree) < MOST_LEVELS { Self::Compressed(tree) } else { Self::Deep(Tree::build(boxes, params)) }
    }
    #[inline]
    fn closest(&self, ray: obvhs::ray::Ray, mut leaf: impl FnMut(usize) -> f32) {
        match self {
            Self::Compressed(tree) => {
                tree.ray_traverse(ray, &mut RayHit::none(), |_, id| leaf(id));
            }
            Self::Deep(tree) => Tree::closest(tree, ray, leaf),
        }
    }
    #[inline]
    fn any(&self, ray: obvhs::ray::Ray, mut leaf: impl FnMut(usize) -> f32) -> bool {
        match self {
            Self::Compressed(tree) => !tree.ray_traverse_miss(ray, |_, id| leaf(id)),
            Self::Deep(tree) => Tree::any(tree, ray, leaf),
        }
    }
    fn order(&self) -> &[u32] {
        match self {
            Self::Compressed(tree) => &tree.primitive_indices,
            Self::Deep(tree) => tree.order(),
        }
    }
    fn node_bytes(&self) -> usize {
        match self {
            Self::Compressed(tree) => size_of_val(tree.nodes.as_slice()),
            Self::Deep(tree) => tree.node_bytes(),
        }
    }
    fn note(&self) -> &'static str {
        match self {
            Self::Compressed(_) => "",
            Self::Deep(_) => ", too deep for obvhs' stack of 32 levels and left two-wide",
        }
    }
}
