//! Building a grid: a pass that counts references, then one that writes them.

use super::Grid;
use super::cells::Cells;
use super::frame::Frame;
use super::options::GridOptions;
use super::seeds::Seeds;
use super::skip::{Method, NoSkip, SkipOptions, Slot, Table};
use super::voxelise::voxels_of;
use super::walk::{VoxelWalk, Walk};
use crate::accel::Candidates;
use crate::error::{Error, Result};
use crate::geometry::Geometry;
use std::marker::PhantomData;

impl<G: Geometry> Grid<G, NoSkip, Walk> {
    /// Builds a grid over `geometry`. Primitives that no ray can hit are left out; an empty geometry is fine.
    ///
    /// # Errors
    /// An option is out of range, or voxels and references would take more than `options.memory` bytes.
    pub fn build(geometry: G, options: &GridOptions) -> Result<Self> {
        options.check()?;
        let Candidates { prims, bounds, left_out } = Candidates::of(&geometry);
        let frame = Frame::new(&bounds, prims.len() as u32, options);
        let cells = fill(&geometry, &prims, &frame, options)?;
        let left = options.memory.saturating_sub(cells.memory().total());
        let seeds = Seeds::new(&geometry, &frame, cells.references(), options, left)?;
        Ok(Self {
            geometry,
            frame,
            voxels: NoSkip(cells),
            bounds,
            // A test that begins in a voxel finds what is in that voxel only: it does not stand for the others.
            mailbox: options.mailbox && seeds.is_empty(),
            seeds,
            memory: options.memory,
            left_out,
            walk: PhantomData,
        })
    }
}

impl<G: Geometry, W: VoxelWalk> Grid<G, NoSkip, W> {
    /// The same grid with the distances of method `M`, in slots of its usual width.
    ///
    /// # Errors
    /// As [`Grid::with_table`].
    pub fn with_skip<M: Method>(self, options: &SkipOptions) -> Result<Grid<G, Table<M>>> {
        self.with_table(options)
    }

    /// The same grid with the distances of method `M` in slots `T`.
    ///
    /// # Errors
    /// An option is out of range, lists or distances would take more than the grid's budget of memory, or the lists are too
    /// long for the slots: 2^31 entries for [`super::skip::One`], 2^28 for [`super::skip::Packed`].
    pub fn with_table<M: Method, T: Slot>(self, options: &SkipOptions) -> Result<Grid<G, Table<M, T>>> {
        let Self { geometry, frame, voxels: NoSkip(cells), seeds, bounds, mailbox, memory, left_out, .. } = self;
        let voxels = Table::new(cells, frame.resolution, options, memory)?;
        Ok(Grid { geometry, frame, voxels, seeds, bounds, mailbox, memory, left_out, walk: PhantomData })
    }

    /// The same grid walked by `V`.
    pub fn with_walk<V: VoxelWalk>(self) -> Grid<G, NoSkip, V> {
        let Self { geometry, frame, voxels, seeds, bounds, mailbox, memory, left_out, .. } = self;
        Grid { geometry, frame, voxels, seeds, bounds, mailbox, memory, left_out, walk: PhantomData }
    }
}

fn fill<G: Geometry>(geometry: &G, candidates: &[u32], frame: &Frame, options: &GridOptions) -> Result<Cells> {
    let [x, y, z] = frame.resolution;
    // At most 4096^3: no overflow in u64.
    let voxels = u64::from(x) * u64::from(y) * u64::from(z);
    let what = |references: u64| format!("grid of {x} x {y} x {z} voxels with {references} references");
    let within_budget = |references: u64| {
        let wanted = (voxels + 1 + references) * 4;
        let allowed = options.memory.min((u64::from(u32::MAX)) * 4);
        if wanted > allowed { Err(Error::TooLarge { what: what(references), wanted, allowed }) } else { Ok(()) }
    };
    within_budget(0)?;
    let mut start = reserve(voxels as usize + 1, &what(0), options)?;
    start.resize(voxels as usize + 1, 0_u32);

    // First pass: start[v + 1] counts the references of voxel v. No count can wrap: a voxel refers to a primitive once.
    let mut references = 0_u64;
    for &prim in candidates {
        voxels_of(geometry, prim, frame, &mut |v| {
            start[v + 1] += 1;
            references += 1;
        });
        // Asked for each primitive, so that a hopeless grid is refused before it is counted to the end.
        within_budget(references)?;
    }
    for v in 1..start.len() {
        start[v] += start[v - 1];
    }

    // Second pass: start[v] runs from the begin of list v to its end, which is the begin of list v + 1.
    let mut prims = reserve(references as usize, &what(references), options)?;
    prims.resize(references as usize, 0_u32);
    for &prim in candidates {
        voxels_of(geometry, prim, frame, &mut |v| {
            prims[start[v] as usize] = prim;
            start[v] += 1;
        });
    }
    start.rotate_right(1);
    start[0] = 0;
    Ok(Cells::new(start, prims))
}

/// An empty vector with room for `len` entries, or an error instead of an abort.
fn reserve(len: usize, what: &str, options: &GridOptions) -> Result<Vec<u32>> {
    let mut vec = Vec::new();
    vec.try_reserve_exact(len).map_err(|_| Error::TooLarge {
        what: format!("{what} (the system refuses the memory)"),
        wanted: len as u64 * 4,
        allowed: options.memory,
    })?;
    Ok(vec)
}
