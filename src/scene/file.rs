//! Scene files in TOML: meshes, spheres, quads, materials, lights and a camera, placed by hand.
//!
//! Lengths are world units, angles degrees, colours linear RGB. The world is right-handed; `+y` is up by default. Every
//! number must be finite. A key that is not listed here is an error, and every error says `path: line L: cause`. A scene
//! may leave out whatever it does not need; without a camera one is framed.
//!
//! ```toml
//! name = "glass"                  # default: the file's name
//! environment = [0.0, 0.0, 0.0]   # radiance from every direction where nothing is hit; default black
//!
//! [camera]
//! origin = [0.0, 2.0, 8.0]
//! target = [0.0, 1.0, 0.0]        # the centre of the picture
//! up = [0.0, 1.0, 0.0]            # default +y
//! yfov = 40.0                     # vertical field of view, above 0 and below 180
//!
//! [render]                        # what the command line does not say; every key may be left out
//! width = 256                     # one of width and height alone: a square
//! height = 256
//! integrator = "whitted"          # or "path"
//! max_depth = 6                   # edges: 1 sees emission only, 2 adds direct light
//! spp = 64
//!
//! [[texture]]
//! name = "checks"
//! file = "checks.png"             # PNG or JPEG, relative to this file
//! srgb = true                     # default true; false: the values are linear
//! filter = "bilinear"             # default; or "nearest"
//!
//! [[material]]
//! name = "floor"
//! type = "lambert"                # lambert, mirror, dielectric or conductor
//! albedo = [0.5, 0.5, 0.5]        # lambert: reflected share, 0 to 1, a factor on the texture; default 0.5, 1 with one
//! texture = "checks"              # lambert: default none
//! emission = [0.0, 0.0, 0.0]      # any type: radiance from the front; default none
//!
//! [[material]]
//! name = "silver"
//! type = "mirror"
//! reflectance = [0.9, 0.9, 0.9]   # 0 to 1; default 1
//!
//! [[material]]
//! name = "crown glass"
//! type = "dielectric"
//! ior = 1.5                       # inside relative to outside, above 0; default 1.5
//!
//! [[material]]
//! name = "gold"
//! type = "conductor"
//! eta = [0.143, 0.375, 1.442]     # default 0
//! k = [3.983, 2.386, 1.603]       # default 1; eta 0 and k 1 reflect everything
//! reflectance = [1.0, 1.0, 1.0]   # 0 to 1; default 1
//! alpha = 0.1                     # GGX roughness, above 0 and at most 1; default 0.1
//!
//! [[sphere]]
//! centre = [0.0, 1.0, 0.0]
//! radius = 1.0                    # above 0
//! material = "crown glass"        # default, here and below: a grey Lambert of albedo 0.5
//!
//! [[quad]]                        # the parallelogram corner, corner + u, corner + u + v, corner + v
//! corner = [-4.0, 0.0, 4.0]
//! u = [8.0, 0.0, 0.0]             # front side: u x v
//! v = [0.0, 0.0, -8.0]
//! repeat = [4.0, 4.0]             # how often a texture repeats along u and v; default once
//! material = "floor"
//!
//! [[mesh]]
//! file = "knot.obj"               # .obj, .gltf or .glb, relative to this file; its lights and cameras are ignored
//! material = "silver"             # default: the file's own materials
//! smooth = true                   # default true; false: without the file's normals
//! scale = 1.0                     # one number or [x, y, z]; default 1; may be negative (a mirror image), not 0
//! rotate = [0.0, 45.0, 0.0]       # about x, then y, then z; default none
//! translate = [0.0, 0.0, 0.0]     # after scale and rotate; default none
//!
//! [[triangles]]                   # a mesh in place
//! positions = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0]]
//! indices = [[0, 1, 2]]           # counter-clockwise seen from the front
//! normals = [[0.0, 0.0, 1.0], [0.0, 0.0, 1.0], [0.0, 0.0, 1.0]]  # one for each position; default: flat
//! uvs = [[0.0, 1.0], [1.0, 1.0], [0.0, 0.0]]                     # one for each position, v DOWN; default none
//! material = "floor"
//!
//! [[procedural]]                  # the geometry alone of a scene of [`super::procedural::ENTRIES`]
//! type = "flakes"
//! depth = 3                       # the options of that entry, such as n, depth and seed
//! materials = ["silver", "floor"] # slot i of the entry gets materials[i mod 2]; default grey
//! scale = 1.0                     # scale, rotate and translate as for a mesh; for spheres the scale is one
//! rotate = [0.0, 0.0, 0.0]        # positive number
//! translate = [0.0, 1.0, 0.0]
//!
//! [[light]]
//! type = "point"
//! position = [2.0, 5.0, 2.0]
//! intensity = [40.0, 40.0, 40.0]  # W/sr
//!
//! [[light]]
//! type = "spot"
//! position = [0.0, 6.0, 0.0]
//! direction = [0.0, -1.0, 0.0]    # the axis; any length but 0
//! intensity = [40.0, 40.0, 40.0]
//! cutoff = 30.0                   # angle between axis and edge, above 0 and at most 90
//! beam_width = 30.0               # full intensity within it, at most cutoff; default cutoff: a hard cone
//!
//! [[light]]
//! type = "directional"
//! direction = [-1.0, -2.0, -1.0]  # in which the light travels; any length but 0
//! irradiance = [1.0, 1.0, 1.0]    # W/m^2 on a surface that faces the light
//! ```
//!
//! A quad's texture coordinates, v down as everywhere, are (0, 1) at `corner`, (1, 1) at `corner + u`, (1, 0) at
//! `corner + u + v` and (0, 0) at `corner + v`, times `repeat`: the texture stands upright where v points up.

