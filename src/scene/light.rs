//! Lights without extent. Lights with extent are primitives with an emissive material.

use glam::{DVec3, Vec3};

/// A light without extent. Radiant quantities are linear RGB, finite and not negative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Light {
    /// Shines equally in all directions.
    Point {
        /// World units.
        position: DVec3,
        /// Radiant intensity, W/sr.
        intensity: Vec3,
    },
    /// Shines within a cone.
    Spot {
        /// World units.
        position: DVec3,
        /// Unit axis of the cone.
        direction: DVec3,
        /// Radiant intensity on the axis, W/sr.
        intensity: Vec3,
        /// Angle between axis and edge, degrees, above 0 and at most 90: dark beyond it.
        cutoff: f64,
        /// Full intensity within this angle of the axis, degrees, from 0 to `cutoff`; between the two it falls linearly
        /// with the angle, as Mitsuba's does. Equal to `cutoff`: a hard cone.
        beam_width: f64,
    },
    /// Shines from infinitely far away.
    Directional {
        /// Unit direction in which the light travels.
        direction: DVec3,
        /// Irradiance on a surface that faces the light, W/m^2.
        irradiance: Vec3,
    },
}

impl Light {
    /// The first value outside its range, in words.
    pub(super) fn defect(&self) -> Option<String> {
        let point = |what: &str, p: DVec3| (!p.is_finite()).then(|| format!("{what} {p} is not finite"));
        let unit = |p: DVec3| (!p.is_normalized()).then(|| format!("direction {p} is not a unit vector"));
        let radiant = |what: &str, c: Vec3| {
            let good = c.is_finite() && c.min_element() >= 0.0;
            (!good).then(|| format!("{what} {c} is not finite or negative"))
        };
        match *self {
            Light::Point { position, intensity } => {
                point("position", position).or_else(|| radiant("intensity", intensity))
            }
            Light::Spot { position, direction, intensity, cutoff, beam_width } => point("position", position)
                .or_else(|| unit(direction))
                .or_else(|| radiant("intensity", intensity))
                .or_else(|| {
                    (!(cutoff > 0.0 && cutoff <= 90.0))
                        .then(|| format!("cutoff {cutoff} is not within 0 to 90 degrees"))
                })
                .or_else(|| {
                    let good = beam_width >= 0.0 && beam_width <= cutoff;
                    (!good).then(|| format!("beam width {beam_width} is not within 0 and the cutoff {cutoff}"))
                }),
            Light::Directional { direction, irradiance } => {
                unit(direction).or_else(|| radiant("irradiance", irradiance))
            }
        }
    }
}
