//! The BVHs of the crate obvhs 0.4 as its authors intend: world coordinates, their own triangle test in f32; for spheres, of
//! which obvhs has no test, the usual one in f32.
//!
//! A peer to compare with. [`super::obvhs`] is what to use: there the same trees find candidates for the exact test. Here rays
//! through edges and corners leak, above all where a barycentric coordinate is -0.0, and what is much smaller or larger than
//! 1 is lost. Rays and triangles are as in [`super::soup`].

use super::obvhs::Preset;
use super::soup::{Given, Labels, Soup, forwards, guarded};
use crate::accel::{Accel, Hit, Memory, Probe, queries_with_probe};
use crate::error::Result;
use crate::geometry::Sphere;
use crate::ray::{Aabb, Ray};
use glam::Vec3A;
use obvhs::BvhBuildParams;
use obvhs::bvh2::Bvh2;
use obvhs::bvh2::builder::{build_bvh2, build_bvh2_from_tris};
use obvhs::cwbvh::CwBvh;
use obvhs::cwbvh::builder::{build_cwbvh, build_cwbvh_from_tris};
use obvhs::ray::RayHit;
use obvhs::rt_triangle::RtTriangle;
use std::time::Duration;

type NativeRay = obvhs::ray::Ray;

/// One of obvhs' two trees.
trait Tree: Send + Sync + Sized {
    fn build(triangles: &[obvhs::triangle::Triangle], params: BvhBuildParams) -> Self;
    fn around(boxes: &[obvhs::aabb::Aabb], params: BvhBuildParams) -> Self;
    /// The position in the leaf order and the parameter of the closest hit that `test` finds.
    fn closest(&self, ray: NativeRay, test: impl FnMut(&NativeRay, usize) -> f32) -> Option<(u32, f32)>;
    fn any(&self, ray: NativeRay, test: impl FnMut(&NativeRay, usize) -> f32) -> bool;
    fn order(&self) -> &[u32];
    fn node_bytes(&self) -> usize;
}

macro_rules! tree {
    ($tree:ty, $build:ident, $around:ident) => {
        impl Tree for $tree {
            fn build(triangles: &[obvhs::triangle::Triangle], params: BvhBuildParams) -> Self {
                $build(triangles, params, &mut Duration::default())
            }
            fn around(boxes: &[obvhs::aabb::Aabb], params: BvhBuildParams) -> Self {
                $around(boxes, params, &mut Duration::default())
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
                size_of_val(self.nodes.as_slice())
            }
        }
    };
}
tree!(Bvh2, build_bvh2_from_tris, build_bvh2);
tree!(CwBvh, build_cwbvh_from_tris, build_cwbvh);

/// Builds obvhs' two-wide BVH over what is given.
///
/// # Errors
/// obvhs panics over it.
pub fn bvh2(given: Given, preset: Preset) -> Result<Box<dyn Accel>> {
    build::<Bvh2>(given, preset)
}

/// Builds obvhs' eight-wide compressed BVH over what is given.
///
/// # Errors
/// obvhs panics over it.
pub fn cwbvh(given: Given, preset: Preset) -> Result<Box<dyn Accel>> {
    build::<CwBvh>(given, preset)
}

fn build<T: Tree + 'static>(given: Given, preset: Preset) -> Result<Box<dyn Accel>> {
    Ok(match given {
        Given::Triangles(soup) => Box::new(Native::<T, RtTriangle>::triangles(soup, preset)?),
        Given::Spheres(soup) => Box::new(Native::<T, Ball>::spheres(soup, preset)?),
    })
}

/// What leaves hold.
trait Shape: Send + Sync {
    /// Whose test it is, for people.
    const TEST: &'static str;
    /// The parameter of the hit within the ray's range, or infinity.
    fn meet(&self, ray: &NativeRay) -> f32;
}

impl Shape for RtTriangle {
    const TEST: &'static str = "triangle test of obvhs";
    #[inline]
    fn meet(&self, ray: &NativeRay) -> f32 {
        self.intersect(ray)
    }
}

/// A sphere, with the square of its radius.
struct Ball {
    centre: Vec3A,
    square: f32,
}

