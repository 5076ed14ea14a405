//! A mesh as a [`Scene`] of the path tracer [`rust_pathtracer`], over any accelerator of `skipgrid`.
//!
//! The trait has two questions for geometry, `closest_hit` and `any_hit`, and so has [`Accel`]: this is all that lies between
//! them. Both sides are f32, so that nothing is rounded. What the tracer wants beside a distance, normal and material, is looked
//! up afterwards, for the one primitive that was hit.
//!
//! ```
//! use rust_pathtracer::prelude::{ColorBuffer, F3, Material, Tracer};
//! use skipgrid_rust_pathtracer::MeshScene;
//! use glam::Vec3;
//!
//! let triangles = vec![[Vec3::new(-1.0, 0.0, -1.0), Vec3::new(1.0, 0.0, -1.0), Vec3::new(0.0, 2.0, -1.0)]];
//! let ochre = |_prim| Material { rgb: F3::new(0.8, 0.5, 0.2), ..Material::new() };
//! let scene = MeshScene::build("nested", triangles, ochre)?;
//! let mut picture = ColorBuffer::new(32, 24);
//! Tracer::new(Box::new(scene.with_background(F3::new(1.0, 1.0, 1.0)))).render(&mut picture);
//! assert_ne!(picture.at(16, 10), picture.at(0, 0));
//! # Ok::<(), skipgrid::Error>(())
//! ```
//!
//! The tracer moves every bounce 0.005 off the surface, whatever the scene: make scenes some units large. Its random numbers
//! cannot be seeded, so that two pictures are never equal; hits are.

use glam::Vec3;
use rust_pathtracer::prelude::{
    AnalyticalLight, Camera3D, F, F3, LightSampleRec, Material, Pinhole, Ray, Scene, State,
};
use skipgrid::accel::{Accel, BruteForce};
use skipgrid::{Hit, Result, Triangle, registry};
use std::sync::Arc;

/// Triangles with a material for each, and lights, a camera and a background of the tracer.
pub struct MeshScene {
    accel: Box<dyn Accel>,
    triangles: Arc<Vec<Triangle>>,
    material: Box<dyn Fn(u32) -> Material + Send + Sync>,
    lights: Vec<AnalyticalLight>,
    camera: Box<dyn Camera3D>,
    background: F3,
}

impl MeshScene {
    /// `spec` names an accelerator with options, such as `nested` or `grid:density=4`; `material` is asked with the index of a
    /// triangle that was hit.
    ///
    /// # Errors
    /// As [`registry::build`].
    pub fn build(
        spec: &str,
        triangles: Vec<Triangle>,
        material: impl Fn(u32) -> Material + Send + Sync + 'static,
    ) -> Result<Self> {
        let mut scene = Self { triangles: Arc::new(triangles), material: Box::new(material), ..Scene::new() };
        scene.accel = registry::build(spec, Arc::clone(&scene.triangles))?;
        Ok(scene)
    }

    /// Adds a light, a ball that shines.
    pub fn with_light(mut self, light: AnalyticalLight) -> Self {
        self.lights.push(light);
        self
    }

    /// Instead of the tracer's usual camera.
    pub fn with_camera(self, camera: impl Camera3D + 'static) -> Self {
        Self { camera: Box::new(camera), ..self }
    }

    /// What is seen where nothing is hit.
    pub fn with_background(self, background: F3) -> Self {
        Self { background, ..self }
    }

    /// Unit normal on the side from which the corners run counter-clockwise; the tracer turns it towards the ray.
    fn normal(&self, hit: Hit) -> F3 {
        let [a, b, c] = self.triangles[hit.prim as usize].map(Vec3::as_dvec3);
        let n = (b - a).cross(c - a).normalize().as_vec3(); // in f64: slivers have one, too
        F3::new(n.x, n.y, n.z)
    }
}

/// The tracer's ray as one of ours, from its origin to `end`.
fn ours(ray: &Ray, end: F) -> skipgrid::Ray {
    let vec = |v: F3| Vec3::new(v.x, v.y, v.z);
    skipgrid::Ray::new(vec(ray.origin), vec(ray.direction)).with_range(0.0, end)
}

impl Scene for MeshScene {
    /// Nothing: no triangle, no light, the tracer's usual camera.
    fn new() -> Self {
        Self {
            accel: Box::new(BruteForce::new(Vec::<Triangle>::new())),
            triangles: Arc::default(),
            material: Box::new(|_| Material::new()),
            lights: vec![],
            camera: Box::new(Pinhole::new()),
            background: F3::zeros(),
        }
    }

    fn background(&self, _ray: &Ray) -> F3 {
        self.background
    }

    fn closest_hit(&self, ray: &Ray, state: &mut State, light: &mut LightSampleRec) -> bool {
        let hit = self.accel.closest_hit(&ours(ray, F::INFINITY));
        state.hit_dist = hit.map_or(F::INFINITY, |hit| hit.t);
        if let Some(hit) = hit {
            state.normal = self.normal(hit);
            state.material = (self.material)(hit.prim);
        }
        // A light before it takes its place.
        self.sample_lights(ray, state, light, &self.lights) || hit.is_some()
    }

    fn any_hit(&self, ray: &Ray, max_dist: F) -> bool {
        self.accel.any_hit(&ours(ray, max_dist))
    }

    fn camera(&self) -> &Box<dyn Camera3D> {
        &self.camera
    }

    fn number_of_lights(&self) -> usize {
        self.lights.len()
    }

    fn light_at(&self, index: usize) -> &AnalyticalLight {
        &self.lights[index]
    }

    fn as_any(&mut self) -> &mut dyn std::any::Any {
        self
    }
}
