//! Exports a scene to Mitsuba 3, which then renders what our path tracer renders.
//!
//! Render with `mitsuba FILE.xml` in any variant with RGB colours; `-D spp=256 -D seed=1` sets samples and seed. Meshes
//! become binary PLY files, textures PNG files beside the scene. What differs by nature is named in the warnings.

use super::export::{Assets, ExportSettings, Number, Triple, at_origin, bounds, check, left_out, plain};
use super::export::{usable_normals, usable_spheres, usable_triangles, write_whole};
use super::{Bsdf, Filter, Light, Material, Mesh, Scene, patches};
use crate::error::Result;
use glam::{DVec3, Vec3};
use std::collections::BTreeSet;
use std::fmt::Write as _;
use std::io::{self, Write};
use std::path::Path;

/// Mitsuba starts its rays off a surface by about 1e-4 of `1 + largest coordinate`: smaller scenes suffer.
const SMALLEST: f32 = 0.1;

/// A spot's full beam as a share of its cone where the edge is hard: Mitsuba divides by the difference.
const HARD: f64 = 1.0 - 1e-6;

/// Writes `out`, its meshes and its textures beside it; returns what Mitsuba cannot show as we do, one sentence each.
///
/// # Errors
/// A setting is 0, the camera sees nothing, or a file cannot be written.
pub fn export(scene: &Scene, settings: &ExportSettings, out: &Path) -> Result<Vec<String>> {
    check(scene, settings)?;
    let scene = &*scene.with_meshes();
    let mut writer = Writer { scene, assets: Assets::beside(out), clamped: BTreeSet::new(), text: String::new() };
    writer.head(settings);
    for (index, material) in scene.materials.iter().enumerate() {
        writer.material(index, material)?;
    }
    for (index, mesh) in scene.meshes.iter().enumerate() {
        writer.mesh(index, mesh)?;
    }
    // A scene of patches has no mesh.
    let tessellated = patches::tessellated(scene, patches::STEPS);
    for (index, mesh) in tessellated.iter().enumerate() {
        writer.mesh(index, mesh)?;
    }
    for index in usable_spheres(scene) {
        writer.sphere(index);
    }
    for light in &scene.lights {
        writer.light(light);
    }
    if scene.environment.max_element() > 0.0 {
        writer.line(&format!("<emitter type=\"constant\">{}</emitter>", rgb("radiance", scene.environment)));
    }
    writer.text += "</scene>\n";

    let mut warnings = std::mem::take(&mut writer.assets.warnings);
    warnings.extend(writer.clamped);
    warnings.extend(left_out(scene));
    if !tessellated.is_empty() {
        let (count, n) = (tessellated.len(), patches::STEPS);
        warnings.push(format!("Mitsuba has no bicubic patches: each of {count} becomes a mesh of {n} x {n} quads"));
    }
    let extent = bounds(scene).extent().max_element();
    if extent > 0.0 && extent < SMALLEST {
        warnings.push(format!(
            "the scene is only {extent} wide: Mitsuba's offsets of about 1e-4 will show; enlarge it for comparisons"
        ));
    }
    write_whole(out, |w| w.write_all(writer.text.as_bytes()))?;
    Ok(warnings)
}

fn float(name: &str, value: f64) -> String {
    format!("<float name=\"{name}\" value=\"{}\"/>", Number(value))
}

fn integer(name: &str, value: impl std::fmt::Display) -> String {
    format!("<integer name=\"{name}\" value=\"{value}\"/>")
}

fn string(name: &str, value: &str) -> String {
    format!("<string name=\"{name}\" value=\"{value}\"/>")
}

fn rgb(name: &str, value: Vec3) -> String {
    format!("<rgb name=\"{name}\" value=\"{}\"/>", Triple::from(value))
}

fn look_at(origin: DVec3, target: DVec3, up: DVec3) -> String {
    format!(
        "<transform name=\"to_world\"><lookat origin=\"{}\" target=\"{}\" up=\"{}\"/></transform>",
        Triple(origin),
        Triple(target),
        Triple(up)
    )
}

/// Near and far clipping distances that lose nothing of the scene.
fn clip(scene: &Scene) -> (f64, f64) {
    let aabb = bounds(scene);
    let origin = scene.camera.origin;
    let farthest = if aabb.is_empty() {
        1.0
    } else {
        let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
        (origin - min).abs().max((origin - max).abs()).length()
    };
    let far = (2.0 * farthest).max(f64::from(f32::MIN_POSITIVE) * 1e8);
    (far * 1e-6, far)
}

struct Writer<'a> {
    scene: &'a Scene,
    assets: Assets,
    /// Warnings about colours that Mitsuba refuses.
    clamped: BTreeSet<String>,
    text: String,
}