mod look;
mod schema;
mod shape;

use super::load::{Loading, read_bytes, stem};
use super::{Material, SceneParts};
use crate::error::{Error, Result};
use glam::Vec3;
use schema::SceneFile;
use std::path::{Path, PathBuf};
use toml::Spanned;

/// Reads a scene file and everything that it refers to.
///
/// # Errors
/// A file cannot be read, the text is not TOML, or a key or value is not as the module's documentation says.
pub(super) fn read(path: &Path, loading: &Loading) -> Result<SceneParts> {
    let bytes = read_bytes(path)?;
    let text = std::str::from_utf8(&bytes).map_err(|e| {
        let line = bytes[..e.valid_up_to()].iter().filter(|&&b| b == b'\n').count() + 1;
        Error::malformed(path, format!("line {line}: not UTF-8"))
    })?;
    let reader = Reader { path, text, loading };
    let file: SceneFile = toml::from_str(text).map_err(|e| {
        let cause = e.message().replace('\n', ", ");
        reader.fail(e.span().map_or(0, |s| s.start), cause)
    })?;
    reader.build(file)
}

/// What every part of a scene file needs to be read and to be blamed.
struct Reader<'a> {
    path: &'a Path,
    text: &'a str,
    loading: &'a Loading,
}

impl Reader<'_> {
    fn fail(&self, at: usize, cause: impl std::fmt::Display) -> Error {
        let line = self.text.bytes().take(at).filter(|&b| b == b'\n').count() + 1;
        Error::malformed(self.path, format!("line {line}: {cause}"))
    }

    fn build(&self, file: SceneFile) -> Result<SceneParts> {
        let name = file.name.unwrap_or_else(|| stem(self.path));
        let mut parts = SceneParts { name, ..SceneParts::default() };
        if let Some(e) = file.environment {
            parts.environment = self.radiance(e.span().start, "environment", *e.get_ref())?;
        }
        parts.camera = file.camera.map(|c| self.camera(c)).transpose()?;
        parts.defaults = file.render.map(|r| self.render(r)).transpose()?.unwrap_or_default();
        for texture in file.texture {
            let texture = self.texture(texture, &parts)?;
            parts.textures.push(texture);
        }
        for material in file.material {
            let material = self.material(material, &parts)?;
            parts.materials.push(material);
        }
        for sphere in file.sphere {
            self.sphere(sphere, &mut parts)?;
        }
        for quad in file.quad {
            self.quad(quad, &mut parts)?;
        }
        for triangles in file.triangles {
            self.triangles(triangles, &mut parts)?;
        }
        for mesh in file.mesh {
            self.mesh(mesh, &mut parts)?;
        }
        for procedural in file.procedural {
            self.procedural(procedural, &mut parts)?;
        }
        for light in file.light {
            let light = self.light(light)?;
            parts.lights.push(light);
        }
        Ok(parts)
    }

    fn beside(&self, file: &str) -> PathBuf {
        self.path.parent().unwrap_or(Path::new("")).join(file)
    }

    fn index_of<'n>(&self, what: &str, name: &Spanned<String>, known: impl Iterator<Item = &'n str>) -> Result<u32> {
        let names: Vec<&str> = known.collect();
        match names.iter().position(|n| n == name.get_ref()) {
            Some(i) => Ok(i as u32),
            None => {
                let cause = format!("no {what} `{}` among [{}]", name.get_ref(), names.join(", "));
                Err(self.fail(name.span().start, cause))
            }
        }
    }

    fn material_index(&self, name: Option<&Spanned<String>>, parts: &mut SceneParts) -> Result<u32> {
        if let Some(name) = name {
            return self.index_of("material", name, parts.materials.iter().map(|m| m.name.as_str()));
        }
        let grey = Material::grey();
        let found = parts.materials.iter().position(|m| *m == grey);
        let index = found.unwrap_or_else(|| {
            parts.materials.push(grey);
            parts.materials.len() - 1
        });
        Ok(index as u32)
    }

    fn point(&self, at: usize, what: &str, p: [f32; 3]) -> Result<Vec3> {
        let p = Vec3::from_array(p);
        if p.is_finite() { Ok(p) } else { Err(self.fail(at, format!("{what}: {p} is not finite"))) }
    }
}
