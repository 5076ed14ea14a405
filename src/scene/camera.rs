//! The pinhole camera, with POV-Ray's and Mitsuba's pixel grid.

use crate::ray::Aabb;
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
    /// A camera that sees all of `bounds`, filling a square picture, from the front, right and above; `+y` is up.
    /// Vertical field of view 40 degrees. Empty bounds are seen as a unit ball at the origin.
    pub fn framed(bounds: &Aabb) -> Self {
        let (min, max) = if bounds.is_empty() {
            (DVec3::splat(-0.5), DVec3::splat(0.5))
        } else {
            (bounds.min.as_dvec3(), bounds.max.as_dvec3())
        };
        let (target, half) = ((min + max) / 2.0, (max - min) / 2.0);
        let backward = DVec3::new(0.6, 0.36, 0.8).normalize();
        let (yfov, [forward, right, up]) = (40.0_f64, basis(-backward, DVec3::Y));
        let tan = (yfov.to_radians() / 2.0).tan();
        // The least distance from which each corner of the box is inside the picture.
        let distance = (0..8)
            .map(|corner: u8| {
                let sign = |axis: u8| if corner >> axis & 1 == 1 { 1.0 } else { -1.0 };
                let p = half * DVec3::new(sign(0), sign(1), sign(2));
                p.dot(right).abs().max(p.dot(up).abs()) / tan - p.dot(forward)
            })
            .fold(0.0, f64::max);
        // A point has no extent: any distance that its coordinates can resolve.
        let least = 1e-3 * target.abs().max_element().max(f64::from(f32::MIN_POSITIVE));
        let origin = target - forward * (1.05 * distance).max(least);
        Self { origin, target, up: DVec3::Y, yfov, source: CameraSource::Framed }
    }

    /// What makes the camera unusable, in words.
    pub(super) fn defect(&self) -> Option<String> {
        let finite = self.origin.is_finite() && self.target.is_finite() && self.up.is_finite();
        if !finite {
            Some(format!("origin {}, target {} or up {} is not finite", self.origin, self.target, self.up))
        } else if !(self.yfov > 0.0 && self.yfov < 180.0) {
            Some(format!("field of view {} is not between 0 and 180 degrees", self.yfov))
        } else if !self.basis().iter().all(|v| v.is_normalized()) {
            Some(format!("origin {}, target {} and up {} span no plane", self.origin, self.target, self.up))
        } else {
            None
        }
    }

    /// Forward, right and up: an orthonormal basis. NaN where the camera has no view: `target` is `origin`, or `up` is
    /// parallel to it.
    pub fn basis(&self) -> [DVec3; 3] {
        basis(self.target - self.origin, self.up)
    }

    /// Unit direction through the film point (x, y), in pixels from the top left corner of a `width` x `height` film, both
    /// above 0; the centre of the first pixel is (0.5, 0.5). Points beyond the film are as good.
    pub fn direction(&self, x: f64, y: f64, width: u32, height: u32) -> DVec3 {
        let [forward, right, up] = self.basis();
        let half = (self.yfov.to_radians() / 2.0).tan();
        let (w, h) = (f64::from(width), f64::from(height));
        let fx = (x / w * 2.0 - 1.0) * half * w / h;
        let fy = (1.0 - y / h * 2.0) * half;
        (forward + fx * right + fy * up).normalize()
    }
}

fn basis(view: DVec3, up: DVec3) -> [DVec3; 3] {
    let forward = view.normalize();
    let right = forward.cross(up).normalize();
    [forward, right, right.cross(forward)]
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn framed_camera_sees_every_corner_and_fills_the_picture() {
        let bounds = Aabb { min: Vec3::new(-3.0, 0.0, 10.0), max: Vec3::new(5.0, 1.0, 12.0) };
        let camera = Camera::framed(&bounds);
        let [forward, right, up] = camera.basis();
        let tan = 20_f64.to_radians().tan();
        let mut widest = 0.0_f64;
        for corner in 0..8 {
            let pick = |axis: usize| if corner >> axis & 1 == 1 { bounds.max[axis] } else { bounds.min[axis] };
            let p = Vec3::new(pick(0), pick(1), pick(2)).as_dvec3() - camera.origin;
            let depth = p.dot(forward) * tan;
            assert!(depth > 0.0);
            widest = widest.max(p.dot(right).abs() / depth).max(p.dot(up).abs() / depth);
        }
        assert!(widest > 0.9 && widest < 1.0, "{widest}");
    }

    #[test]
    fn any_bounds_give_a_usable_camera() {
        let far = Vec3::splat(1e30);
        for bounds in [Aabb::EMPTY, Aabb { min: far, max: far }, Aabb { min: Vec3::ZERO, max: Vec3::ZERO }] {
            assert_eq!(Camera::framed(&bounds).defect(), None, "{bounds:?}");
        }
    }

    #[test]
    fn unusable_cameras_are_told() {
        let good = Camera::framed(&Aabb::EMPTY);
        let bad = [
            Camera { yfov: 0.0, ..good },
            Camera { yfov: 180.0, ..good },
            Camera { target: good.origin, ..good },
            Camera { up: good.target - good.origin, ..good },
            Camera { origin: DVec3::NAN, ..good },
        ];
        for camera in bad {
            assert!(camera.defect().is_some(), "{camera:?}");
        }
    }
}
