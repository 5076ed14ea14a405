//! What both exporters share: settings, numbers as text, texture files, and files that are never half written.

use super::{Filter, Mesh, Scene, SceneGeometry, Texture, patches};
use crate::error::{Error, Result};
use crate::picture::io::replace_file;
use crate::picture::srgb;
use crate::ray::Aabb;
use glam::{DVec3, Vec3};
use image::{ExtendedColorType, ImageEncoder, codecs::png::PngEncoder};
use std::borrow::Cow;
use std::fmt;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// What an exported file asks of the other renderer.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ExportSettings {
    /// Columns of the picture, above 0. POV-Ray takes only the ratio of the two from the file.
    pub width: u32,
    /// Rows of the picture, above 0.
    pub height: u32,
    /// Longest path in edges, above 0: 1 sees emission only, 2 adds direct light.
    pub max_depth: u32,
    /// For POV-Ray, which has no lights with an area as we have: so many spots along each side of a shining triangle
    /// stand for its light. 0: it lights nothing, as in the Whitted integrator.
    pub lamp_grid: u32,
}

impl Default for ExportSettings {
    fn default() -> Self {
        Self { width: 512, height: 512, max_depth: 8, lamp_grid: 4 }
    }
}

/// A number that reads back as the same f64, without a needless exponent.
#[derive(Clone, Copy)]
pub(super) struct Number(pub f64);

impl fmt::Display for Number {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let size = self.0.abs();
        if size == 0.0 || (1e-5..1e12).contains(&size) { write!(f, "{}", self.0) } else { write!(f, "{:e}", self.0) }
    }
}

/// Three numbers with commas between them.
#[derive(Clone, Copy)]
pub(super) struct Triple(pub DVec3);

impl From<Vec3> for Triple {
    fn from(v: Vec3) -> Self {
        Self(v.as_dvec3())
    }
}

impl fmt::Display for Triple {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}, {}, {}", Number(self.0.x), Number(self.0.y), Number(self.0.z))
    }
}

/// `name` with everything but ASCII letters, digits, `_` and single `-` replaced by `_`: safe in comments and paths.
pub(super) fn plain(name: &str) -> String {
    let mut out = String::new();
    for c in name.chars().take(64) {
        let keep = c.is_ascii_alphanumeric() || (c == '-' && !out.ends_with('-') && !out.is_empty());
        out.push(if keep { c } else { '_' });
    }
    if out.ends_with('-') || out.is_empty() {
        out.push('_');
    }
    out
}

/// Refuses what no renderer could take.
pub(super) fn check(scene: &Scene, settings: &ExportSettings) -> Result<()> {
    let ExportSettings { width, height, max_depth, .. } = *settings;
    if width == 0 || height == 0 || max_depth == 0 {
        return Err(Error::invalid(format!(
            "export: width {width}, height {height} and depth {max_depth} are to be above 0"
        )));
    }
    let camera = &scene.camera;
    let placed = camera.basis().iter().all(|axis| axis.is_finite()) && camera.origin.is_finite();
    let opened = camera.yfov > 0.0 && camera.yfov < 180.0;
    if !(placed && opened) {
        return Err(Error::invalid(format!(
            "{}: the camera at {} towards {} with up {} and {} degrees sees nothing",
            scene.name, camera.origin, camera.target, camera.up, camera.yfov
        )));
    }
    Ok(())
}

/// The triangles of `mesh` that a renderer can read: every corner exists and is finite.
pub(super) fn usable_triangles(mesh: &Mesh) -> Vec<[u32; 3]> {
    let finite = |&i: &u32| mesh.positions.get(i as usize).is_some_and(|p| p.is_finite());
    mesh.triangles.iter().filter(|t| t.iter().all(finite)).copied().collect()
}