impl Writer<'_> {
    fn line(&mut self, text: &str) {
        self.text += "  ";
        self.text += text;
        self.text.push('\n');
    }

    fn head(&mut self, settings: &ExportSettings) {
        let scene = self.scene;
        let camera = &scene.camera;
        let (near, far) = clip(scene);
        self.text = String::from("<?xml version=\"1.0\" encoding=\"utf-8\"?>\n");
        // Writing to a string cannot fail.
        let _ = writeln!(self.text, "<!-- Scene {}, exported by skipgrid. -->", plain(&scene.name));
        self.text += "<scene version=\"3.0.0\">\n";
        self.line("<default name=\"spp\" value=\"64\"/>");
        self.line("<default name=\"seed\" value=\"0\"/>");
        // Russian roulette would only add noise; Mitsuba counts depth in edges as we do.
        let depth = settings.max_depth.min(i32::MAX as u32);
        self.line(&format!(
            "<integrator type=\"path\">{}{}</integrator>",
            integer("max_depth", depth),
            integer("rr_depth", 100_000)
        ));
        self.line("<sensor type=\"perspective\">");
        self.line(&format!("  {}{}", float("fov", camera.yfov), string("fov_axis", "y")));
        self.line(&format!("  {}{}", float("near_clip", near), float("far_clip", far)));
        let [_, _, up] = camera.basis();
        self.line(&format!("  {}", look_at(camera.origin, camera.target, up)));
        self.line("  <sampler type=\"independent\"><integer name=\"sample_count\" value=\"$spp\"/><integer name=\"seed\" value=\"$seed\"/></sampler>");
        self.line(&format!(
            "  <film type=\"hdrfilm\">{}{}{}{}<rfilter type=\"box\"/></film>",
            integer("width", settings.width),
            integer("height", settings.height),
            string("pixel_format", "rgb"),
            string("component_format", "float32")
        ));
        self.line("</sensor>");
    }

    /// A reflectance; Mitsuba refuses what lies outside 0 to 1.
    fn share(&mut self, name: &str, value: Vec3, material: &Material) -> String {
        let clamped = value.clamp(Vec3::ZERO, Vec3::ONE);
        if clamped != value {
            self.clamped.insert(format!(
                "material `{}` reflects {value}: Mitsuba takes shares from 0 to 1 alone, it is clamped",
                material.name
            ));
        }
        rgb(name, clamped)
    }

    /// Writes the material as `m{index}`, and a Lambert material with a texture also as `m{index}-plain`, for shapes
    /// without texture coordinates: Mitsuba invents some for them.
    fn material(&mut self, index: usize, material: &Material) -> Result<()> {
        self.line(&format!("<!-- {} -->", plain(&material.name)));
        let (kind, inner, sides) = match &material.bsdf {
            Bsdf::Lambert { albedo, texture } => {
                let map = texture.and_then(|t| Some((t, self.scene.textures.get(t as usize)?)));
                match map {
                    None => ("diffuse", self.share("reflectance", *albedo, material), true),
                    Some((t, texture)) => {
                        let inner = self.share("reflectance", *albedo * at_origin(texture), material);
                        self.bsdf(&format!("m{index}-plain"), "diffuse", &inner, true);
                        let file = self.assets.texture(self.scene, t, *albedo)?;
                        let filter = if texture.filter == Filter::Bilinear { "bilinear" } else { "nearest" };
                        let inner = format!(
                            "<texture type=\"bitmap\" name=\"reflectance\">{}{}{}<boolean name=\"raw\" value=\"{}\"/></texture>",
                            string("filename", &file.name),
                            string("filter_type", filter),
                            string("wrap_mode", "repeat"),
                            !file.srgb
                        );
                        ("diffuse", inner, true)
                    }
                }
            }
            Bsdf::Mirror { reflectance } => {
                let share = self.share("specular_reflectance", *reflectance, material);
                ("conductor", string("material", "none") + &share, true)
            }
            Bsdf::Dielectric { ior } => {
                ("dielectric", float("int_ior", f64::from(*ior)) + &float("ext_ior", 1.0), false)
            }
            Bsdf::Conductor { eta, k, reflectance, alpha } => {
                let share = self.share("specular_reflectance", *reflectance, material);
                let rough = string("distribution", "ggx") + &float("alpha", f64::from(*alpha));
                ("roughconductor", rough + &rgb("eta", *eta) + &rgb("k", *k) + &share, true)
            }
        };
        self.bsdf(&format!("m{index}"), kind, &inner, sides);
        Ok(())
    }

    fn bsdf(&mut self, id: &str, kind: &str, inner: &str, two_sided: bool) {
        if two_sided {
            self.line(&format!("<bsdf type=\"twosided\" id=\"{id}\"><bsdf type=\"{kind}\">{inner}</bsdf></bsdf>"));
        } else {
            self.line(&format!("<bsdf type=\"{kind}\" id=\"{id}\">{inner}</bsdf>"));
        }
    }

    /// Reference to a material, and the emitter if it emits.
    fn surface(&self, material: u32, uv: bool) -> String {
        let m = &self.scene.materials[material as usize];
        let textured =
            matches!(m.bsdf, Bsdf::Lambert { texture: Some(t), .. } if (t as usize) < self.scene.textures.len());
        let id = if textured && !uv { format!("m{material}-plain") } else { format!("m{material}") };
        let emitter = if m.emission.max_element() > 0.0 {
            format!("<emitter type=\"area\">{}</emitter>", rgb("radiance", m.emission))
        } else {
            String::new()
        };
        format!("<ref id=\"{id}\"/>{emitter}")
    }

    fn mesh(&mut self, index: usize, mesh: &Mesh) -> Result<()> {
        let mut triangles = usable_triangles(mesh);
        if self.scene.materials[mesh.material as usize].emission.max_element() > 0.0 {
            // Mitsuba picks points on emitters by area and refuses a mesh that has none.
            let corner = |i: u32| mesh.positions[i as usize].as_dvec3();
            triangles.retain(|&[a, b, c]| (corner(b) - corner(a)).cross(corner(c) - corner(a)) != DVec3::ZERO);
        }
        if triangles.is_empty() {
            return Ok(());
        }
        let file = self.assets.write(&format!("mesh{index}.ply"), |w| write_ply(mesh, &triangles, w))?;
        let flat = mesh.normals.is_empty();
        let surface = self.surface(mesh.material, !mesh.uvs.is_empty());
        self.line(&format!(
            "<shape type=\"ply\">{}<boolean name=\"face_normals\" value=\"{flat}\"/>{surface}</shape>",
            string("filename", &file)
        ));
        Ok(())
    }

    fn sphere(&mut self, index: usize) {
        let sphere = self.scene.spheres[index];
        let surface = self.surface(self.scene.sphere_materials[index], false);
        let c = sphere.centre.as_dvec3();
        self.line(&format!(
            "<shape type=\"sphere\"><point name=\"center\" x=\"{}\" y=\"{}\" z=\"{}\"/>{}{surface}</shape>",
            Number(c.x),
            Number(c.y),
            Number(c.z),
            float("radius", f64::from(sphere.radius))
        ));
    }

    fn light(&mut self, light: &Light) {
        let text = match light {
            Light::Point { position, intensity } => format!(
                "<emitter type=\"point\"><point name=\"position\" value=\"{}\"/>{}</emitter>",
                Triple(*position),
                rgb("intensity", *intensity)
            ),
            Light::Spot { position, direction, intensity, cutoff, beam_width } => {
                let up = if direction.z.abs() < 0.9 { DVec3::Z } else { DVec3::X };
                format!(
                    "<emitter type=\"spot\">{}{}{}{}</emitter>",
                    look_at(*position, *position + *direction, up),
                    rgb("intensity", *intensity),
                    float("cutoff_angle", *cutoff),
                    float("beam_width", beam_width.min(*cutoff * HARD))
                )
            }
            Light::Directional { direction, irradiance } => format!(
                "<emitter type=\"directional\"><vector name=\"direction\" value=\"{}\"/>{}</emitter>",
                Triple(*direction),
                rgb("irradiance", *irradiance)
            ),
        };
        self.line(&text);
    }
}

