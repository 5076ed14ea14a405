//! The BVHs of the crate obvhs 0.4 as its authors intend: world coordinates, their own triangle test in f32.
//!
//! A peer to compare with. [`super::obvhs`] is what to use: there the same trees find candidates for the exact test. Here rays
//! through edges and corners leak, above all where a barycentric coordinate is -0.0, and what is much smaller or larger than
//! 1 is lost. Rays and triangles are as in [`super::soup`].

use super::obvhs::Preset;
use super::soup::{Labels, Soup, forwards, guarded};
use crate::accel::{Accel, Hit, Memory, Probe, queries_with_probe};
use crate::error::Result;
use crate::ray::{Aabb, Ray};
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::build_bvh2_from_tris;
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::build_cwbvh_from_tris;
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use std::time::Duration;

type NativeRay = obvhs::ray::Ray;

/// One of obvhs' two trees over triangles.
trait Tree: Send + Sync + Sized {
    fn build(triangles: &[obvhs::triangle::Triangle], params: BvhBuildParams) -> Self;
    /// The position in the leaf order and the parameter of the closest hit that `test` finds.
    fn closest(&self, ray: NativeRay, test: impl FnMut(&NativeRay, usize) -> f32) -> Option<(u32, f32)>;
    fn any(&self, ray: NativeRay, test: impl FnMut(&NativeRay, usize) -> f32) -> bool;
    fn order(&self) -> &[u32];
    fn node_bytes(&self) -> usize;
}

macro_rules! tree {
    ($tree:ty, $build:ident) => {
        impl Tree for $tree {
            fn build(triangles: &[obvhs::triangle::Triangle], params: BvhBuildParams) -> Self {
                $build(triangles, params, &mut Duration::default())
            }
            #[inline]
            fn closest(&self, ray: NativeRay, test: impl FnMut(&NativeRay, usize) -> f32) -> Option<(u32, f32)> {
                let mut hit = RayHit::none();
                self.ray_traverse(ray, &mut hit, test).then_some((hit.primitive_id, hit.t))
            }
            #[inline]
            fn any(&self, ray: NativeRay, test: impl FnMut(&NativeRay, usize) -> f32) -> bool {
                !self.ray_traverse_miss(ray, test)
            }
            fn order(&self) -> &[u32] {
                &self.primitive_indices
            }
            fn node_bytes(&self) -> usize {
                std::mem::size_of_val(self.nodes.as_slice())
            }
        }
    };
}
tree!(Bvh2, build_bvh2_from_tris);
tree!(CwBvh, build_cwbvh_from_tris);

/// Builds obvhs' two-wide BVH over the triangles of `soup`.
///
/// # Errors
/// obvhs panics over these triangles.
pub fn bvh2(soup: Soup, preset: Preset) -> Result<Box<dyn Accel>> {
    Ok(Box::new(Native::<Bvh2>::build(soup, preset)?))
}

/// Builds obvhs' eight-wide compressed BVH over the triangles of `soup`.
///
/// # Errors
/// obvhs panics over these triangles.
pub fn cwbvh(soup: Soup, preset: Preset) -> Result<Box<dyn Accel>> {
    Ok(Box::new(Native::<CwBvh>::build(soup, preset)?))
}

/// A tree and its triangles in the order of its leaves.
struct Native<T> {
    /// `None` if there is no triangle.
    tree: Option<T>,
    triangles: Vec<RtTriangle>,
    labels: Labels,
    preset: Preset,
}

impl<T: Tree> Native<T> {
    fn build(soup: Soup, preset: Preset) -> Result<Self> {
        let Soup { triangles, labels } = soup;
        let triangle =
            |&[a, b, c]: &crate::Triangle| obvhs::triangle::Triangle { v0: a.into(), v1: b.into(), v2: c.into() };
        let triangles: Vec<_> = triangles.iter().map(triangle).collect();
        let build = || (!triangles.is_empty()).then(|| T::build(&triangles, preset.params()));
        let tree = guarded("obvhs", triangles.len(), build)?;
        // Large triangles may stand in several leaves.
        let order = tree.as_ref().map_or(&[][..], T::order);
        let triangles = order.iter().map(|&i| RtTriangle::from(&triangles[i as usize])).collect();
        Ok(Self { tree, triangles, labels, preset })
    }

    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let (ray, tree) = (native(&forwards(ray)?), self.tree.as_ref()?);
        let (position, t) = tree.closest(ray, |ray, id| {
            probe.test();
            self.triangles[id].intersect(ray)
        })?;
        let index = tree.order().get(position as usize)?;
        Some(Hit { t, prim: self.labels.prim(*index) })
    }

    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        let (Some(ray), Some(tree)) = (forwards(ray), self.tree.as_ref()) else { return false };
        tree.any(native(&ray), |ray, id| {
            probe.test();
            self.triangles[id].intersect(ray)
        })
    }
}

fn native(ray: &Ray) -> NativeRay {
    NativeRay::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
}

impl<T: Tree> Accel for Native<T> {
    queries_with_probe!(closest, any);

    fn bounds(&self) -> Aabb {
        self.labels.bounds
    }

    fn memory(&self) -> Memory {
        let tree = self.tree.as_ref();
        let triangles = std::mem::size_of_val(self.triangles.as_slice());
        Memory {
            structure: tree.map_or(0, |t| t.node_bytes() as u64),
            references: 4 * tree.map_or(0, |t| t.order().len()) as u64 + triangles as u64,
            tables: 0,
        }
    }

    fn describe(&self) -> String {
        let preset = Preset::NAMES.iter().find(|(_, p)| *p == self.preset).map_or("", |(name, _)| name);
        self.labels.describe(&format!("preset {preset}, triangle test of obvhs, nodes visited are not counted"))
    }
}
