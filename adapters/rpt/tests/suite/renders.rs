//! rpt's renderer over the plug: every ray that it sends is answered as by its own kd-tree.

use crate::{Answer, EPSILON, corners, triangles};
use rand::rngs::StdRng;
use rpt::{
    Camera, HitRecord, Light, Material, Mesh, Object, Ray, Renderer, Scene, SceneAdd, Shape, Triangle, glm, plane,
};
use skipgrid_rpt::Accelerated;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering::Relaxed};

/// Asks both and counts.
struct Twins {
    ours: Accelerated<Triangle>,
    theirs: Mesh,
    list: Vec<Triangle>,
    rays: AtomicUsize,
    bounces: AtomicUsize,
    apart: AtomicUsize,
}

impl Shape for Twins {
    fn intersect(&self, ray: &Ray, t_min: f64, record: &mut HitRecord) -> bool {
        assert_eq!(t_min, EPSILON);
        let ask = |shape: &dyn Shape| -> Answer {
            let mut record = HitRecord { time: record.time, normal: record.normal };
            shape.intersect(ray, t_min, &mut record);
            (record.time, record.normal)
        };
        let (ours, theirs) = (ask(&self.ours), ask(&self.theirs));
        self.rays.fetch_add(1, Relaxed);
        self.bounces.fetch_add(usize::from(ray.origin.norm() < 2.0), Relaxed);
        if ours != theirs {
            self.apart.fetch_add(1, Relaxed);
            let mut all = HitRecord { time: record.time, normal: record.normal };
            self.list.iter().for_each(|triangle| _ = triangle.intersect(ray, t_min, &mut all));
            assert_eq!(ours, (all.time, all.normal), "all triangles, one by one: {:?} {:?}", ray.origin, ray.dir);
        }
        self.ours.intersect(ray, t_min, record)
    }

    fn sample(&self, target: &glm::DVec3, rng: &mut StdRng) -> (glm::DVec3, glm::DVec3, f64) {
        self.ours.sample(target, rng)
    }
}

#[test]
fn every_ray_of_a_picture_is_answered_alike() {
    let list = triangles(&corners("bumpy"));
    for spec in ["nested", "grid-octant"] {
        let ours = Accelerated::new(list.clone(), spec).expect("finite triangles");
        let [rays, bounces, apart] = [0; 3].map(AtomicUsize::new);
        let twins = Arc::new(Twins { ours, theirs: Mesh::new(list.clone()), list: list.clone(), rays, bounces, apart });
        let mut scene = Scene::new();
        scene.add(Object::new(Arc::clone(&twins)).material(Material::specular(rpt::hex_color(0xAA_7744), 0.3)));
        scene.add(
            Object::new(plane(glm::vec3(0.0, 1.0, 0.0), -1.1)).material(Material::diffuse(rpt::hex_color(0x99_9999))),
        );
        scene.add(Light::Ambient(glm::vec3(0.1, 0.1, 0.1)));
        scene.add(Light::Point(glm::vec3(60.0, 60.0, 60.0), glm::vec3(3.0, 4.0, 3.0)));
        let camera = Camera::look_at(glm::vec3(1.0, 1.0, 4.0), glm::vec3(0.0, 0.0, 0.0), glm::vec3(0.0, 1.0, 0.0), 0.7);
        let picture = Renderer::new(&scene, camera).width(64).height(48).max_bounces(3).num_samples(4).render();
        assert!(picture.pixels().any(|p| p.0 != picture.get_pixel(0, 0).0), "a picture of one colour");
        let [rays, bounces, apart] = [&twins.rays, &twins.bounces, &twins.apart].map(|count| count.load(Relaxed));
        println!("{spec}: {rays} rays of a picture, {bounces} of them from its surfaces; {apart} answers differ");
        assert!(rays > 20_000 && bounces > 5_000 && apart < rays / 1000, "{rays} {bounces} {apart}");
    }
}
