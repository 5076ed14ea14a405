//! MagicaVoxel's `.vox` files as solid voxels.
//!
//! `dot_vox` takes the bytes apart. It passes over what it cannot read and may end with a panic, so the structure of the file
//! is checked before: see `check.rs`. What is read: models, the palette (or the default one), the scene graph with its
//! translations and rotations, hidden nodes and layers, and emission; the rest is named in a note. Of animations the first
//! frame is shown.
//!
//! MagicaVoxel's z points upwards; here it is y, as in all scenes: (x, y, z) becomes (x, z, -y), and handedness stays. A
//! voxel has edge 1. A model of the scene graph has its middle, rounded down to whole voxels, at its node's origin; the
//! model of a file without a graph has its least corner there. Where models overlap the later one counts.
//!
//! A colour of the palette is sRGB and becomes a Lambert material. A colour of the type `_emit` also emits: its radiance is
//! the linear colour times `_emit` times ten to the power of `_flux`, which is our reading, as the format has no units.
//!
//! Source: the format's description, "MagicaVoxel .vox File Format" (version 150) and its extension (version 200), by its
//! author.

mod check;
mod graph;

use super::budget::Budget;
use super::load::{read_bytes, stem};
use super::{Bsdf, Material, SceneParts};
use crate::error::{Error, Result};
use crate::geometry::SolidVoxels;
use crate::picture::srgb;
use dot_vox::DotVoxData;
use glam::{I64Vec3, Vec3};
use graph::Placed;
use std::path::Path;

/// Most voxels of all placed models together, whether they overlap or not.
const MAX_PLACED: u64 = 1 << 28;
/// Most names in a note.
const MAX_NAMED: usize = 8;

/// Reads a file.
///
/// # Errors
/// The file cannot be read; its structure is broken, with the byte; it has no voxel; the models spread over more than
/// [`SolidVoxels::MAX_RESOLUTION`] voxels along an axis or [`SolidVoxels::MAX_VOXELS`] in all, or take more than `budget`.
pub(super) fn read(path: &Path, budget: &Budget) -> Result<SceneParts> {
    let bytes = read_bytes(path)?;
    check::check(&bytes).map_err(|cause| Error::malformed(path, cause))?;
    let data = dot_vox::load_bytes(&bytes).map_err(|cause| Error::malformed(path, cause))?;
    drop(bytes);
    let mut notes = Vec::new();
    let parts = parts(&data, &mut notes, budget).map_err(|cause| Error::malformed(path, cause))?;
    let notes = notes.into_iter().map(|note| format!("{}: {note}", path.display()));
    Ok(SceneParts { name: stem(path), notes: notes.collect(), ..parts })
}

/// The error is the cause.
fn parts(data: &DotVoxData, notes: &mut Vec<String>, budget: &Budget) -> std::result::Result<SceneParts, String> {
    let placed = graph::placed(data, notes)?;
    let total: u64 = placed.iter().map(|p| data.models[p.model].voxels.len() as u64).sum();
    if total > MAX_PLACED {
        return Err(format!("the placed models have {total} voxels together, at most {MAX_PLACED} are read"));
    }
    let (min, max) = each(data, &placed).fold((I64Vec3::MAX, I64Vec3::MIN), |(a, b), (p, _)| (a.min(p), b.max(p)));
    if min.cmpgt(max).any() {
        return Err(match data.models.len() {
            0 => "no model".into(),
            n => format!("no voxel in {n} models"),
        });
    }
    let size = max - min + 1;
    let most = i64::from(SolidVoxels::MAX_RESOLUTION);
    let voxels = size.element_product();
    if size.max_element() > most || voxels as u64 > SolidVoxels::MAX_VOXELS {
        let all = SolidVoxels::MAX_VOXELS;
        return Err(format!(
            "the models spread over {size} voxels; at most {most} along an axis and {all} are possible"
        ));
    }
    // Single precision has all whole numbers up to here.
    if min.abs().max(max.abs()).max_element() > 1 << 23 {
        return Err(format!("the models lie between {min} and {max}, too far from the origin"));
    }
    // A byte for each voxel, four for each face of a solid one.
    let wanted = voxels as u64 + 24 * total.min(voxels as u64);
    budget.take(wanted, || format!("models spread over {size} voxels")).map_err(|e| e.to_string())?;
    let mut materials = Vec::new();
    let mut bytes: Vec<u8> = Vec::new();
    bytes.try_reserve_exact(voxels as usize).map_err(|_| format!("no memory for {voxels} voxels"))?;
    bytes.resize(voxels as usize, 0);
    let mut byte_of = [0_u8; 256];
    for (place, colour) in each(data, &placed) {
        let byte = &mut byte_of[usize::from(colour)];
        if *byte == 0 {
            materials.push(material(data, colour)?);
            // 255 colours at most: index 0 is no colour.
            *byte = materials.len() as u8;
        }
        let at = place - min;
        bytes[((at.z * size.y + at.y) * size.x + at.x) as usize] = *byte;
    }
    note_materials(data, &byte_of, notes);
    // All within 2^23.
    let resolution = size.to_array().map(|n| n as u32);
    let voxels = SolidVoxels::new(resolution, bytes, min.as_vec3(), 1.0).map_err(|e| e.to_string())?;
    Ok(SceneParts { voxels: Some(voxels), materials, ..SceneParts::default() })
}

