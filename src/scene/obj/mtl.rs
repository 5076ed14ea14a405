//! Reads MTL files; the rule that maps materials is stated in the parent module.

use super::words;
use crate::error::{Error, Result};
use crate::scene::load::read_bytes;
use crate::scene::texture::decode;
use crate::scene::{Bsdf, Filter, Material, SceneParts};
use glam::Vec3;
use std::path::Path;

/// A material as it is written.
#[derive(Default)]
struct Written {
    name: String,
    diffuse: Option<Vec3>,
    specular: Option<Vec3>,
    emission: Vec3,
    map: Option<String>,
    opacity: Option<f32>,
    ior: Option<f32>,
    illumination: u32,
}

/// Adds the materials and textures of an MTL file to `parts`; returns names and indices.
///
/// # Errors
/// The file cannot be read, or a number is none.
pub(super) fn read(path: &Path, parts: &mut SceneParts) -> Result<Vec<(String, u32)>> {
    let bytes = read_bytes(path)?;
    let mut list: Vec<Written> = Vec::new();
    for (i, line) in bytes.split(|&b| b == b'\n').enumerate() {
        let line = line.trim_ascii();
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = (&line[..end], line[end..].trim_ascii());
        let fail = |cause: String| Error::malformed(path, format!("line {}: {cause}", i + 1));
        if keyword == b"newmtl" {
            list.push(Written { name: String::from_utf8_lossy(rest).into_owned(), ..Written::default() });
        } else if let Some(material) = list.last_mut() {
            material.statement(keyword, rest).map_err(fail)?;
        }
    }
    Ok(list.into_iter().map(|written| written.add(path, parts)).collect())
}

impl Written {
    fn statement(&mut self, keyword: &[u8], rest: &[u8]) -> std::result::Result<(), String> {
        match keyword {
            b"Kd" => self.diffuse = Some(colour(rest)?),
            b"Ks" => self.specular = Some(colour(rest)?),
            b"Ke" => self.emission = colour(rest)?,
            b"d" => self.opacity = Some(number(rest)?),
            b"Tr" => self.opacity = Some(1.0 - number(rest)?),
            b"Ni" => self.ior = Some(number(rest)?),
            b"illum" => self.illumination = number(rest)?.clamp(0.0, 100.0) as u32,
            b"map_Kd" => self.map = Some(file_name(&String::from_utf8_lossy(rest))),
            // Ambient colour, highlights, bump and the like do not show here.
            _ => {}
        }
        Ok(())
    }

    fn add(self, path: &Path, parts: &mut SceneParts) -> (String, u32) {
        let index = parts.materials.len() as u32;
        let mut warn = |text: String| parts.warnings.push(format!("{}: {text}", path.display()));
        let transparent = self.opacity.is_some_and(|d| d < 0.5);
        let name = self.name;
        let mut cut = |what: &str, c: Vec3| {
            let clamped = c.clamp(Vec3::ZERO, Vec3::ONE);
            if clamped != c {
                warn(format!("material `{name}`: {what} {c} is cut to 0 to 1"));
            }
            clamped
        };
        let bsdf = match self.illumination {
            3 | 5 => Bsdf::Mirror { reflectance: cut("Ks", self.specular.unwrap_or(Vec3::ONE)) },
            4 | 6 | 7 | 9 if transparent => Bsdf::Dielectric { ior: self.ior.filter(|&n| n > 0.0).unwrap_or(1.5) },
            _ => {
                let default = Vec3::splat(if self.map.is_some() { 1.0 } else { 0.5 });
                let albedo = cut("Kd", self.diffuse.unwrap_or(default));
                let texture = self.map.and_then(|file| texture(path, &file, parts));
                Bsdf::Lambert { albedo, texture }
            }
        };
        parts.materials.push(Material { name: name.clone(), bsdf, emission: self.emission.max(Vec3::ZERO) });
        (name, index)
    }
}

/// The index of the texture in `file` beside `path`; a texture that cannot be had is left out, with a warning.
fn texture(path: &Path, file: &str, parts: &mut SceneParts) -> Option<u32> {
    if let Some(known) = parts.textures.iter().position(|t| t.name == file) {
        return Some(known as u32);
    }
    let place = path.parent().unwrap_or(Path::new("")).join(file);
    let bytes = read_bytes(&place).map_err(|e| e.to_string());
    let cause = |cause: String| format!("{}: {cause}", place.display());
    match bytes.and_then(|bytes| decode(&bytes, file, true, Filter::Bilinear).map_err(cause)) {
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

fn number(text: &[u8]) -> std::result::Result<f32, String> {
    // `d -halo 0.5` and the like: the number comes last.
    let word = words(text).last().unwrap_or_default();
    let number = std::str::from_utf8(word).ok().and_then(|w| w.parse::<f32>().ok());
    number.filter(|n| n.is_finite()).ok_or_else(|| format!("`{}` is no finite number", super::printable(text)))
}

/// Three numbers, or one for all three.
fn colour(text: &[u8]) -> std::result::Result<Vec3, String> {
    let bad = || format!("`{}` is no colour of one or three finite numbers", super::printable(text));
    let mut numbers = Vec::new();
    for word in words(text).take(3) {
        let number = std::str::from_utf8(word).ok().and_then(|w| w.parse::<f32>().ok()).filter(|n| n.is_finite());
        numbers.push(number.ok_or_else(bad)?);
    }
    match numbers[..] {
        [r, g, b] => Ok(Vec3::new(r, g, b)),
        [v] => Ok(Vec3::splat(v)),
        _ => Err(bad()),
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

    #[test]
    fn numbers_and_colours_are_checked() {
        assert_eq!(number(b"-halo 0.25"), Ok(0.25));
        assert_eq!(colour(b"0.1 0.2 0.3"), Ok(Vec3::new(0.1, 0.2, 0.3)));
        assert_eq!(colour(b"0.5"), Ok(Vec3::splat(0.5)));
        for bad in [b"".as_slice(), b"1 2", b"spectral file.rfl", b"nan 0 0", b"1 1 1e99"] {
            assert!(colour(bad).is_err(), "{bad:?}");
        }
        assert!(number(b"inf").is_err());
    }
}
