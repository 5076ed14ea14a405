//! What is rendered: primitives in world space, materials, lights, camera; and where it comes from.
//!
//! [`load`] reads files and makes scenes by formula; [`Scene::new`] takes the parts that a program has made itself. The
//! world is right-handed; lengths are world units, colours linear RGB. [`Scene::accel`] builds an accelerator over the
//! primitives, and [`Scene::surface`] says of a hit what shading needs. [`povray`] and [`mitsuba`] write scenes for
//! other renderers.

mod assemble;
mod budget;
mod camera;
mod dense;
mod export;
pub mod file;
#[cfg(feature = "gltf")]
pub mod gltf;
mod light;
mod load;
mod material;
pub mod mitsuba;
#[cfg(feature = "obj")]
pub mod obj;
mod patches;
pub mod povray;
pub mod procedural;
pub mod raw;
mod surface;
mod texture;
mod transform;
#[cfg(feature = "vox")]
mod vox;
mod voxels;

pub use camera::{Camera, CameraSource};
pub use export::ExportSettings;
pub use light::Light;
pub use load::{LoadOptions, load};
pub use material::{Bsdf, Filter, Material, Texture};

use crate::accel::{Accel, Hit, PointShadows};
use crate::auto::Choice;
use crate::error::Result;
use crate::geometry::bezier::ControlPoints;
use crate::geometry::{BezierPatches, Geometry, Mixed, SolidVoxels, Sphere, Triangle};
use crate::ray::Ray;
use glam::{DVec2, DVec3, Vec2, Vec3};
use std::borrow::Cow;
use std::sync::Arc;

/// The primitives of a scene as the accelerators see them: no sphere test is compiled into the path of a scene of
/// triangles, and no triangle test into that of spheres.
#[derive(Clone, Debug)]
pub enum SceneGeometry {
    /// Triangles only (or nothing at all).
    Triangles(Arc<Vec<Triangle>>),
    /// Spheres only.
    Spheres(Arc<Vec<Sphere>>),
    /// Triangles, then spheres.
    Mixed(Arc<Mixed>),
    /// Solid voxels only; the byte of a voxel is its index in [`Scene::materials`] plus one.
    Voxels(SolidVoxels),
    /// Bicubic patches only.
    Patches(Arc<BezierPatches>),
}

/// `$body` with `$g` bound to the primitives of `$geometry`, whatever they are: compiled once for each kind.
macro_rules! with_geometry {
    ($geometry:expr, $g:ident => $body:expr) => {
        match &$geometry {
            $crate::scene::SceneGeometry::Triangles($g) => $body,
            $crate::scene::SceneGeometry::Spheres($g) => $body,
            $crate::scene::SceneGeometry::Mixed($g) => $body,
            $crate::scene::SceneGeometry::Voxels($g) => $body,
            $crate::scene::SceneGeometry::Patches($g) => $body,
        }
    };
}
#[cfg(feature = "cli")]
pub(crate) use with_geometry;

impl SceneGeometry {
    /// Builds the accelerator that `spec` names over these primitives.
    ///
    /// # Errors
    /// As [`crate::registry::build`].
    pub fn accel(&self, spec: &str) -> Result<Box<dyn Accel>> {
        with_geometry!(*self, g => crate::registry::build(spec, g.clone()))
    }
}

/// A triangle mesh in world space with what shading needs.
#[derive(Clone, Debug, Default)]
pub struct Mesh {
    /// Name from the file, for messages and exporters.
    pub name: String,
    /// Corners, world units. A triangle with one that is not finite is never hit.
    pub positions: Vec<Vec3>,
    /// Indices in `positions` of each triangle's corners, counter-clockwise seen from the front.
    pub triangles: Vec<[u32; 3]>,
    /// Unit normals, one for each position; empty: flat shading.
    pub normals: Vec<Vec3>,
    /// Texture coordinates, one for each position, u right and v DOWN (as in glTF); empty: none.
    pub uvs: Vec<Vec2>,
    /// Index in [`Scene::materials`].
    pub material: u32,
}

