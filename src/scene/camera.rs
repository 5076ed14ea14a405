//! The pinhole camera, with POV-Ray's and Mitsuba's pixel grid.

use glam::DVec3;

/// Where a camera came from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum CameraSource {
    /// The scene file has it.
    File,
    /// The file has none: this one was framed around the scene's bounds.
    Framed,
}

/// A pinhole camera in a right-handed world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Camera {
    /// Eye, world units.
    pub origin: DVec3,
    /// A point in the centre of the picture, world units.
    pub target: DVec3,
    /// A direction that points up in the picture; not parallel to the view.
    pub up: DVec3,
    /// Vertical field of view, degrees, above 0 and below 180.
    pub yfov: f64,
    /// Where it came from.
    pub source: CameraSource,
}

impl Camera {
    /// Forward, right and up: an orthonormal basis.
    pub fn basis(&self) -> [DVec3; 3] {
        let forward = (self.target - self.origin).normalize();
        let right = forward.cross(self.up).normalize();
        [forward, right, right.cross(forward)]
    }

    /// Unit direction through the film point (x, y), in pixels from the top left corner of a `width` x `height` film;
    /// the centre of the first pixel is (0.5, 0.5).
    pub fn direction(&self, x: f64, y: f64, width: u32, height: u32) -> DVec3 {
        let [forward, right, up] = self.basis();
        let half = (self.yfov.to_radians() / 2.0).tan();
        let (w, h) = (f64::from(width), f64::from(height));
        let fx = (x / w * 2.0 - 1.0) * half * w / h;
        let fy = (1.0 - y / h * 2.0) * half;
        (forward + fx * right + fy * up).normalize()
    }
}
