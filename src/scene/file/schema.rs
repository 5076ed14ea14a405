//! The tables and keys of a scene file, as they are written; checked by the parent module.

use serde::Deserialize;
use toml::Spanned;

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct SceneFile {
    pub name: Option<String>,
    pub environment: Option<Spanned<[f32; 3]>>,
    pub camera: Option<Spanned<Camera>>,
    pub render: Option<Spanned<Render>>,
    #[serde(default)]
    pub texture: Vec<Spanned<Texture>>,
    #[serde(default)]
    pub material: Vec<Spanned<Material>>,
    #[serde(default)]
    pub sphere: Vec<Spanned<Sphere>>,
    #[serde(default)]
    pub quad: Vec<Spanned<Quad>>,
    #[serde(default)]
    pub mesh: Vec<Spanned<Mesh>>,
    #[serde(default)]
    pub triangles: Vec<Spanned<Triangles>>,
    #[serde(default)]
    pub procedural: Vec<Spanned<Procedural>>,
    #[serde(default)]
    pub light: Vec<Spanned<Light>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Camera {
    pub origin: [f64; 3],
    pub target: [f64; 3],
    pub up: Option<[f64; 3]>,
    pub yfov: f64,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Render {
    pub width: Option<u32>,
    pub height: Option<u32>,
    pub integrator: Option<String>,
    pub max_depth: Option<u32>,
    pub spp: Option<u32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Texture {
    pub name: String,
    pub file: String,
    pub srgb: Option<bool>,
    pub filter: Option<String>,
}

/// All keys of all types; which belong together is checked later, since a tagged enum would lose the line numbers.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Material {
    pub name: String,
    #[serde(rename = "type")]
    pub kind: String,
    pub emission: Option<[f32; 3]>,
    pub albedo: Option<[f32; 3]>,
    pub texture: Option<Spanned<String>>,
    pub reflectance: Option<[f32; 3]>,
    pub ior: Option<f32>,
    pub eta: Option<[f32; 3]>,
    pub k: Option<[f32; 3]>,
    pub alpha: Option<f32>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Sphere {
    pub centre: [f32; 3],
    pub radius: f32,
    pub material: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Quad {
    pub corner: [f64; 3],
    pub u: [f64; 3],
    pub v: [f64; 3],
    pub repeat: Option<[f32; 2]>,
    pub material: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Mesh {
    pub file: String,
    pub material: Option<Spanned<String>>,
    pub smooth: Option<bool>,
    pub scale: Option<Scale>,
    pub rotate: Option<[f64; 3]>,
    pub translate: Option<[f64; 3]>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Triangles {
    pub positions: Vec<[f32; 3]>,
    pub indices: Vec<[u32; 3]>,
    #[serde(default)]
    pub normals: Vec<[f32; 3]>,
    #[serde(default)]
    pub uvs: Vec<[f32; 2]>,
    pub material: Option<Spanned<String>>,
}

#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Procedural {
    #[serde(rename = "type")]
    pub kind: String,
    pub n: Option<u64>,
    pub depth: Option<u64>,
    pub seed: Option<u64>,
    pub sides: Option<u64>,
    pub balls: Option<u64>,
    #[serde(default)]
    pub materials: Vec<Spanned<String>>,
    pub scale: Option<Scale>,
    pub rotate: Option<[f64; 3]>,
    pub translate: Option<[f64; 3]>,
}

/// All keys of all types, as for materials.
#[derive(Deserialize)]
#[serde(deny_unknown_fields)]
pub(super) struct Light {
    #[serde(rename = "type")]
    pub kind: String,
    pub position: Option<[f64; 3]>,
    pub direction: Option<[f64; 3]>,
    pub intensity: Option<[f32; 3]>,
    pub irradiance: Option<[f32; 3]>,
    pub cutoff: Option<f64>,
    pub beam_width: Option<f64>,
}

#[derive(Clone, Copy, Deserialize)]
#[serde(untagged, expecting = "expected a number or [x, y, z]")]
pub(super) enum Scale {
    Uniform(f64),
    Axes([f64; 3]),
}

/// The keys that place a mesh or a procedural body.
pub(super) struct Place {
    pub scale: Option<Scale>,
    pub rotate: Option<[f64; 3]>,
    pub translate: Option<[f64; 3]>,
}
