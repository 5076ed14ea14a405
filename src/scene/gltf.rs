//! glTF 2.0 scenes: `.gltf` and `.glb`, flattened to world space.
//!
//! What is read: the default scene, else the first, else all root nodes; triangles, strips and fans; normals, one set of
//! texture coordinates, base colour textures; perspective cameras (the first one that the scene reaches);
//! `KHR_lights_punctual`, `KHR_materials_ior`, `_transmission`, `_emissive_strength`, and `KHR_mesh_quantization`.
//! Everything else is passed over with a warning where the picture would differ, or with a note where the format allows
//! it (skins, vertex colours, normal maps). An extension that the file requires and that is not in this list is an error.
//!
//! Materials become, in this order:
//! 1. a dielectric of the file's `ior` (default 1.5) where the transmission factor is above 0.5;
//! 2. a conductor where the metallic factor is at least 0.5: `eta` 0 and `k` 1 with the base colour as reflectance, GGX
//!    `alpha` the square of the roughness; a mirror if `alpha` is below 0.01;
//! 3. else Lambert of the base colour, with its texture.
//!
//! Factors of transmission, metallic and roughness are multiplied with their texture's mean; so are the base colour of
//! a conductor and the emission of any material, since these take no texture here. A primitive without a material is a
//! grey Lambert of albedo 0.5. Materials are opaque and two-sided; emission leaves from the front.
//!
//! Candela and lux are taken as W/sr and W/m^2, number for number.

mod accessor;
mod container;
mod json_check;
mod material;
mod mesh;
mod walk;

use super::SceneParts;
use super::load::{Loading, read_bytes, stem};
use crate::error::{Error, Result};
use ::gltf::json::Root;
use std::path::Path;

/// Reads a .gltf or .glb file and everything that it refers to.
///
/// # Errors
/// A file cannot be read, or breaks the format: see the messages.
pub(super) fn read(path: &Path, loading: &Loading) -> Result<SceneParts> {
    let bytes = read_bytes(path)?;
    let mut notices = Notices::new(path);
    let (json, blob) = container::split(path, &bytes)?;
    let root: Root = ::gltf::json::deserialize::from_slice(json).map_err(|e| {
        // The place is part of the parser's message.
        Error::malformed(path, format!("not a glTF document: {e}"))
    })?;
    json_check::check(path, &root, &mut notices)?;
    let budget = &loading.budget;
    let buffers = container::buffers(path, &root, blob, budget)?;
    let data = accessor::Data { path, root: &root, buffers: &buffers, budget };
    data.check_all(loading.drop_invalid)?;
    let mut parts = SceneParts { name: stem(path), ..SceneParts::default() };
    let materials = material::read_all(&data, &mut parts, &mut notices);
    walk::walk(&data, &materials, &mut parts, &mut notices)?;
    parts.warnings = notices.warnings;
    parts.notes = notices.notes;
    Ok(parts)
}

/// Warnings and notes, each text once, with the file's name.
struct Notices {
    prefix: String,
    warnings: Vec<String>,
    notes: Vec<String>,
}

impl Notices {
    fn new(path: &Path) -> Self {
        Self { prefix: path.display().to_string(), warnings: Vec::new(), notes: Vec::new() }
    }

    /// The picture may differ from what the file means.
    fn warn(&mut self, text: impl std::fmt::Display) {
        add(&mut self.warnings, format!("{}: {text}", self.prefix));
    }

    /// Something that a reader may pass over.
    fn note(&mut self, text: impl std::fmt::Display) {
        add(&mut self.notes, format!("{}: {text}", self.prefix));
    }
}

fn add(list: &mut Vec<String>, text: String) {
    /// More than this help nobody.
    const MOST: usize = 100;
    if list.len() < MOST && !list.contains(&text) {
        list.push(text);
    }
}
