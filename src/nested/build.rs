//! Building a part: the grid on top by counting and scattering, nodes below by masks, cell by cell.

use super::frame::{Frame, PADDING};
use super::lanes::Lanes;
use super::options::Settings;
use super::raster::Window;
use super::shape::{Node, Part, Slot, Top};
use super::simd::Isa;
use super::source::Source;
use crate::error::{Error, Result};
use crate::grid::skip::free_cubes;
use std::ops::Range;

/// Cells with a shorter edge are not made, in a part's coordinates: eight paddings.
pub(super) const LEAST_CELL: f32 = 8.0 * PADDING;

/// Primitives met by a window of the grid on top.
pub(super) struct Met {
    cells: u64,
    prim: u32,
    /// Cell of the grid where the window begins.
    first: u32,
}

/// Builds a part.
///
/// # Errors
/// It would take more than `memory` bytes.
pub(super) fn build<Src: Source>(
    source: &Src,
    frame: Frame,
    settings: &Settings,
    memory: u64,
    isa: Isa,
) -> Result<Part<Src::Pack>> {
    let half = frame.half;
    let cells = resolution(half, settings.density * source.len() as f64);
    let count = cells.iter().map(|&n| n as usize).product::<usize>();
    let cell = [0, 1, 2].map(|a| 2.0 * half[a] / cells[a] as f32);
    let per_unit = [0, 1, 2].map(|a| cells[a] as f32 / (2.0 * half[a]));
    let mut top = Top { half, cell, per_unit, cells, free: Vec::new(), slots: vec![Slot::EMPTY; count] };

    let met = isa.windows(source, &top, memory)?;
    let mut start = vec![0_u32; count + 1];
    each(&met, &cells, |cell, _| start[cell + 1] += 1);
    for i in 0..count {
        start[i + 1] += start[i];
    }
    let mut list = vec![0_u32; start[count] as usize];
    let mut next = start.clone();
    each(&met, &cells, |cell, prim| {
        list[next[cell] as usize] = prim;
        next[cell] += 1;
    });
    drop((met, next));

    let filled = start.windows(2).map(|pair| pair[0] < pair[1]).collect();
    top.free = free_cubes(cells.map(|n| n as usize), filled).concat();

    let mut builder = Builder {
        source,
        settings,
        isa,
        nodes: Vec::new(),
        slots: Vec::new(),
        packs: Vec::new(),
        list,
        masks: Vec::new(),
    };
    // Packs and nodes in the order of cells: neighbours are near one another.
    for (i, slot) in top.slots.iter_mut().enumerate() {
        let range = start[i] as usize..start[i + 1] as usize;
        if !range.is_empty() {
            let [nx, ny, _] = cells.map(|n| n as usize);
            let at = [i % nx, i / nx % ny, i / (nx * ny)];
            let low = [0, 1, 2].map(|a| at[a] as f32 * cell[a] - half[a]);
            *slot = builder.cell(range, low, cell);
        }
    }
    let Builder { nodes, slots, packs, .. } = builder;
    Ok(Part { frame, top, nodes, slots, packs })
}

/// Cubic cells, `wanted` of them; an axis shorter than one gets one.
fn resolution(half: [f32; 3], wanted: f64) -> [u32; 3] {
    const MOST: f64 = 512.0;
    let volume: f64 = half.iter().map(|&h| 2.0 * f64::from(h)).product();
    let edge = (volume / wanted.max(1.0)).cbrt();
    half.map(|h| (2.0 * f64::from(h) / edge).round().clamp(1.0, MOST) as u32)
}

/// Which cells of the grid each primitive meets, window by window.
///
/// # Errors
/// They would take more than `memory` bytes.
#[inline(always)]
pub(super) fn windows<S: Lanes, Src: Source>(source: &Src, top: &Top, memory: u64) -> Result<Vec<Met>> {
    let mut met = Vec::with_capacity(source.len());
    let mut references = 0_u64;
    for i in 0..source.len() {
        let [min, max] = source.bounds(i);
        let place = |a: usize, x: f32| (((x + top.half[a]) * top.per_unit[a]) as i32).clamp(0, top.cells[a] as i32 - 1);
        let low = [0, 1, 2].map(|a| place(a, min[a] - 2.0 * PADDING));
        let high = [0, 1, 2].map(|a| place(a, max[a] + 2.0 * PADDING));
        let steps = |a: usize| (low[a]..=high[a]).step_by(4);
        for z in steps(2) {
            for y in steps(1) {
                for x in steps(0) {
                    let at = [x, y, z];
                    let low = [0, 1, 2].map(|a| at[a] as f32 * top.cell[a] - top.half[a]);
                    let cells = source.cells::<S>(i, &Window { low, cell: top.cell }) & within(at, &top.cells);
                    if cells != 0 {
                        let [x, y, z] = at.map(|i| i as u32);
                        let first = (z * top.cells[1] + y) * top.cells[0] + x;
                        met.push(Met { cells, prim: i as u32, first });
                        references += u64::from(cells.count_ones());
                    }
                }
            }
        }
        // Asked for each primitive, so that what cannot be is refused before it is counted to the end.
        let wanted = references * 8 + met.len() as u64 * 16;
        if wanted > memory || references > u64::from(u32::MAX / 2) {
            let what = format!("nested grid of {:?} cells with {references} references", top.cells);
            return Err(Error::TooLarge { what, wanted, allowed: memory.min(16 << 30) });
        }
    }
    Ok(met)
}

