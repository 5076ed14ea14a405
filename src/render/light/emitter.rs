//! One light: what arrives from it at a point.

use super::super::frame::{from_local, polar};
use super::luminance;
use crate::geometry::Sphere;
use crate::scene::Light;
use glam::DVec3;
use std::f64::consts::{PI, TAU};

/// Where a shadow ray ends.
#[derive(Clone, Copy, Debug)]
pub(in super::super) enum Target {
    /// At the place, in world units, of this one of [`super::Lights::points`].
    Point(DVec3, usize),
    /// At a point of a surface with this unit normal on its shining side.
    Surface(DVec3, DVec3),
    /// Nowhere.
    Infinity,
}

/// Light that arrives at a point if nothing is in its way.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Arrival {
    /// Where it comes from.
    pub target: Target,
    /// Unit direction to the light.
    pub direction: DVec3,
    /// Radiance; for lights without extent irradiance on a surface that faces them.
    pub radiance: DVec3,
}

impl Arrival {
    /// The same with another amount of light.
    pub fn scaled(self, factor: f64) -> Self {
        Self { radiance: self.radiance * factor, ..self }
    }
}

/// A light without extent.
#[derive(Clone, Copy, Debug)]
pub(in super::super) enum Emitter {
    /// See [`Light::Point`]; `number` is its index in [`super::Lights::points`].
    Point { number: usize, position: DVec3, intensity: DVec3 },
    /// See [`Light::Spot`]; angles in radians.
    Spot { number: usize, position: DVec3, axis: DVec3, intensity: DVec3, cutoff: f64, beam: f64 },
    /// See [`Light::Directional`].
    Directional { towards: DVec3, irradiance: DVec3 },
}

impl Emitter {
    /// The light, unless it is dark; `number` is its own if it has a position.
    pub fn new(light: &Light, number: usize) -> Option<Self> {
        match *light {
            Light::Point { position, intensity } => {
                let intensity = intensity.as_dvec3();
                (intensity.max_element() > 0.0).then_some(Emitter::Point { number, position, intensity })
            }
            Light::Spot { position, direction, intensity, cutoff, beam_width } => {
                let intensity = intensity.as_dvec3();
                let (cutoff, beam) = (cutoff.to_radians(), beam_width.to_radians());
                let axis = direction.normalize();
                let spot = Emitter::Spot { number, position, axis, intensity, cutoff, beam };
                (intensity.max_element() > 0.0).then_some(spot)
            }
            Light::Directional { direction, irradiance } => {
                let irradiance = irradiance.as_dvec3();
                let towards = -direction.normalize();
                (irradiance.max_element() > 0.0).then_some(Emitter::Directional { towards, irradiance })
            }
        }
    }

    /// Where it is, world units; `None` for a directional light.
    pub fn position(&self) -> Option<DVec3> {
        match *self {
            Emitter::Point { position, .. } | Emitter::Spot { position, .. } => Some(position),
            Emitter::Directional { .. } => None,
        }
    }

    /// Radiated power, W, of luminance; for a directional light, that which enters a sphere of `radius`.
    pub fn power(&self, radius: f64) -> f64 {
        match *self {
            Emitter::Point { intensity, .. } => 4.0 * PI * luminance(intensity),
            Emitter::Spot { intensity, cutoff, beam, .. } => {
                TAU * (1.0 - 0.5 * (cutoff.cos() + beam.cos())) * luminance(intensity)
            }
            Emitter::Directional { irradiance, .. } => PI * radius * radius * luminance(irradiance),
        }
    }

    /// What arrives at `position`; `None` outside the cone of a spot light.
    pub fn arrival(&self, position: DVec3) -> Option<Arrival> {
        match *self {
            Emitter::Point { number, position: at, intensity } => Some(arrival_from(at, number, position, intensity)),
            Emitter::Spot { number, position: at, axis, intensity, cutoff, beam } => {
                let arrival = arrival_from(at, number, position, intensity);
                let angle = (-arrival.direction).dot(axis).clamp(-1.0, 1.0).acos();
                if angle <= beam {
                    Some(arrival)
                } else {
                    (angle < cutoff).then(|| arrival.scaled((cutoff - angle) / (cutoff - beam)))
                }
            }
            Emitter::Directional { towards, irradiance } => {
                Some(Arrival { target: Target::Infinity, direction: towards, radiance: irradiance })
            }
        }
    }
}

fn arrival_from(at: DVec3, number: usize, position: DVec3, intensity: DVec3) -> Arrival {
    let way = at - position;
    let distance2 = way.length_squared();
    Arrival { target: Target::Point(at, number), direction: way / distance2.sqrt(), radiance: intensity / distance2 }
}