impl Shape for Ball {
    const TEST: &'static str = "usual sphere test in f32";
    /// The point nearest to the centre, and half a chord before or behind it.
    #[inline]
    fn meet(&self, ray: &NativeRay) -> f32 {
        let (d, f) = (ray.direction, self.centre - ray.origin);
        let inverse = 1.0 / d.dot(d);
        let middle = f.dot(d) * inverse;
        let square = self.square - (f - middle * d).length_squared();
        if square < 0.0 {
            return f32::INFINITY;
        }
        let half = (square * inverse).sqrt();
        let within = |t: &f32| *t >= ray.tmin && *t <= ray.tmax;
        [middle - half, middle + half].into_iter().find(within).unwrap_or(f32::INFINITY)
    }
}

/// A tree and its primitives in the order of its leaves.
struct Native<T, S> {
    /// `None` if there is no primitive.
    tree: Option<T>,
    shapes: Vec<S>,
    labels: Labels,
    preset: Preset,
}

impl<T: Tree> Native<T, RtTriangle> {
    fn triangles(soup: Soup, preset: Preset) -> Result<Self> {
        let Soup { shapes: triangles, labels } = soup;
        let triangle =
            |&[a, b, c]: &crate::Triangle| obvhs::triangle::Triangle { v0: a.into(), v1: b.into(), v2: c.into() };
        let triangles: Vec<_> = triangles.iter().map(triangle).collect();
        let build = || (!triangles.is_empty()).then(|| T::build(&triangles, preset.params()));
        let tree = guarded("obvhs", triangles.len(), build)?;
        // Large triangles may stand in several leaves.
        let order = tree.as_ref().map_or(&[][..], T::order);
        let shapes = order.iter().map(|&i| RtTriangle::from(&triangles[i as usize])).collect();
        Ok(Self { tree, shapes, labels, preset })
    }
}

impl<T: Tree> Native<T, Ball> {
    fn spheres(soup: Soup<Sphere>, preset: Preset) -> Result<Self> {
        let Soup { shapes: spheres, labels } = soup;
        let around = |s: &Sphere| {
            let (centre, radius) = (Vec3A::from(s.centre), Vec3A::splat(s.radius));
            obvhs::aabb::Aabb { min: centre - radius, max: centre + radius }
        };
        let boxes: Vec<_> = spheres.iter().map(around).collect();
        let build = || (!boxes.is_empty()).then(|| T::around(&boxes, preset.params()));
        let tree = guarded("obvhs", boxes.len(), build)?;
        let order = tree.as_ref().map_or(&[][..], T::order);
        let ball = |s: &Sphere| Ball { centre: s.centre.into(), square: s.radius * s.radius };
        let shapes = order.iter().map(|&i| ball(&spheres[i as usize])).collect();
        Ok(Self { tree, shapes, labels, preset })
    }
}

impl<T: Tree, S: Shape> Native<T, S> {
    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let (ray, tree) = (native(&forwards(ray)?), self.tree.as_ref()?);
        let (position, t) = tree.closest(ray, |ray, id| {
            probe.test();
            self.shapes[id].meet(ray)
        })?;
        let index = tree.order().get(position as usize)?;
        Some(Hit { t, prim: self.labels.prim(*index) })
    }

    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        let (Some(ray), Some(tree)) = (forwards(ray), self.tree.as_ref()) else { return false };
        tree.any(native(&ray), |ray, id| {
            probe.test();
            self.shapes[id].meet(ray)
        })
    }
}

fn native(ray: &Ray) -> NativeRay {
    NativeRay::new(ray.origin.into(), ray.direction.into(), ray.t_min, ray.t_max)
}

impl<T: Tree, S: Shape> Accel for Native<T, S> {
    queries_with_probe!(closest, any);

    fn bounds(&self) -> Aabb {
        self.labels.bounds
    }

    fn memory(&self) -> Memory {
        let tree = self.tree.as_ref();
        let shapes = size_of_val(self.shapes.as_slice());
        Memory {
            structure: tree.map_or(0, |t| t.node_bytes() as u64),
            references: 4 * tree.map_or(0, |t| t.order().len()) as u64 + shapes as u64,
            tables: 0,
        }
    }

    fn describe(&self) -> String {
        let preset = self.preset.name();
        self.labels.describe(&format!("preset {preset}, {}, nodes visited are not counted", S::TEST))
    }
}
