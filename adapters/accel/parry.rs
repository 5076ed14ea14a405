//! Triangle meshes of the crate parry3d 0.31, from the Rapier physics engine, with its own triangle test in f32.
//!
//! A peer to compare with. Its rays have no `t_min` and its tree no query for any hit: hits before `t_min` are passed over in
//! the leaves, and any hit is the closest one. Rays and triangles are as in [`super::soup`].

use super::soup::{Labels, Soup, forwards, guarded};
use crate::accel::{Accel, Hit, Memory, Probe, queries_with_probe};
use crate::error::{Error, Result};
use crate::ray::{Aabb, Ray};
use parry3d::math::Vector;
use parry3d::partitioning::BvhNode;
use parry3d::query::RayCast;
use parry3d::shape::TriMesh;
use std::cell::Cell;

/// Builds a mesh, and with it parry's BVH, over the triangles of `soup`.
///
/// # Errors
/// The crate panics over these triangles or refuses them.
pub fn parry(soup: Soup) -> Result<Box<dyn Accel>> {
    let Soup { shapes: triangles, labels } = soup;
    let corners: Vec<Vector> = triangles.iter().flatten().map(|c| Vector::new(c.x, c.y, c.z)).collect();
    // `Soup` has at most 2^32 / 3 triangles.
    let indices: Vec<[u32; 3]> = (0..triangles.len() as u32).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect();
    let mesh = match guarded("parry3d", triangles.len(), || {
        (!triangles.is_empty()).then(|| TriMesh::new(corners, indices)).transpose()
    })? {
        Ok(mesh) => mesh,
        Err(cause) => return Err(Error::invalid(format!("parry3d refuses {} triangles: {cause}", triangles.len()))),
    };
    Ok(Box::new(Adapter { mesh, labels }))
}

struct Adapter {
    /// `None` if there is no triangle.
    mesh: Option<TriMesh>,
    labels: Labels,
}

impl Adapter {
    fn closest<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let (ray, mesh) = (forwards(ray)?, self.mesh.as_ref()?);
        let vector = |v: glam::Vec3| Vector::new(v.x, v.y, v.z);
        let native = parry3d::query::Ray::new(vector(ray.origin), vector(ray.direction));
        // The tree takes a function that changes nothing.
        let tests = Cell::new(0_u64);
        // It drops hits at its bound, so the bound lies beyond the ray's end.
        let found = mesh.bvh().cast_ray(&native, ray.t_max.next_up().min(f32::MAX), |leaf, _| {
            tests.set(tests.get() + 1);
            let t = mesh.triangle(leaf).cast_local_ray(&native, f32::MAX, false)?;
            (t >= ray.t_min && t <= ray.t_max).then_some(t)
        });
        (0..tests.get()).for_each(|_| probe.test());
        let (leaf, t) = found.filter(|(_, t)| *t <= ray.t_max)?;
        Some(Hit { t, prim: self.labels.prim(leaf) })
    }

    fn any<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        self.closest(ray, probe).is_some()
    }
}

impl Accel for Adapter {
    queries_with_probe!(closest, any);

    fn bounds(&self) -> Aabb {
        self.labels.bounds
    }

    fn memory(&self) -> Memory {
        let Some(mesh) = &self.mesh else { return Memory::default() };
        let (corners, triangles) = (mesh.vertices(), mesh.indices());
        Memory {
            // A binary tree over n leaves.
            structure: (2 * triangles.len().max(1) - 1) as u64 * size_of::<BvhNode>() as u64,
            references: (size_of_val(corners) + size_of_val(triangles)) as u64,
            tables: 0,
        }
    }

    fn describe(&self) -> String {
        self.labels.describe("triangle test of parry3d, nodes visited are not counted")
    }
}
