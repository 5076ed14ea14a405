//! Building a tree from the root down.

use super::frame::{Frame, SIZE};
use super::nodes::{NIL, Node, Nodes, Planes};
use super::options::{BspOptions, Choice};
use super::reference::{Extent, Of, Reference, Sorter};
use super::tree::{AnyPlane, AxisPlane};
use super::walk::Partition;
use super::{Bsp, Interval};
use crate::accel::Candidates;
use crate::error::{Error, Result};
use crate::geometry::Geometry;
use glam::DVec3;
use std::marker::PhantomData;

impl<G: Geometry> Bsp<G, AxisPlane, Partition<Interval>> {
    /// Builds a tree of planes across the axes. Primitives that no ray can hit are left out; an empty geometry is fine.
    ///
    /// # Errors
    /// An option is out of range, the planes are to be oblique (see [`Bsp::build_oblique`]), or the tree would take more
    /// than `options.memory` bytes.
    pub fn build(geometry: G, options: &BspOptions) -> Result<Self> {
        if options.planes == Choice::Oblique {
            return Err(Error::invalid("oblique planes need a tree that can hold them"));
        }
        planted(geometry, options)
    }
}

impl<G: Geometry> Bsp<G, AnyPlane, Partition<Interval>> {
    /// Builds a tree of planes across the axes and their diagonals, whatever `options.planes` says.
    ///
    /// # Errors
    /// An option is out of range, or the tree would take more than `options.memory` bytes.
    pub fn build_oblique(geometry: G, options: &BspOptions) -> Result<Self> {
        planted(geometry, &BspOptions { planes: Choice::Oblique, ..*options })
    }
}

fn planted<G: Geometry, P: Planes>(geometry: G, options: &BspOptions) -> Result<Bsp<G, P, Partition<Interval>>> {
    options.check()?;
    let Candidates { prims, bounds, left_out } = Candidates::of(&geometry);
    let count = prims.len() as u32;
    let frame = Frame::new(&bounds);
    let sorter = Sorter { shapes: &Of(&geometry), frame: &frame };
    let mut builder = Builder::new(sorter, count, options);
    let mut references = builder.room(count as usize)?;
    references.extend(prims.iter().map(|&prim| {
        let b = geometry.bounds(prim);
        Reference { prim, part: Extent { min: frame.local(b.min.as_dvec3()), max: frame.local(b.max.as_dvec3()) } }
    }));
    let nodes = builder.tree(references)?;
    let form = PhantomData;
    Ok(Bsp { geometry, frame, shape: nodes.shape(), nodes, planes: options.planes, bounds, left_out, form })
}

/// Splits in a row that may leave both children with the whole list before the cell becomes a leaf: primitives that lie on
/// each other cannot be parted, but those that cross a cell's planes alone can, a few levels deeper.
const BARREN: u32 = 3;

/// References that splitting may add, for each primitive and in all.
const SPARE: (u64, u64) = (16, 1024);

/// Where in the tree a cell is.
#[derive(Clone, Copy)]
struct Level {
    depth: u32,
    /// Barren splits that led here, without another between them.
    barren: u32,
    /// References that may still be added below.
    spare: u64,
}

/// A cell parted in two.
struct Split {
    plane: AnyPlane,
    sides: [Vec<Reference>; 2],
    below: [Level; 2],
}

struct Builder<'a> {
    sorter: Sorter<'a>,
    options: &'a BspOptions,
    count: u32,
    levels: u32,
    nodes: Nodes,
    /// Bytes of lists of references.
    in_flight: u64,
}

impl<'a> Builder<'a> {
    /// For a tree of `count` primitives.
    fn new(sorter: Sorter<'a>, count: u32, options: &'a BspOptions) -> Self {
        let levels = options.levels(count as usize);
        Self { sorter, options, count, levels, nodes: Nodes::default(), in_flight: 0 }
    }

    /// The tree of the references, which come from [`Builder::room`].
    fn tree(mut self, references: Vec<Reference>) -> Result<Nodes> {
        let whole = Extent { min: DVec3::ZERO, max: DVec3::splat(SIZE) };
        let spare = SPARE.0 * u64::from(self.count) + SPARE.1;
        self.subtree(references, &whole, Level { depth: 0, barren: 0, spare })?;
        Ok(self.nodes)
    }

