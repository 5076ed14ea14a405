//! Exports a scene to POV-Ray 3.7, which then renders what our Whitted integrator renders.
//!
//! The world keeps its coordinates: the camera is written as explicit vectors, so POV-Ray's left-handed default never
//! matters. Surfaces that shine become spots, see `lamps`. Render with `povray +IFILE.pov +W.. +H.. -D -A +FE
//! File_Gamma=1.0` in the folder of the file; the picture is linear. What differs by nature is named in the warnings.
//!
//! Source of the laws of light: POV-Ray 3.7 computes pigment x colour x cosine without 1/pi, and attenuates by
//! `2 / (1 + (d / fade_distance)^fade_power)`.

mod lamps;
mod material;

use super::export::{Assets, ExportSettings, Number, Triple, bounds, check, left_out, plain};
use super::export::{usable_normals, usable_spheres, usable_triangles, write_whole};
use super::{Light, Mesh, Scene, SceneGeometry};
use crate::error::Result;
use crate::geometry::Geometry;
use glam::{DVec3, Vec3};
use lamps::Spot;
use material::Declared;
use std::f64::consts::PI;
use std::io::{self, Write};
use std::path::Path;

/// POV-Ray's limit of `max_trace_level`.
const MAX_TRACE_LEVEL: u32 = 256;

/// Scenes smaller than this are enlarged: POV-Ray ignores hits nearer than 1e-4 and occluders nearer than 1e-3.
const SMALLEST: f64 = 4.0;

/// `fade_distance`: so near that POV-Ray's law is an inverse square wherever light falls; the error is `(this / d)^2`.
const FADE: f64 = 1e-6;

/// Writes `out` and its textures beside it; returns what POV-Ray cannot show as we do, one sentence each.
///
/// # Errors
/// A setting is 0, the camera sees nothing, or a file cannot be written.
pub fn export(scene: &Scene, settings: &ExportSettings, out: &Path) -> Result<Vec<String>> {
    check(scene, settings)?;
    let scene = &*scene.with_meshes();
    let mut assets = Assets::beside(out);
    let mut materials = Vec::new();
    for (index, material) in scene.materials.iter().enumerate() {
        materials.push(Declared::new(scene, index, material, settings, &mut assets)?);
    }
    let (spots, too_many) = lamps::spots(scene, settings.lamp_grid);
    let mut warnings = assets.warnings;
    warnings.extend(materials.iter().flat_map(|m| m.warnings.iter().cloned()));
    warnings.extend(left_out(scene));
    warnings.extend(too_many);
    if scene.environment.max_element() > 0.0 {
        let cause =
            "the environment is seen, in mirrors too, but lights nothing in POV-Ray, as in the Whitted integrator";
        warnings.push(cause.into());
    }
    if settings.max_depth == 1 {
        warnings.push("depth 1 shows emission alone: POV-Ray has no such depth and adds direct light".into());
    }
    warnings.extend(scene.lights.iter().enumerate().filter_map(|(i, l)| soft_spot(i, l)));
    if settings.max_depth - 1 > MAX_TRACE_LEVEL {
        warnings.push(format!("depth {} is cut to POV-Ray's greatest, {}", settings.max_depth, MAX_TRACE_LEVEL + 1));
    }
    let writer = Writer::new(scene, materials, spots);
    write_whole(out, |w| writer.write(settings, w))?;
    Ok(warnings)
}

/// The warning for a spot whose edge POV-Ray draws otherwise.
fn soft_spot(index: usize, light: &Light) -> Option<String> {
    let Light::Spot { cutoff, beam_width, .. } = light else { return None };
    (beam_width < cutoff).then(|| {
        format!(
            "light {index} is a spot that fades between {beam_width} and {cutoff} degrees: linearly in the angle here, \
             by a cubic of the cosine in POV-Ray"
        )
    })
}

struct Writer<'a> {
    scene: &'a Scene,
    materials: Vec<Declared>,
    spots: Vec<Spot>,
    /// Lengths in the file in units of the scene's, a power of two.
    scale: f64,
    /// Middle of the scene and the radius around it, scene units.
    centre: DVec3,
    radius: f64,
}

