//! OBJ and MTL scenes, with the line in every error.
//!
//! Faces become fans of triangles; one mesh for each pair of group (or object) and material. Faces with fewer than three
//! corners, points, lines and statements that are not read are counted in warnings. Texture coordinates are turned to
//! v down. Normals are used where all corners of a mesh have one. A vertex's fourth number divides the first three;
//! colours after them are passed over.
//!
//! Materials: `illum` 3 or 5 is a mirror of `Ks`; `illum` 4, 6, 7 or 9 with `d` below 0.5 (or `Tr` above) is a
//! dielectric of `Ni`, 1.5 by default; all else is Lambert of `Kd`, by default 0.5, with `map_Kd`, whose default factor
//! is 1. `Ke` is the emission. Colours above 1 are cut to 1 with a warning. What cannot be had (an MTL file, a material,
//! a texture) is left out with a warning that names it.
//!
//! Source: Wavefront's "Object Files (.obj)" and "MTL material format", version 3.0 and 4.0.

mod faces;
mod mtl;

use super::load::{read_bytes, stem};
use super::{LoadOptions, Material, SceneParts};
use crate::error::{Error, Result};
use faces::Faces;
use glam::{Vec2, Vec3};
use std::collections::{BTreeMap, HashMap};
use std::path::Path;

/// Reads an OBJ file, its MTL files and their textures.
///
/// # Errors
/// The file cannot be read; a number or index is none; an index refers to nothing; a coordinate is not finite (unless
/// `options` drop such vertices later).
pub(super) fn read(path: &Path, options: &LoadOptions) -> Result<SceneParts> {
    let bytes = read_bytes(path)?;
    let mut reader = Reader {
        path,
        options,
        line: 0,
        positions: Vec::new(),
        normals: Vec::new(),
        uvs: Vec::new(),
        faces: Faces::default(),
        materials: HashMap::new(),
        dangling: false,
        passed_over: BTreeMap::new(),
        parts: SceneParts { name: stem(path), ..SceneParts::default() },
    };
    for line in bytes.split(|&b| b == b'\n') {
        reader.line += 1;
        reader.statement(line)?;
    }
    Ok(reader.finish())
}

struct Reader<'a> {
    path: &'a Path,
    options: &'a LoadOptions,
    /// From 1.
    line: usize,
    positions: Vec<Vec3>,
    normals: Vec<Vec3>,
    uvs: Vec<Vec2>,
    faces: Faces,
    /// Index by name; names without a material are there, with the grey one's.
    materials: HashMap<String, Option<u32>>,
    /// Faces refer to normals or texture coordinates, and there are none so far.
    dangling: bool,
    /// How often each statement that is not read occurs.
    passed_over: BTreeMap<String, usize>,
    parts: SceneParts,
}

