//! Solid voxels in scenes: their materials, and their faces as meshes for whoever wants these.

use super::{Mesh, Scene, SceneGeometry};
use crate::geometry::{Geometry, SolidVoxels};
use std::borrow::Cow;
use std::sync::Arc;

/// Indices of the materials of solid voxels, ascending.
pub(super) fn used(voxels: &SolidVoxels) -> impl Iterator<Item = u32> {
    let mut used = [false; 256];
    voxels.materials().iter().for_each(|&byte| used[usize::from(byte)] = true);
    (0..255).filter(move |&material| used[material as usize + 1])
}

/// What is wrong with voxels in a scene of so many materials.
pub(super) fn defect(voxels: &SolidVoxels, materials: usize) -> Option<String> {
    let last = used(voxels).last().filter(|&m| m as usize >= materials)?;
    Some(format!("voxels: material {last} of {materials}"))
}

/// A mesh for each material with an exposed face, in the order of the materials; faces do not share corners.
pub(super) fn meshes(voxels: &SolidVoxels) -> Vec<Mesh> {
    let mut meshes: Vec<Mesh> = Vec::new();
    let mut of_byte = [None; 256];
    for material in used(voxels) {
        of_byte[material as usize + 1] = Some(meshes.len());
        meshes.push(Mesh { name: format!("voxels of material {material}"), material, ..Mesh::default() });
    }
    for prim in (0..Geometry::len(voxels)).step_by(2) {
        let byte = voxels.material(voxels.face_of(prim).0);
        let (Some(mesh), Some([a, b, c]), Some([.., d])) =
            (of_byte[usize::from(byte)], voxels.triangle(prim), voxels.triangle(prim + 1))
        else {
            unreachable!("a primitive is a triangle of a solid voxel")
        };
        let mesh = &mut meshes[mesh];
        // Below 2^31 faces in all; a mesh of more than 2^30 would overflow, and does not fit in memory.
        let first = mesh.positions.len() as u32;
        mesh.positions.extend([a, b, c, d]);
        mesh.triangles.extend([[first, first + 1, first + 2], [first, first + 2, first + 3]]);
    }
    meshes.retain(|mesh| !mesh.triangles.is_empty());
    meshes
}

/// See [`Scene::with_meshes`].
pub(super) fn with_meshes(scene: &Scene) -> Cow<'_, Scene> {
    let Some(voxels) = scene.voxels() else { return Cow::Borrowed(scene) };
    let meshes = meshes(voxels);
    let mut mesh_offsets = vec![0];
    let mut triangles = Vec::new();
    for mesh in &meshes {
        triangles.extend(mesh.triangles.iter().map(|t| t.map(|i| mesh.positions[i as usize])));
        mesh_offsets.push(triangles.len() as u32);
    }
    let geometry = SceneGeometry::Triangles(Arc::new(triangles));
    Cow::Owned(Scene { geometry, meshes, mesh_offsets, ..scene.clone() })
}
