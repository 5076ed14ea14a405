//! Gathers faces into meshes with one index for each different corner.

use crate::scene::Mesh;
use crate::scene::transform::make_normals_unit;
use glam::{Vec2, Vec3};
use std::collections::HashMap;

/// An index that a corner does not have.
pub(super) const NONE: u32 = u32::MAX;

/// All faces so far.
#[derive(Default)]
pub(super) struct Faces {
    /// Position, texture coordinate and normal of the corners of the face at hand.
    pub corners: Vec<[u32; 3]>,
    /// Faces with fewer than three corners.
    pub too_small: usize,
    group: String,
    material: Option<u32>,
    /// The mesh of the group and material at hand, once it has a face.
    current: Option<usize>,
    by_key: HashMap<(String, Option<u32>), usize>,
    builders: Vec<Builder>,
}

#[derive(Default)]
struct Builder {
    mesh: Mesh,
    material: Option<u32>,
    vertices: HashMap<[u32; 3], u32>,
    without_normal: bool,
    with_normal: bool,
    with_uv: bool,
}

impl Faces {
    pub(super) fn set_group(&mut self, name: &str) {
        self.group = name.to_owned();
        self.current = None;
    }

    pub(super) fn set_material(&mut self, material: Option<u32>) {
        self.material = material;
        self.current = None;
    }

    /// Adds the face of `corners`, whose indices are in range. The error is the cause alone.
    pub(super) fn add(&mut self, positions: &[Vec3], normals: &[Vec3], uvs: &[Vec2]) -> Result<(), String> {
        if self.corners.len() < 3 {
            self.too_small += 1;
            return Ok(());
        }
        let current = match self.current {
            Some(current) => current,
            None => self.start(),
        };
        self.current = Some(current);
        let builder = &mut self.builders[current];
        let mut first_two = [0; 2];
        for (k, corner) in self.corners.iter().enumerate() {
            let index = builder.vertex(*corner, positions, normals, uvs)?;
            match first_two.get_mut(k) {
                Some(place) => *place = index,
                None => {
                    builder.mesh.triangles.push([first_two[0], first_two[1], index]);
                    first_two[1] = index;
                }
            }
        }
        Ok(())
    }

    /// The mesh for the group and material at hand.
    fn start(&mut self) -> usize {
        let next = self.builders.len();
        let found = *self.by_key.entry((self.group.clone(), self.material)).or_insert(next);
        if found == next {
            let name = if self.group.is_empty() { format!("mesh {next}") } else { self.group.clone() };
            let mesh = Mesh { name, ..Mesh::default() };
            self.builders.push(Builder { mesh, material: self.material, ..Builder::default() });
        }
        found
    }

    /// Meshes with normals at some corners only; they lose them.
    pub(super) fn partial_normals(&self) -> usize {
        self.builders.iter().filter(|b| b.without_normal && b.with_normal).count()
    }

    /// The meshes in order of their first faces, each with its material.
    pub(super) fn meshes(self) -> impl Iterator<Item = (Mesh, Option<u32>)> {
        self.builders.into_iter().map(|mut builder| {
            if builder.without_normal {
                builder.mesh.normals.clear();
            }
            if !builder.with_uv {
                builder.mesh.uvs.clear();
            }
            make_normals_unit(&mut builder.mesh);
            (builder.mesh, builder.material)
        })
    }
}

impl Builder {
    fn vertex(&mut self, corner: [u32; 3], positions: &[Vec3], normals: &[Vec3], uvs: &[Vec2]) -> Result<u32, String> {
        if let Some(&known) = self.vertices.get(&corner) {
            return Ok(known);
        }
        let index = u32::try_from(self.mesh.positions.len()).map_err(|_| "more than 2^32 vertices")?;
        let [v, vt, vn] = corner;
        self.mesh.positions.push(positions[v as usize]);
        // Gaps are filled, so that lists stay of one length; `meshes` drops lists that are nothing but gaps.
        self.mesh.normals.push(normals.get(vn as usize).copied().unwrap_or_default());
        self.mesh.uvs.push(uvs.get(vt as usize).copied().unwrap_or_default());
        self.without_normal |= vn == NONE;
        self.with_normal |= vn != NONE;
        self.with_uv |= vt != NONE;
        self.vertices.insert(corner, index);
        Ok(index)
    }
}