impl Mesh {
    /// The first triangle that refers to a vertex that does not exist, with that index.
    pub(crate) fn first_bad_index(&self) -> Option<(usize, u32)> {
        let count = self.positions.len();
        let bad = |t: &[u32; 3]| t.iter().copied().find(|&i| i as usize >= count);
        self.triangles.iter().enumerate().find_map(|(i, t)| Some((i, bad(t)?)))
    }
}

/// What shading needs to know about a hit, in f64.
#[derive(Clone, Copy, Debug)]
pub struct Surface {
    /// The point, on the primitive as nearly as f64 allows, world units.
    pub position: DVec3,
    /// Unit normal of the primitive itself; front side, not turned towards the viewer.
    pub geometric_normal: DVec3,
    /// Unit shading normal (interpolated where the mesh has normals); front side, not turned towards the viewer.
    pub shading_normal: DVec3,
    /// Texture coordinates, v down; zero where the mesh has none.
    pub uv: DVec2,
    /// Index in [`Scene::materials`].
    pub material: u32,
}

/// Everything there is to render.
#[derive(Clone, Debug)]
pub struct Scene {
    /// Name for messages and output.
    pub name: String,
    /// Triangles of all meshes in order, then spheres; or solid voxels alone.
    pub geometry: SceneGeometry,
    /// Meshes; triangle `i` of mesh `m` is primitive `mesh_offsets[m] + i`.
    pub meshes: Vec<Mesh>,
    /// First primitive of each mesh, and the number of triangles at the end: `meshes.len() + 1` entries.
    pub mesh_offsets: Vec<u32>,
    /// Spheres; sphere `i` is primitive `triangle_count + i`.
    pub spheres: Vec<Sphere>,
    /// Index in [`Scene::materials`] for each sphere.
    pub sphere_materials: Vec<u32>,
    /// Index in [`Scene::materials`] for each patch; a scene of patches has no triangle and no sphere.
    pub patch_materials: Vec<u32>,
    /// Materials; at least one.
    pub materials: Vec<Material>,
    /// Textures that materials refer to.
    pub textures: Vec<Texture>,
    /// Lights without extent. Emissive materials make their primitives area lights.
    pub lights: Vec<Light>,
    /// Radiance that arrives from every direction where nothing is hit, linear RGB, finite and not negative; zero: no
    /// environment.
    pub environment: Vec3,
    /// Where the picture is taken from.
    pub camera: Camera,
    /// What the file asks of the renderer; the command line overrides it.
    pub defaults: RenderDefaults,
    /// What was odd but usable in the input, one sentence each, naming the file.
    pub warnings: Vec<String>,
    /// What was chosen where the input is silent (default light, say), one sentence each.
    pub notes: Vec<String>,
}

/// What a scene file asks of the renderer, where it does.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct RenderDefaults {
    /// Width and height, pixels, above 0.
    pub size: Option<(u32, u32)>,
    /// Name of the integrator, `path` or `whitted`.
    pub integrator: Option<String>,
    /// Longest path, counted in edges (1: directly seen emission only), above 0.
    pub max_depth: Option<u32>,
    /// Samples for each pixel, above 0.
    pub spp: Option<u32>,
}

/// The parts of a scene, before primitives are laid out in one index space.
#[derive(Clone, Debug, Default)]
pub struct SceneParts {
    /// See [`Scene::name`].
    pub name: String,
    /// See [`Scene::meshes`].
    pub meshes: Vec<Mesh>,
    /// Solid voxels, whose bytes are indices of materials plus one. Beside meshes or spheres they become meshes.
    pub voxels: Option<SolidVoxels>,
    /// Spheres with the indices of their materials.
    pub spheres: Vec<(Sphere, u32)>,
    /// Bicubic patches with the indices of their materials; not beside meshes or spheres.
    pub patches: Vec<(ControlPoints, u32)>,
    /// See [`Scene::materials`]; a grey Lambert material is added if there is none.
    pub materials: Vec<Material>,
    /// See [`Scene::textures`].
    pub textures: Vec<Texture>,
    /// See [`Scene::lights`].
    pub lights: Vec<Light>,
    /// See [`Scene::environment`].
    pub environment: Vec3,
    /// `None`: one is framed.
    pub camera: Option<Camera>,
    /// See [`Scene::defaults`].
    pub defaults: RenderDefaults,
    /// See [`Scene::warnings`].
    pub warnings: Vec<String>,
    /// See [`Scene::notes`].
    pub notes: Vec<String>,
}