/// A primitive that shines from its front side.
#[derive(Clone, Copy, Debug)]
pub(super) struct Extended {
    /// Its index.
    pub prim: u32,
    radiance: DVec3,
    area: f64,
    shape: Shape,
}

#[derive(Clone, Copy, Debug)]
enum Shape {
    Triangle { corners: [DVec3; 3], normal: DVec3 },
    Sphere { centre: DVec3, radius: f64 },
}

impl Extended {
    /// A triangle, unless it has no area.
    pub fn triangle(prim: u32, corners: [DVec3; 3], radiance: DVec3) -> Option<Self> {
        let [a, b, c] = corners;
        let normal = (b - a).cross(c - a);
        let area = normal.length() / 2.0;
        let shape = Shape::Triangle { corners, normal: normal.normalize_or_zero() };
        (area > 0.0 && area.is_finite()).then_some(Self { prim, radiance, area, shape })
    }

    /// A sphere, unless it has no area.
    pub fn sphere(prim: u32, sphere: &Sphere, radiance: DVec3) -> Option<Self> {
        let radius = f64::from(sphere.radius);
        let usable = radius > 0.0 && radius.is_finite() && sphere.centre.is_finite();
        let shape = Shape::Sphere { centre: sphere.centre.as_dvec3(), radius };
        usable.then_some(Self { prim, radiance, area: 4.0 * PI * radius * radius, shape })
    }

    /// Radiated power, W, of luminance.
    pub fn power(&self) -> f64 {
        PI * self.area * luminance(self.radiance)
    }

    /// What arrives from a point chosen by two uniform numbers, and the density of its direction in solid angle.
    ///
    /// Triangles are sampled by area, spheres by the solid angle of the cone in which they are seen.
    pub fn sample(&self, position: DVec3, u: [f64; 2]) -> Option<(Arrival, f64)> {
        let (point, normal) = match self.shape {
            Shape::Triangle { corners: [a, b, c], normal } => {
                let root = u[0].sqrt();
                (a * (1.0 - root) + b * (root * (1.0 - u[1])) + c * (root * u[1]), normal)
            }
            Shape::Sphere { centre, radius } => {
                let normal = seen_normal(centre - position, radius, u)?;
                (centre + normal * radius, normal)
            }
        };
        let density = self.pdf(position, point);
        let direction = (point - position).normalize();
        let arrival = Arrival { target: Target::Surface(point, normal), direction, radiance: self.radiance };
        (density > 0.0).then_some((arrival, density))
    }

    /// Density in solid angle with which [`Extended::sample`] gives the direction from `position` to `point` on the
    /// primitive; 0 behind it.
    pub fn pdf(&self, position: DVec3, point: DVec3) -> f64 {
        match self.shape {
            Shape::Triangle { normal, .. } => {
                let way = point - position;
                let distance2 = way.length_squared();
                let cosine = -way.dot(normal) / distance2.sqrt();
                if cosine > 0.0 { distance2 / (cosine * self.area) } else { 0.0 }
            }
            Shape::Sphere { centre, radius } => {
                cap(centre - position, radius).map_or(0.0, |height| 1.0 / (TAU * height))
            }
        }
    }
}

/// One minus the cosine of the half angle under which a sphere is seen, `to_centre` away; `None` from inside.
fn cap(to_centre: DVec3, radius: f64) -> Option<f64> {
    let sine2 = radius * radius / to_centre.length_squared();
    // 1 - cos = sin^2 / (1 + cos) keeps the digits of small angles.
    (sine2 < 1.0).then(|| sine2 / (1.0 + (1.0 - sine2).sqrt()))
}

/// The normal where a direction that is uniform in the sphere's cone first meets it; `None` from inside.
fn seen_normal(to_centre: DVec3, radius: f64, u: [f64; 2]) -> Option<DVec3> {
    let distance = to_centre.length();
    let drop = u[0] * cap(to_centre, radius)?;
    let sine2 = drop * (2.0 - drop);
    let ratio = distance / radius;
    // Law of sines: angle at the centre between the way back and the point.
    let sine_at_point = (sine2.sqrt() * ratio).min(1.0);
    let (sine, cosine) = (sine2.sqrt(), 1.0 - drop);
    let cosine_at_centre = sine_at_point * sine + (1.0 - sine_at_point * sine_at_point).sqrt() * cosine;
    Some(from_local(-to_centre / distance, polar(cosine_at_centre.clamp(-1.0, 1.0), u[1])))
}