/// The normals of `mesh`, empty if it shades flat. Where one is zero or not finite the sum of the normals of the
/// triangles around stands for it: the renderers want to normalise it.
pub(super) fn usable_normals(mesh: &Mesh) -> Cow<'_, [Vec3]> {
    let usable = |n: &Vec3| n.is_finite() && n.length_squared() > 0.0;
    if mesh.normals.iter().all(usable) {
        return Cow::Borrowed(&mesh.normals);
    }
    let mut sums = vec![DVec3::ZERO; mesh.positions.len()];
    for triangle in usable_triangles(mesh) {
        let [a, b, c] = triangle.map(|i| mesh.positions[i as usize].as_dvec3());
        let normal = (b - a).cross(c - a).normalize_or_zero();
        triangle.iter().for_each(|&i| sums[i as usize] += normal);
    }
    let normals = mesh.normals.iter().zip(sums);
    Cow::Owned(normals.map(|(n, sum)| if usable(n) { *n } else { sum.normalize_or(DVec3::Y).as_vec3() }).collect())
}

/// Indices of the spheres that a renderer can read: finite, with a radius above 0.
pub(super) fn usable_spheres(scene: &Scene) -> Vec<usize> {
    let usable = |i: &usize| {
        let s = &scene.spheres[*i];
        s.centre.is_finite() && s.radius.is_finite() && s.radius > 0.0
    };
    (0..scene.spheres.len()).filter(usable).collect()
}

/// What [`usable_triangles`] and [`usable_spheres`] leave out, as a warning.
pub(super) fn left_out(scene: &Scene) -> Option<String> {
    let triangles: usize = scene.meshes.iter().map(|m| m.triangles.len() - usable_triangles(m).len()).sum();
    let spheres = scene.spheres.len() - usable_spheres(scene).len();
    (triangles + spheres > 0).then(|| {
        format!(
            "{triangles} triangles and {spheres} spheres that are not finite or have no radius are left out of the export"
        )
    })
}

/// The least box around everything that is exported.
pub(super) fn bounds(scene: &Scene) -> Aabb {
    let points = scene.meshes.iter().flat_map(|m| &m.positions).filter(|p| p.is_finite()).copied();
    let boxes = usable_spheres(scene).into_iter().map(|i| {
        let s = scene.spheres[i];
        Aabb { min: s.centre - s.radius, max: s.centre + s.radius }
    });
    let patches = match &scene.geometry {
        SceneGeometry::Patches(patches) => patches::bounds(patches),
        _ => Aabb::EMPTY,
    };
    points.map(|p| Aabb { min: p, max: p }).chain(boxes).chain([patches]).fold(Aabb::EMPTY, |a, b| a.union(&b))
}

/// A texture's value where nothing has texture coordinates: at (0, 0).
pub(super) fn at_origin(texture: &Texture) -> Vec3 {
    let (w, h) = (texture.width as usize, texture.height as usize);
    let texel = |x: usize, y: usize| texture.texels.get(y * w + x).copied().unwrap_or(Vec3::ZERO);
    match texture.filter {
        Filter::Nearest => texel(0, 0),
        // The origin is the corner at which the four corner texels of the repeated picture meet.
        Filter::Bilinear if w > 0 && h > 0 => {
            (texel(0, 0) + texel(w - 1, 0) + texel(0, h - 1) + texel(w - 1, h - 1)) / 4.0
        }
        Filter::Bilinear => Vec3::ZERO,
    }
}

/// A file that a renderer reads as a texture.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct TextureFile {
    /// Name in the folder of the exported scene.
    pub name: String,
    /// 8 bits in sRGB, or else 16 bits linear.
    pub srgb: bool,
}

/// The files beside an exported scene.
pub(super) struct Assets {
    folder: PathBuf,
    stem: String,
    textures: Vec<(u32, Vec3, TextureFile)>,
    /// What could not be written as it is.
    pub warnings: Vec<String>,
}

