//! The parts of a shape: one kind of primitives each, and each group of them by itself.

use super::build;
use super::frame::Frame;
use super::options::{NestedOptions, Settings};
use super::shape::{AnyPart, Shape};
use super::simd::Isa;
use super::source::{Others, Spheres, Triangles};
use super::split::{Group, split};
use crate::error::Result;
use crate::geometry::{Geometry, Sphere, Triangle};
use crate::ray::{Aabb, Cell};

/// Builds all parts over the primitives `prims` of `geometry`.
///
/// # Errors
/// They would take more than `options.memory` bytes.
pub(super) fn build<G: Geometry>(geometry: &G, prims: &[u32], options: &NestedOptions, isa: Isa) -> Result<Shape> {
    let (triangles, others): (Vec<u32>, Vec<u32>) = prims.iter().partition(|&&prim| geometry.triangle(prim).is_some());
    let (spheres, others): (Vec<u32>, Vec<u32>) = others.iter().partition(|&&prim| geometry.sphere(prim).is_some());
    let mut root = Root { options, isa, shape: Shape::default() };
    let bounds = |prims: &[u32]| -> Vec<Aabb> { prims.iter().map(|&prim| geometry.bounds(prim)).collect() };
    root.triangles(&triangles, &bounds(&triangles), |prim| geometry.triangle(prim))?;
    root.spheres(&spheres, &bounds(&spheres), |prim| geometry.sphere(prim))?;
    root.others(&others, &bounds(&others), &|prim, cell: &Cell| geometry.overlaps(prim, cell))?;
    Ok(root.shape)
}

/// What has been built so far.
struct Root<'a> {
    options: &'a NestedOptions,
    isa: Isa,
    shape: Shape,
}

/// A group with what it has of the lists: its frame, settings, indices in the geometry, and boxes.
struct Members {
    frame: Frame,
    settings: Settings,
    prims: Vec<u32>,
    boxes: Vec<Aabb>,
}

impl Root<'_> {
    /// The groups of some primitives.
    fn groups(prims: &[u32], boxes: &[Aabb], settings: Settings) -> Vec<Members> {
        let groups = if prims.is_empty() { Vec::new() } else { split(boxes) };
        let members = |Group { members, loose }: Group| {
            let boxes: Vec<Aabb> = members.iter().map(|&i| boxes[i as usize]).collect();
            Members {
                frame: Frame::new(&boxes.iter().fold(Aabb::EMPTY, |all, b| all.union(b))),
                settings: if loose { Settings::LOOSE } else { settings },
                prims: members.iter().map(|&i| prims[i as usize]).collect(),
                boxes,
            }
        };
        groups.into_iter().map(members).collect()
    }

    /// What has not been used of the budget.
    fn memory(&self) -> u64 {
        let used: u64 = self.shape.parts.iter().flat_map(AnyPart::bytes).sum();
        self.options.memory.saturating_sub(used)
    }

    fn triangles(&mut self, prims: &[u32], boxes: &[Aabb], corners: impl Fn(u32) -> Option<Triangle>) -> Result<()> {
        for Members { frame, settings, prims, .. } in
            Self::groups(prims, boxes, Settings::triangles(self.options.quality))
        {
            let corners = prims.iter().filter_map(|&prim| corners(prim)).collect();
            let part = build::build(&Triangles::new(frame, prims, corners), frame, &settings, self.memory(), self.isa)?;
            self.shape.parts.push(AnyPart::Triangles(part));
        }
        Ok(())
    }

    fn spheres(&mut self, prims: &[u32], boxes: &[Aabb], sphere: impl Fn(u32) -> Option<Sphere>) -> Result<()> {
        for Members { frame, settings, prims, .. } in
            Self::groups(prims, boxes, Settings::spheres(self.options.quality))
        {
            let spheres: Vec<Sphere> = prims.iter().filter_map(|&prim| sphere(prim)).collect();
            let part = build::build(&Spheres::new(frame, prims, &spheres), frame, &settings, self.memory(), self.isa)?;
            self.shape.parts.push(AnyPart::Spheres(part));
        }
        Ok(())
    }

    fn others(
        &mut self,
        prims: &[u32],
        boxes: &[Aabb],
        overlaps: &(dyn Fn(u32, &Cell) -> bool + Sync + '_),
    ) -> Result<()> {
        for Members { frame, settings, prims, boxes } in
            Self::groups(prims, boxes, Settings::spheres(self.options.quality))
        {
            let part =
                build::build(&Others::new(frame, prims, &boxes, overlaps), frame, &settings, self.memory(), self.isa)?;
            self.shape.parts.push(AnyPart::Lists(part));
        }
        Ok(())
    }
}
