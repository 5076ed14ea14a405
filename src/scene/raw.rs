//! Bare triangles, spheres and rays: `.tri`, `.sph`, `.rays`, `.truth`.

use crate::error::{Error, Result};
use crate::geometry::{Sphere, Triangle};
use std::path::Path;

/// Reads a `.tri` file.
///
/// # Errors
/// Always, for now.
pub fn read_triangles(path: &Path) -> Result<Vec<Triangle>> {
    Err(Error::malformed(path, "cannot read .tri files yet"))
}

/// Reads a `.sph` file.
///
/// # Errors
/// Always, for now.
pub fn read_spheres(path: &Path) -> Result<Vec<Sphere>> {
    Err(Error::malformed(path, "cannot read .sph files yet"))
}