impl Reader<'_> {
    fn fail(&self, cause: impl std::fmt::Display) -> Error {
        Error::malformed(self.path, format!("line {}: {cause}", self.line))
    }

    fn warn(&mut self, text: impl std::fmt::Display) {
        self.parts.warnings.push(format!("{}: {text}", self.path.display()));
    }

    fn statement(&mut self, line: &[u8]) -> Result<()> {
        let line = line.trim_ascii();
        let end = line.iter().position(u8::is_ascii_whitespace).unwrap_or(line.len());
        let (keyword, rest) = (&line[..end], line[end..].trim_ascii());
        match keyword {
            b"v" => {
                let (v, n) = self.numbers::<6>(rest)?;
                if n < 3 || n == 5 {
                    return Err(self.fail(format_args!("{n} numbers for a vertex; 3, 4 or 6 are read")));
                }
                let position = Vec3::new(v[0], v[1], v[2]) / if n == 4 { v[3] } else { 1.0 };
                let position = self.finite("vertex", self.positions.len(), position, position.is_finite())?;
                self.positions.push(position);
            }
            b"vn" => {
                let (v, n) = self.numbers::<3>(rest)?;
                if n < 3 {
                    return Err(self.fail(format_args!("{n} numbers for a normal, 3 are needed")));
                }
                let normal = Vec3::from_array(v);
                let normal = self.finite("normal", self.normals.len(), normal, normal.is_finite())?;
                self.normals.push(normal);
            }
            b"vt" => {
                let (v, n) = self.numbers::<3>(rest)?;
                if n < 1 {
                    return Err(self.fail("no number for a texture coordinate"));
                }
                let uv = Vec2::new(v[0], 1.0 - v[1]);
                let uv = self.finite("texture coordinate", self.uvs.len(), uv, uv.is_finite())?;
                self.uvs.push(uv);
            }
            b"f" => self.face(rest)?,
            b"o" | b"g" => self.faces.set_group(&String::from_utf8_lossy(rest)),
            b"usemtl" => self.use_material(&String::from_utf8_lossy(rest)),
            b"mtllib" => self.library(&String::from_utf8_lossy(rest)),
            b"" | b"s" => {}
            _ if keyword.starts_with(b"#") => {}
            _ => {
                // A name of a few letters; binary rubbish is not worth keeping.
                let name = String::from_utf8_lossy(&keyword[..keyword.len().min(16)]).into_owned();
                if self.passed_over.len() < 16 || self.passed_over.contains_key(&name) {
                    *self.passed_over.entry(name).or_default() += 1;
                }
            }
        }
        Ok(())
    }

    /// Up to `N` numbers, and how many there were; missing ones are 0, more are an error.
    fn numbers<const N: usize>(&self, text: &[u8]) -> Result<([f32; N], usize)> {
        let mut numbers = [0.0; N];
        let mut count = 0;
        for word in words(text) {
            let number = std::str::from_utf8(word).ok().and_then(|w| w.parse().ok());
            let number = number.ok_or_else(|| self.fail(format_args!("`{}` is no number", printable(word))))?;
            let place = numbers.get_mut(count).ok_or_else(|| self.fail(format_args!("more than {N} numbers")))?;
            *place = number;
            count += 1;
        }
        Ok((numbers, count))
    }

    fn finite<T: std::fmt::Display>(&self, what: &str, index: usize, value: T, is_finite: bool) -> Result<T> {
        if is_finite || self.options.drop_invalid {
            Ok(value)
        } else {
            Err(self.fail(format_args!("{what} {}: {value} is not finite", index + 1)))
        }
    }

    fn face(&mut self, text: &[u8]) -> Result<()> {
        let mut corners = std::mem::take(&mut self.faces.corners);
        corners.clear();
        for word in words(text) {
            corners.push(self.corner(word)?);
        }
        self.faces.corners = corners;
        self.faces.add(&self.positions, &self.normals, &self.uvs).map_err(|cause| self.fail(cause))
    }

    /// Position, texture coordinate and normal of a corner such as `3/1/2`, `3//2`, `3/1` or `-1`.
    fn corner(&mut self, word: &[u8]) -> Result<[u32; 3]> {
        let counts = [self.positions.len(), self.uvs.len(), self.normals.len()];
        let names = ["vertex", "texture coordinate", "normal"];
        let mut corner = [faces::NONE; 3];
        for (k, text) in word.split(|&b| b == b'/').enumerate() {
            let (Some(&count), Some(name)) = (counts.get(k), names.get(k)) else {
                return Err(self.fail(format_args!("corner `{}` has more than three indices", printable(word))));
            };
            // Some writers refer to normals and texture coordinates that they leave out altogether.
            if k > 0 && (text.is_empty() || count == 0) {
                self.dangling |= !text.is_empty();
                continue;
            }
            let index: Option<i64> = std::str::from_utf8(text).ok().and_then(|t| t.parse().ok());
            let Some(index) = index else {
                return Err(self.fail(format_args!("corner `{}` is not made of indices", printable(word))));
            };
            // From 1; negative ones count back from the last so far.
            let from_zero = if index < 0 { index.checked_add(count as i64) } else { index.checked_sub(1) };
            let good = from_zero.and_then(|i| u32::try_from(i).ok()).filter(|&i| (i as usize) < count);
            let Some(i) = good else {
                return Err(self.fail(format_args!("face refers to {name} {index} of {count}")));
            };
            corner[k] = i;
        }
        Ok(corner)
    }

    fn use_material(&mut self, name: &str) {
        if !self.materials.contains_key(name) {
            self.materials.insert(name.to_owned(), None);
            let line = self.line;
            self.warn(format_args!("line {line}: no material `{name}`, grey is used"));
        }
        self.faces.set_material(self.materials.get(name).copied().flatten());
    }

    /// The statement holds one file name, or several without blanks in them.
    fn library(&mut self, names: &str) {
        let folder = self.path.parent().unwrap_or(Path::new(""));
        let one = [names];
        let several: Vec<&str> = names.split_ascii_whitespace().collect();
        let list = if folder.join(names).is_file() { one.as_slice() } else { several.as_slice() };
        let line = self.line;
        for name in list {
            match mtl::read(&folder.join(name), &mut self.parts) {
                Ok(found) => self.materials.extend(found.into_iter().map(|(name, i)| (name, Some(i)))),
                Err(e) => self.warn(format_args!("line {line}: no materials: {e}")),
            }
        }
    }

    fn finish(mut self) -> SceneParts {
        let faces = std::mem::take(&mut self.faces);
        if faces.too_small > 0 {
            self.warn(format_args!("{} faces with fewer than three corners are left out", faces.too_small));
        }
        if self.dangling {
            self.warn("faces refer to normals or texture coordinates where the file has none");
        }
        let partial = faces.partial_normals();
        if partial > 0 {
            self.warn(format_args!("{partial} meshes have normals at some corners only: shaded flat"));
        }
        for (keyword, count) in std::mem::take(&mut self.passed_over) {
            let keyword = printable(keyword.as_bytes());
            self.warn(format_args!("{count} statements `{keyword}` are passed over"));
        }
        let mut grey = None;
        for (mut mesh, material) in faces.meshes() {
            mesh.material = material.unwrap_or_else(|| {
                *grey.get_or_insert_with(|| {
                    self.parts.materials.push(Material::grey());
                    self.parts.materials.len() as u32 - 1
                })
            });
            self.parts.meshes.push(mesh);
        }
        self.parts
    }
}

fn words(text: &[u8]) -> impl Iterator<Item = &[u8]> {
    text.split(u8::is_ascii_whitespace).filter(|w| !w.is_empty())
}

/// For messages: short, and without control characters.
fn printable(word: &[u8]) -> String {
    let text = String::from_utf8_lossy(&word[..word.len().min(40)]).into_owned();
    text.chars().map(|c| if c.is_control() { '?' } else { c }).collect()
}
