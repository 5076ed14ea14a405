//! A renderer with one fault: what a validator is there to find.

use glam::Vec3;
use skipgrid::accel::{Accel, Counts, Hit, Memory};
use skipgrid::ray::{Aabb, Ray};
use skipgrid::scene::{Bsdf, Scene};
use std::fmt;

/// One thing that is wrong.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fault {
    /// Every diffuse albedo is so many per cent too great.
    Albedo(f32),
    /// The picture is moved to the side by so many pixels.
    Shift(f64),
    /// One shadow ray in so many meets nothing, chosen by its bits.
    Shadows(u64),
    /// Paths end one edge too early.
    Bounce,
}

impl fmt::Display for Fault {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.pad(&match self {
            Fault::Albedo(percent) => format!("albedo +{percent} %"),
            Fault::Shift(pixels) => format!("shift of {pixels} pixels"),
            Fault::Shadows(one_in) => format!("1 in {one_in} shadow rays skipped"),
            Fault::Bounce => "one bounce missing".into(),
        })
    }
}

impl Fault {
    /// The scene that the faulty renderer sees instead of `scene`, in a picture of `rows` rows.
    pub fn scene(self, scene: &Scene, rows: u32) -> Scene {
        let mut scene = scene.clone();
        match self {
            Fault::Albedo(percent) => {
                for material in &mut scene.materials {
                    if let Bsdf::Lambert { albedo, .. } = &mut material.bsdf {
                        *albedo = (*albedo * (1.0 + percent / 100.0)).min(Vec3::ONE);
                    }
                }
            }
            Fault::Shift(pixels) => {
                let camera = &mut scene.camera;
                let [_, right, _] = camera.basis();
                let pixel = 2.0 * (camera.yfov.to_radians() / 2.0).tan() / f64::from(rows);
                camera.target += right * (pixels * pixel * (camera.target - camera.origin).length());
            }
            Fault::Shadows(_) | Fault::Bounce => {}
        }
        scene
    }

    /// The accelerator that it asks instead of `accel`.
    pub fn accel<'a>(self, accel: &'a dyn Accel) -> Box<dyn Accel + 'a> {
        let one_in = if let Fault::Shadows(one_in) = self { one_in } else { u64::MAX };
        Box::new(DropsShadows { accel, one_in })
    }

    /// The longest path that it follows instead of `max_depth`.
    pub fn depth(self, max_depth: u32) -> u32 {
        if self == Fault::Bounce { max_depth - 1 } else { max_depth }
    }
}

/// Misses every occluder for one shadow ray of `one_in`; none for the greatest number.
struct DropsShadows<'a> {
    accel: &'a dyn Accel,
    one_in: u64,
}

impl Accel for DropsShadows<'_> {
    fn closest_hit(&self, ray: &Ray) -> Option<Hit> {
        self.accel.closest_hit(ray)
    }
    fn any_hit(&self, ray: &Ray) -> bool {
        let mut hash = 0u64;
        for value in ray.origin.to_array().into_iter().chain(ray.direction.to_array()) {
            hash = (hash ^ u64::from(value.to_bits())).wrapping_mul(0x9e37_79b9_7f4a_7c15);
            hash ^= hash >> 29;
        }
        let dropped = self.one_in != u64::MAX && hash.is_multiple_of(self.one_in);
        !dropped && self.accel.any_hit(ray)
    }
    fn closest_hit_counted(&self, ray: &Ray, counts: &mut Counts) -> Option<Hit> {
        self.accel.closest_hit_counted(ray, counts)
    }
    fn any_hit_counted(&self, ray: &Ray, _: &mut Counts) -> bool {
        self.any_hit(ray)
    }
    fn bounds(&self) -> Aabb {
        self.accel.bounds()
    }
    fn memory(&self) -> Memory {
        self.accel.memory()
    }
}
