//! Makes materials of what `tobj` read from MTL files; the rule is stated in the parent module.

use crate::scene::budget::Budget;
use crate::scene::load::read_bytes;
use crate::scene::texture::keep;
use crate::scene::{Bsdf, Filter, Material, SceneParts};
use glam::Vec3;
use std::path::Path;

/// Adds a material of the MTL file `path`, and its texture, to `parts`.
pub(super) fn add(written: &tobj::Material, path: &Path, parts: &mut SceneParts, budget: &Budget) {
    let name = &written.name;
    let tr = || written.unknown_param.get("Tr").and_then(|text| text.parse::<f32>().ok()).map(|tr| 1.0 - tr);
    let is_transparent = written.dissolve.or_else(tr).is_some_and(|d| d < 0.5);
    let mut cut = |what: &str, c: Vec3| {
        let clamped = c.clamp(Vec3::ZERO, Vec3::ONE);
        if clamped != c {
            let text = format!("{}: material `{name}`: {what} {c} is cut to 0 to 1", path.display());
            parts.warnings.push(text);
        }
        clamped
    };
    let bsdf = match written.illumination_model {
        Some(3 | 5) => Bsdf::Mirror { reflectance: cut("Ks", written.specular.map_or(Vec3::ONE, Vec3::from_array)) },
        Some(4 | 6 | 7 | 9) if is_transparent => {
            Bsdf::Dielectric { ior: written.optical_density.filter(|&n| n > 0.0).unwrap_or(1.5) }
        }
        _ => {
            let default = Vec3::splat(if written.diffuse_texture.is_some() { 1.0 } else { 0.5 });
            let albedo = cut("Kd", written.diffuse.map_or(default, Vec3::from_array));
            let map = written.diffuse_texture.as_deref().map(file_name);
            Bsdf::Lambert { albedo, texture: map.and_then(|file| texture(path, &file, parts, budget)) }
        }
    };
    let emission = Vec3::from_array(written.emissive.unwrap_or_default()).max(Vec3::ZERO);
    parts.materials.push(Material { name: name.clone(), bsdf, emission });
}

/// The index of the texture in `file` beside `path`; a texture that cannot be had is left out, with a warning.
fn texture(path: &Path, file: &str, parts: &mut SceneParts, budget: &Budget) -> Option<u32> {
    if let Some(known) = parts.textures.iter().position(|t| t.name == file) {
        return Some(known as u32);
    }
    let place = path.parent().unwrap_or(Path::new("")).join(file);
    let bytes = read_bytes(&place).map_err(|e| e.to_string());
    let cause = |cause: String| format!("{}: {cause}", place.display());
    match bytes.and_then(|bytes| keep(&bytes, file, true, Filter::Bilinear, budget).map_err(cause)) {
        Ok(texture) => {
            parts.textures.push(texture);
            Some(parts.textures.len() as u32 - 1)
        }
        Err(cause) => {
            parts.warnings.push(format!("{}: texture `{file}` is left out: {cause}", path.display()));
            None
        }
    }
}

/// The file's name after options such as `-s 1 1 1`, with `/` between folders.
fn file_name(text: &str) -> String {
    let mut rest = text.trim();
    while let Some(option) = rest.strip_prefix('-') {
        let (_, mut after) = option.split_once(char::is_whitespace).unwrap_or((option, ""));
        // Values are numbers or switches; the name is neither.
        loop {
            after = after.trim_start();
            let (word, tail) = after.split_once(char::is_whitespace).unwrap_or((after, ""));
            let is_value = word.parse::<f32>().is_ok() || word == "on" || word == "off";
            if !is_value || tail.is_empty() {
                break;
            }
            after = tail;
        }
        rest = after;
    }
    rest.replace('\\', "/")
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn file_names_follow_options() {
        for (text, name) in [
            ("wood.png", "wood.png"),
            ("a b\\c d.png", "a b/c d.png"),
            ("-s 2 2 1 -clamp on my wood.png", "my wood.png"),
        ] {
            assert_eq!(file_name(text), name);
        }
    }
}