/// A mesh as binary little-endian PLY: x y z, nx ny nz and u v where there are any (v down, as Mitsuba has it).
fn write_ply(mesh: &Mesh, triangles: &[[u32; 3]], w: &mut dyn Write) -> io::Result<()> {
    write!(w, "ply\nformat binary_little_endian 1.0\nelement vertex {}\n", mesh.positions.len())?;
    let directions = usable_normals(mesh);
    let normals = directions.len() == mesh.positions.len();
    let uvs = mesh.uvs.len() == mesh.positions.len();
    let names = ["x", "y", "z"].into_iter();
    let names = names.chain(["nx", "ny", "nz"].into_iter().filter(|_| normals));
    for name in names.chain(["u", "v"].into_iter().filter(|_| uvs)) {
        writeln!(w, "property float {name}")?;
    }
    write!(w, "element face {}\nproperty list uchar int vertex_indices\nend_header\n", triangles.len())?;
    let mut put = |c: f32| w.write_all(&if c.is_finite() { c } else { 0.0 }.to_le_bytes());
    for (i, p) in mesh.positions.iter().enumerate() {
        // No triangle that is written uses a vertex that is not finite.
        p.to_array().into_iter().try_for_each(&mut put)?;
        if normals {
            directions[i].to_array().into_iter().try_for_each(&mut put)?;
        }
        if uvs {
            mesh.uvs[i].to_array().into_iter().try_for_each(&mut put)?;
        }
    }
    for triangle in triangles {
        w.write_all(&[3])?;
        triangle.iter().try_for_each(|i| w.write_all(&i.to_le_bytes()))?;
    }
    Ok(())
}
