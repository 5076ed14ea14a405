//! Bicubic patches in a scene: what they may stand beside, their surface, and meshes for renderers that have none.

use super::procedural::patch::{Edge, patch};
use super::{Mesh, Scene, SceneGeometry, SceneParts, Surface};
use crate::accel::Hit;
use crate::geometry::{BezierPatches, Geometry};
use crate::ray::{Aabb, Ray};
use glam::{DVec2, DVec3, Vec3};

/// Steps along each edge of a patch where it has to become a mesh.
pub(super) const STEPS: u32 = 32;

/// The least box around all that can be hit.
pub(super) fn bounds(patches: &BezierPatches) -> Aabb {
    (0..patches.len()).fold(Aabb::EMPTY, |all, prim| all.union(&patches.bounds(prim)))
}

/// What makes the patches of a scene unusable.
pub(super) fn defect(parts: &SceneParts) -> Option<String> {
    let (patches, materials) = (&parts.patches, parts.materials.len());
    if let Some((i, (_, m))) = patches.iter().enumerate().find(|(_, (_, m))| *m as usize >= materials) {
        return Some(format!("patch {i}: material {m} of {materials}"));
    }
    let triangles: usize = parts.meshes.iter().map(|m| m.triangles.len()).sum();
    let spheres = parts.spheres.len();
    if !patches.is_empty() && triangles + spheres > 0 {
        let counts = format!("{} patches, {triangles} triangles and {spheres} spheres", patches.len());
        return Some(format!("{counts}: a scene of patches can have no other primitive"));
    }
    let shines = |m: u32| parts.materials[m as usize].emission != Vec3::ZERO;
    let (i, (_, m)) = patches.iter().enumerate().find(|(_, (_, m))| shines(*m))?;
    Some(format!("patch {i}: material {m} `{}` emits light, which a patch cannot", parts.materials[*m as usize].name))
}

/// See [`Scene::surface`]. The texture coordinates are (u, 1 - v): v down as everywhere.
pub(super) fn surface(patches: &BezierPatches, material: u32, ray: &Ray, hit: Hit) -> Surface {
    let facing = || (-ray.direction.as_dvec3()).try_normalize().unwrap_or(DVec3::Z);
    // A hit comes from these patches; if it does not, its own parameter is all there is.
    let Some((u, v)) = patches.locate(hit.prim, ray, hit.t) else {
        let (position, normal) = (ray.at(f64::from(hit.t)), facing());
        return Surface { position, geometric_normal: normal, shading_normal: normal, uv: DVec2::ZERO, material };
    };
    let [position, ..] = patches.evaluate(hit.prim, u, v);
    let normal = patches.normal(hit.prim, u, v).try_normalize().unwrap_or_else(facing);
    Surface { position, geometric_normal: normal, shading_normal: normal, uv: DVec2::new(u, 1.0 - v), material }
}

/// The patches as meshes of `steps` steps along each edge, one for each usable patch; none if the scene has no patches.
pub(super) fn tessellated(scene: &Scene, steps: u32) -> Vec<Mesh> {
    let SceneGeometry::Patches(patches) = &scene.geometry else { return Vec::new() };
    let mesh = |prim: u32| {
        let edge = (steps, Edge::Open);
        let mut mesh = patch(&format!("patch {prim}"), edge, edge, |u, v| {
            (patches.evaluate(prim, u, v)[0], patches.normal(prim, u, v))
        });
        mesh.material = scene.patch_materials[prim as usize];
        mesh
    };
    (0..patches.len()).filter(|&prim| !patches.bounds(prim).is_empty()).map(mesh).collect()
}
