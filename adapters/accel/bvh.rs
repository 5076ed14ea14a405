//! The crate bvh 0.13, a two-wide BVH by surface areas, with its own triangle test in f32.
//!
//! A peer to compare with, as its authors intend but for what its interface lacks:
//!
//! - Its rays are normalised and have no range: distances are divided by the direction's length, and hits out of range are
//!   passed over.
//! - It leaves finding the closest hit to its user: boxes come sorted by where the ray enters them, and the search ends at the
//!   first that it enters beyond the best hit.
//! - Its triangle test sees front faces only: each triangle is tested in both windings.
//!
//! Rays and triangles are as in [`super::soup`]. Triangles with an area below about 1e-7, and rays that are not of a length
//! whose square is within f32, are lost; a ray in the plane of a box's face misses the box.

use super::soup::{Labels, Soup, forwards, guarded};
use crate::accel::{Accel, Hit, Memory, Probe, queries_with_probe};
use crate::error::Result;
use crate::ray::{Aabb, Ray};
use bvh::aabb::Bounded;
use bvh::bounding_hierarchy::BHShape;
use bvh::bvh::{Bvh, BvhNode};
use nalgebra::{Point3, Vector3};

type NativeBox = bvh::aabb::Aabb<f32, 3>;
type NativeRay = bvh::ray::Ray<f32, 3>;

/// Builds the BVH over the triangles of `soup`.
///
/// # Errors
/// The crate panics over these triangles.
pub fn bvh(soup: Soup) -> Result<Box<dyn Accel>> {
    let Soup { shapes: triangles, labels } = soup;
    let shape = |(index, corners): (usize, &crate::Triangle)| {
        let corners = corners.map(|c| Point3::from(c.to_array()));
        let [a, b, c] = corners;
        Shape { corners, aabb: NativeBox::empty().grow(&a).grow(&b).grow(&c), index: index as u32, node: 0 }
    };
    let mut shapes: Vec<Shape> = triangles.iter().enumerate().map(shape).collect();
    let tree = guarded("bvh", shapes.len(), || Bvh::build(&mut shapes))?;
    Ok(Box::new(Adapter { tree, shapes, labels }))
}

struct Shape {
    corners: [Point3<f32>; 3],
    aabb: NativeBox,
    index: u32,
    node: usize,
}

impl Bounded<f32, 3> for Shape {
    fn aabb(&self) -> NativeBox {
        self.aabb
    }
}

impl BHShape<f32, 3> for Shape {
    fn set_bh_node_index(&mut self, node: usize) {
        self.node = node;
    }

    fn bh_node_index(&self) -> usize {
        self.node
    }
}

struct Adapter {
    tree: Bvh<f32, 3>,
    shapes: Vec<Shape>,
    labels: Labels,
}

/// A ray of the crate, with the range and the length that it lacks.
struct Ranged {
    native: NativeRay,
    length: f32,
    range: Ray,
}

impl Ranged {
    fn new(ray: &Ray) -> Option<Self> {
        let range = forwards(ray)?;
        let direction = Vector3::from(range.direction.to_array());
        let native = NativeRay::new(Point3::from(range.origin.to_array()), direction);
        Some(Self { native, length: direction.norm(), range })
    }

    /// The parameter at which the ray meets a triangle within its range; infinite if it does not.
    fn meets(&self, [a, b, c]: &[Point3<f32>; 3]) -> f32 {
        let distance = self.native.intersects_triangle(a, b, c).distance;
        let distance = distance.min(self.native.intersects_triangle(a, c, b).distance);
        let t = distance / self.length;
        if t >= self.range.t_min && t <= self.range.t_max { t } else { f32::INFINITY }
    }
}

impl Adapter {
    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let ray = Ranged::new(ray)?;
        let mut best: Option<Hit> = None;
        for shape in self.tree.nearest_traverse_iterator(&ray.native, &self.shapes) {
            if let Some(best) = best
                && let Some((enter, _)) = ray.native.intersection_slice_for_aabb(&shape.aabb)
                && enter > best.t * ray.length
            {
                break;
            }
            probe.test();
            let t = ray.meets(&shape.corners);
            if t < best.map_or(f32::INFINITY, |best| best.t) {
                best = Some(Hit { t, prim: self.labels.prim(shape.index) });
            }
        }
        best
    }

    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        let Some(ray) = Ranged::new(ray) else { return false };
        self.tree.nearest_traverse_iterator(&ray.native, &self.shapes).any(|shape| {
            probe.test();
            ray.meets(&shape.corners) < f32::INFINITY
        })
    }
}

impl Accel for Adapter {
    queries_with_probe!(closest, any);

    fn bounds(&self) -> Aabb {
        self.labels.bounds
    }

    fn memory(&self) -> Memory {
        Memory {
            structure: (self.tree.nodes.len() * size_of::<BvhNode<f32, 3>>()) as u64,
            references: size_of_val(self.shapes.as_slice()) as u64,
            tables: 0,
        }
    }

    fn describe(&self) -> String {
        self.labels.describe("triangle test of the crate bvh, nodes visited are not counted")
    }
}
