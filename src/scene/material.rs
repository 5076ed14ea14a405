//! Materials and textures.

use glam::Vec3;

/// A named material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name from the file, for messages and exporters.
    pub name: String,
    /// How it scatters light.
    pub bsdf: Bsdf,
    /// Radiance emitted from the front side, linear RGB, finite and not negative; zero: none.
    pub emission: Vec3,
}

impl Material {
    /// The material of whatever has none: Lambert, albedo 0.5.
    pub fn grey() -> Self {
        let bsdf = Bsdf::Lambert { albedo: Vec3::splat(0.5), texture: None };
        Self { name: "grey".into(), bsdf, emission: Vec3::ZERO }
    }

    /// The first value outside its range, in words.
    pub(super) fn defect(&self) -> Option<String> {
        let share = |what: &str, c: Vec3| {
            let good = c.is_finite() && c.min_element() >= 0.0 && c.max_element() <= 1.0;
            (!good).then(|| format!("{what} {c} is not within 0 to 1"))
        };
        let radiance = |what: &str, c: Vec3| {
            let good = c.is_finite() && c.min_element() >= 0.0;
            (!good).then(|| format!("{what} {c} is not finite or negative"))
        };
        radiance("emission", self.emission).or_else(|| match self.bsdf {
            Bsdf::Lambert { albedo, .. } => share("albedo", albedo),
            Bsdf::Mirror { reflectance } => share("reflectance", reflectance),
            Bsdf::Dielectric { ior } => {
                (!(ior > 0.0 && ior.is_finite())).then(|| format!("index of refraction {ior} is not above 0"))
            }
            Bsdf::Conductor { eta, k, reflectance, alpha } => radiance("eta", eta)
                .or_else(|| radiance("k", k))
                .or_else(|| share("reflectance", reflectance))
                .or_else(|| (!(alpha > 0.0 && alpha <= 1.0)).then(|| format!("alpha {alpha} is not within 0 to 1"))),
        })
    }
}

/// How a surface scatters light. Albedo and reflectance are linear RGB, 0 to 1.
#[derive(Clone, Debug, PartialEq)]
pub enum Bsdf {
    /// Diffuse, on both sides.
    Lambert {
        /// Reflected share, multiplied with the texture if there is one.
        albedo: Vec3,
        /// Index in [`crate::scene::Scene::textures`].
        texture: Option<u32>,
    },
    /// Perfect mirror, on both sides.
    Mirror {
        /// Reflected share.
        reflectance: Vec3,
    },
    /// Smooth dielectric; the front side looks out of the medium.
    Dielectric {
        /// Index of refraction inside, relative to outside; above 0, finite.
        ior: f32,
    },
    /// Rough conductor with the GGX distribution, on both sides.
    Conductor {
        /// Real part of the index of refraction, for R, G, B; finite, not negative.
        eta: Vec3,
        /// Imaginary part, finite, not negative. `eta` 0 and `k` 1 reflect everything.
        k: Vec3,
        /// Factor on the reflected radiance.
        reflectance: Vec3,
        /// GGX roughness, above 0 and at most 1.
        alpha: f32,
    },
}

/// How texels are combined.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Filter {
    /// The texel whose square contains the point.
    Nearest,
    /// Bilinear between texel centres at (i + 0.5) / width.
    Bilinear,
}

/// A picture that repeats over the plane. Row 0 is at v = 0, the top.
#[derive(Clone, Debug, PartialEq)]
pub struct Texture {
    /// Name or path from the file.
    pub name: String,
    /// Texels in a row, above 0.
    pub width: u32,
    /// Rows, above 0.
    pub height: u32,
    /// Linear RGB, row by row from the top; `width * height` entries.
    pub texels: Vec<Vec3>,
    /// True if the source was encoded in sRGB with 8 bits: exporters write it back so.
    pub srgb: bool,
    /// How texels are combined.
    pub filter: Filter,
}
