//! The BVHs of the crate obvhs 0.4: `Bvh2` and the eight-wide compressed `CwBvh` (Ylitie et al. 2017).
//!
//! obvhs decides boxes only; in the leaves runs the same exact test as everywhere. Its f32 box test is made safe from
//! outside, so that it cannot lose what the exact test would find:
//!
//! - **Frame.** Boxes and rays are handed over in a frame whose centre is the scene's and whose scale is a power of two, so
//!   that coordinates lie in -0.5..=0.5 whatever the scene's size (obvhs loses all of a scene at 1e-12 and panics at 1e20).
//! - **Rays** that start near the scene are scaled by powers of two and run up a bit, since `CwBvh` drops boxes that end before
//!   its own epsilon; all others start where they enter the scene's box, found in f64. The largest component of a direction is
//!   1 to 2, and negative zeros are gone.
//! - **Padding.** With coordinates of boxes below 0.75, of origins at most 2, and u = 2^-24, the ray handed over is off by at
//!   most 8u, the f32 box test and the quantised boxes by some 30u, and the clamp of inverse directions at 2^23 by 6u: together
//!   below 2^-18. Boxes are padded by 2^-17, and the best parameter handed back is raised by as much.
//! - Primitives that no ray can hit, which make obvhs panic when they are not finite, are not handed over, nor are copies of
//!   others, on which its builder takes minutes.
//! - A ray that starts so far away that f64 cannot find the entry to within 2^-22 is tested against every primitive.

use crate::accel::{Accel, Candidates, Hit, LeftOut, Memory, Probe, queries_with_probe, scan_all, scan_any};
use crate::geometry::{Best, Geometry};
use crate::ray::{Aabb, Ray, greater, lesser};
use glam::{DVec3, Vec3, Vec3A};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2;
use obvhs::bvh2::reinsertion::ReinsertionOptimizer;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::bvh2_to_cwbvh::bvh2_to_cwbvh;
use obvhs::ploc::PlocBuilder;
use obvhs::ray::RayHit;
use std::time::Duration;

/// Boxes reach this far beyond their primitives, in units of the frame.
const PADDING: f64 = 1.0 / 131_072.0;

/// Rays start this far before their first point, in units of the frame: more than the 1e-4 before which `CwBvh` takes a box
/// to be behind the ray, and not much more, since every box in between is a box too many.
const RUN_UP: f64 = 1.0 / 8192.0;

/// obvhs' own settings, from the fastest build to the fastest traversal.
///
/// `slow` and `very_slow` would also split large triangles, which obvhs does only for its own triangles: here they differ in
/// search and reinsertion alone.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Preset {
    /// `BvhBuildParams::fastest_build`
    Fastest,
    /// `BvhBuildParams::very_fast_build`
    VeryFast,
    /// `BvhBuildParams::fast_build`
    Fast,
    /// `BvhBuildParams::medium_build`
    #[default]
    Medium,
    /// `BvhBuildParams::slow_build`
    Slow,
    /// `BvhBuildParams::very_slow_build`
    VerySlow,
}