impl Scene {
    /// Lays the parts out in one index space, and adds what they lack, each with an entry in [`Scene::notes`]: a camera
    /// framed around the bounds ([`Camera::framed`]); and, where nothing emits light, a constant environment of 0.6
    /// with a directional light over the camera's left shoulder of 0.4 pi, so that no diffuse surface is brighter than
    /// its albedo. A scene without primitives is legal, with a warning. Primitives that are not finite are kept and
    /// never hit; only the loaders refuse them.
    ///
    /// # Errors
    /// A triangle refers to a vertex, or anything to a material or texture, that does not exist; normals or texture
    /// coordinates differ in number from the positions; a texture's size differs from its texels; a light or the camera
    /// is not finite; more than 2^32 - 2 primitives, or more than memory holds; there are patches beside meshes or
    /// spheres, or patches that shine.
    pub fn new(parts: SceneParts) -> Result<Scene> {
        let origin = parts.name.clone();
        assemble::assemble(parts, &origin)
    }

    /// Number of triangles, two for each exposed face of a voxel; spheres come after them.
    pub fn triangle_count(&self) -> u32 {
        match &self.geometry {
            SceneGeometry::Voxels(voxels) => Geometry::len(voxels),
            _ => *self.mesh_offsets.last().unwrap_or(&0),
        }
    }

    /// The solid voxels, if the scene consists of these.
    pub fn voxels(&self) -> Option<&SolidVoxels> {
        match &self.geometry {
            SceneGeometry::Voxels(voxels) => Some(voxels),
            _ => None,
        }
    }

    /// The same scene with its voxels, if it has any, as meshes: one for each material, with other primitive indices.
    pub fn with_meshes(&self) -> Cow<'_, Scene> {
        voxels::with_meshes(self)
    }

    /// Number of primitives: triangles and spheres, or patches.
    pub fn primitive_count(&self) -> u32 {
        self.triangle_count() + self.spheres.len() as u32 + self.patch_materials.len() as u32
    }

    /// Whether a light has a place but no extent: those that shadow voxels are for.
    pub fn has_point_lights(&self) -> bool {
        self.lights.iter().any(|light| matches!(light, Light::Point { .. } | Light::Spot { .. }))
    }

    /// Builds the accelerator that `spec` names over the scene's primitives.
    ///
    /// # Errors
    /// As [`crate::registry::build`].
    pub fn accel(&self, spec: &str) -> Result<Box<dyn Accel>> {
        self.geometry.accel(spec)
    }

    /// What `spec` stands for, and why, if it is `auto`.
    ///
    /// # Errors
    /// As [`crate::registry::choose`].
    pub fn choose(&self, spec: &str) -> Result<Option<(String, Choice)>> {
        with_geometry!(self.geometry, g => crate::registry::choose(spec, g))
    }
    /// Decides for every voxel of a grid, `density` voxels for each primitive (finite, above 0), which of the lights at
    /// `lights`, world units, surely reach it and which surely do not.
    ///
    /// Source: Amanatides & Woo 1987, last section.
    ///
    /// # Errors
    /// As [`crate::registry::shadow_voxels`].
    pub fn shadow_voxels(&self, lights: &[DVec3], density: f64) -> Result<Box<dyn PointShadows>> {
        with_geometry!(self.geometry, g => crate::registry::shadow_voxels(g.clone(), lights, density))
    }

    /// What shading needs at `hit` of `ray`, which comes from an accelerator over [`Scene::geometry`].
    ///
    /// The parameter is computed afresh in f64, so the point lies on the ray and on the primitive; where that strays
    /// from `hit.t` (a grazed triangle), the point of `hit.t` is projected onto the primitive instead. An interpolated
    /// normal that is degenerate gives way to the geometric one; one on the other side of it is negated, so that
    /// normals that disagree with the winding shade as if they agreed.
    pub fn surface(&self, ray: &Ray, hit: Hit) -> Surface {
        surface::surface(self, ray, hit)
    }
}
