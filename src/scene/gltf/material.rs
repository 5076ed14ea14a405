//! Maps materials; the rule is stated in the parent module.

use super::Notices;
use super::accessor::Data;
use super::container;
use crate::scene::texture::{decode, mean};
use crate::scene::{Bsdf, Filter, Material, SceneParts, Texture};
use ::gltf::json;
use ::gltf::json::material::AlphaMode;
use ::gltf::json::texture::{Info, MagFilter, WrappingMode};
use ::gltf::json::validation::Checked;
use glam::{Vec3, Vec4};
use std::collections::HashMap;

/// What meshes need of the document's materials.
pub(super) struct Materials {
    /// Index of the grey material of primitives that have none.
    pub grey: u32,
    /// Set of texture coordinates that each of the document's materials uses, if it has a texture.
    pub coordinates: Vec<Option<u32>>,
}

/// Reads all materials, in the document's order, and the textures that they use; then the grey one.
pub(super) fn read_all(data: &Data, parts: &mut SceneParts, notices: &mut Notices) -> Materials {
    let mut textures = Textures { data, kept: HashMap::new(), means: HashMap::new() };
    let mut coordinates = Vec::new();
    for (i, material) in data.root.materials.iter().enumerate() {
        let name = material.name.clone().unwrap_or_else(|| format!("material {i}"));
        let (bsdf, set) = textures.bsdf(material, parts, notices, &name);
        let emission = textures.emission(material, notices);
        passed_over(material, notices, &name);
        let mut material = Material { name, bsdf, emission };
        if let Some(what) = material.defect() {
            notices.warn(format_args!("materials[{i}] `{}`: {what}; it becomes grey", material.name));
            material = Material { name: material.name, ..Material::grey() };
        }
        let textured = matches!(material.bsdf, Bsdf::Lambert { texture: Some(_), .. });
        coordinates.push(set.filter(|_| textured));
        parts.materials.push(material);
    }
    parts.materials.push(Material::grey());
    Materials { grey: coordinates.len() as u32, coordinates }
}

/// Says what of a material does not show.
fn passed_over(material: &json::Material, notices: &mut Notices, name: &str) {
    match material.alpha_mode {
        Checked::Valid(AlphaMode::Opaque) => {}
        _ => notices.warn(format_args!("material `{name}`: alpha is passed over, the material is opaque")),
    }
    if material.normal_texture.is_some() || material.occlusion_texture.is_some() {
        notices.note("normal and occlusion textures are passed over");
    }
}

struct Textures<'a> {
    data: &'a Data<'a>,
    /// Textures of the scene by texture of the document; `None`: not usable.
    kept: HashMap<usize, Option<u32>>,
    /// Means by image of the document, and whether its values are sRGB; `None`: not usable.
    means: HashMap<(usize, bool), Option<Vec3>>,
}