impl<'a> Writer<'a> {
    fn new(scene: &'a Scene, materials: Vec<Declared>, spots: Vec<Spot>) -> Self {
        let aabb = bounds(scene);
        let (centre, radius) = if aabb.is_empty() {
            (DVec3::ZERO, 1.0)
        } else {
            let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
            ((min + max) / 2.0, ((max - min).length() / 2.0).max(f64::from(f32::MIN_POSITIVE)))
        };
        let scale = if radius < SMALLEST { (SMALLEST / radius).log2().ceil().exp2() } else { 1.0 };
        Self { scene, materials, spots, scale, centre, radius }
    }

    fn point(&self, p: DVec3) -> Triple {
        Triple(p * self.scale)
    }

    fn write(&self, settings: &ExportSettings, w: &mut dyn Write) -> io::Result<()> {
        let scene = self.scene;
        writeln!(w, "// Scene {}, exported by skipgrid.", plain(&scene.name))?;
        if self.scale != 1.0 {
            writeln!(w, "// Lengths are {} times those of the scene.", Number(self.scale))?;
        }
        writeln!(w, "#version 3.7;")?;
        writeln!(
            w,
            "global_settings {{ assumed_gamma 1.0 max_trace_level {} adc_bailout 0 ambient_light 0 }}",
            (settings.max_depth - 1).clamp(1, MAX_TRACE_LEVEL)
        )?;
        self.write_camera(settings, w)?;
        writeln!(w, "background {{ rgb <{}> }}", Triple::from(scene.environment))?;
        for light in &scene.lights {
            self.write_light(light, w)?;
        }
        for spot in &self.spots {
            self.write_lamp(spot, w)?;
        }
        for material in &self.materials {
            w.write_all(material.text.as_bytes())?;
        }
        for (index, mesh) in scene.meshes.iter().enumerate() {
            self.write_mesh(index, mesh, w)?;
        }
        for index in usable_spheres(scene) {
            let sphere = scene.spheres[index];
            let shape = format!(
                "sphere {{ <{}>, {}",
                self.point(sphere.centre.as_dvec3()),
                Number(f64::from(sphere.radius) * self.scale)
            );
            self.write_object(&shape, scene.sphere_materials[index], false, w)?;
        }
        self.write_patches(w)
    }

    fn write_camera(&self, settings: &ExportSettings, w: &mut dyn Write) -> io::Result<()> {
        let camera = &self.scene.camera;
        let [forward, right, up] = camera.basis();
        let height = 2.0 * (camera.yfov.to_radians() / 2.0).tan();
        let width = height * f64::from(settings.width) / f64::from(settings.height);
        writeln!(
            w,
            "camera {{ perspective location <{}> direction <{}> right <{}> up <{}> }}",
            self.point(camera.origin),
            Triple(forward),
            Triple(right * width),
            Triple(up * height)
        )
    }

    /// Colour and fading of a light of `intensity`, W/sr.
    ///
    /// An intensity of I gives I / d^2; POV-Ray's colour c gives pi c 2 FADE^2 / d^2 in our units.
    fn falling(&self, intensity: DVec3) -> String {
        let colour = intensity * self.scale * self.scale / (2.0 * PI * FADE * FADE);
        format!("rgb <{}> fade_distance {} fade_power 2", Triple(colour), Number(FADE))
    }

    fn write_lamp(&self, spot: &Spot, w: &mut dyn Write) -> io::Result<()> {
        writeln!(
            w,
            "light_source {{ <{}>, {} spotlight point_at <{}> radius 90 falloff 90 tightness 1 }}",
            self.point(spot.position),
            self.falling(spot.intensity),
            Triple(spot.position * self.scale + spot.normal * self.radius * self.scale)
        )
    }

    fn write_light(&self, light: &Light, w: &mut dyn Write) -> io::Result<()> {
        match light {
            Light::Point { position, intensity } => {
                writeln!(w, "light_source {{ <{}>, {} }}", self.point(*position), self.falling(intensity.as_dvec3()))
            }
            Light::Spot { position, direction, intensity, cutoff, beam_width } => writeln!(
                w,
                "light_source {{ <{}>, {} spotlight point_at <{}> radius {} falloff {} tightness 0 }}",
                self.point(*position),
                self.falling(intensity.as_dvec3()),
                Triple(*position * self.scale + *direction * self.radius * self.scale),
                Number(beam_width.min(*cutoff)),
                Number(*cutoff)
            ),
            // Shadow rays end at the light's plane, so it stands beyond everything.
            Light::Directional { direction, irradiance } => writeln!(
                w,
                "light_source {{ <{}>, rgb <{}> parallel point_at <{}> }}",
                self.point(self.centre - *direction * self.radius * 2.0),
                Triple(irradiance.as_dvec3() / PI),
                self.point(self.centre)
            ),
        }
    }

