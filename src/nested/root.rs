//! Which primitives share a grid.

use super::frame::Frame;
use super::options::{NestedOptions, Settings};
use super::shape::{AnyPart, Shape};
use super::simd::Isa;
use super::source::{Others, Spheres, Triangles};
use crate::error::Result;
use crate::geometry::Geometry;
use crate::ray::Aabb;

/// Builds all parts over the primitives `prims` of `geometry`.
///
/// # Errors
/// They would take more than `options.memory` bytes.
pub(super) fn build<G: Geometry>(geometry: &G, prims: &[u32], options: &NestedOptions, isa: Isa) -> Result<Shape> {
    let (triangles, others): (Vec<u32>, Vec<u32>) = prims.iter().partition(|&&prim| geometry.triangle(prim).is_some());
    let (spheres, others): (Vec<u32>, Vec<u32>) = others.iter().partition(|&&prim| geometry.sphere(prim).is_some());
    let around = |prims: &[u32]| prims.iter().fold(Aabb::EMPTY, |b, &prim| b.union(&geometry.bounds(prim)));
    let mut shape = Shape::default();
    if !triangles.is_empty() {
        let frame = Frame::new(&around(&triangles));
        let corners = triangles.iter().filter_map(|&prim| geometry.triangle(prim)).collect();
        let source = Triangles::new(frame, triangles, corners);
        let settings = Settings::triangles(options.quality);
        shape.parts.push(AnyPart::Triangles(isa.build(&source, frame, &settings, options.memory)?));
    }
    if !spheres.is_empty() {
        let frame = Frame::new(&around(&spheres));
        let balls: Vec<_> = spheres.iter().filter_map(|&prim| geometry.sphere(prim)).collect();
        let source = Spheres::new(frame, spheres, &balls);
        let settings = Settings::spheres(options.quality);
        shape.parts.push(AnyPart::Spheres(isa.build(&source, frame, &settings, options.memory)?));
    }
    if !others.is_empty() {
        let frame = Frame::new(&around(&others));
        let bounds: Vec<_> = others.iter().map(|&prim| geometry.bounds(prim)).collect();
        let overlaps = |prim: u32, cell: &crate::ray::Cell| geometry.overlaps(prim, cell);
        let source = Others::new(frame, others, &bounds, &overlaps);
        let settings = Settings::spheres(options.quality);
        shape.parts.push(AnyPart::Lists(isa.build(&source, frame, &settings, options.memory)?));
    }
    Ok(shape)
}
