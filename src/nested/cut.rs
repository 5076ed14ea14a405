//! Cells of the grid on top cut into nodes, and their primitives listed at the leaves.

use super::boxes::Boxes;
use super::frame::{Frame, PADDING};
use super::lanes::Lanes;
use super::limit::Limit;
use super::options::{Nodes, Settings};
use super::raster::Window;
use super::shape::{Node, Slot};
use super::simd::{Isa, Work};
use super::source::Source;
use super::tree::{Grower, Member};
use crate::geometry::NO_PRIM;
use crate::ray::Aabb;
use std::ops::Range;

/// Cells with a shorter edge are not made, in a part's coordinates: eight paddings.
pub(super) const LEAST_CELL: f32 = 8.0 * PADDING;

/// What comes of some cells in a row: nodes, their slots and packs are counted from the piece's own begin.
#[derive(Clone, Debug)]
pub(super) struct Piece<L> {
    /// Which cells of the grid.
    pub cells: Range<usize>,
    pub nodes: Vec<Node>,
    pub slots: Vec<Slot>,
    /// Boxes around the packs of leaves that have more than [`FEW`]; they count packs from the piece's own begin as well.
    pub boxes: Vec<Boxes>,
    /// The primitives of eight lanes for each pack; [`NO_PRIM`] where a lane holds none.
    pub lanes: Vec<u32>,
    /// The primitives of the cell that is being cut.
    locals: Vec<L>,
    /// Lists of parts of it, one behind the other, as places in `locals`.
    lists: Vec<u32>,
    /// For each primitive of the list that is being cut, the cells that it meets.
    masks: Vec<u64>,
    /// What those of a leaf have in its cell.
    members: Vec<Member>,
}

impl<L> Default for Piece<L> {
    fn default() -> Self {
        Self {
            cells: 0..0,
            nodes: Vec::new(),
            slots: Vec::new(),
            boxes: Vec::new(),
            lanes: Vec::new(),
            locals: Vec::new(),
            lists: Vec::new(),
            masks: Vec::new(),
            members: Vec::new(),
        }
    }
}

impl<L> Piece<L> {
    /// Begins anew with these cells, in the same memory.
    pub fn clear(&mut self, cells: Range<usize>) {
        self.cells = cells;
        self.nodes.clear();
        self.slots.clear();
        self.boxes.clear();
        self.lanes.clear();
    }

    /// Number of packs.
    pub fn packs(&self) -> usize {
        self.lanes.len() / 8
    }
}

/// Cuts cells.
pub(super) struct Cutter<'a, Src: Source> {
    pub source: &'a Src,
    pub settings: &'a Settings,
    pub frame: &'a Frame,
    pub boxes: &'a [Aabb],
    pub isa: Isa,
    pub limit: &'a Limit,
}

