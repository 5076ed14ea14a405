//! The memory that a scene may take while it is read, asked for before it is taken.

use super::{LoadOptions, Mesh, Texture};
use crate::error::{Error, Result};
use crate::geometry::Triangle;
use glam::Vec3;
use std::cell::Cell;

/// What is left of [`LoadOptions::memory`].
#[derive(Debug)]
pub(super) struct Budget {
    allowed: u64,
    taken: Cell<u64>,
}

impl Budget {
    pub(super) fn new(options: &LoadOptions) -> Self {
        Self { allowed: options.memory, taken: Cell::new(0) }
    }

    /// Bytes that may still be taken.
    pub(super) fn left(&self) -> u64 {
        self.allowed.saturating_sub(self.taken.get())
    }

    /// Takes `bytes` for good; `what` says for what.
    ///
    /// # Errors
    /// Less is left.
    pub(super) fn take(&self, bytes: u64, what: impl FnOnce() -> String) -> Result<()> {
        self.afford(bytes, what)?;
        self.taken.set(self.taken.get() + bytes);
        Ok(())
    }

    /// Whether `bytes` could be taken, for what is soon given back.
    ///
    /// # Errors
    /// As [`Budget::take`].
    pub(super) fn afford(&self, bytes: u64, what: impl FnOnce() -> String) -> Result<()> {
        let wanted = self.taken.get().saturating_add(bytes);
        if wanted <= self.allowed {
            return Ok(());
        }
        Err(Error::TooLarge { what: format!("{} with all before", what()), wanted, allowed: self.allowed })
    }

    /// Takes what a mesh with so many vertices and triangles takes in a scene, its primitives included.
    ///
    /// # Errors
    /// As [`Budget::take`].
    #[cfg_attr(not(all(feature = "gltf", feature = "obj")), allow(dead_code, reason = "for the readers of meshes"))]
    pub(super) fn take_mesh(&self, vertices: u64, triangles: u64, what: impl FnOnce() -> String) -> Result<()> {
        // Position, normal and texture coordinates.
        const VERTEX: u64 = 2 * size_of::<Vec3>() as u64 + 8;
        const TRIANGLE: u64 = (size_of::<[u32; 3]>() + size_of::<Triangle>()) as u64;
        self.take(vertices.saturating_mul(VERTEX).saturating_add(triangles.saturating_mul(TRIANGLE)), what)
    }

    /// As [`Budget::take_mesh`], for meshes that were read by a reader with bounds of its own.
    ///
    /// # Errors
    /// As [`Budget::take`].
    #[cfg_attr(not(all(feature = "gltf", feature = "obj")), allow(dead_code, reason = "for the readers of meshes"))]
    pub(super) fn take_meshes(&self, meshes: &[Mesh], what: impl FnOnce() -> String) -> Result<()> {
        let sum = |count: fn(&Mesh) -> usize| meshes.iter().map(|m| count(m) as u64).sum::<u64>();
        self.take_mesh(sum(|m| m.positions.len()), sum(|m| m.triangles.len()), what)
    }

    /// Takes the texels of a texture. The error is the cause alone.
    pub(super) fn take_texture(&self, texture: &Texture) -> std::result::Result<(), String> {
        let bytes = texture.texels.len() as u64 * size_of::<Vec3>() as u64;
        self.take(bytes, || format!("{} x {} texels", texture.width, texture.height)).map_err(|e| e.to_string())
    }
}
