//! Checks the parts of a scene, lays its primitives out in one index space, and adds what it lacks.

use super::{Bsdf, Camera, Light, Material, Scene, SceneGeometry, SceneParts, patches, voxels};
use crate::error::{Error, Result};
use crate::geometry::bezier::ControlPoints;
use crate::geometry::{BezierPatches, Geometry, Mixed, Sphere, Triangle};
use crate::ray::Aabb;
use glam::{DVec3, Vec2, Vec3};
use std::f32::consts::PI;
use std::sync::Arc;

/// Environment and directional light of a scene without light: together at most 1 on a diffuse surface of albedo 1.
const DEFAULT_ENVIRONMENT: f32 = 0.6;
const DEFAULT_IRRADIANCE: f32 = 0.4 * PI;

/// See [`Scene::new`]; `origin` is what messages call the scene: its file or its name.
pub(super) fn assemble(mut parts: SceneParts, origin: &str) -> Result<Scene> {
    if parts.materials.is_empty() {
        parts.materials.push(Material::grey());
    }
    if let Some(cause) = parts.voxels.as_ref().and_then(|v| voxels::defect(v, parts.materials.len())) {
        return Err(Error::invalid(format!("{origin}: {cause}")));
    }
    let mixed = !(parts.meshes.is_empty() && parts.spheres.is_empty() && parts.patches.is_empty());
    if let Some(voxels) = parts.voxels.take_if(|_| mixed) {
        parts.meshes.extend(voxels::meshes(&voxels));
        parts.notes.push(format!("{origin}: the voxels became meshes, because the scene has other primitives too"));
    }
    check(&parts, origin)?;
    fill_texture_coordinates(&mut parts);
    let mesh_offsets = mesh_offsets(&parts, origin)?;
    let triangles = triangles(&parts, mesh_offsets.last().copied().unwrap_or(0))?;
    let (spheres, sphere_materials): (Vec<Sphere>, Vec<u32>) = parts.spheres.iter().copied().unzip();
    let (patches, patch_materials): (Vec<ControlPoints>, Vec<u32>) = parts.patches.iter().copied().unzip();
    let patches = BezierPatches::new(patches);
    let bounds = match &parts.voxels {
        Some(voxels) => voxels.solid_bounds(),
        None => patches::bounds(&patches).union(&bounds(&triangles, &spheres)),
    };
    if bounds.is_empty() && triangles.is_empty() && spheres.is_empty() && patches.is_empty() {
        parts.warnings.push(format!("{origin}: the scene has no primitive"));
    }
    let camera = parts.camera.unwrap_or_else(|| Camera::framed(&bounds));
    light_up(&mut parts, &camera, origin);
    let geometry = match (triangles.is_empty(), spheres.is_empty()) {
        _ if !patches.is_empty() => SceneGeometry::Patches(Arc::new(patches)),
        (_, true) => SceneGeometry::Triangles(Arc::new(triangles)),
        (true, false) => SceneGeometry::Spheres(Arc::new(spheres.clone())),
        (false, false) => SceneGeometry::Mixed(Arc::new(Mixed { triangles, spheres: spheres.clone() })),
    };
    let geometry = parts.voxels.map_or(geometry, SceneGeometry::Voxels);
    Ok(Scene {
        name: parts.name,
        geometry,
        meshes: parts.meshes,
        mesh_offsets,
        spheres,
        sphere_materials,
        patch_materials,
        materials: parts.materials,
        textures: parts.textures,
        lights: parts.lights,
        environment: parts.environment,
        camera,
        defaults: parts.defaults,
        warnings: parts.warnings,
        notes: parts.notes,
    })
}