impl<Src: Source> Cutter<'_, Src> {
    /// What becomes of the cell of the grid on top that begins at `low` and meets `prims`.
    pub fn top(&self, prims: &[u32], low: [f32; 3], size: [f32; 3], piece: &mut Piece<Src::Local>) -> Slot {
        if prims.len() <= 8 * FEW || self.settings.nodes.is_none() {
            return self.leaf(piece, prims.len(), |_, i| prims[i], low, size);
        }
        self.source.gather(prims, &mut piece.locals);
        piece.lists.clear();
        piece.lists.extend(0..prims.len() as u32);
        self.cell(prims, 0..prims.len(), low, size, piece)
    }

    /// A node costs as much as some packs: fewer are tested at once.
    fn may_cut(&self, primitives: usize, size: &[f32; 3]) -> Option<Nodes> {
        let worth = |nodes: &Nodes| cost(primitives) > nodes.cost && size.iter().all(|&edge| 0.25 * edge >= LEAST_CELL);
        self.settings.nodes.filter(worth)
    }

    /// Cuts the cell that begins at `low` and meets the primitives of `piece.lists[range]`, if that is worth it.
    fn cell(
        &self,
        prims: &[u32],
        range: Range<usize>,
        low: [f32; 3],
        size: [f32; 3],
        piece: &mut Piece<Src::Local>,
    ) -> Slot {
        let len = range.len();
        let prim = |lists: &[u32], i| prims[lists[range.start + i] as usize];
        let Some(nodes) = self.may_cut(len, &size) else { return self.leaf(piece, len, prim, low, size) };
        let window = Window::new(low, size.map(|x| 0.25 * x));
        let Piece { locals, lists, masks, .. } = piece;
        let counts =
            self.isa.run(Masks { source: self.source, locals, list: &lists[range.clone()], window: &window, masks });
        // The chance that a ray through a box meets a convex part of it is the quotient of their surfaces: a sixteenth.
        let below: f32 = counts.iter().map(|&n| cost(n as usize)).sum();
        let growth = counts.iter().map(|n| n.div_ceil(8)).sum::<u32>() as f32 - len.div_ceil(8) as f32;
        if nodes.cost + below / 16.0 + nodes.growth * growth >= cost(len) {
            return self.leaf(piece, len, prim, low, size);
        }
        let begin = lists.len();
        let mut next = [0_usize; 64];
        let (mut mask, mut end) = (0, begin);
        for (i, &n) in counts.iter().enumerate() {
            next[i] = end;
            end += n as usize;
            mask |= u64::from(n > 0) << i;
        }
        if !self.limit.lend(4 * end as u64) || self.limit.exceeded() {
            return Slot::EMPTY;
        }
        lists.resize(end, 0);
        for (at, &cells) in range.clone().zip(&*masks) {
            let (local, mut cells) = (lists[at], cells);
            while cells != 0 {
                let cell = cells.trailing_zeros() as usize;
                lists[next[cell]] = local;
                next[cell] += 1;
                cells &= cells - 1;
            }
        }
        let index = piece.nodes.len();
        let base = piece.slots.len();
        let centre = [0, 1, 2].map(|a| low[a] + 2.0 * window.cell[a]);
        piece.nodes.push(Node { mask, centre, cell: window.cell, base: base as u32 });
        piece.slots.resize(base + mask.count_ones() as usize, Slot::EMPTY);
        for (slot, cell) in (base..).zip((0..64).filter(|cell| mask >> cell & 1 != 0)) {
            let at = [cell & 3, cell >> 2 & 3, cell >> 4];
            let low = [0, 1, 2].map(|a| low[a] + at[a] as f32 * window.cell[a]);
            let list = next[cell] - counts[cell] as usize..next[cell];
            piece.slots[slot] = self.cell(prims, list, low, window.cell, piece);
        }
        piece.lists.truncate(begin);
        Slot::node(index as u32)
    }

    /// A leaf of `len` primitives, which are found with `piece.lists`, in the cell that begins at `low`: a pack, or trees of boxes.
    fn leaf(
        &self,
        piece: &mut Piece<Src::Local>,
        len: usize,
        prim: impl Fn(&[u32], usize) -> u32,
        low: [f32; 3],
        size: [f32; 3],
    ) -> Slot {
        const PACK: usize = size_of::<[u32; 8]>();
        if self.limit.exceeded() {
            return Slot::EMPTY;
        }
        let Piece { lists, lanes, boxes, members, .. } = piece;
        let [packs, groups] = [lanes.len() / 8, boxes.len()];
        let prims = (0..len).map(|i| prim(lists, i));
        let slot = if len <= 8 * FEW {
            lanes.extend(prims);
            lanes.resize(8 * (packs + len.div_ceil(8)), NO_PRIM);
            Slot { first: packs as u32, count: len.div_ceil(8) as u32 }
        } else if self.limit.lend((len * size_of::<Member>()) as u64) {
            let high = [0, 1, 2].map(|a| low[a] + size[a]);
            let (low, high) = (self.frame.outwards(low, -1.0), self.frame.outwards(high, 1.0));
            members.clear();
            members.extend(prims.map(|prim| {
                let [from, to] = self.frame.bounds(&self.boxes[prim as usize], Src::MARGIN);
                Member::new(prim, from.max(low), to.min(high))
            }));
            let [first, roots] = Grower { boxes, lanes, halved: self.settings.halved }.plant(members);
            Slot::boxed(first, roots)
        } else {
            Slot::EMPTY
        };
        let bytes = (lanes.len() / 8 - packs) * (PACK + size_of::<Src::Pack>());
        let bytes = bytes + (boxes.len() - groups) * size_of::<Boxes>();
        if self.limit.take(bytes as u64) { slot } else { Slot::EMPTY }
    }
}

/// Leaves of more packs than this have boxes around them.
const FEW: usize = 1;

/// What a leaf of so many primitives costs, in packs: a group of boxes as much as half a pack, and of the packs behind them
/// two fifths are tested. Too much for large leaves of a surface, so that more is cut than pays, but right for what
/// overlaps.
fn cost(primitives: usize) -> f32 {
    let packs = primitives.div_ceil(8);
    if packs <= FEW { packs as f32 } else { 0.5 * packs.div_ceil(8) as f32 + 0.4 * packs as f32 }
}

/// Finds the cells of a window that each primitive of a list meets, and how many meet each cell.
struct Masks<'a, Src: Source> {
    source: &'a Src,
    locals: &'a [Src::Local],
    /// Places in `locals`.
    list: &'a [u32],
    window: &'a Window,
    /// One for each primitive of the list.
    masks: &'a mut Vec<u64>,
}

impl<Src: Source> Work for Masks<'_, Src> {
    type Output = [u32; 64];

    #[inline(always)]
    fn run<S: Lanes>(self) -> [u32; 64] {
        let Self { source, locals, list, window, masks } = self;
        let mut counts = [0; 64];
        masks.clear();
        masks.reserve(list.len());
        for &i in list {
            let mask = source.cells::<S>(&locals[i as usize], window);
            masks.push(mask);
            let mut cells = mask;
            while cells != 0 {
                counts[cells.trailing_zeros() as usize & 63] += 1;
                cells &= cells - 1;
            }
        }
        counts
    }
}

/// Makes a pack of eight lanes.
pub(super) struct Fill<'a, Src: Source> {
    pub source: &'a Src,
    pub lanes: &'a [u32],
}

impl<Src: Source> Work for Fill<'_, Src> {
    type Output = Src::Pack;

    #[inline(always)]
    fn run<S: Lanes>(self) -> Src::Pack {
        let filled = self.lanes.iter().position(|&prim| prim == NO_PRIM).unwrap_or(self.lanes.len());
        self.source.pack(&self.lanes[..filled])
    }
}
