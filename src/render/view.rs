//! Camera rays: the camera's basis, computed once.

use crate::error::{Error, Result};
use crate::ray::Ray;
use crate::scene::Camera;
use glam::DVec3;

/// A camera for one film size. Follows [`Camera::direction`].
#[derive(Clone, Copy, Debug)]
pub(super) struct View {
    origin: DVec3,
    corner: DVec3,
    across: DVec3,
    down: DVec3,
}

impl View {
    /// The view of a `width` x `height` film, both above 0.
    ///
    /// # Errors
    /// The camera has no direction, looks along `up`, or has a field of view outside 0 to 180 degrees.
    pub fn new(camera: &Camera, width: u32, height: u32) -> Result<Self> {
        if !(camera.yfov > 0.0 && camera.yfov < 180.0) {
            return Err(Error::invalid(format!(
                "camera: yfov is {} degrees, allowed are 0 to 180, ends excluded",
                camera.yfov
            )));
        }
        let [forward, right, up] = camera.basis();
        if !(camera.origin.as_vec3().is_finite() && forward.is_finite() && right.is_finite() && up.is_finite()) {
            return Err(Error::invalid(format!(
                "camera: no view from {} to {} with {} up",
                camera.origin, camera.target, camera.up
            )));
        }
        let half = (camera.yfov.to_radians() / 2.0).tan();
        let (w, h) = (f64::from(width), f64::from(height));
        Ok(Self {
            origin: camera.origin,
            corner: forward - right * (half * w / h) + up * half,
            across: right * (2.0 * half / h),
            down: up * (-2.0 * half / h),
        })
    }

    /// The ray through the film point (x, y), pixels from the top left corner; its direction has unit length.
    pub fn ray(&self, x: f64, y: f64) -> Ray {
        let direction = (self.corner + x * self.across + y * self.down).normalize();
        Ray::new(self.origin.as_vec3(), direction.as_vec3())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::CameraSource;

    #[test]
    fn rays_follow_the_camera() {
        let camera = Camera {
            origin: DVec3::new(1.0, 2.0, 3.0),
            target: DVec3::new(-4.0, 1.0, 0.5),
            up: DVec3::new(0.2, 1.0, 0.1),
            yfov: 47.0,
            source: CameraSource::File,
        };
        let view = View::new(&camera, 31, 17).expect("a usable camera");
        for (x, y) in [(0.0, 0.0), (31.0, 17.0), (15.5, 8.5), (3.25, 11.75)] {
            let error = view.ray(x, y).direction.as_dvec3() - camera.direction(x, y, 31, 17);
            // Half an f32 ulp of a number below 1.
            assert!(error.abs().max_element() <= 0.5f64.powi(25) * 1.001, "{x} {y} {error}");
        }
    }
}
