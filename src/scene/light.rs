//! Lights without extent. Lights with extent are primitives with an emissive material.

use glam::{DVec3, Vec3};

/// A light without extent. Radiant quantities are linear RGB.
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
        /// Angle between axis and edge, degrees, 0 to 90: dark beyond it.
        cutoff: f64,
        /// Full intensity within this angle of the axis, degrees, at most `cutoff`; between the two it falls linearly
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
