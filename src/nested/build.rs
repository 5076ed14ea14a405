//! Building a part: the grid on top by sorting references into its cells, then what is below, cell by cell, then the packs.
//!
//! Every step is done in chunks that threads share, of primitives first and of cells then; what comes of them is put together in
//! the order of the grid, so that it does not depend on how many threads there are.

use super::cut::{Cutter, Fill, Piece};
use super::frame::Frame;
use super::limit::Limit;
use super::options::Settings;
use super::place::{Place, Placed, Placements};
use super::shape::{Node, Part, Slot, Top};
use super::simd::Isa;
use super::source::Source;
use crate::error::Result;
use crate::grid::{lists, skip::free_cubes};
use crate::parallel;
use crate::ray::Aabb;
use std::ops::Range;

/// Memory of a build that the next one uses again; `L` is a primitive in a part's coordinates.
#[derive(Clone, Debug)]
pub(super) struct Shop<L> {
    placed: Vec<Placed<L>>,
    start: Vec<u32>,
    list: Vec<u32>,
    pieces: Vec<Piece<L>>,
}

impl<L> Default for Shop<L> {
    fn default() -> Self {
        Self { placed: Vec::new(), start: Vec::new(), list: Vec::new(), pieces: Vec::new() }
    }
}

/// What to build a part of.
pub(super) struct Plan<'a, Src> {
    pub source: &'a Src,
    /// By index in the geometry, ascending.
    pub members: &'a [u32],
    /// Boxes by index in the geometry.
    pub boxes: &'a [Aabb],
    pub frame: Frame,
    pub settings: Settings,
    /// Bytes that it may take.
    pub memory: u64,
    pub isa: Isa,
}

impl<Src: Source> Plan<'_, Src> {
    /// Builds the part in the memory of another.
    ///
    /// # Errors
    /// It would take more than `memory` bytes.
    pub fn build(&self, part: &mut Part<Src::Pack>, shop: &mut Shop<Src::Local>) -> Result<()> {
        part.frame = self.frame;
        let Part { top, .. } = part;
        top.half = self.frame.half;
        top.cells = resolution(top.half, self.settings.density * self.members.len() as f64);
        top.cell = [0, 1, 2].map(|a| 2.0 * top.half[a] / top.cells[a] as f32);
        top.per_unit = [0, 1, 2].map(|a| top.cells[a] as f32 / (2.0 * top.half[a]));
        self.place(top, shop)?;
        let occupied = shop.start.windows(2).map(|pair| pair[0] < pair[1]);
        free_cubes(top.cells.map(|n| n as usize), occupied, &mut top.free);
        self.cut(top, shop)?;
        join(part, &mut shop.pieces);

        let ends: Vec<usize> = ends(shop.pieces.iter().map(Piece::packs)).collect();
        parallel::fill(&mut part.packs, ends.last().copied().unwrap_or(0), |pack| {
            let piece = ends.partition_point(|&end| end <= pack);
            let first = if piece == 0 { 0 } else { ends[piece - 1] };
            let lanes = &shop.pieces[piece].lanes[8 * (pack - first)..][..8];
            self.isa.run(Fill { source: self.source, lanes })
        });
        Ok(())
    }

    /// Lists of the primitives that each cell of the grid meets, in `shop.start` and `shop.list`.
    fn place(&self, top: &Top, shop: &mut Shop<Src::Local>) -> Result<()> {
        const LEAST: usize = 2048;
        // With four bytes for each reference, they can be counted in 32 bits.
        let mut limit = Limit::new(self.memory.min(16 << 30));
        let ranges: Vec<Range<usize>> = parallel::chunks(self.members.len(), LEAST).collect();
        shop.placed.resize_with(ranges.len(), Placed::default);
        parallel::each(shop.placed.iter_mut().zip(ranges), |(placed, range)| {
            placed.range = range;
            let Self { source, members, boxes, ref frame, .. } = *self;
            self.isa.run(Place { source, frame, top, members, boxes, limit: &limit, placed });
        });
        limit.check(&top.cells)?;
        let count = top.cells.iter().map(|&n| n as usize).product::<usize>();
        let references = Placements { members: self.members, placed: &shop.placed, cells: &top.cells };
        lists::sort(&references, count, &mut shop.start, &mut shop.list);
        Ok(())
    }

    /// Cuts the cells of the grid, in pieces.
    fn cut(&self, top: &mut Top, shop: &mut Shop<Src::Local>) -> Result<()> {
        const LEAST: usize = 4096;
        let Shop { start, list, pieces, .. } = shop;
        let Top { half, cell, cells, slots, .. } = top;
        let count = start.len() - 1;
        slots.clear();
        slots.resize(count, Slot::EMPTY);

        // Pieces of about as many references.
        let (mut work, mut rest, mut first) = (Vec::new(), slots.as_mut_slice(), 0);
        for chunk in parallel::chunks(list.len(), LEAST) {
            let end = start.partition_point(|&begin| (begin as usize) < chunk.end).min(count);
            let (mine, others) = std::mem::take(&mut rest).split_at_mut(end.saturating_sub(first));
            work.push((first, mine));
            (rest, first) = (others, end.max(first));
        }
        pieces.resize_with(work.len(), Piece::default);

        let mut limit = Limit::new(self.memory.min(1 << 40));
        let cutter = Cutter { source: self.source, settings: &self.settings, isa: self.isa, limit: &limit };
        let [nx, ny, _] = cells.map(|n| n as usize);
        parallel::each(pieces.iter_mut().zip(work), |(piece, (first, slots))| {
            piece.clear(first..first + slots.len());
            for (i, slot) in (first..).zip(slots) {
                let list = &list[start[i] as usize..start[i + 1] as usize];
                if !list.is_empty() {
                    let at = [i % nx, i / nx % ny, i / (nx * ny)];
                    let low = [0, 1, 2].map(|a| at[a] as f32 * cell[a] - half[a]);
                    *slot = cutter.top(list, low, *cell, piece);
                }
            }
        });
        limit.check(cells)
    }
}

