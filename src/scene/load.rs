//! Picks the loader by name and extension, and refuses or drops what is not finite.

use super::assemble::assemble;
use super::budget::Budget;
use super::{Mesh, Scene, SceneParts, dense, file, procedural, raw};
use crate::accel::half_the_memory;
use crate::error::{Error, Result};
use glam::{Vec2, Vec3};
use std::io::Read;
use std::path::Path;

/// Most bytes of one input file.
const MAX_FILE: u64 = 1 << 32;

/// How to read a scene.
#[derive(Clone, Debug)]
pub struct LoadOptions {
    /// Drop primitives with coordinates that are not finite, with a warning that counts them, instead of refusing.
    pub drop_invalid: bool,
    /// Bytes that meshes, textures and voxels may take together; a scene that needs more is refused before it takes them.
    pub memory: u64,
}

impl Default for LoadOptions {
    /// Nothing is dropped; half of the machine's memory.
    fn default() -> Self {
        Self { drop_invalid: false, memory: half_the_memory() }
    }
}

/// The options of one scene, and what is left of its memory.
pub(super) struct Loading {
    pub(super) drop_invalid: bool,
    pub(super) budget: Budget,
}

/// Reads `spec`: the path of a .toml ([`file`](mod@super::file)), .gltf, .glb, .obj, .vox, .npy (voxels), .tri or .sph
/// ([`raw`]) file, or the name of a procedural scene with options, such as `random:n=10000` ([`procedural::ENTRIES`]).
///
/// Files with a coordinate that is not finite are refused unless `options` says otherwise; but .tri and .sph files keep
/// all primitives, so that indices stay as in the file: bad ones are never hit, and a warning counts them.
///
/// # Errors
/// The file cannot be read, is not usable, or needs more memory than [`LoadOptions::memory`]: the message names the file, the
/// place and the cause. A name or an option of a procedural scene is unknown, or a value out of range.
///
/// ```
/// use skipgrid::Ray;
/// use skipgrid::scene::{LoadOptions, load};
/// use glam::Vec3;
///
/// let spheres = load("random:n=100,seed=7", &LoadOptions::default())?;
/// assert_eq!((spheres.primitive_count(), spheres.triangle_count()), (100, 0));
///
/// let text = r#"
///     [[material]]
///     name = "red"
///     type = "lambert"
///     albedo = [0.8, 0.1, 0.1]
///     [[sphere]]
///     centre = [0.0, 1.0, 0.0]
///     radius = 1.0
///     material = "red"
/// "#;
/// let file = std::env::temp_dir().join(format!("skipgrid-scene-{}.toml", std::process::id()));
/// std::fs::write(&file, text).map_err(|error| skipgrid::Error::io(&file, error))?;
/// let scene = load(&file.display().to_string(), &LoadOptions::default())?;
/// // What the file does not say is chosen, and told.
/// assert!(scene.notes.iter().any(|note| note.contains("camera")));
///
/// let ray = Ray::new(Vec3::new(0.0, 1.0, 5.0), -Vec3::Z);
/// let hit = scene.accel("grid")?.closest_hit(&ray).expect("the sphere is there");
/// assert_eq!((hit.t, hit.prim), (4.0, 0));
/// let surface = scene.surface(&ray, hit);
/// assert_eq!(scene.materials[surface.material as usize].name, "red");
/// # std::fs::remove_file(&file).map_err(|error| skipgrid::Error::io(&file, error))?;
/// # Ok::<(), skipgrid::Error>(())
/// ```
pub fn load(spec: &str, options: &LoadOptions) -> Result<Scene> {
    let path = Path::new(spec);
    let loading = &Loading { drop_invalid: options.drop_invalid, budget: Budget::new(options) };
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    let parts = match extension.as_deref() {
        Some("toml") => file::read(path, loading)?,
        Some("tri") => bare_triangles(path)?,
        Some("sph") => bare_spheres(path)?,
        Some("obj" | "gltf" | "glb") => read_mesh_file(path, loading)?,
        Some("npy") => dense::read(path, &loading.budget)?,
        #[cfg(feature = "vox")]
        Some("vox") => super::vox::read(path, &loading.budget)?,
        _ => procedural::parse_within(spec, &loading.budget)?,
    };
    assemble(parts, spec)
}

/// Reads a .gltf, .glb or .obj file; every coordinate that is left is finite.
pub(super) fn read_mesh_file(path: &Path, loading: &Loading) -> Result<SceneParts> {
    let extension = path.extension().and_then(|e| e.to_str()).map(str::to_ascii_lowercase);
    type Read = fn(&Path, &Loading) -> Result<SceneParts>;
    let read: Option<Read> = match extension.as_deref() {
        #[cfg(feature = "gltf")]
        Some("gltf" | "glb") => Some(super::gltf::read),
        #[cfg(feature = "obj")]
        Some("obj") => Some(super::obj::read),
        _ => None,
    };
    let cause = "not a kind of mesh file that this build reads (.gltf, .glb, .obj)";
    let mut parts = read.ok_or_else(|| Error::malformed(path, cause))?(path, loading)?;
    make_finite(&mut parts, path, loading)?;
    Ok(parts)
}