    fn write_mesh(&self, index: usize, mesh: &Mesh, w: &mut dyn Write) -> io::Result<()> {
        let triangles = usable_triangles(mesh);
        if triangles.is_empty() {
            return Ok(());
        }
        let name = format!("Mesh{index}");
        writeln!(w, "// {}\n#declare {name} = mesh2 {{", plain(&mesh.name))?;
        self.write_vectors("vertex_vectors", &mesh.positions, self.scale, w)?;
        if !mesh.normals.is_empty() {
            self.write_vectors("normal_vectors", &usable_normals(mesh), 1.0, w)?;
        }
        if !mesh.uvs.is_empty() {
            write!(w, "uv_vectors {{ {}", mesh.uvs.len())?;
            for uv in &mesh.uvs {
                let (u, v) = if uv.is_finite() { (f64::from(uv.x), 1.0 - f64::from(uv.y)) } else { (0.0, 0.0) };
                write!(w, ",\n<{}, {}>", Number(u), Number(v))?;
            }
            writeln!(w, " }}")?;
        }
        // POV-Ray's triangles look the other way: turned round, front stays front for `interior_texture`.
        write!(w, "face_indices {{ {}", triangles.len())?;
        for [a, b, c] in triangles {
            write!(w, ",\n<{a}, {c}, {b}>")?;
        }
        writeln!(w, " }} }}")?;
        self.write_object(&format!("object {{ {name}"), mesh.material, !mesh.uvs.is_empty(), w)
    }

    /// Patches as POV-Ray's own, cut into 32 x 32 quads with smooth normals each, the most that is of use there.
    fn write_patches(&self, w: &mut dyn Write) -> io::Result<()> {
        let SceneGeometry::Patches(patches) = &self.scene.geometry else { return Ok(()) };
        for (prim, &material) in (0_u32..).zip(&self.scene.patch_materials) {
            if patches.bounds(prim).is_empty() {
                continue;
            }
            // POV-Ray's patches look the other way: with rows run backwards, front stays front.
            let points = patches.points(prim).iter().flat_map(|row| row.iter().rev());
            let points: Vec<String> = points.map(|p| format!("<{}>", self.point(p.as_dvec3()))).collect();
            let shape = format!("bicubic_patch {{ type 1 flatness 0 u_steps 5 v_steps 5\n{}", points.join(",\n"));
            self.write_object(&shape, material, false, w)?;
        }
        Ok(())
    }

    fn write_vectors(&self, keyword: &str, vectors: &[Vec3], scale: f64, w: &mut dyn Write) -> io::Result<()> {
        write!(w, "{keyword} {{ {}", vectors.len())?;
        for v in vectors {
            // No triangle that is written uses a vector that is not finite.
            let v = if v.is_finite() { v.as_dvec3() * scale } else { DVec3::ZERO };
            write!(w, ",\n<{}>", Triple(v))?;
        }
        writeln!(w, " }}")
    }

    /// Writes `shape`, which lacks its closing brace, with its material.
    ///
    /// Shadow rays pass through POV-Ray's glass; a black twin that nothing else sees stops them.
    fn write_object(&self, shape: &str, material: u32, uv: bool, w: &mut dyn Write) -> io::Result<()> {
        let material = &self.materials[material as usize];
        let look = if uv { &material.textured } else { &material.plain };
        if !material.glass {
            return writeln!(w, "{shape} {look} }}");
        }
        writeln!(w, "{shape} {look} no_shadow }}")?;
        writeln!(
            w,
            "{shape} texture {{ pigment {{ rgb 0 }} finish {{ ambient 0 diffuse 0 }} }} no_image no_reflection \
             no_radiosity }}"
        )
    }
}