impl Textures<'_> {
    /// The scattering, and the set of texture coordinates if it has a texture.
    fn bsdf(
        &mut self,
        material: &json::Material,
        parts: &mut SceneParts,
        notices: &mut Notices,
        name: &str,
    ) -> (Bsdf, Option<u32>) {
        let pbr = &material.pbr_metallic_roughness;
        let extensions = material.extensions.as_ref();
        if let Some(t) = extensions.and_then(|e| e.transmission.as_ref()) {
            let share = self.mean_of(t.transmission_texture.as_ref(), false, notices).x;
            if t.transmission_factor.0 * share > 0.5 {
                // An ior of 0 means "no Fresnel term" to the extension; it has none of its own here.
                let ior = extensions.and_then(|e| e.ior.as_ref()).map_or(1.5, |i| i.ior.0);
                return (Bsdf::Dielectric { ior: if ior == 0.0 { 1.5 } else { ior } }, None);
            }
        }
        let base = Vec4::from_array(pbr.base_color_factor.0).truncate();
        let sampled = self.mean_of(pbr.metallic_roughness_texture.as_ref(), false, notices);
        let metallic = pbr.metallic_factor.0 * sampled.z;
        if metallic >= 0.5 {
            let roughness = pbr.roughness_factor.0 * sampled.y;
            if pbr.base_color_texture.is_some() {
                notices.warn(format_args!("material `{name}`: a metal's texture is replaced by its mean"));
            }
            let reflectance = base * self.mean_of(pbr.base_color_texture.as_ref(), true, notices);
            let alpha = roughness * roughness;
            let rough = Bsdf::Conductor { eta: Vec3::ZERO, k: Vec3::ONE, reflectance, alpha };
            return (if alpha < 0.01 { Bsdf::Mirror { reflectance } } else { rough }, None);
        }
        let texture = pbr.base_color_texture.as_ref().and_then(|info| self.keep(info, parts, notices));
        let set = pbr.base_color_texture.as_ref().map(|info| info.tex_coord);
        (Bsdf::Lambert { albedo: base, texture }, set)
    }

    fn emission(&mut self, material: &json::Material, notices: &mut Notices) -> Vec3 {
        let factor = Vec3::from_array(material.emissive_factor.0);
        if factor == Vec3::ZERO {
            return factor;
        }
        let strength = material.extensions.as_ref().and_then(|e| e.emissive_strength.as_ref());
        let strength = strength.map_or(1.0, |s| s.emissive_strength.0);
        if material.emissive_texture.is_some() {
            notices.warn("emissive textures are replaced by their means");
        }
        factor * strength * self.mean_of(material.emissive_texture.as_ref(), true, notices)
    }

    /// The scene's texture for one of the document's.
    fn keep(&mut self, info: &Info, parts: &mut SceneParts, notices: &mut Notices) -> Option<u32> {
        let t = info.index.value();
        if let Some(&known) = self.kept.get(&t) {
            return known;
        }
        let texture = self.decode(t, true, notices).filter(|texture| {
            let room = self.data.budget.take_texture(texture);
            room.map_err(|cause| notices.warn(format_args!("textures[{t}] is left out: {cause}"))).is_ok()
        });
        let index = texture.map(|texture| {
            parts.textures.push(texture);
            parts.textures.len() as u32 - 1
        });
        self.kept.insert(t, index);
        index
    }

    /// The mean of a texture, linear RGB; white where there is none.
    fn mean_of(&mut self, info: Option<&Info>, srgb: bool, notices: &mut Notices) -> Vec3 {
        let Some(t) = info.map(|info| info.index.value()) else { return Vec3::ONE };
        let Some(image) = self.data.root.textures.get(t).map(|t| t.source.value()) else { return Vec3::ONE };
        let known = self.means.get(&(image, srgb)).copied();
        let mean = known.unwrap_or_else(|| self.decode(t, srgb, notices).map(|texture| mean(&texture)));
        self.means.insert((image, srgb), mean);
        mean.unwrap_or(Vec3::ONE)
    }

    /// A texture that cannot be had is white, with a warning.
    fn decode(&self, t: usize, srgb: bool, notices: &mut Notices) -> Option<Texture> {
        let root = self.data.root;
        let texture = root.textures.get(t)?;
        let sampler = texture.sampler.and_then(|s| root.samplers.get(s.value()));
        let nearest = Some(Checked::Valid(MagFilter::Nearest));
        let filter = if sampler.is_some_and(|s| s.mag_filter == nearest) { Filter::Nearest } else { Filter::Bilinear };
        let repeats = |wrap| wrap == Checked::Valid(WrappingMode::Repeat);
        if sampler.is_some_and(|s| !repeats(s.wrap_s) || !repeats(s.wrap_t)) {
            notices.note("textures that are clamped or mirrored at their edges repeat instead");
        }
        let i = texture.source.value();
        let image = root.images.get(i)?;
        let label = image.uri.as_deref().filter(|uri| !uri.starts_with("data:")).or(image.name.as_deref());
        let label = label.map_or_else(|| format!("image {i}"), str::to_owned);
        let decoded =
            container::image(self.data, image).and_then(|bytes| decode(&bytes, &label, srgb, filter, self.data.budget));
        decoded.map_err(|cause| notices.warn(format_args!("images[{i}] `{label}` is left out: {cause}"))).ok()
    }
}
