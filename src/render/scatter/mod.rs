//! How a surface scatters light at one point: values, densities and samples.

mod fresnel;
mod ggx;

use super::frame::{cosine_hemisphere, from_local};
use super::tracer::Vertex;
use crate::scene::{Bsdf, Scene};
use ggx::Conductor;
use glam::DVec3;
use std::f64::consts::FRAC_1_PI;

/// What a surface does with light at one point.
#[derive(Clone, Copy, Debug)]
pub(super) enum Lobe {
    /// Diffuse reflection.
    Lambert {
        /// Reflected share, with the texture applied.
        albedo: DVec3,
    },
    /// Perfect reflection.
    Mirror {
        /// Reflected share.
        reflectance: DVec3,
    },
    /// Reflection and refraction at a smooth interface.
    Dielectric {
        /// Index of refraction on the far side, relative to the viewer's side.
        ratio: f64,
    },
    /// Reflection by a rough conductor.
    Conductor(Conductor),
}

/// A direction that light came from, chosen at random.
#[derive(Clone, Copy, Debug)]
pub(super) struct Scattered {
    /// Unit direction, away from the surface.
    pub direction: DVec3,
    /// Value times cosine over density.
    pub weight: DVec3,
    /// Density in solid angle; `None`: the only direction, or one of two.
    pub pdf: Option<f64>,
    /// Ratio of the index of refraction of the side that the direction points to, to that of the viewer's side.
    pub eta: f64,
}

/// The two directions that a smooth interface connects to the viewer's.
#[derive(Clone, Copy, Debug)]
pub(super) struct Split {
    /// Reflected share, 0 to 1; the rest is refracted.
    pub reflectance: f64,
    /// Unit direction of the mirror image.
    pub reflected: DVec3,
    /// Unit direction beyond the interface; of no meaning where `reflectance` is 1.
    pub refracted: DVec3,
}

impl Lobe {
    /// What the material at `vertex` does there.
    pub fn at(scene: &Scene, vertex: &Vertex) -> Self {
        match scene.materials[vertex.material as usize].bsdf {
            Bsdf::Lambert { albedo, texture } => {
                let factor = texture.map_or(DVec3::ONE, |t| scene.textures[t as usize].at(vertex.uv));
                Lobe::Lambert { albedo: albedo.as_dvec3() * factor }
            }
            Bsdf::Mirror { reflectance } => Lobe::Mirror { reflectance: reflectance.as_dvec3() },
            Bsdf::Dielectric { ior } => {
                let ior = f64::from(ior);
                Lobe::Dielectric { ratio: if vertex.front { ior } else { 1.0 / ior } }
            }
            Bsdf::Conductor { eta, k, reflectance, alpha } => Lobe::Conductor(Conductor {
                eta: eta.as_dvec3(),
                k: k.as_dvec3(),
                reflectance: reflectance.as_dvec3(),
                alpha: f64::from(alpha),
            }),
        }
    }

    /// True if light arrives from one or two directions only, which no light source can be connected to.
    pub fn is_delta(&self) -> bool {
        matches!(self, Lobe::Mirror { .. } | Lobe::Dielectric { .. })
    }

    /// Value times cosine for light from the unit `direction`, and the density with which [`Lobe::sample`] gives it.
    ///
    /// Zero on the far side of the shading normal; the geometric normal plays no part, as in POV-Ray and in Mitsuba's
    /// `twosided`.
    pub fn evaluate(&self, vertex: &Vertex, direction: DVec3) -> (DVec3, f64) {
        match self {
            Lobe::Lambert { albedo } => {
                let pdf = vertex.shading.dot(direction).max(0.0) * FRAC_1_PI;
                (*albedo * pdf, pdf)
            }
            Lobe::Conductor(conductor) => conductor.evaluate(vertex.shading, vertex.outgoing, direction),
            Lobe::Mirror { .. } | Lobe::Dielectric { .. } => (DVec3::ZERO, 0.0),
        }
    }

    /// A direction chosen by four uniform numbers, or `None` if the choice carries nothing.
    pub fn sample(&self, vertex: &Vertex, u: [f64; 4]) -> Option<Scattered> {
        match self {
            Lobe::Lambert { albedo } => {
                let local = cosine_hemisphere([u[0], u[1]]);
                let direction = from_local(vertex.shading, local);
                Some(Scattered { direction, weight: *albedo, pdf: Some(local.z * FRAC_1_PI), eta: 1.0 })
            }
            Lobe::Mirror { reflectance } => {
                Some(Scattered { direction: mirrored(vertex), weight: *reflectance, pdf: None, eta: 1.0 })
            }
            Lobe::Dielectric { ratio } => {
                let split = split(vertex, *ratio);
                Some(if u[2] < split.reflectance {
                    Scattered { direction: split.reflected, weight: DVec3::ONE, pdf: None, eta: 1.0 }
                } else {
                    // Radiance changes with the square of the index of refraction; Veach 1997, section 5.2.
                    let weight = DVec3::splat(1.0 / (ratio * ratio));
                    Scattered { direction: split.refracted, weight, pdf: None, eta: *ratio }
                })
            }
            Lobe::Conductor(conductor) => conductor.sample(vertex.shading, vertex.outgoing, [u[0], u[1]]),
        }
    }
}

/// The viewer's direction mirrored at the shading normal.
pub(super) fn mirrored(vertex: &Vertex) -> DVec3 {
    2.0 * vertex.shading.dot(vertex.outgoing) * vertex.shading - vertex.outgoing
}

/// Fresnel's split at an interface to a medium with `ratio` times the viewer's index of refraction.
pub(super) fn split(vertex: &Vertex, ratio: f64) -> Split {
    let cosine = vertex.shading.dot(vertex.outgoing).clamp(0.0, 1.0);
    let (reflectance, beyond) = fresnel::dielectric(cosine, ratio);
    let refracted = (cosine / ratio - beyond) * vertex.shading - vertex.outgoing / ratio;
    Split { reflectance, reflected: mirrored(vertex), refracted: refracted.normalize_or(-vertex.shading) }
}
