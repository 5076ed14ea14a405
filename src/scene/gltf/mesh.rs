//! Reads the primitives of a mesh in its own space.

use super::Notices;
use super::accessor::Data;
use super::material::Materials;
use crate::error::{Error, Result};
use crate::scene::Mesh;
use crate::scene::transform::make_normals_unit;
use ::gltf::json::mesh::{Mode, Primitive, Semantic};
use ::gltf::json::validation::Checked;
use glam::{Vec2, Vec3};

/// The triangles of mesh `m`, one mesh for each primitive that has any.
pub(super) fn read(data: &Data, m: usize, materials: &Materials, notices: &mut Notices) -> Result<Vec<Mesh>> {
    let Some(mesh) = data.root.meshes.get(m) else {
        let count = data.root.meshes.len();
        return Err(Error::malformed(data.path, format!("mesh {m} of {count}")));
    };
    let name = mesh.name.clone().unwrap_or_else(|| format!("mesh {m}"));
    let mut list = Vec::new();
    for (p, primitive) in mesh.primitives.iter().enumerate() {
        let place = format!("meshes[{m}].primitives[{p}]");
        let mode = match primitive.mode {
            Checked::Valid(mode @ (Mode::Triangles | Mode::TriangleStrip | Mode::TriangleFan)) => mode,
            Checked::Valid(_) => {
                notices.warn(format_args!("{place}: points and lines are left out"));
                continue;
            }
            Checked::Invalid => return Err(Error::malformed(data.path, format!("{place}: unknown mode"))),
        };
        let mut mesh = vertices(data, primitive, materials, &place, notices)?;
        mesh.triangles = triangles(data, primitive, mode, mesh.positions.len(), &place, notices)?;
        mesh.name = name.clone();
        list.push(mesh);
    }
    Ok(list)
}

fn vertices(
    data: &Data,
    primitive: &Primitive,
    materials: &Materials,
    place: &str,
    notices: &mut Notices,
) -> Result<Mesh> {
    let attribute = |semantic| primitive.attributes.get(&Checked::Valid(semantic)).map(|a| a.value());
    let Some(positions) = attribute(Semantic::Positions) else {
        return Err(Error::malformed(data.path, format!("{place}: no POSITION")));
    };
    let mut mesh = Mesh {
        positions: data.vectors::<3>(positions)?.into_iter().map(Vec3::from_array).collect(),
        material: primitive.material.map_or(materials.grey, |i| i.value() as u32),
        ..Mesh::default()
    };
    if let Some(normals) = attribute(Semantic::Normals) {
        mesh.normals = data.vectors::<3>(normals)?.into_iter().map(Vec3::from_array).collect();
        make_normals_unit(&mut mesh);
    }
    let set = materials.coordinates.get(mesh.material as usize).copied().flatten();
    match (attribute(Semantic::TexCoords(set.unwrap_or(0))), set) {
        (Some(uvs), _) => mesh.uvs = data.vectors::<2>(uvs)?.into_iter().map(Vec2::from_array).collect(),
        (None, Some(set)) => {
            notices.warn(format_args!("{place}: no TEXCOORD_{set} for the material's texture, taken as (0, 0)"));
        }
        (None, None) => {}
    }
    if attribute(Semantic::Colors(0)).is_some() {
        notices.note("vertex colours are passed over");
    }
    if primitive.targets.as_ref().is_some_and(|t| !t.is_empty()) {
        notices.warn("morph targets are passed over");
    }
    let count = mesh.positions.len();
    for (what, n) in [("NORMAL", mesh.normals.len()), ("TEXCOORD", mesh.uvs.len())] {
        if n != 0 && n != count {
            return Err(Error::malformed(data.path, format!("{place}: {n} {what} for {count} POSITION")));
        }
    }
    Ok(mesh)
}

fn triangles(
    data: &Data,
    primitive: &Primitive,
    mode: Mode,
    count: usize,
    place: &str,
    notices: &mut Notices,
) -> Result<Vec<[u32; 3]>> {
    let order = match primitive.indices {
        Some(indices) => data.indices(indices.value())?,
        None => {
            let bytes = 4 * count as u64;
            data.budget.take(bytes, || format!("{}: {place}: {count} corners", data.path.display()))?;
            (0..count as u32).collect()
        }
    };
    // A strip or fan makes a triangle of almost every corner.
    let bytes = size_of::<[u32; 3]>() as u64 * order.len() as u64;
    data.budget.take(bytes, || format!("{}: {place}: {} corners", data.path.display(), order.len()))?;
    if let Some((i, vertex)) = order.iter().enumerate().find(|&(_, &v)| v as usize >= count) {
        return Err(Error::malformed(data.path, format!("{place}: index {i} refers to vertex {vertex} of {count}")));
    }
    let left_over = match mode {
        Mode::Triangles => !order.len().is_multiple_of(3),
        _ => matches!(order.len(), 1 | 2),
    };
    if left_over {
        notices.warn(format_args!("{place}: {} corners are no whole number of triangles", order.len()));
    }
    Ok(match mode {
        Mode::Triangles => order.as_chunks::<3>().0.to_vec(),
        // glTF 2.0 specification, section 3.7.2.1: every second triangle of a strip is turned around.
        Mode::TriangleStrip => {
            let turn = |(i, w): (usize, &[u32])| if i % 2 == 0 { [w[0], w[1], w[2]] } else { [w[0], w[2], w[1]] };
            order.windows(3).enumerate().map(turn).collect()
        }
        _ => {
            let first = order.first().copied().unwrap_or(0);
            order.get(1..).unwrap_or_default().windows(2).map(|w| [w[0], w[1], first]).collect()
        }
    })
}
