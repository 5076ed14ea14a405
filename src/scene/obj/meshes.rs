//! Joins the models of `tobj` into one mesh for each group and material.

use super::faces::Faces;
use crate::scene::Mesh;
use crate::scene::transform::make_normals_unit;
use glam::{Vec2, Vec3};
use std::collections::HashMap;

#[derive(Default)]
struct Builder {
    mesh: Mesh,
    material: Option<usize>,
    with_normals: bool,
    without_normals: bool,
    with_uvs: bool,
}

/// The meshes in order of their first faces, each with its material; and how many lost normals that only some of their
/// corners have.
pub(super) fn meshes(models: &[tobj::Model], faces: &Faces) -> (Vec<(Mesh, Option<usize>)>, usize) {
    let mut builders: Vec<Builder> = Vec::new();
    let mut numbers = HashMap::new();
    // `tobj` makes one model of each set; it has one without faces if there are no sets.
    for (model, set) in models.iter().zip(&faces.sets) {
        let material = model.mesh.material_id;
        let next = builders.len();
        let number = *numbers.entry((set.key.group, material)).or_insert(next);
        if number == next {
            let name = faces.group_name(set.key.group).map_or_else(|| format!("mesh {next}"), str::to_owned);
            builders.push(Builder { mesh: Mesh { name, ..Mesh::default() }, material, ..Builder::default() });
        }
        builders[number].add(&model.mesh, set.key.has_uvs, set.key.has_normals);
    }
    let partial = builders.iter().filter(|b| b.with_normals && b.without_normals).count();
    (builders.into_iter().map(|b| (b.material, b.finish())).map(|(material, mesh)| (mesh, material)).collect(), partial)
}

impl Builder {
    fn add(&mut self, from: &tobj::Mesh, has_uvs: bool, has_normals: bool) {
        let mesh = &mut self.mesh;
        // Bounded by the size of the file, far below 2^32.
        let first = mesh.positions.len() as u32;
        mesh.positions.extend(vectors(&from.positions));
        if has_normals {
            mesh.normals.extend(vectors(&from.normals));
        }
        if has_uvs {
            mesh.uvs.extend(from.texcoords.as_chunks().0.iter().map(|&[u, v]| Vec2::new(u, 1.0 - v)));
        }
        // Gaps are filled, so that lists stay of one length; `finish` drops lists that are nothing but gaps.
        mesh.normals.resize(mesh.positions.len(), Vec3::ZERO);
        mesh.uvs.resize(mesh.positions.len(), Vec2::ZERO);
        mesh.triangles.extend(from.indices.as_chunks().0.iter().map(|t: &[u32; 3]| t.map(|i| first + i)));
        self.with_normals |= has_normals;
        self.without_normals |= !has_normals;
        self.with_uvs |= has_uvs;
    }

    fn finish(self) -> Mesh {
        let mut mesh = self.mesh;
        if self.without_normals {
            mesh.normals.clear();
        }
        if !self.with_uvs {
            mesh.uvs.clear();
        }
        make_normals_unit(&mut mesh);
        mesh
    }
}

fn vectors(numbers: &[f32]) -> impl Iterator<Item = Vec3> {
    numbers.as_chunks().0.iter().map(|&v| Vec3::from_array(v))
}
