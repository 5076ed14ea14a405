//! Materials and textures.

use glam::Vec3;

/// A named material.
#[derive(Clone, Debug, PartialEq)]
pub struct Material {
    /// Name from the file, for messages and exporters.
    pub name: String,
    /// How it scatters light.
    pub bsdf: Bsdf,
    /// Radiance emitted from the front side, linear RGB; zero: none.
    pub emission: Vec3,
}

/// How a surface scatters light. Colours are linear RGB, 0 to 1.
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
        /// Index of refraction inside, relative to outside; above 0.
        ior: f32,
    },
    /// Rough conductor with the GGX distribution, on both sides.
    Conductor {
        /// Real part of the index of refraction, for R, G, B.
        eta: Vec3,
        /// Imaginary part. `eta` 0 and `k` 1 reflect everything.
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
    /// Texels in a row.
    pub width: u32,
    /// Rows.
    pub height: u32,
    /// Linear RGB, row by row from the top.
    pub texels: Vec<Vec3>,
    /// True if the source was encoded in sRGB with 8 bits: exporters write it back so.
    pub srgb: bool,
    /// How texels are combined.
    pub filter: Filter,
}
