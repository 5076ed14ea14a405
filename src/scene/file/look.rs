//! Reads what gives a scene its look: camera, render defaults, textures, materials and lights.

use super::{Reader, schema};
use crate::error::{Error, Result};
use crate::scene::load::read_bytes;
use crate::scene::texture::keep;
use crate::scene::{Bsdf, Camera, CameraSource, Filter, Light, Material, RenderDefaults, SceneParts, Texture};
use glam::{DVec3, Vec3};
use toml::Spanned;

impl Reader<'_> {
    pub(super) fn radiance(&self, at: usize, what: &str, c: [f32; 3]) -> Result<Vec3> {
        let c = self.point(at, what, c)?;
        if c.min_element() >= 0.0 { Ok(c) } else { Err(self.fail(at, format!("{what}: {c} is negative"))) }
    }

    pub(super) fn camera(&self, camera: Spanned<schema::Camera>) -> Result<Camera> {
        let at = camera.span().start;
        let schema::Camera { origin, target, up, yfov } = camera.into_inner();
        let camera = Camera {
            origin: DVec3::from_array(origin),
            target: DVec3::from_array(target),
            up: DVec3::from_array(up.unwrap_or([0.0, 1.0, 0.0])),
            yfov,
            source: CameraSource::File,
        };
        camera.defect().map_or(Ok(camera), |what| Err(self.fail(at, format!("camera: {what}"))))
    }

    pub(super) fn render(&self, render: Spanned<schema::Render>) -> Result<RenderDefaults> {
        let at = render.span().start;
        let schema::Render { width, height, integrator, max_depth, spp } = render.into_inner();
        let numbers = [("width", width), ("height", height), ("max_depth", max_depth), ("spp", spp)];
        if let Some((what, _)) = numbers.iter().find(|(_, n)| n.is_some_and(|n| n == 0 || n > 1 << 24)) {
            return Err(self.fail(at, format!("render: {what} is not within 1 to {}", 1 << 24)));
        }
        if let Some(name) = integrator.as_deref().filter(|i| !["path", "whitted"].contains(i)) {
            return Err(self.fail(at, format!("render: integrator `{name}` is neither `path` nor `whitted`")));
        }
        let size = width.or(height).zip(height.or(width));
        Ok(RenderDefaults { size, integrator, max_depth, spp })
    }

    pub(super) fn texture(&self, texture: Spanned<schema::Texture>, parts: &SceneParts) -> Result<Texture> {
        let at = texture.span().start;
        let schema::Texture { name, file, srgb, filter } = texture.into_inner();
        if parts.textures.iter().any(|t| t.name == name) {
            return Err(self.fail(at, format!("a second texture `{name}`")));
        }
        let filter = match filter.as_deref() {
            None | Some("bilinear") => Filter::Bilinear,
            Some("nearest") => Filter::Nearest,
            Some(other) => {
                return Err(self.fail(at, format!("filter `{other}` is neither `bilinear` nor `nearest`")));
            }
        };
        let path = self.beside(&file);
        let bytes = read_bytes(&path)?;
        keep(&bytes, &name, srgb.unwrap_or(true), filter, &self.loading.budget)
            .map_err(|cause| Error::malformed(&path, cause))
    }

    pub(super) fn material(&self, material: Spanned<schema::Material>, parts: &SceneParts) -> Result<Material> {
        let at = material.span().start;
        let m = material.into_inner();
        if parts.materials.iter().any(|other| other.name == m.name) {
            return Err(self.fail(at, format!("a second material `{}`", m.name)));
        }
        let given = [
            ("albedo", m.albedo.is_some()),
            ("texture", m.texture.is_some()),
            ("reflectance", m.reflectance.is_some()),
            ("ior", m.ior.is_some()),
            ("eta", m.eta.is_some()),
            ("k", m.k.is_some()),
            ("alpha", m.alpha.is_some()),
        ];
        let only = |keys: &[&str]| self.only(at, &m.kind, keys, &given);
        let colour = |c: Option<[f32; 3]>, default: f32| Vec3::from_array(c.unwrap_or([default; 3]));
        let bsdf = match m.kind.as_str() {
            "lambert" => {
                only(&["albedo", "texture"])?;
                let texture = m.texture.as_ref().map(|name| {
                    let known = parts.textures.iter().map(|t| t.name.as_str());
                    self.index_of("texture", name, known)
                });
                // A texture is not darkened unless the file says so.
                let default = if texture.is_some() { 1.0 } else { 0.5 };
                Bsdf::Lambert { albedo: colour(m.albedo, default), texture: texture.transpose()? }
            }
            "mirror" => {
                only(&["reflectance"])?;
                Bsdf::Mirror { reflectance: colour(m.reflectance, 1.0) }
            }
            "dielectric" => {
                only(&["ior"])?;
                Bsdf::Dielectric { ior: m.ior.unwrap_or(1.5) }
            }
            "conductor" => {
                only(&["eta", "k", "reflectance", "alpha"])?;
                let (eta, k) = (colour(m.eta, 0.0), colour(m.k, 1.0));
                Bsdf::Conductor { eta, k, reflectance: colour(m.reflectance, 1.0), alpha: m.alpha.unwrap_or(0.1) }
            }
            other => {
                let cause = format!("material type `{other}` is none of lambert, mirror, dielectric, conductor");
                return Err(self.fail(at, cause));
            }
        };
        let material = Material { name: m.name, bsdf, emission: colour(m.emission, 0.0) };
        match material.defect() {
            Some(what) => Err(self.fail(at, format!("material `{}`: {what}", material.name))),
            None => Ok(material),
        }
    }

    pub(super) fn light(&self, light: Spanned<schema::Light>) -> Result<Light> {
        let at = light.span().start;
        let l = light.into_inner();
        let given = [
            ("position", l.position.is_some()),
            ("direction", l.direction.is_some()),
            ("intensity", l.intensity.is_some()),
            ("irradiance", l.irradiance.is_some()),
            ("cutoff", l.cutoff.is_some()),
            ("beam_width", l.beam_width.is_some()),
        ];
        let only = |keys: &[&str]| self.only(at, &l.kind, keys, &given);
        let need = |what: &str| self.fail(at, format!("{} light: `{what}` is missing", l.kind));
        let position = || Ok(DVec3::from_array(l.position.ok_or_else(|| need("position"))?));
        let intensity = || Ok(Vec3::from_array(l.intensity.ok_or_else(|| need("intensity"))?));
        let direction = || {
            let d = DVec3::from_array(l.direction.ok_or_else(|| need("direction"))?);
            d.try_normalize().ok_or_else(|| self.fail(at, format!("direction {d} has no length")))
        };
        let light = match l.kind.as_str() {
            "point" => {
                only(&["position", "intensity"])?;
                Light::Point { position: position()?, intensity: intensity()? }
            }
            "spot" => {
                only(&["position", "direction", "intensity", "cutoff", "beam_width"])?;
                let cutoff = l.cutoff.ok_or_else(|| need("cutoff"))?;
                let beam_width = l.beam_width.unwrap_or(cutoff);
                let (position, direction) = (position()?, direction()?);
                Light::Spot { position, direction, intensity: intensity()?, cutoff, beam_width }
            }
            "directional" => {
                only(&["direction", "irradiance"])?;
                let irradiance = l.irradiance.ok_or_else(|| need("irradiance"))?;
                Light::Directional { direction: direction()?, irradiance: Vec3::from_array(irradiance) }
            }
            other => return Err(self.fail(at, format!("light type `{other}` is none of point, spot, directional"))),
        };
        light.defect().map_or(Ok(light), |what| Err(self.fail(at, format!("light: {what}"))))
    }

    fn only(&self, at: usize, kind: &str, keys: &[&str], given: &[(&str, bool)]) -> Result<()> {
        match given.iter().find(|(key, present)| *present && !keys.contains(key)) {
            Some((key, _)) => {
                Err(self.fail(at, format!("`{key}` does not belong to {kind}, which takes {}", keys.join(", "))))
            }
            None => Ok(()),
        }
    }
}