    /// Adds the subtree of a cell, children behind parents; gives its index.
    fn subtree(&mut self, references: Vec<Reference>, cell: &Extent, level: Level) -> Result<u32> {
        if references.is_empty() {
            return Ok(NIL);
        }
        self.within_budget(1, references.len())?;
        let index = self.nodes.all.len() as u32;
        let Some(Split { plane, sides, below }) = self.split(&references, cell, level)? else {
            let from = self.nodes.prims.len() as u32;
            self.nodes.prims.extend(references.iter().map(|r| r.prim));
            self.nodes.all.push(Node::leaf(from, self.nodes.prims.len() as u32));
            self.release(references);
            return Ok(index);
        };
        self.release(references);
        self.nodes.all.push(Node::leaf(0, 0));
        let cells = cell.sides(&plane, 0.0);
        let mut links = [NIL; 2];
        for (side, list) in sides.into_iter().enumerate() {
            links[side] = self.subtree(list, &cells[side], below[side])?;
        }
        self.nodes.all[index as usize] = Node::inner(&plane, links, &mut self.nodes.oblique);
        Ok(index)
    }

    /// The plane and the lists of both sides, or `None` if the cell is to be a leaf.
    fn split(&mut self, references: &[Reference], cell: &Extent, level: Level) -> Result<Option<Split>> {
        let all = references.len();
        if all <= self.options.leaf as usize || level.depth >= self.levels {
            return Ok(None);
        }
        let Some(plane) = self.sorter.choose(self.options.planes, references, cell, level.depth) else {
            return Ok(None);
        };
        let mut sides = [self.room(all)?, self.room(all)?];
        for reference in references {
            let parts = self.sorter.parts(reference, &plane);
            for (side, part) in sides.iter_mut().zip(parts) {
                side.extend(part);
            }
        }
        let [low, high] = [sides[0].len(), sides[1].len()];
        let added = (low + high).saturating_sub(all) as u64;
        let barren = match (low == all, high == all) {
            (true, true) => level.barren + 1,
            (false, false) => 0,
            _ => level.barren,
        };
        if added > level.spare || barren > BARREN {
            sides.into_iter().for_each(|side| self.release(side));
            return Ok(None);
        }
        // Shared by need; the product may exceed 64 bits.
        let spare = |n: usize| (u128::from(level.spare - added) * n as u128 / (low + high).max(1) as u128) as u64;
        let below = [low, high].map(|n| Level { depth: level.depth + 1, barren, spare: spare(n) });
        for side in &mut sides {
            let before = side.capacity();
            side.shrink_to_fit();
            self.in_flight -= bytes(before - side.capacity());
        }
        Ok(Some(Split { plane, sides, below }))
    }

    /// An empty list with room for `len` references, which count as memory until [`Builder::release`].
    fn room(&mut self, len: usize) -> Result<Vec<Reference>> {
        self.in_flight += bytes(len);
        self.within_budget(0, 0)?;
        let mut list = Vec::new();
        let refused = |_| self.too_large(0, 0, " (the system refuses the memory)");
        list.try_reserve_exact(len).map_err(refused)?;
        // The system may give more than asked for.
        self.in_flight += bytes(list.capacity() - len);
        Ok(list)
    }

    fn release(&mut self, list: Vec<Reference>) {
        self.in_flight -= bytes(list.capacity());
    }

    /// # Errors
    /// So many nodes and references more are beyond the budget or beyond what 32 bits can number.
    fn within_budget(&self, nodes: usize, references: usize) -> Result<()> {
        let numbered = self.nodes.all.len().max(self.nodes.prims.len() + references) < (u32::MAX - 8) as usize;
        if numbered && self.wanted(nodes, references) <= self.options.memory {
            return Ok(());
        }
        Err(self.too_large(nodes, references, ""))
    }

    fn wanted(&self, nodes: usize, references: usize) -> u64 {
        let kept = self.nodes.bytes() + 4 * self.nodes.prims.len() as u64;
        kept + (nodes * size_of::<Node>() + references * 4) as u64 + self.in_flight
    }

    fn too_large(&self, nodes: usize, references: usize, why: &str) -> Error {
        let (count, so_far) = (self.count, self.nodes.all.len());
        Error::TooLarge {
            what: format!("bsp tree of {count} primitives with {so_far} nodes so far{why}"),
            wanted: self.wanted(nodes, references),
            allowed: self.options.memory,
        }
    }
}

fn bytes(references: usize) -> u64 {
    (references * size_of::<Reference>()) as u64
}
