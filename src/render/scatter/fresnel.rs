//! How much light a smooth interface reflects.

use glam::DVec3;

/// Reflectance of unpolarised light at an interface to a medium with `ratio` times the index of refraction, and the
/// cosine of the angle beyond it.
///
/// `cosine` is that of the angle of incidence, 0 to 1. Beyond the critical angle: 1 and 0.
pub(super) fn dielectric(cosine: f64, ratio: f64) -> (f64, f64) {
    let sine2_beyond = (1.0 - cosine * cosine) / (ratio * ratio);
    if sine2_beyond >= 1.0 {
        // An interface between equal media reflects nothing, not even at a right angle.
        return if ratio == 1.0 { (0.0, cosine) } else { (1.0, 0.0) };
    }
    let beyond = (1.0 - sine2_beyond).sqrt();
    let senkrecht = (cosine - ratio * beyond) / (cosine + ratio * beyond);
    let parallel = (ratio * cosine - beyond) / (ratio * cosine + beyond);
    (0.5 * (senkrecht * senkrecht + parallel * parallel), beyond)
}

/// Reflectance of unpolarised light at a conductor with the complex index `eta + i k`, for each channel.
///
/// Source: Born and Wolf, Principles of Optics, section 14.2 (7th edition), solved for real numbers.
pub(super) fn conductor(cosine: f64, eta: DVec3, k: DVec3) -> DVec3 {
    let channel = |eta: f64, k: f64| {
        let cos2 = cosine * cosine;
        let sin2 = 1.0 - cos2;
        let difference = eta * eta - k * k - sin2;
        let a2_plus_b2 = (difference * difference + 4.0 * eta * eta * k * k).sqrt();
        let a = (0.5 * (a2_plus_b2 + difference)).max(0.0).sqrt();
        let s = (a2_plus_b2 + cos2, 2.0 * a * cosine);
        let senkrecht = (s.0 - s.1) / (s.0 + s.1);
        let p = (a2_plus_b2 * cos2 + sin2 * sin2, s.1 * sin2);
        0.5 * (senkrecht + senkrecht * (p.0 - p.1) / (p.0 + p.1))
    };
    DVec3::new(channel(eta.x, k.x), channel(eta.y, k.y), channel(eta.z, k.z))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn dielectrics_reflect_as_the_closed_forms_say() {
        for n in [1.5f64, 1.0 / 1.5, 1.33, 2.4, 1.0] {
            let normal = ((n - 1.0) / (n + 1.0)).powi(2);
            // A few roundings.
            assert!((dielectric(1.0, n).0 - normal).abs() < 1e-15, "{n}");
            // Brewster's angle: only the half polarised across the plane of incidence is reflected.
            let brewster = n.atan();
            let across = ((n * n - 1.0) / (n * n + 1.0)).powi(2);
            assert!((dielectric(brewster.cos(), n).0 - 0.5 * across).abs() < 1e-15, "{n}");
        }
        assert!((dielectric(0.0, 1.5).0 - 1.0).abs() < 1e-15);
        // The critical angle from glass to air is 41.8 degrees.
        assert_eq!(dielectric(42f64.to_radians().cos(), 1.0 / 1.5).0, 1.0);
        assert!(dielectric(41.5f64.to_radians().cos(), 1.0 / 1.5).0 < 1.0);
    }

    #[test]
    fn conductors_without_absorption_are_dielectrics() {
        for cosine in [0.05, 0.3, 0.8, 1.0] {
            let ours = conductor(cosine, DVec3::splat(1.7), DVec3::ZERO).x;
            assert!((ours - dielectric(cosine, 1.7).0).abs() < 1e-14, "{cosine}");
            assert_eq!(conductor(cosine, DVec3::ZERO, DVec3::ONE), DVec3::ONE);
        }
        // Gold at 650 nm, at normal incidence: ((n - 1)^2 + k^2) / ((n + 1)^2 + k^2).
        let (n, k) = (0.166f64, 3.15f64);
        let expected = ((n - 1.0).powi(2) + k * k) / ((n + 1.0).powi(2) + k * k);
        assert!((conductor(1.0, DVec3::splat(n), DVec3::splat(k)).y - expected).abs() < 1e-14);
    }
}