impl Preset {
    /// Names as in specifications, in the order of the variants.
    pub const NAMES: [(&'static str, Preset); 6] = [
        ("fastest", Preset::Fastest),
        ("very_fast", Preset::VeryFast),
        ("fast", Preset::Fast),
        ("medium", Preset::Medium),
        ("slow", Preset::Slow),
        ("very_slow", Preset::VerySlow),
    ];

    pub(super) fn params(self) -> BvhBuildParams {
        match self {
            Preset::Fastest => BvhBuildParams::fastest_build(),
            Preset::VeryFast => BvhBuildParams::very_fast_build(),
            Preset::Fast => BvhBuildParams::fast_build(),
            Preset::Medium => BvhBuildParams::medium_build(),
            Preset::Slow => BvhBuildParams::slow_build(),
            Preset::VerySlow => BvhBuildParams::very_slow_build(),
        }
    }
}

/// One of obvhs' two trees, as far as this adapter needs it.
trait Tree: Send + Sync + Sized {
    fn build(boxes: &[obvhs::aabb::Aabb], params: BvhBuildParams) -> Self;
    /// Calls `leaf` with the position in the leaf order of each candidate; it returns the new end of the ray or `inf`.
    fn closest(&self, ray: obvhs::ray::Ray, leaf: impl FnMut(usize) -> f32);
    /// As `closest`, and ends when `leaf` returns something before the end of the ray; true if it did.
    fn any(&self, ray: obvhs::ray::Ray, leaf: impl FnMut(usize) -> f32) -> bool;
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
enum Wide {
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

/// Builds obvhs' two-wide BVH over `geometry`.
pub fn bvh2<'a, G: Geometry + 'a>(geometry: G, preset: Preset) -> impl Accel + 'a {
    Bvh::<G, Bvh2>::build(geometry, preset)
}

/// Builds obvhs' eight-wide compressed BVH over `geometry`.
pub fn cwbvh<'a, G: Geometry + 'a>(geometry: G, preset: Preset) -> impl Accel + 'a {
    Bvh::<G, Wide>::build(geometry, preset)
}

/// A tree over the primitives that can be hit.
struct Bvh<G, T> {
    geometry: G,
    /// `None` if no primitive can be hit.
    tree: Option<T>,
    /// Primitive of each position in the tree's leaf order.
    prims: Vec<u32>,
    frame: Frame,
    bounds: Aabb,
    left_out: LeftOut,
    preset: Preset,
}

/// World to frame: `(world - centre) * scale`, with a power of two as scale.
struct Frame {
    centre: Vec3,
    scale: f64,
    /// The scale where f32 can hold it and what is scaled with it.
    near_scale: Option<f32>,
    /// Half the edge lengths of the scene's padded box.
    half: DVec3,
}

impl Frame {
    fn new(bounds: &Aabb) -> Self {
        if bounds.is_empty() {
            return Self { centre: Vec3::ZERO, scale: 1.0, near_scale: None, half: DVec3::ZERO };
        }
        let (min, max) = (bounds.min.as_dvec3(), bounds.max.as_dvec3());
        // A point has no extent: any scale below the least distance of f32 will do.
        let extent = (max - min).max_element().max(1e-60);
        // The largest extent becomes 0.5..1.
        let scale = 2.0_f64.powi(-(extent.log2().floor() as i32) - 1);
        let near_scale = (1e-30..1e30).contains(&scale).then_some(scale as f32);
        let centre = ((min + max) * 0.5).as_vec3();
        let half = (max - centre.as_dvec3()).max(centre.as_dvec3() - min) * scale + PADDING;
        Self { centre, scale, near_scale, half }
    }

    fn to_local(&self, world: DVec3) -> DVec3 {
        (world - self.centre.as_dvec3()) * self.scale
    }

    fn local_box(&self, aabb: &Aabb) -> obvhs::aabb::Aabb {
        let (min, max) = (self.to_local(aabb.min.as_dvec3()) - PADDING, self.to_local(aabb.max.as_dvec3()) + PADDING);
        obvhs::aabb::Aabb { min: min.as_vec3a(), max: max.as_vec3a() }
    }

    /// The ray in the frame, or why it has none.
    #[inline]
    fn local_ray(&self, ray: &Ray) -> Entry {
        self.near_ray(ray).unwrap_or_else(|| self.far_ray(ray))
    }

    /// The ray as it is, in f32 and by powers of two alone, if it starts within two units of the centre: subtracting the
    /// centre and running up then round the origin by less than 6u, and nothing else is rounded.
    #[inline]
    fn near_ray(&self, ray: &Ray) -> Option<Entry> {
        let scale = self.near_scale?;
        let origin = (ray.origin - self.centre) * scale;
        let exponent = ray.direction.abs().max_element().to_bits() >> 23;
        // Not so for a NaN; the exponents keep the scaled direction and its scale within the normal numbers.
        if !(origin.abs().max_element() <= 2.0 && ray.t_min >= 0.0 && (1..=252).contains(&exponent)) {
            return None;
        }
        // The largest component becomes 1..2.
        let direction = ray.direction * f32::from_bits((254 - exponent) << 23);
        let speed = f64::from(f32::from_bits(exponent << 23)) * self.scale;
        let local = obvhs::ray::Ray::new(
            vec3a(origin - direction * RUN_UP as f32),
            vec3a(direction),
            0.0,
            raised(f64::from(ray.t_max) * speed + RUN_UP),
        );
        Some(Entry::Inside { local, speed, offset: RUN_UP })
    }