/// Appends the cells of a window that each primitive of a list meets.
#[inline(always)]
pub(super) fn masks<S: Lanes, Src: Source>(source: &Src, list: &[u32], window: &Window, masks: &mut Vec<u64>) {
    masks.reserve(list.len());
    for &i in list {
        masks.push(source.cells::<S>(i as usize, window));
    }
}

/// The cells of a window that are in the grid.
fn within(at: [i32; 3], cells: &[u32; 3]) -> u64 {
    let mut mask = u64::MAX;
    let room = [0, 1, 2].map(|a| (cells[a] as i32 - at[a]).min(4) as u32);
    mask &= ((1_u64 << room[0]) - 1) * 0x1111_1111_1111_1111;
    mask &= ((1_u64 << (4 * room[1])) - 1).wrapping_mul(0x0001_0001_0001_0001);
    if room[2] < 4 {
        mask &= (1 << (16 * room[2])) - 1;
    }
    mask
}

/// Every cell that every primitive meets.
fn each(met: &[Met], cells: &[u32; 3], mut visit: impl FnMut(usize, u32)) {
    let [nx, ny, _] = cells.map(|n| n as usize);
    for Met { cells, prim, first } in met {
        let mut rest = *cells;
        while rest != 0 {
            let bit = rest.trailing_zeros() as usize;
            rest &= rest - 1;
            visit(*first as usize + (bit & 3) + nx * ((bit >> 2 & 3) + ny * (bit >> 4)), *prim);
        }
    }
}

/// What grows while cells are cut.
struct Builder<'a, Src: Source> {
    source: &'a Src,
    settings: &'a Settings,
    isa: Isa,
    nodes: Vec<Node>,
    slots: Vec<Slot>,
    packs: Vec<Src::Pack>,
    /// The lists of cells that are being cut, one behind the other.
    list: Vec<u32>,
    /// For each primitive of a list that is being cut, the cells that it meets.
    masks: Vec<u64>,
}

impl<Src: Source> Builder<'_, Src> {
    /// Cuts the cell that begins at `low`, if that is worth it. It meets the primitives of `self.list[range]`.
    fn cell(&mut self, range: Range<usize>, low: [f32; 3], size: [f32; 3]) -> Slot {
        let window = Window { low, cell: size.map(|x| 0.25 * x) };
        let packs = range.len().div_ceil(8) as f32;
        // A node costs as much as some packs: fewer are tested at once.
        let worth = packs > self.settings.node_cost;
        if !worth || window.cell.iter().any(|&edge| edge < LEAST_CELL) {
            return self.leaf(range);
        }
        let mut counts = [0_u32; 64];
        self.masks.clear();
        self.isa.masks(self.source, &self.list[range.clone()], &window, &mut self.masks);
        for &cells in &self.masks {
            let mut cells = cells;
            while cells != 0 {
                counts[cells.trailing_zeros() as usize] += 1;
                cells &= cells - 1;
            }
        }
        // The chance that a ray through a box meets a convex part of it is the quotient of their surfaces: a sixteenth.
        let below: u32 = counts.iter().map(|n| n.div_ceil(8)).sum();
        if self.settings.node_cost + below as f32 / 16.0 >= packs {
            return self.leaf(range);
        }
        let begin = self.list.len();
        let mut next = [0_usize; 64];
        let mut mask = 0;
        let mut end = begin;
        for (i, &n) in counts.iter().enumerate() {
            next[i] = end;
            end += n as usize;
            mask |= u64::from(n > 0) << i;
        }
        self.list.resize(end, 0);
        for (at, &cells) in range.zip(&self.masks) {
            let (prim, mut cells) = (self.list[at], cells);
            while cells != 0 {
                let cell = cells.trailing_zeros() as usize;
                self.list[next[cell]] = prim;
                next[cell] += 1;
                cells &= cells - 1;
            }
        }
        let index = self.nodes.len();
        let base = self.slots.len();
        let centre = [0, 1, 2].map(|a| low[a] + 2.0 * window.cell[a]);
        self.nodes.push(Node { mask, centre, cell: window.cell, base: base as u32 });
        self.slots.resize(base + mask.count_ones() as usize, Slot::EMPTY);
        for (slot, cell) in (base..).zip((0..64).filter(|cell| mask >> cell & 1 != 0)) {
            let at = [cell & 3, cell >> 2 & 3, cell >> 4];
            let low = [0, 1, 2].map(|a| low[a] + at[a] as f32 * window.cell[a]);
            let list = next[cell] - counts[cell] as usize..next[cell];
            self.slots[slot] = self.cell(list, low, window.cell);
        }
        self.list.truncate(begin);
        Slot::node(index as u32)
    }

    /// The primitives of a list in packs.
    fn leaf(&mut self, range: Range<usize>) -> Slot {
        let first = self.packs.len();
        for eight in self.list[range].chunks(8) {
            self.packs.push(self.source.pack(eight));
        }
        Slot { first: first as u32, count: (self.packs.len() - first) as u32 }
    }
}
