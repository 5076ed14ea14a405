//! OBJ and MTL scenes, with the line in every error.
//!
//! `tobj` reads the text, resolves materials and cuts faces into fans of triangles. It never says where an error is,
//! panics on some, reads a polyline of three points as a triangle, and mixes up lists when only some corners have
//! normals. So every line is checked before, and what reaches `tobj` is plain: see `check.rs` and `mtl.rs`.
//!
//! There is one mesh for each pair of group (or object) and material. Faces with fewer than three corners, points,
//! lines and statements that are not read are counted in warnings. Texture coordinates are turned to v down. Normals are
//! used where all corners of a mesh have one. A vertex's fourth number divides the first three; colours after them are
//! passed over. MTL files hold for the whole file, wherever it names them.
//!
//! Materials: `illum` 3 or 5 is a mirror of `Ks`; `illum` 4, 6, 7 or 9 with `d` below 0.5 (or, without `d`, `Tr` above)
//! is a dielectric of `Ni`, 1.5 by default; all else is Lambert of `Kd`, by default 0.5, with `map_Kd`, whose default
//! factor is 1. `Ke` is the emission. Colours above 1 are cut to 1 with a warning. What cannot be had (an MTL file, a
//! material, a texture) is left out with a warning that names it.
//!
//! Source: Wavefront's "Object Files (.obj)" and "MTL material format", version 3.0 and 4.0.

mod check;
mod faces;
mod material;
mod meshes;
mod mtl;

use super::budget::Budget;
use super::load::{Loading, read_bytes, stem};
use super::{Material, SceneParts};
use crate::error::{Error, Result};
use check::Checked;
use std::collections::{HashMap, HashSet};
use std::path::Path;

/// Most bytes of an OBJ file.
const MAX_BYTES: usize = 1 << 30;
/// Most MTL files.
const MAX_LIBRARIES: usize = 256;
/// Most warnings about MTL files and materials that are not there.
const MAX_MISSING: usize = 64;
/// About the most bytes that `tobj` holds for a corner of a face: the face, its place in a map and the vertex, while
/// lists grow.
const CORNER_BYTES: u64 = 256;
/// About the most bytes for a mesh beside its vertices: names above all.
const SET_BYTES: u64 = 2048;

/// An MTL file as `tobj` has it: materials, and their indices by name.
type Library = (Vec<tobj::Material>, HashMap<String, usize>);

/// Reads an OBJ file, its MTL files and their textures.
///
/// # Errors
/// The file cannot be read or is too large; a number or index is none; an index refers to nothing; a coordinate is not
/// finite (unless such vertices are dropped later).
pub(super) fn read(path: &Path, loading: &Loading) -> Result<SceneParts> {
    let bytes = read_bytes(path)?;
    if bytes.len() > MAX_BYTES {
        return Err(Error::malformed(path, format!("{} bytes, at most {MAX_BYTES} are read", bytes.len())));
    }
    let checked = check::check(path, &bytes, loading.drop_invalid)?;
    drop(bytes);
    afford(path, &checked, &loading.budget)?;
    let mut parts = SceneParts { name: stem(path), ..SceneParts::default() };
    let libraries = libraries(path, &checked, &mut parts, &loading.budget)?;
    missing_materials(path, &checked, &libraries, &mut parts.warnings);
    let text = checked.text(libraries.len());
    let how = tobj::LoadOptions { single_index: true, triangulate: true, ignore_points: true, ignore_lines: true };
    let library = |name: &Path| {
        // The text names MTL files by their number.
        let number = name.to_str().and_then(|n| n.parse::<usize>().ok());
        number.and_then(|n| libraries.get(n)).cloned().ok_or(tobj::LoadError::OpenFileFailed)
    };
    let (models, _) = tobj::load_obj_buf(&mut text.as_slice(), &how, library)
        .map_err(|cause| Error::malformed(path, cause.to_string()))?;
    let (meshes, partial) = meshes::meshes(&models, &checked.faces);
    parts.warnings.extend(checked.warnings(path, partial));
    let mut grey = None;
    for (mut mesh, material) in meshes {
        mesh.material = material.map_or_else(|| *grey.get_or_insert_with(|| add_grey(&mut parts)), |id| id as u32);
        parts.meshes.push(mesh);
    }
    loading.budget.take_meshes(&parts.meshes, || format!("{}: meshes", path.display()))?;
    Ok(parts)
}

/// Refuses what would not fit into memory, before `tobj` tries.
fn afford(path: &Path, checked: &Checked, budget: &Budget) -> Result<()> {
    let (corners, sets) = (checked.faces.corners, checked.faces.sets.len() as u64);
    let wanted = corners.saturating_mul(CORNER_BYTES).saturating_add(sets.saturating_mul(SET_BYTES));
    budget.afford(wanted, || format!("{}: {corners} corners of faces", path.display()))
}

fn add_grey(parts: &mut SceneParts) -> u32 {
    parts.materials.push(Material::grey());
    parts.materials.len() as u32 - 1
}

/// Reads all MTL files into `parts`, in the order in which `tobj` numbers their materials.
fn libraries(path: &Path, checked: &Checked, parts: &mut SceneParts, budget: &Budget) -> Result<Vec<Library>> {
    let folder = path.parent().unwrap_or(Path::new(""));
    let mut seen = HashSet::new();
    let mut libraries = Vec::new();
    let mut failures = 0;
    for (n, (line, names)) in checked.libraries.iter().enumerate() {
        // The statement holds one file name, or several without blanks in them.
        let one = [names.as_str()];
        let several: Vec<&str> = names.split_ascii_whitespace().collect();
        let list = if folder.join(names).is_file() { one.as_slice() } else { several.as_slice() };
        for name in list {
            if !seen.insert(name.to_string()) {
                continue;
            }
            if n.max(seen.len()) > MAX_LIBRARIES {
                return Err(Error::malformed(path, format!("line {line}: more than {MAX_LIBRARIES} MTL files")));
            }
            match mtl::read(&folder.join(name), parts, budget) {
                Ok(library) => libraries.push(library),
                Err(e) => {
                    failures += 1;
                    if failures <= MAX_MISSING {
                        parts.warnings.push(format!("{}: line {line}: no materials: {e}", path.display()));
                    }
                }
            }
        }
    }
    Ok(libraries)
}

/// Warns of names that no MTL file has, where they are first used.
fn missing_materials(path: &Path, checked: &Checked, libraries: &[Library], warnings: &mut Vec<String>) {
    let known: HashSet<&String> = libraries.iter().flat_map(|(_, by_name)| by_name.keys()).collect();
    let missing: Vec<_> = checked.faces.materials.iter().filter(|(name, _)| !known.contains(name)).collect();
    for (name, line) in missing.iter().take(MAX_MISSING) {
        let name = check::printable(name.as_bytes());
        warnings.push(format!("{}: line {line}: no material `{name}`, grey is used", path.display()));
    }
    if let Some(more) = missing.len().checked_sub(MAX_MISSING).filter(|&more| more > 0) {
        warnings.push(format!("{}: {more} more materials are not there", path.display()));
    }
}
