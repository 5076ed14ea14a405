//! What surrounds the geometry of an SPD scene: surfaces, camera, lights, background.

use super::super::stock::look;
use super::{Mesh, PIXELS, Stage};
use crate::scene::{Bsdf, Light, Material, RenderDefaults};
use glam::{DVec3, Vec3};
use std::f64::consts::PI;

/// Longest path in edges: SPD's five rays in a row, and the way to a light.
const EDGES: u32 = 6;

/// View and light of a scene.
pub(super) struct Setting<'a> {
    pub from: [f64; 3],
    pub at: [f64; 3],
    pub up: [f64; 3],
    /// Full field of view, degrees.
    pub angle: f64,
    pub lights: &'a [[f64; 3]],
    /// Where the lights have SPD's intensity; `None`: at `at`.
    pub focus: Option<[f64; 3]>,
    /// Linear RGB.
    pub background: Vec3,
    /// Pixels on a side.
    pub size: u32,
}

impl Setting<'static> {
    /// What most scenes share: z up, 45 degrees, a sky.
    pub const USUAL: Setting<'static> = Setting {
        from: [0.0; 3],
        at: [0.0; 3],
        up: [0.0, 0.0, 1.0],
        angle: 45.0,
        lights: &[],
        focus: None,
        background: Vec3::new(0.078, 0.361, 0.753),
        size: PIXELS,
    };
}

impl Setting<'_> {
    /// The stage for materials by slot, and meshes with materials of their own.
    pub fn stage(&self, palette: Vec<Material>, props: Vec<(Mesh, Material)>) -> Stage {
        let focus = DVec3::from_array(self.focus.unwrap_or(self.at));
        let scale = 0.5 / (self.lights.len() as f64).sqrt();
        let light = |&position: &[f64; 3]| {
            let position = DVec3::from_array(position);
            // A white Lambert surface that faces the light at the focus has radiance `scale`.
            let intensity = scale * PI * position.distance_squared(focus);
            Light::Point { position, intensity: Vec3::splat(intensity as f32) }
        };
        Stage {
            palette,
            props,
            lights: self.lights.iter().map(light).collect(),
            environment: self.background,
            camera: look(self.from, self.at, DVec3::from_array(self.up), self.angle),
            defaults: RenderDefaults {
                size: Some((self.size, self.size)),
                integrator: Some("whitted".into()),
                max_depth: Some(EDGES),
                spp: None,
            },
        }
    }
}

/// An opaque surface of SPD's colour, Kd and Ks: the mirror or the diffuse part of it, whichever is stronger.
pub(super) fn surface(name: &str, colour: [f32; 3], kd: f32, ks: f32) -> Material {
    let colour = Vec3::from_array(colour);
    let bsdf = if ks >= kd {
        Bsdf::Mirror { reflectance: ks * colour }
    } else {
        Bsdf::Lambert { albedo: kd * colour, texture: None }
    };
    Material { name: name.into(), bsdf, emission: Vec3::ZERO }
}

/// A transparent surface: clear glass of index of refraction `ior`.
pub(super) fn glass(ior: f32) -> Material {
    Material { name: "glass".into(), bsdf: Bsdf::Dielectric { ior }, emission: Vec3::ZERO }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lights_give_a_facing_surface_the_recommended_intensity() {
        let lights = [[3.0, 4.0, 0.0], [0.0, 0.0, 7.0], [1.0, 2.0, 2.0]];
        let stage = Setting { lights: &lights, ..Setting::USUAL }.stage(Vec::new(), Vec::new());
        for (light, distance) in stage.lights.iter().zip([5.0_f64, 7.0, 3.0]) {
            let Light::Point { intensity, .. } = light else { panic!("a point light") };
            // SPD's readme: sqrt(lights) / (2 * lights).
            let radiance = f64::from(intensity.x) / (PI * distance * distance);
            assert!((radiance - 3.0_f64.sqrt() / 6.0).abs() < 1e-6, "{radiance}");
        }
    }

    #[test]
    fn surfaces_keep_their_stronger_part() {
        let red = [1.0, 0.5, 0.0];
        let lambert = Bsdf::Lambert { albedo: Vec3::new(0.75, 0.375, 0.0), texture: None };
        assert_eq!(surface("", red, 0.75, 0.25).bsdf, lambert);
        assert_eq!(surface("", red, 0.5, 0.5).bsdf, Bsdf::Mirror { reflectance: Vec3::new(0.5, 0.25, 0.0) });
    }
}
