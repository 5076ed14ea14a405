//! The parts of a shape: one kind of primitives each, and each group of them by itself.

use super::boxes::Boxes;
use super::build::{Plan, Shop};
use super::frame::Frame;
use super::options::{NestedOptions, Settings};
use super::pack::List;
use super::shape::{AnyPart, Kind, Part, Shape, Slot, Top};
use super::simd::Isa;
use super::source::{Others, Source, Spheres, Triangles};
use super::split::{Group, split};
use crate::accel::{LeftOut, Sieve};
use crate::error::Result;
use crate::geometry::{Geometry, Sphere, Triangle};
use crate::ray::{Aabb, Cell};

/// Memory of a build that the next one uses again.
#[derive(Clone, Debug, Default)]
pub(super) struct Workshop {
    sieve: Sieve,
    triangles: Shop<<Triangles<'static> as Source>::Local>,
    spheres: Shop<<Spheres<'static> as Source>::Local>,
    others: Shop<<Others<'static> as Source>::Local>,
}

/// Builds all parts over `geometry`, in the memory of those of `shape`; the box around all and what is left out.
///
/// # Errors
/// They would take more than `options.memory` bytes. Then only some parts are there.
pub(super) fn build<G: Geometry>(
    geometry: &G,
    options: &NestedOptions,
    isa: Isa,
    shape: &mut Shape,
    shop: &mut Workshop,
) -> Result<(Aabb, LeftOut)> {
    let found = shop.sieve.sift(geometry);
    let Workshop { sieve: Sieve { prims, boxes, .. }, triangles, spheres, others } = shop;
    let old = std::mem::take(&mut shape.parts);
    let mut root = Root { options, isa, boxes, shape, old };

    let is_triangle = |&prim: &u32| geometry.triangle(prim).is_some();
    let is_sphere = |&prim: &u32| geometry.sphere(prim).is_some();
    let (mut lists, none) = ([const { Vec::new() }; 3], [].as_slice());
    let [of_triangles, of_spheres, of_others] = if prims.iter().all(is_triangle) {
        [prims.as_slice(), none, none]
    } else if prims.iter().all(|prim| !is_triangle(prim) && is_sphere(prim)) {
        [none, prims, none]
    } else {
        for prim in prims.iter() {
            lists[if is_triangle(prim) { 0 } else { 2 - usize::from(is_sphere(prim)) }].push(*prim);
        }
        lists.each_ref().map(Vec::as_slice)
    };
    let settings = Settings::of(options);
    let corners = |prims: &[u32], places: &mut [Triangle]| {
        for (place, &prim) in places.iter_mut().zip(prims) {
            *place = geometry.triangle(prim).unwrap_or(*place);
        }
    };
    root.add(of_triangles, settings, triangles, |frame| Triangles { frame, corners: &corners })?;
    let fetch = |prims: &[u32], places: &mut [Sphere]| {
        for (place, &prim) in places.iter_mut().zip(prims) {
            *place = geometry.sphere(prim).unwrap_or(*place);
        }
    };
    root.add(of_spheres, settings, spheres, |frame| Spheres { frame, spheres: &fetch })?;
    let overlaps = |prim: u32, cell: &Cell| geometry.overlaps(prim, cell);
    root.add(of_others, settings, others, |frame| Others { frame, boxes, overlaps: &overlaps })?;
    Ok(found)
}

/// A shape of all primitives of `geometry` in one list: four bytes for each, whatever they are.
pub(super) fn list<G: Geometry>(geometry: &G, shape: &mut Shape, shop: &mut Workshop) -> (Aabb, LeftOut) {
    let (bounds, left_out) = shop.sieve.sift(geometry);
    let frame = Frame::new(&bounds);
    let packs: Vec<List> = shop.sieve.prims.chunks(8).map(|prims| List::new(prims.iter().copied())).collect();
    let boxes: Vec<Boxes> = (0..packs.len()).step_by(8).map(|first| Boxes::around_all(first, packs.len())).collect();
    let top = Top::one(frame.half, Slot::boxed(0, boxes.len() as u32));
    shape.parts = vec![AnyPart::Lists(Part { top, boxes, packs, ..Part::new(frame) })];
    (bounds, left_out)
}

/// What has been built so far, and what it is built in.
struct Root<'a> {
    options: &'a NestedOptions,
    isa: Isa,
    boxes: &'a [Aabb],
    shape: &'a mut Shape,
    /// Parts of an earlier build, of which only the memory is of use.
    old: Vec<AnyPart>,
}

impl Root<'_> {
    /// Adds a part for each group of some primitives.
    fn add<Src: Source<Pack: Kind>>(
        &mut self,
        prims: &[u32],
        settings: Settings,
        shop: &mut Shop<Src::Local>,
        source: impl Fn(Frame) -> Src,
    ) -> Result<()> {
        if prims.is_empty() {
            return Ok(());
        }
        for Group { members, bounds, loose } in split(self.boxes, prims) {
            let frame = Frame::new(&bounds);
            let plan = Plan {
                source: &source(frame),
                members: &members,
                boxes: self.boxes,
                frame,
                settings: if loose { Settings::LOOSE } else { settings },
                memory: self.memory(),
                isa: self.isa,
            };
            let mut part = Kind::take(&mut self.old).unwrap_or_else(|| Part::new(frame));
            plan.build(&mut part, shop)?;
            self.shape.parts.push(Kind::any(part));
        }
        Ok(())
    }

    /// What has not been used of the budget.
    fn memory(&self) -> u64 {
        let used: u64 = self.shape.parts.iter().flat_map(AnyPart::bytes).sum();
        self.options.memory.saturating_sub(used)
    }
}