impl Assets {
    /// Assets of the scene file `out`: in its folder, with its stem.
    pub fn beside(out: &Path) -> Self {
        let folder = out.parent().unwrap_or(Path::new("")).to_path_buf();
        let stem = plain(&out.file_stem().unwrap_or_default().to_string_lossy());
        Self { folder, stem, textures: Vec::new(), warnings: Vec::new() }
    }

    /// Writes the file `STEM-name` by `content` and returns its name without the folder.
    pub fn write(&self, name: &str, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<String> {
        let name = format!("{}-{name}", self.stem);
        write_whole(&self.folder.join(&name), content)?;
        Ok(name)
    }

    /// The file of texture `index` times `factor`, written when it is first asked for.
    pub fn texture(&mut self, scene: &Scene, index: u32, factor: Vec3) -> Result<TextureFile> {
        if let Some((.., file)) = self.textures.iter().find(|(i, f, _)| *i == index && *f == factor) {
            return Ok(file.clone());
        }
        let texture = scene.textures.get(index as usize).ok_or_else(|| {
            Error::invalid(format!("{}: texture {index} of {} does not exist", scene.name, scene.textures.len()))
        })?;
        let srgb = texture.srgb && factor == Vec3::ONE;
        let texels = || texture.texels.iter().map(|&t| t * factor);
        if texels().any(|t| t.max_element() > 1.0 || t.min_element() < 0.0 || t.is_nan()) {
            self.warnings.push(format!(
                "texture `{}` times {factor} leaves the range from 0 to 1: it is clamped in the export",
                texture.name
            ));
        }
        let bytes: Vec<u8> = if srgb {
            texels().flat_map(|t| t.to_array()).map(srgb::to_byte).collect()
        } else {
            texels().flat_map(|t| t.to_array()).flat_map(|c| encode_linear(c).to_ne_bytes()).collect()
        };
        let colour = if srgb { ExtendedColorType::Rgb8 } else { ExtendedColorType::Rgb16 };
        let name = self.write(&format!("texture{}.png", self.textures.len()), |w| {
            PngEncoder::new(w)
                .write_image(&bytes, texture.width, texture.height, colour)
                .map_err(|e| io::Error::other(e.to_string()))
        })?;
        let file = TextureFile { name, srgb };
        self.textures.push((index, factor, file.clone()));
        Ok(file)
    }
}

/// The 16-bit code of a linear value. Values that came from 8 bits are exact.
fn encode_linear(linear: f32) -> u16 {
    (f64::from(linear) * 65535.0).round().clamp(0.0, 65535.0) as u16
}

/// Writes `path` by way of a temporary file beside it: there is the whole file or the old one.
///
/// # Errors
/// The file cannot be written.
pub(super) fn write_whole(path: &Path, content: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<()> {
    let mut bytes = Vec::new();
    content(&mut bytes).map_err(|e| Error::io(path, e))?;
    replace_file(path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_read_back_as_the_same_bits() {
        for x in [0.0, -0.0, 1.0, -0.1, 1e-300, 5e-324, 1e12, f64::MAX, f64::from(0.1f32), f64::from(f32::MIN_POSITIVE)]
        {
            let text = Number(x).to_string();
            assert_eq!(text.parse::<f64>().expect("a number").to_bits(), x.to_bits(), "{text}");
            assert!(text.len() < 32, "{text}");
        }
    }

    #[test]
    fn srgb_codes_survive() {
        for code in 0..=255u8 {
            let c = f64::from(code) / 255.0;
            assert_eq!(srgb::to_byte(srgb::decode(c)), code);
            assert_eq!(encode_linear((c) as f32), u16::from(code) * 257);
        }
        assert_eq!((srgb::to_byte(f32::NAN), encode_linear(f32::NAN)), (0, 0));
    }

    #[test]
    fn names_are_safe_in_comments_and_paths() {
        assert_eq!(plain("glass-1"), "glass-1");
        assert_eq!(plain("../a--b*/\n\"é"), "___a-_b_____");
        assert_eq!(plain(""), "_");
        assert!(!plain("x-").ends_with('-'));
    }
}
