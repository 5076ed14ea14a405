//! Rough conductors: the GGX distribution with Smith's masking, as Mitsuba's `roughconductor` has them.

use super::super::frame::{from_local, polar, to_local};
use super::{Scattered, fresnel};
use glam::DVec3;
use std::f64::consts::PI;

/// A rough conductor.
///
/// Value: `F D G1(o) G1(i) / (4 cos_o cos_i)`, the masking of the two directions taken as independent.
/// Source: Walter et al. 2007, "Microfacet Models for Refraction through Rough Surfaces", equations 20, 33 and 34.
#[derive(Clone, Copy, Debug)]
pub(in super::super) struct Conductor {
    /// Real part of the index of refraction.
    pub eta: DVec3,
    /// Imaginary part.
    pub k: DVec3,
    /// Factor on the reflected radiance.
    pub reflectance: DVec3,
    /// Roughness.
    pub alpha: f64,
}

impl Conductor {
    /// Value times cosine for light from `incoming`, and the density with which [`Conductor::sample`] gives it.
    /// All directions have unit length and point away from the surface.
    pub fn evaluate(&self, normal: DVec3, outgoing: DVec3, incoming: DVec3) -> (DVec3, f64) {
        let (cos_out, cos_in) = (normal.dot(outgoing), normal.dot(incoming));
        if !(cos_out > 0.0 && cos_in > 0.0) {
            return (DVec3::ZERO, 0.0);
        }
        let half = (outgoing + incoming).normalize();
        let pdf = self.distribution(normal, half) * self.visible(cos_out) / (4.0 * cos_out);
        (self.colour(half.dot(outgoing)) * pdf * self.visible(cos_in), pdf)
    }

    /// A direction mirrored at a microfacet that `outgoing` sees; `None` if it points into the surface.
    ///
    /// Source: Dupuy and Benyoub 2023, "Sampling Visible GGX Normals with Spherical Caps".
    pub fn sample(&self, normal: DVec3, outgoing: DVec3, u: [f64; 2]) -> Option<Scattered> {
        let stretch = DVec3::new(self.alpha, self.alpha, 1.0);
        let view = (to_local(normal, outgoing) * stretch).normalize();
        let cap = polar((1.0 - u[0]) * (1.0 + view.z) - view.z, u[1]);
        let half = from_local(normal, ((cap + view) * stretch).normalize());
        let direction = 2.0 * half.dot(outgoing) * half - outgoing;
        let (cos_out, cos_in) = (normal.dot(outgoing), normal.dot(direction));
        if !(cos_out > 0.0 && cos_in > 0.0) {
            return None;
        }
        let pdf = self.distribution(normal, half) * self.visible(cos_out) / (4.0 * cos_out);
        let weight = self.colour(half.dot(outgoing)) * self.visible(cos_in);
        Some(Scattered { direction, weight, pdf: Some(pdf), eta: 1.0 })
    }

    fn colour(&self, cosine: f64) -> DVec3 {
        fresnel::conductor(cosine.clamp(0.0, 1.0), self.eta, self.k) * self.reflectance
    }

    /// Density of microfacet normals, per projected area and solid angle.
    fn distribution(&self, normal: DVec3, half: DVec3) -> f64 {
        let alpha2 = self.alpha * self.alpha;
        let cosine = normal.dot(half).max(0.0);
        // The sine from the cross product keeps its digits where the angle is small.
        let sine2 = normal.cross(half).length_squared();
        let t = cosine * cosine + sine2 / alpha2;
        1.0 / (PI * alpha2 * t * t)
    }

    /// Share of the facets that a direction with this cosine, above 0, sees.
    fn visible(&self, cosine: f64) -> f64 {
        let tangent2 = (1.0 - cosine * cosine).max(0.0) / (cosine * cosine);
        2.0 / (1.0 + (1.0 + self.alpha * self.alpha * tangent2).sqrt())
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::render::Sampler;
    use crate::render::sampler::PixelSamples;

    fn perfect(alpha: f64) -> Conductor {
        Conductor { eta: DVec3::ZERO, k: DVec3::ONE, reflectance: DVec3::ONE, alpha }
    }

    #[test]
    fn samples_follow_their_density() {
        // The mean of weight over samples is the integral of value times cosine: taken over a uniform grid of
        // directions it must be the same.
        let normal = DVec3::new(0.2, 0.5, -0.7).normalize();
        for (alpha, tilt) in [(0.6, 0.3), (1.0, 1.2), (0.35, 0.9)] {
            let surface = perfect(alpha);
            let outgoing = from_local(normal, polar(f64::cos(tilt), 0.3));
            let pixel = PixelSamples::new(Sampler::Sobol(4096), 1, 0, 0);
            let (mut mean, mut upward, mut by_grid, mut density) = (0.0, 0.0, 0.0, 0.0);
            for i in 0..4096 {
                let [a, b, ..] = pixel.sample(i).four(0);
                if let Some(s) = surface.sample(normal, outgoing, [a, b]) {
                    let (value, pdf) = surface.evaluate(normal, outgoing, s.direction);
                    // Equal formulas, but the half vector is recomputed.
                    let given = s.pdf.expect("a rough surface has a density");
                    assert!((pdf - given).abs() < 1e-9 * pdf, "{pdf} {given}");
                    assert!((value.x / pdf - s.weight.x).abs() < 1e-9, "{value} {}", s.weight);
                    mean += s.weight.x / 4096.0;
                    upward += 1.0 / 4096.0;
                }
                let (value, pdf) = surface.evaluate(normal, outgoing, from_local(normal, polar(a, b)));
                by_grid += value.x * 2.0 * PI / 4096.0;
                density += pdf * 2.0 * PI / 4096.0;
            }
            // 4096 low-discrepancy points: the peak of the widest lobe here is resolved to about 1 %.
            assert!((mean - by_grid).abs() < 0.01, "{alpha} {tilt}: {mean} {by_grid}");
            assert!((upward - density).abs() < 0.01, "{alpha} {tilt}: {upward} {density}");
        }
    }

    #[test]
    fn smooth_conductors_lose_nothing_and_all_are_reciprocal() {
        let normal = DVec3::Z;
        for tilt in [0.0, 0.5, 1.0] {
            let outgoing = polar(f64::cos(tilt), 0.1);
            let sample = perfect(1e-3).sample(normal, outgoing, [0.4, 0.7]).expect("nearly a mirror");
            // Masking takes about (alpha tan)^2 / 4 for each direction, here below 1e-6.
            assert!((sample.weight - DVec3::ONE).abs().max_element() < 2e-6, "{tilt} {}", sample.weight);
        }
        let (a, b) = (polar(0.9, 0.2), polar(0.3, 0.6));
        let rough = perfect(0.4);
        let (there, back) = (rough.evaluate(normal, a, b).0.x / b.z, rough.evaluate(normal, b, a).0.x / a.z);
        assert!((there - back).abs() < 1e-14 * there);
    }
}