/// Puts pieces together: what they number from their own begin, the part numbers from its.
fn join<K, L>(part: &mut Part<K>, pieces: &mut [Piece<L>]) {
    if let [piece] = pieces {
        std::mem::swap(&mut part.nodes, &mut piece.nodes);
        std::mem::swap(&mut part.slots, &mut piece.slots);
        return;
    }
    let Part { nodes, slots, top, .. } = part;
    nodes.clear();
    slots.clear();
    nodes.reserve_exact(pieces.iter().map(|piece| piece.nodes.len()).sum());
    slots.reserve_exact(pieces.iter().map(|piece| piece.slots.len()).sum());
    let mut packs = 0;
    for piece in pieces {
        let (first_node, first_slot) = (nodes.len() as u32, slots.len() as u32);
        let moved = |slot: &Slot| match slot {
            slot if slot.is_node() => Slot::node(slot.first + first_node),
            slot => Slot { first: slot.first + packs, ..*slot },
        };
        nodes.extend(piece.nodes.iter().map(|node| Node { base: node.base + first_slot, ..*node }));
        slots.extend(piece.slots.iter().map(moved));
        for slot in top.slots[piece.cells.clone()].iter_mut().filter(|slot| slot.count > 0) {
            *slot = moved(slot);
        }
        packs += piece.packs() as u32;
    }
}

/// Cubic cells, `wanted` of them; an axis shorter than one gets one.
fn resolution(half: [f32; 3], wanted: f64) -> [u32; 3] {
    const MOST: f64 = 512.0;
    let volume: f64 = half.iter().map(|&h| 2.0 * f64::from(h)).product();
    let edge = (volume / wanted.max(1.0)).cbrt();
    half.map(|h| (2.0 * f64::from(h) / edge).round().clamp(1.0, MOST) as u32)
}

/// Running totals.
fn ends(lengths: impl Iterator<Item = usize>) -> impl Iterator<Item = usize> {
    lengths.scan(0, |end, length| {
        *end += length;
        Some(*end)
    })
}
