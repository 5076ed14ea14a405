//! Reads what has a shape: spheres, quads, triangles, mesh files and procedural bodies.

use super::schema::{Place, Scale};
use super::{Reader, schema};
use crate::error::{Error, Result};
use crate::geometry::Sphere;
use crate::scene::load::{drop_invalid, read_mesh_file};
use crate::scene::procedural::{self, Options};
use crate::scene::transform::{apply, is_regular, make_normals_unit, placement};
use crate::scene::{Bsdf, Material, Mesh, SceneParts};
use glam::{DAffine3, DVec3, Vec2, Vec3};
use toml::Spanned;

impl Reader<'_> {
    pub(super) fn sphere(&self, sphere: Spanned<schema::Sphere>, parts: &mut SceneParts) -> Result<()> {
        let at = sphere.span().start;
        let schema::Sphere { centre, radius, material } = sphere.into_inner();
        if self.loading.drop_invalid && !(Vec3::from_array(centre).is_finite() && radius.is_finite()) {
            parts.warnings.push(self.fail(at, "dropped a sphere that is not finite").to_string());
            return Ok(());
        }
        let centre = self.point(at, "centre", centre)?;
        if !(radius > 0.0 && radius.is_finite()) {
            return Err(self.fail(at, format!("radius {radius} is not above 0")));
        }
        let material = self.material_index(material.as_ref(), parts)?;
        parts.spheres.push((Sphere { centre, radius }, material));
        Ok(())
    }

    pub(super) fn quad(&self, quad: Spanned<schema::Quad>, parts: &mut SceneParts) -> Result<()> {
        let at = quad.span().start;
        let schema::Quad { corner, u, v, repeat, material } = quad.into_inner();
        let [corner, u, v] = [corner, u, v].map(DVec3::from_array);
        let positions = [corner, corner + u, corner + u + v, corner + v].map(DVec3::as_vec3);
        let area = u.cross(v).length();
        let spans = positions.iter().all(|p| p.is_finite()) && area > 0.0 && area.is_finite();
        if !spans {
            return Err(self.fail(at, format!("quad: corner {corner}, u {u} and v {v} span no parallelogram")));
        }
        let repeat = Vec2::from_array(repeat.unwrap_or([1.0; 2]));
        if !repeat.is_finite() {
            return Err(self.fail(at, format!("repeat {repeat} is not finite")));
        }
        let uvs = [Vec2::Y, Vec2::ONE, Vec2::X, Vec2::ZERO].map(|uv| uv * repeat);
        let mesh = Mesh {
            name: format!("quad {}", parts.meshes.len()),
            positions: positions.to_vec(),
            triangles: vec![[0, 1, 2], [0, 2, 3]],
            uvs: uvs.to_vec(),
            material: self.material_index(material.as_ref(), parts)?,
            ..Mesh::default()
        };
        parts.meshes.push(mesh);
        Ok(())
    }

    pub(super) fn triangles(&self, triangles: Spanned<schema::Triangles>, parts: &mut SceneParts) -> Result<()> {
        let at = triangles.span().start;
        let schema::Triangles { positions, indices, normals, uvs, material } = triangles.into_inner();
        let keep = self.loading.drop_invalid;
        let vectors = |what: &str, list: Vec<[f32; 3]>| {
            let each = |(i, v): (usize, [f32; 3])| match keep {
                true => Ok(Vec3::from_array(v)),
                false => self.point(at, &format!("{what} {i}"), v),
            };
            list.into_iter().enumerate().map(each).collect::<Result<Vec<Vec3>>>()
        };
        let mut mesh = Mesh {
            name: format!("triangles {}", parts.meshes.len()),
            positions: vectors("position", positions)?,
            triangles: indices,
            normals: vectors("normal", normals)?,
            uvs: uvs.into_iter().map(Vec2::from_array).collect(),
            material: self.material_index(material.as_ref(), parts)?,
        };
        if let Some(i) = mesh.uvs.iter().position(|uv| !uv.is_finite() && !keep) {
            return Err(self.fail(at, format!("uv {i}: {} is not finite", mesh.uvs[i])));
        }
        let count = mesh.positions.len();
        if let Some((t, corner)) = mesh.first_bad_index() {
            return Err(self.fail(at, format!("triangle {t} refers to vertex {corner} of {count}")));
        }
        for (what, n) in [("normals", mesh.normals.len()), ("uvs", mesh.uvs.len())] {
            if n != 0 && n != count {
                return Err(self.fail(at, format!("{n} {what} for {count} positions")));
            }
        }
        self.drop_invalid(at, &mut mesh, parts);
        make_normals_unit(&mut mesh);
        parts.meshes.push(mesh);
        Ok(())
    }

    /// Drops what is not finite, with a warning.
    fn drop_invalid(&self, at: usize, mesh: &mut Mesh, parts: &mut SceneParts) {
        let dropped = drop_invalid(mesh);
        if dropped > 0 {
            let cause = format!("dropped {dropped} triangles of `{}` that are not finite", mesh.name);
            parts.warnings.push(self.fail(at, cause).to_string());
        }
    }

    pub(super) fn mesh(&self, mesh: Spanned<schema::Mesh>, parts: &mut SceneParts) -> Result<()> {
        let at = mesh.span().start;
        let schema::Mesh { file, material, smooth, scale, rotate, translate } = mesh.into_inner();
        let (transform, _) = self.placement(at, Place { scale, rotate, translate })?;
        let mut read = read_mesh_file(&self.beside(&file), self.loading)?;
        let replacement = material.as_ref().map(|m| self.material_index(Some(m), parts)).transpose()?;
        if read.materials.is_empty() {
            read.materials.push(Material::grey());
        }
        let (first_material, first_texture) = (parts.materials.len() as u32, parts.textures.len() as u32);
        for mut mesh in read.meshes {
            mesh.material = replacement.unwrap_or(first_material.saturating_add(mesh.material));
            if smooth == Some(false) {
                mesh.normals.clear();
            }
            self.place(at, mesh, &transform, parts)?;
        }
        if replacement.is_none() {
            for mut material in read.materials {
                if let Bsdf::Lambert { texture: Some(t), .. } = &mut material.bsdf {
                    *t = t.saturating_add(first_texture);
                }
                parts.materials.push(material);
            }
            parts.textures.append(&mut read.textures);
        }
        parts.warnings.append(&mut read.warnings);
        parts.notes.append(&mut read.notes);
        Ok(())
    }

    pub(super) fn procedural(&self, procedural: Spanned<schema::Procedural>, parts: &mut SceneParts) -> Result<()> {
        let at = procedural.span().start;
        let p = procedural.into_inner();
        let (transform, scale) =
            self.placement(at, Place { scale: p.scale, rotate: p.rotate, translate: p.translate })?;
        let (n, depth, seed, sides, balls) = (p.n, p.depth, p.seed, p.sides, p.balls);
        let options = Options { n, depth, seed, sides, balls, ..Options::default() };
        let fail = |e: Error| self.fail(at, format!("procedural: {e}"));
        let body = procedural::body(&p.kind, &options, &self.loading.budget).map_err(fail)?;
        let mut materials = Vec::new();
        for name in &p.materials {
            materials.push(self.material_index(Some(name), parts)?);
        }
        if materials.is_empty() {
            materials.push(self.material_index(None, parts)?);
        }
        let of_slot = |slot: u32| materials[slot as usize % materials.len()];
        let round = scale.x > 0.0 && scale == DVec3::splat(scale.x);
        if !body.spheres.is_empty() && !round {
            return Err(self.fail(at, format!("scale {scale} makes spheres something else; give one positive number")));
        }
        for (sphere, slot) in body.spheres {
            let centre = transform.transform_point3(sphere.centre.as_dvec3()).as_vec3();
            let radius = (f64::from(sphere.radius) * scale.x) as f32;
            if !(centre.is_finite() && radius > 0.0 && radius.is_finite()) {
                return Err(self.fail(at, format!("the placement moves a sphere to {centre}, radius {radius}")));
            }
            parts.spheres.push((Sphere { centre, radius }, of_slot(slot)));
        }
        for (points, slot) in body.patches {
            let mut points = points.map(|row| row.map(|p| transform.transform_point3(p.as_dvec3()).as_vec3()));
            if transform.matrix3.determinant() < 0.0 {
                // A mirror image: front stays front.
                points.iter_mut().for_each(|row| row.reverse());
            }
            if let Some(bad) = points.as_flattened().iter().find(|p| !p.is_finite()) {
                return Err(self.fail(at, format!("the placement moves a patch to {bad}")));
            }
            parts.patches.push((points, of_slot(slot)));
        }
        for mut mesh in body.meshes {
            mesh.material = of_slot(mesh.material);
            self.place(at, mesh, &transform, parts)?;
        }
        Ok(())
    }

    fn placement(&self, at: usize, place: Place) -> Result<(DAffine3, DVec3)> {
        let scale = match place.scale {
            None => DVec3::ONE,
            Some(Scale::Uniform(s)) => DVec3::splat(s),
            Some(Scale::Axes(s)) => DVec3::from_array(s),
        };
        let [rotate, translate] = [place.rotate, place.translate].map(|v| DVec3::from_array(v.unwrap_or_default()));
        let transform = placement(scale, rotate, translate);
        if !is_regular(&transform) {
            let cause = format!("scale {scale}, rotate {rotate}, translate {translate} are not finite or flatten");
            return Err(self.fail(at, cause));
        }
        Ok((transform, scale))
    }

    fn place(&self, at: usize, mut mesh: Mesh, transform: &DAffine3, parts: &mut SceneParts) -> Result<()> {
        apply(&mut mesh, transform);
        if self.loading.drop_invalid {
            self.drop_invalid(at, &mut mesh, parts);
        }
        if let Some(p) = mesh.positions.iter().find(|p| !p.is_finite()) {
            return Err(self.fail(at, format!("the placement moves a vertex of `{}` to {p}", mesh.name)));
        }
        parts.meshes.push(mesh);
        Ok(())
    }
}