    /// The ray from where it enters the scene's box, found in f64.
    #[cold]
    fn far_ray(&self, ray: &Ray) -> Entry {
        let origin = self.to_local(ray.origin.as_dvec3());
        // 2^-52 |o| is the rounding of the entry point.
        if origin.abs().max_element() > f64::from(1 << 30) {
            return Entry::TooFar;
        }
        let direction = ray.direction.as_dvec3() * self.scale;
        let range = (f64::from(ray.t_min), f64::from(ray.t_max));
        let Some((enter, leave)) = clip(origin, direction.recip(), (-self.half, self.half), range) else {
            return Entry::Miss;
        };
        let speed = direction.abs().max_element();
        let pace = 1.0 / speed;
        let start = enter - RUN_UP * pace;
        let local = obvhs::ray::Ray::new(
            (origin + start * direction).as_vec3a(),
            vec3a((direction * pace).as_vec3()),
            0.0,
            raised((leave - start) * speed),
        );
        Entry::Inside { local, speed, offset: -start * speed }
    }
}

/// Four lanes, with +0.0 for -0.0, which obvhs' tests do not treat alike.
#[inline]
fn vec3a(v: Vec3) -> Vec3A {
    Vec3A::from(v) + Vec3A::ZERO
}

/// A parameter of the frame, raised by more than all errors of the box test.
#[inline]
fn raised(t: f64) -> f32 {
    (t + PADDING) as f32
}

/// How a ray meets the scene's box.
enum Entry {
    Miss,
    TooFar,
    /// The parameter `t` of the ray is `t * speed + offset` in the frame.
    Inside {
        local: obvhs::ray::Ray,
        speed: f64,
        offset: f64,
    },
}

impl<G: Geometry, T: Tree> Bvh<G, T> {
    fn build(geometry: G, preset: Preset) -> Self {
        let Candidates { prims: kept, bounds, left_out } = Candidates::of(&geometry);
        let frame = Frame::new(&bounds);
        let boxes: Vec<_> = kept.iter().map(|&prim| frame.local_box(&geometry.bounds(prim))).collect();
        let tree = (!boxes.is_empty()).then(|| T::build(&boxes, preset.params()));
        let prims = tree.iter().flat_map(|t| t.order()).map(|&i| kept[i as usize]).collect();
        Self { geometry, tree, prims, frame, bounds, left_out, preset }
    }

    #[inline]
    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let (ray, tree) = (ray.intake()?, self.tree.as_ref()?);
        let best = match self.frame.local_ray(&ray) {
            Entry::Miss => return None,
            Entry::TooFar => scan_all(&self.geometry, &ray, probe),
            Entry::Inside { local, speed, offset } => {
                let prep = self.geometry.prepare(&ray);
                let mut best = Best::NONE;
                tree.closest(local, |id| {
                    probe.test();
                    let before = best.prim();
                    self.geometry.test(self.prims[id], &ray, &prep, &mut best);
                    if best.prim() == before { f32::INFINITY } else { raised(best.upper() * speed + offset) }
                });
                best
            }
        };
        best.prim().map(|prim| Hit { t: self.geometry.round(&ray, &best), prim })
    }

    #[inline]
    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        let (Some(ray), Some(tree)) = (ray.intake(), self.tree.as_ref()) else { return false };
        match self.frame.local_ray(&ray) {
            Entry::Miss => false,
            Entry::TooFar => scan_any(&self.geometry, &ray, probe),
            Entry::Inside { local, .. } => {
                let prep = self.geometry.prepare(&ray);
                let mut best = Best::NONE;
                tree.any(local, |id| {
                    probe.test();
                    self.geometry.test(self.prims[id], &ray, &prep, &mut best);
                    if best.is_hit() { 0.0 } else { f32::INFINITY }
                })
            }
        }
    }
}

impl<G: Geometry, T: Tree> Accel for Bvh<G, T> {
    queries_with_probe!(closest, any);

    fn bounds(&self) -> Aabb {
        self.bounds
    }

    fn memory(&self) -> Memory {
        let tree = self.tree.as_ref();
        Memory {
            structure: tree.map_or(0, |t| t.node_bytes() as u64),
            // obvhs' own order is kept beside ours.
            references: 4 * (self.prims.len() + tree.map_or(0, |t| t.order().len())) as u64,
            tables: 0,
        }
    }

    fn describe(&self) -> String {
        let preset = Preset::NAMES.iter().find(|(_, p)| *p == self.preset).map_or("", |(name, _)| name);
        let note = self.tree.as_ref().map_or("", Tree::note);
        format!("preset {preset}, nodes visited are not counted{note}{}", self.left_out)
    }
}

/// The part of `t_min..=t_max` over which `origin + t * direction` lies between the planes of a box, or `None`.
///
/// `inverse` is 1 over each component of the direction. A component that is zero, the inverse infinite, is a test of the
/// origin, never a product with infinity. The result is right up to a few roundings of f64, so callers pad their boxes. The
/// direction is not zero and the box is bounded, so the result is finite.
#[inline(always)]
fn clip(origin: DVec3, inverse: DVec3, (min, max): (DVec3, DVec3), (t_min, t_max): (f64, f64)) -> Option<(f64, f64)> {
    let (mut enter, mut leave) = (t_min, t_max);
    let (a, b) = ((min - origin) * inverse, (max - origin) * inverse);
    for axis in 0..3 {
        if inverse[axis].is_finite() {
            enter = greater(enter, lesser(a[axis], b[axis]));
            leave = lesser(leave, greater(a[axis], b[axis]));
        } else if origin[axis] < min[axis] || origin[axis] > max[axis] {
            return None;
        }
    }
    (enter <= leave).then_some((enter, leave))
}