/// The name of a scene file without folder and extension.
pub(super) fn stem(path: &Path) -> String {
    path.file_stem().map_or_else(|| "scene".into(), |s| s.to_string_lossy().into_owned())
}

/// The whole file, if it is a regular file of a size that can be meant.
pub(super) fn read_bytes(path: &Path) -> Result<Vec<u8>> {
    let io = |source| Error::io(path, source);
    // Asked before opening: opening a pipe would wait for a writer.
    let meta = std::fs::metadata(path).map_err(io)?;
    if !meta.is_file() {
        return Err(Error::malformed(path, "not a regular file"));
    }
    if meta.len() > MAX_FILE {
        return Err(Error::malformed(path, format!("{} bytes, at most {MAX_FILE} are read", meta.len())));
    }
    let mut bytes = Vec::new();
    let wanted = usize::try_from(meta.len()).unwrap_or(usize::MAX);
    bytes.try_reserve_exact(wanted).map_err(|_| Error::TooLarge {
        what: path.display().to_string(),
        wanted: meta.len(),
        allowed: 0,
    })?;
    std::fs::File::open(path).map_err(io)?.take(MAX_FILE).read_to_end(&mut bytes).map_err(io)?;
    Ok(bytes)
}

fn bare_triangles(path: &Path) -> Result<SceneParts> {
    let triangles = raw::read_triangles(path)?;
    let count = u32::try_from(triangles.len()).ok().filter(|n| n.checked_mul(3).is_some());
    let Some(count) = count else {
        return Err(Error::malformed(path, format!("{} triangles are too many", triangles.len())));
    };
    let bad = triangles.iter().filter(|t| !t.iter().all(|p| p.is_finite())).count();
    let mesh = Mesh {
        name: stem(path),
        positions: triangles.into_flattened(),
        triangles: (0..count).map(|i| [3 * i, 3 * i + 1, 3 * i + 2]).collect(),
        ..Mesh::default()
    };
    Ok(SceneParts { name: stem(path), meshes: vec![mesh], warnings: never_hit(path, bad), ..SceneParts::default() })
}

fn bare_spheres(path: &Path) -> Result<SceneParts> {
    let spheres: Vec<_> = raw::read_spheres(path)?.into_iter().map(|s| (s, 0)).collect();
    let good = |r: f32| r >= 0.0 && r.is_finite();
    let bad = spheres.iter().filter(|(s, _)| !(s.centre.is_finite() && good(s.radius))).count();
    Ok(SceneParts { name: stem(path), spheres, warnings: never_hit(path, bad), ..SceneParts::default() })
}

fn never_hit(path: &Path, bad: usize) -> Vec<String> {
    let warning = || format!("{}: {bad} primitives are not finite and are never hit", path.display());
    (bad > 0).then(warning).into_iter().collect()
}

/// Refuses vertices that are not finite, or drops the triangles that use them.
fn make_finite(parts: &mut SceneParts, path: &Path, loading: &Loading) -> Result<()> {
    let mut dropped = 0;
    for (m, mesh) in parts.meshes.iter_mut().enumerate() {
        let Some(v) = (0..mesh.positions.len()).find(|&v| !vertex_is_finite(mesh, v)) else { continue };
        if !loading.drop_invalid {
            let name = &mesh.name;
            let cause = format!("mesh {m} `{name}`: vertex {v}: {} is not finite", vertex_defect(mesh, v));
            return Err(Error::malformed(path, cause));
        }
        dropped += drop_invalid(mesh);
    }
    if dropped > 0 {
        parts.warnings.push(format!("{}: dropped {dropped} triangles that are not finite", path.display()));
    }
    Ok(())
}

/// Drops the triangles with a vertex that is not finite; says how many there were.
pub(super) fn drop_invalid(mesh: &mut Mesh) -> usize {
    let bad: Vec<bool> = (0..mesh.positions.len()).map(|v| !vertex_is_finite(mesh, v)).collect();
    let before = mesh.triangles.len();
    // An index out of range stays, for `Scene::new` to name.
    mesh.triangles.retain(|t| t.iter().all(|&i| bad.get(i as usize) != Some(&true)));
    // Nothing refers to these vertices any more; exporters write them all the same.
    for v in (0..bad.len()).filter(|&v| bad[v]) {
        mesh.positions[v] = Vec3::ZERO;
        mesh.normals.get_mut(v).into_iter().for_each(|n| *n = Vec3::ZERO);
        mesh.uvs.get_mut(v).into_iter().for_each(|uv| *uv = Vec2::ZERO);
    }
    before - mesh.triangles.len()
}

fn vertex_is_finite(mesh: &Mesh, v: usize) -> bool {
    mesh.positions[v].is_finite()
        && mesh.normals.get(v).is_none_or(|n| n.is_finite())
        && mesh.uvs.get(v).is_none_or(|uv| uv.is_finite())
}

fn vertex_defect(mesh: &Mesh, v: usize) -> String {
    if !mesh.positions[v].is_finite() {
        format!("position {}", mesh.positions[v])
    } else if let Some(n) = mesh.normals.get(v).filter(|n| !n.is_finite()) {
        format!("normal {n}")
    } else {
        format!("texture coordinate {}", mesh.uvs.get(v).copied().unwrap_or_default())
    }
}
