//! Picks the loader by name and extension; lays primitives out; answers what shading asks of a hit.

use super::{Scene, SceneParts, Surface};
use crate::accel::Hit;
use crate::error::Result;
use crate::ray::Ray;

/// How to read a scene.
#[derive(Clone, Debug, Default)]
pub struct LoadOptions {
    /// Drop primitives with coordinates that are not finite, with a warning that counts them, instead of refusing.
    pub drop_invalid: bool,
}

/// Reads `spec`: the path of a .toml, .gltf, .glb, .obj, .tri or .sph file, or the name of a procedural scene with
/// options, such as `random:n=10000`.
///
/// # Errors
/// The file cannot be read or is not usable: the message names the file, the place and the cause.
pub fn load(_spec: &str, _options: &LoadOptions) -> Result<Scene> {
    unimplemented!()
}

pub(super) fn assemble(_parts: SceneParts) -> Result<Scene> {
    unimplemented!()
}

pub(super) fn surface(_scene: &Scene, _ray: &Ray, _hit: Hit) -> Surface {
    unimplemented!()
}