/// All voxels of all placed models: where in our coordinates, and the colour's index from 0.
fn each<'a>(data: &'a DotVoxData, placed: &'a [Placed]) -> impl Iterator<Item = (I64Vec3, u8)> + 'a {
    placed.iter().flat_map(move |placed| {
        let voxels = &data.models[placed.model].voxels;
        voxels.iter().map(move |v| {
            let p = placed.place(I64Vec3::new(v.x.into(), v.y.into(), v.z.into()));
            // The cell from y to y + 1 lies between -y - 1 and -y.
            (I64Vec3::new(p.x, p.z, -p.y - 1), v.i)
        })
    })
}

/// The property of a colour's material.
fn property<'a>(data: &'a DotVoxData, colour: u8, key: &str) -> Option<&'a str> {
    // Materials count colours from 1.
    let material = data.materials.iter().rev().find(|m| m.id == u32::from(colour) + 1)?;
    material.properties.get(key).map(String::as_str)
}

fn number(data: &DotVoxData, colour: u8, key: &str) -> Option<f32> {
    property(data, colour, key)?.trim().parse().ok()
}

fn material(data: &DotVoxData, colour: u8) -> std::result::Result<Material, String> {
    let index = usize::from(colour);
    let Some(c) = data.palette.get(index) else {
        return Err(format!("colour {} of a palette of {}", index + 1, data.palette.len()));
    };
    let albedo = Vec3::from([c.r, c.g, c.b].map(|code| srgb::decode(f64::from(code) / 255.0)));
    let bsdf = Bsdf::Lambert { albedo, texture: None };
    let mut emission = Vec3::ZERO;
    if property(data, colour, "_type") == Some("_emit") {
        let share = number(data, colour, "_emit").unwrap_or(1.0);
        let power = number(data, colour, "_flux").unwrap_or(0.0);
        let radiance = albedo * share * 10f32.powf(power);
        if !(radiance.is_finite() && radiance.min_element() >= 0.0) {
            return Err(format!("colour {}: `_emit` {share} and `_flux` {power} give no radiance", index + 1));
        }
        emission = radiance;
    }
    Ok(Material { name: format!("colour {}", index + 1), bsdf, emission })
}

/// Names the colours in use that are more than colours.
fn note_materials(data: &DotVoxData, byte_of: &[u8; 256], notes: &mut Vec<String>) {
    let mut kinds: Vec<(&str, Vec<String>)> = Vec::new();
    for colour in (0..=u8::MAX).filter(|&c| byte_of[usize::from(c)] != 0) {
        let kind = property(data, colour, "_type").unwrap_or("_diffuse");
        if kind == "_diffuse" {
            continue;
        }
        let name = (u32::from(colour) + 1).to_string();
        // 255 kinds at most.
        match kinds.iter_mut().find(|(known, _)| *known == kind) {
            Some((_, names)) => names.push(name),
            None => kinds.push((kind, vec![name])),
        }
    }
    for (kind, mut names) in kinds {
        let more = names.len().saturating_sub(MAX_NAMED);
        names.truncate(MAX_NAMED);
        let rest = if more > 0 { format!(" and {more} more") } else { String::new() };
        let what = match kind {
            "_emit" => "emits: radiance is the colour times `_emit` times ten to the power of `_flux`",
            _ => "is shown as a matt colour",
        };
        let kind: String = kind.chars().take(32).collect();
        notes.push(format!("material `{}` of colour {}{rest} {what}", kind.escape_debug(), names.join(", ")));
    }
}
