//! Any accelerator of `skipgrid` as a [`Shape`] of the path tracer [`rpt`]: [`Accelerated`] stands where [`rpt::KdTree`] stood.
//!
//! ```
//! use rpt::{HitRecord, Ray, Shape, Triangle, glm};
//! use skipgrid_rpt::Accelerated;
//!
//! let (a, b, c) = (glm::vec3(0.0, 0.0, 0.0), glm::vec3(1.0, 0.0, 0.0), glm::vec3(0.0, 1.0, 0.0));
//! let triangles = vec![Triangle::from_vertices(a, b, c)];
//! let mesh = Accelerated::new(triangles, "nested")?; // instead of rpt::Mesh::new(triangles)
//! let mut hit = HitRecord::new();
//! let ray = Ray { origin: glm::vec3(0.25, 0.25, 2.0), dir: glm::vec3(0.0, 0.0, -1.0) };
//! assert!(mesh.intersect(&ray, 1e-12, &mut hit));
//! assert_eq!(hit.time, 2.0);
//! # Ok::<(), skipgrid::Error>(())
//! ```
//!
//! rpt traces in f64 and lets bounces begin 1e-12 beyond a surface; skipgrid's rays are f32. So the accelerator finds the
//! candidates, along a ray that is rounded to f32 and through boxes that are padded by more than the rounding, and rpt's own
//! code says in f64, for the ray as it was, whether and when each of them is hit ([`Objects`]). The answer is the least time of
//! all objects, as from testing every one. Normals are rpt's, too: of triangles without normals, from their winding.

mod objects;

pub use objects::{Objects, Query};

use rand::{Rng, rngs::StdRng};
use rpt::{Bounded, BoundingBox, HitRecord, Shape, glm};
use skipgrid::{Accel, Result, registry};
use std::sync::Arc;

/// Objects of rpt behind an accelerator of skipgrid, by default one that is chosen at run time.
///
/// Of objects that are hit at the same time the first one counts. Objects may be accelerated ones themselves, transformed:
/// copies of a mesh share it as `Arc<Accelerated<Triangle>>`.
pub struct Accelerated<T, A = Box<dyn Accel>> {
    objects: Arc<Objects<T>>,
    accel: A,
}

impl<T: Bounded + 'static> Accelerated<T> {
    /// `spec` is a name with options, such as `nested` or `grid-octant:density=4`, of those in [`registry::ENTRIES`] that take
    /// primitives of any kind.
    ///
    /// # Errors
    /// As [`Accelerated::with`] and [`registry::build`].
    pub fn new(objects: Vec<T>, spec: &str) -> Result<Self> {
        Self::with(objects, |objects| registry::build(spec, objects))
    }
}

impl<T: Bounded, A: Accel> Accelerated<T, A> {
    /// With an accelerator of any type, which `build` makes of the objects.
    ///
    /// # Errors
    /// As [`Objects::new`], or `build` fails.
    pub fn with(objects: Vec<T>, build: impl FnOnce(Arc<Objects<T>>) -> Result<A>) -> Result<Self> {
        let objects = Arc::new(Objects::new(objects)?);
        Ok(Self { accel: build(Arc::clone(&objects))?, objects })
    }

    /// What was built: its size, its bounds in the coordinates of [`Objects`], and counts of its work.
    pub fn accel(&self) -> &A {
        &self.accel
    }
}

impl<T: Bounded, A: Accel> Shape for Accelerated<T, A> {
    fn intersect(&self, ray: &rpt::Ray, t_min: f64, record: &mut HitRecord) -> bool {
        let query = Query::new(ray, t_min, record.time, &self.objects);
        let hit = query.ask(|rounded| self.accel.closest_hit(rounded));
        // The accelerator says which object it is; time and normal come from that object.
        hit.is_some_and(|hit| self.objects.list()[hit.prim as usize].intersect(ray, t_min, record))
    }

    /// A random object's sample, all objects alike, as [`rpt::KdTree`] does it.
    fn sample(&self, target: &glm::DVec3, rng: &mut StdRng) -> (glm::DVec3, glm::DVec3, f64) {
        let list = self.objects.list();
        let (point, normal, density) = list[rng.gen_range(0..list.len())].sample(target, rng);
        (point, normal, density / list.len() as f64)
    }
}

impl<T: Bounded, A: Accel> Bounded for Accelerated<T, A> {
    fn bounding_box(&self) -> BoundingBox {
        self.objects.bounding_box()
    }
}