/// References, counts and finiteness of everything but the primitives' coordinates.
fn check(parts: &SceneParts, origin: &str) -> Result<()> {
    let fail = |cause: String| Err(Error::invalid(format!("{origin}: {cause}")));
    let materials = parts.materials.len();
    for (i, mesh) in parts.meshes.iter().enumerate() {
        let place = || format!("mesh {i} `{}`", mesh.name);
        let vertices = mesh.positions.len();
        if let Some((t, corner)) = mesh.first_bad_index() {
            return fail(format!("{}: triangle {t} refers to vertex {corner} of {vertices}", place()));
        }
        for (what, count) in [("normals", mesh.normals.len()), ("texture coordinates", mesh.uvs.len())] {
            if count != 0 && count != vertices {
                return fail(format!("{}: {count} {what} for {vertices} vertices", place()));
            }
        }
        if mesh.material as usize >= materials {
            return fail(format!("{}: material {} of {materials}", place(), mesh.material));
        }
    }
    if let Some((i, (_, m))) = parts.spheres.iter().enumerate().find(|(_, (_, m))| *m as usize >= materials) {
        return fail(format!("sphere {i}: material {m} of {materials}"));
    }
    if let Some(cause) = patches::defect(parts) {
        return fail(cause);
    }
    for (i, material) in parts.materials.iter().enumerate() {
        if let Bsdf::Lambert { texture: Some(t), .. } = material.bsdf
            && t as usize >= parts.textures.len()
        {
            return fail(format!("material {i} `{}`: texture {t} of {}", material.name, parts.textures.len()));
        }
        if let Some(what) = material.defect() {
            return fail(format!("material {i} `{}`: {what}", material.name));
        }
    }
    for (i, texture) in parts.textures.iter().enumerate() {
        let (w, h, n) = (texture.width, texture.height, texture.texels.len());
        if n == 0 || u64::from(w) * u64::from(h) != n as u64 {
            return fail(format!("texture {i} `{}`: {w} x {h} pixels but {n} texels", texture.name));
        }
    }
    for (i, light) in parts.lights.iter().enumerate() {
        if let Some(what) = light.defect() {
            return fail(format!("light {i}: {what}"));
        }
    }
    if let Some(what) = parts.camera.as_ref().and_then(Camera::defect) {
        return fail(format!("camera: {what}"));
    }
    if !parts.environment.is_finite() || parts.environment.min_element() < 0.0 {
        return fail(format!("environment {} is not finite or negative", parts.environment));
    }
    Ok(())
}

/// Gives (0, 0) to the vertices of textured meshes without coordinates: other renderers would make up their own.
fn fill_texture_coordinates(parts: &mut SceneParts) {
    for mesh in parts.meshes.iter_mut().filter(|m| m.uvs.is_empty()) {
        let bsdf = &parts.materials[mesh.material as usize].bsdf;
        if matches!(bsdf, Bsdf::Lambert { texture: Some(_), .. }) {
            mesh.uvs = vec![Vec2::ZERO; mesh.positions.len()];
        }
    }
}

fn mesh_offsets(parts: &SceneParts, origin: &str) -> Result<Vec<u32>> {
    let mut offsets = vec![0];
    let mut total = 0_u64;
    for mesh in &parts.meshes {
        total += mesh.triangles.len() as u64;
        offsets.push(u32::try_from(total).unwrap_or(u32::MAX));
    }
    total += parts.spheres.len() as u64 + parts.patches.len() as u64;
    // The last index is kept free for "no primitive".
    if total > u64::from(u32::MAX) - 1 {
        let cause = format!("{origin}: {total} primitives, at most {} are possible", u32::MAX - 1);
        return Err(Error::invalid(cause));
    }
    Ok(offsets)
}

fn triangles(parts: &SceneParts, count: u32) -> Result<Vec<Triangle>> {
    let mut triangles: Vec<Triangle> = Vec::new();
    triangles.try_reserve_exact(count as usize).map_err(|_| Error::TooLarge {
        what: format!("{}: {count} triangles", parts.name),
        wanted: u64::from(count) * size_of::<Triangle>() as u64,
        allowed: 0,
    })?;
    for mesh in &parts.meshes {
        let corners = mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize]));
        triangles.extend(corners);
    }
    Ok(triangles)
}

/// The least box around all that can be hit.
fn bounds(triangles: &[Triangle], spheres: &[Sphere]) -> Aabb {
    let triangles = triangles.iter().map(|t| Aabb::of_points(t));
    let spheres = spheres.iter().map(|s| Aabb::of_points(&[s.centre - s.radius, s.centre + s.radius]));
    triangles.chain(spheres).fold(Aabb::EMPTY, |all, one| all.union(&one))
}

/// Adds the default light if nothing emits any.
fn light_up(parts: &mut SceneParts, camera: &Camera, origin: &str) {
    let emits = |material: u32| parts.materials[material as usize].emission != Vec3::ZERO;
    let lit = !parts.lights.is_empty()
        || parts.environment != Vec3::ZERO
        || parts.meshes.iter().any(|m| !m.triangles.is_empty() && emits(m.material))
        || parts.spheres.iter().any(|&(_, m)| emits(m))
        || parts.voxels.as_ref().is_some_and(|v| voxels::used(v).any(emits));
    if lit {
        return;
    }
    let [forward, right, up] = camera.basis();
    let direction: DVec3 = (forward + 0.5 * right - 0.7 * up).normalize();
    parts.environment = Vec3::splat(DEFAULT_ENVIRONMENT);
    parts.lights.push(Light::Directional { direction, irradiance: Vec3::splat(DEFAULT_IRRADIANCE) });
    parts.notes.push(format!(
        "{origin}: no light in the scene: added a constant environment of {DEFAULT_ENVIRONMENT} and a directional light of \
         {DEFAULT_IRRADIANCE:.3} W/m^2 from behind the camera"
    ));
}
