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

mod frame;
mod tree;

use crate::accel::{Accel, Candidates, Hit, LeftOut, Memory, Probe, queries_with_probe, scan_all, scan_any};
use crate::geometry::{Best, Geometry};
use crate::ray::{Aabb, Ray};
use frame::{Entry, Frame, raised};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use tree::{Tree, Wide};

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

    /// Its name in specifications.
    pub fn name(self) -> &'static str {
        Self::NAMES[self as usize].0
    }

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

/// Builds obvhs' two-wide BVH over `geometry`, which it owns, borrows or shares. Answers are exact, by the geometry's own test.
///
/// ```
/// use glam::Vec3;
/// use skipgrid::adapters::obvhs::{Preset, bvh2, cwbvh};
/// use skipgrid::{Accel, Hit, Ray};
///
/// let triangles = vec![[Vec3::ZERO, Vec3::X, Vec3::Y], [Vec3::ZERO, Vec3::X, Vec3::Y].map(|p| p + Vec3::Z)];
/// let (two, eight) = (bvh2(&triangles, Preset::Fast), cwbvh(&triangles, Preset::default()));
/// let ray = Ray::new(Vec3::new(0.5, 0.5, 4.0), Vec3::NEG_Z); // through an edge
/// assert_eq!(two.closest_hit(&ray), Some(Hit { t: 3.0, prim: 1 }));
/// assert_eq!(eight.closest_hit(&ray), two.closest_hit(&ray));
/// ```
pub fn bvh2<'a, G: Geometry + 'a>(geometry: G, preset: Preset) -> impl Accel + 'a {
    Bvh::<G, Bvh2>::build(geometry, preset)
}

/// Builds obvhs' eight-wide compressed BVH over `geometry`, as [`bvh2`] the two-wide one. Where it would be deeper than
/// obvhs can walk it stays two-wide.
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
        let preset = self.preset.name();
        let note = self.tree.as_ref().map_or("", Tree::note);
        format!("preset {preset}, nodes visited are not counted{note}{}", self.left_out)
    }
}
