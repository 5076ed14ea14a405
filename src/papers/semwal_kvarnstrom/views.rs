//! The four scenes and the three views of each.

use crate::error::Result;
use crate::ray::Aabb;
use crate::scene::{Camera, CameraSource, Scene, procedural};
use glam::DVec3;

/// A scene of the paper.
pub struct Setting {
    /// The paper's name for it, in lower case.
    pub name: &'static str,
    /// What it is here, in words.
    pub words: &'static str,
    spec: &'static str,
    /// A floor far wider than the objects would leave them a voxel or two.
    floor: bool,
    up: DVec3,
    /// Direction of the axis view.
    axis: DVec3,
    /// Eye and target of the inside view: among the objects, in none of them.
    inside: [DVec3; 2],
}

/// Names of the views.
pub const VIEWS: [&str; 3] = ["camera", "axis", "inside"];

/// The views in words.
pub const VIEWS_IN_WORDS: &str = "Views: `camera` is the scene's own or, where it has none, one framed around it; `axis` \
    looks along a grid axis from far away with a field of view of 5 degrees, so that its rays are nearly parallel to it \
    (down the lanes; down on the cars); `inside` stands among the objects and looks across the axes with 60 degrees.";

/// The paper's four scenes. Its numbers of objects are lost; these have four digits as its ones had.
pub const SETTINGS: [Setting; 4] = [
    Setting {
        name: "random",
        words: "1000 spheres of random size and place",
        spec: "random",
        floor: true,
        up: DVec3::Y,
        axis: DVec3::NEG_Z,
        inside: [DVec3::new(2.0, 1.0, 3.0), DVec3::new(-2.5, -1.5, -4.0)],
    },
    Setting {
        name: "lanes",
        words: "10 x 10 x 10 spheres with straight empty lanes between them",
        spec: "lanes",
        floor: true,
        up: DVec3::Y,
        axis: DVec3::NEG_Z,
        inside: [DVec3::ZERO, DVec3::new(4.0, 2.5, 3.1)],
    },
    Setting {
        name: "flakes",
        words: "a sphereflake of 7381 spheres, without the floor that it stands on elsewhere",
        spec: "flakes",
        floor: false,
        up: DVec3::Z,
        axis: DVec3::NEG_X,
        inside: [DVec3::new(0.5, -0.5, 0.5), DVec3::new(-0.4, 0.7, 0.3)],
    },
    Setting {
        name: "cars",
        words: "four parked cars of triangular patches on a floor, 18626 triangles",
        spec: "cars",
        floor: true,
        up: DVec3::Y,
        axis: DVec3::NEG_Y,
        inside: [DVec3::new(0.0, 1.2, 0.0), DVec3::new(3.0, 0.3, 1.9)],
    },
];

impl Setting {
    /// The scene with its own camera.
    ///
    /// # Errors
    /// None for these scenes, short of memory.
    pub fn scene(&self) -> Result<Scene> {
        let mut parts = procedural::parse(self.spec)?;
        if !self.floor {
            parts.meshes.clear();
        }
        Scene::new(parts)
    }

    /// The cameras of [`VIEWS`]; `own` is the scene's.
    pub fn cameras(&self, own: Camera, bounds: &Aabb) -> [Camera; 3] {
        let look = |origin, target, up, yfov| Camera { origin, target, up, yfov, source: CameraSource::File };
        let centre = (bounds.min.as_dvec3() + bounds.max.as_dvec3()) / 2.0;
        let half = bounds.extent().as_dvec3() / 2.0;
        let yfov = 5.0_f64;
        // The near face of the bounds fills the picture.
        let across = (half - half * self.axis.abs()).max_element();
        let away = half.dot(self.axis.abs()) + across / (yfov.to_radians() / 2.0).tan();
        let [eye, target] = self.inside;
        let up = if self.axis.dot(self.up) == 0.0 { self.up } else { DVec3::NEG_Z };
        [own, look(centre - away * self.axis, centre, up, yfov), look(eye, target, self.up, 60.0)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn no_eye_stands_in_a_sphere_and_every_view_sees_something() {
        for setting in &SETTINGS {
            let scene = setting.scene().expect("a valid scene");
            let accel = scene.accel("grid").expect("builds");
            for (camera, view) in setting.cameras(scene.camera, &accel.bounds()).into_iter().zip(VIEWS) {
                let name = setting.name;
                let within =
                    scene.spheres.iter().filter(|s| s.centre.as_dvec3().distance(camera.origin) <= f64::from(s.radius));
                assert_eq!(within.count(), 0, "{name} {view}");
                let hits = (0..32 * 32).filter(|i| {
                    let direction = camera.direction(f64::from(i % 32) + 0.5, f64::from(i / 32) + 0.5, 32, 32);
                    accel.any_hit(&crate::Ray::new(camera.origin.as_vec3(), direction.as_vec3()))
                });
                let hits = hits.count();
                assert!(hits > 100, "{name} {view}: {hits} of 1024 rays hit something");
            }
        }
    }
}
