//! A skip table: one slot for each voxel, and the lists of the filled ones.

use super::{Look, Method, Skip, SkipOptions, Slot, Voxels};
use crate::accel::Memory;
use crate::error::{Error, Result};
use crate::grid::cells::Cells;
use crate::grid::occupancy::Occupancy;
use crate::grid::walk::Walk;
use crate::parallel;
use std::marker::PhantomData;

/// The voxels of a grid with the distances of method `M` in slots `T`.
///
/// Memory: the slot of each voxel, which takes the place of its offset in a plain grid; and for each filled voxel four bytes
/// beside its references, because the list says itself how long it is.
#[derive(Clone, Debug)]
pub struct Table<M: Method, T: Slot = <M as Method>::Slot> {
    pub(super) slots: Vec<T>,
    /// Lists one after the other: the number of references, then these.
    lists: Vec<u32>,
    filled: u64,
    total: Total,
    method: PhantomData<M>,
}

/// All distances of a table, for people.
#[derive(Clone, Copy, Debug, Default)]
struct Total {
    sum: u64,
    count: u64,
    longest: u32,
}

impl Total {
    fn add<T: Slot>(&mut self, slot: T, fields: usize) {
        for field in 0..fields {
            let distance = slot.distance(field);
            self.sum += u64::from(distance);
            self.longest = self.longest.max(distance);
        }
        self.count += fields as u64;
    }

    fn and(self, other: Self) -> Self {
        let longest = self.longest.max(other.longest);
        Self { sum: self.sum + other.sum, count: self.count + other.count, longest }
    }
}

impl<M: Method, T: Slot> Table<M, T> {
    /// Turns plain cells into a table.
    pub(in crate::grid) fn new(cells: Cells, resolution: [u32; 3], options: &SkipOptions, memory: u64) -> Result<Self> {
        options.check()?;
        let voxels = cells.voxels() as u64;
        let filled = voxels - cells.empty();
        let places = cells.references() + filled;
        let bytes = size_of::<T>() as u64;
        let planes = if filled == voxels { 0 } else { M::PEAK };
        // All that is held while the slots are written; the cells are there too.
        let wanted = voxels * (1 + planes + bytes) + places * 4 + cells.memory().total();
        let allowed = memory.min(T::PLACES.saturating_mul(4));
        if wanted > memory || places > T::PLACES {
            let what = format!("skip table of {} over {voxels} voxels with {places} entries of lists", M::NAME);
            return Err(Error::TooLarge { what, wanted, allowed });
        }
        let occupancy = Occupancy { resolution: resolution.map(|n| n as usize), filled: cells.flags() };
        // A grid without an empty voxel needs no distance.
        let planes = if planes == 0 { Vec::new() } else { M::distances(&occupancy, options) };
        let mut lists = Vec::with_capacity(places as usize);
        for voxel in (0..occupancy.len()).filter(|&v| occupancy.filled[v]) {
            let list = cells.list(voxel);
            lists.push(list.len() as u32);
            lists.extend_from_slice(list);
        }
        // The place of a list is the number of references and of lists before it.
        let place = |voxel, filled_before| cells.begin(voxel) + filled_before;
        let (slots, total) = slots(&occupancy, &planes, M::WIDTHS, options, place);
        Ok(Self { slots, lists, filled, total, method: PhantomData })
    }

    /// A table of distances alone: [`Slot::place`] tells filled voxels, but there are no lists.
    pub(in crate::grid) fn without_lists(occupancy: &Occupancy, options: &SkipOptions, memory: u64) -> Result<Self> {
        options.check()?;
        let voxels = occupancy.len() as u64;
        let filled = occupancy.filled.iter().filter(|&&filled| filled).count() as u64;
        let planes = if filled == voxels { 0 } else { M::PEAK };
        let wanted = voxels * (1 + planes + size_of::<T>() as u64);
        if wanted > memory {
            let what = format!("skip table of {} over {voxels} voxels", M::NAME);
            return Err(Error::TooLarge { what, wanted, allowed: memory });
        }
        let planes = if planes == 0 { Vec::new() } else { M::distances(occupancy, options) };
        let (slots, total) = slots(occupancy, &planes, M::WIDTHS, options, |_, _| 0);
        Ok(Self { slots, lists: Vec::new(), filled, total, method: PhantomData })
    }

    /// Bytes of all slots.
    pub(in crate::grid) fn slot_bytes(&self) -> u64 {
        (self.slots.len() * size_of::<T>()) as u64
    }

    /// Whether the walk's voxel is filled, or else how far it may go; for tables without lists.
    #[inline(always)]
    pub(in crate::grid) fn free(&self, walk: &Walk, ray: &M::Ray) -> Free {
        let slot = self.slots[walk.voxel];
        match slot.place() {
            Some(_) => Free::Filled,
            None => M::safe_until(ray, walk, &self.slots, slot).map_or(Free::Near, Free::Until),
        }
    }

    /// The primitives of the list at `place`.
    #[inline(always)]
    pub(super) fn list(&self, place: usize) -> &[u32] {
        let len = self.lists[place] as usize;
        &self.lists[place + 1..place + 1 + len]
    }
}

/// What a table without lists says of a voxel.
pub(in crate::grid) enum Free {
    /// It is filled.
    Filled,
    /// As [`Look::Empty`].
    Until(f64),
    /// As [`Look::Near`].
    Near,
}

/// The slots of all voxels, and the sum of their distances. `place` is told a filled voxel and the number of filled ones
/// before it; the first `widths` of the planes are no lengths.
fn slots<T: Slot>(
    occupancy: &Occupancy,
    planes: &[Vec<u8>],
    widths: usize,
    options: &SkipOptions,
    place: impl Fn(usize, u64) -> u64 + Sync,
) -> (Vec<T>, Total) {
    // Chunks of voxels, each with the number of filled voxels before it.
    const CHUNK: usize = 1 << 16;
    let mut slots = vec![T::filled(0); occupancy.len()];
    let mut filled_before = 0_u64;
    let chunks: Vec<_> = slots
        .chunks_mut(CHUNK)
        .enumerate()
        .map(|(chunk, slots)| {
            let begin = filled_before;
            let flags = &occupancy.filled[chunk * CHUNK..][..slots.len()];
            filled_before += flags.iter().filter(|&&filled| filled).count() as u64;
            (chunk * CHUNK, begin, slots)
        })
        .collect();
    let lengths: Vec<u8> = (0..=u8::MAX).map(|d| options.stored(d)).collect();
    let rounded: Vec<u8> = (0..=u8::MAX).map(|d| options.rounded(d)).collect();
    let planes: Vec<(&[u8], &Vec<u8>)> = (planes.iter().enumerate())
        .map(|(field, plane)| (&plane[..], if field < widths { &rounded } else { &lengths }))
        .collect();
    let totals = parallel::map(chunks, |(first, mut filled_before, slots)| {
        let mut total = Total::default();
        let mut distances = [0; 8];
        for (voxel, slot) in (first..).zip(slots) {
            if occupancy.filled[voxel] {
                *slot = T::filled(place(voxel, filled_before));
                filled_before += 1;
            } else {
                for (distance, (plane, stored)) in distances.iter_mut().zip(&planes) {
                    *distance = stored[usize::from(plane[voxel])];
                }
                *slot = T::empty(&distances[..planes.len()]);
                total.add(*slot, planes.len());
            }
        }
        total
    });
    (slots, totals.into_iter().fold(Total::default(), Total::and))
}

impl<M: Method, T: Slot> Skip<Walk> for Table<M, T> {
    type Ray = M::Ray;

    #[inline(always)]
    fn ray(walk: &Walk) -> M::Ray {
        M::ray(walk)
    }

    #[inline(always)]
    fn look(&self, walk: &Walk, ray: &M::Ray) -> Look<'_> {
        let slot = self.slots[walk.voxel];
        match slot.place() {
            Some(place) => Look::List(self.list(place)),
            None => M::safe_until(ray, walk, &self.slots, slot).map_or(Look::Near, Look::Empty),
        }
    }
}

impl<M: Method, T: Slot> Voxels for Table<M, T> {
    /// Four bytes of each slot are structure, as in a plain grid; what distances take beyond is table.
    fn memory(&self) -> Memory {
        let slots = (self.slots.len() * size_of::<T>()) as u64;
        let structure = (self.slots.len() * 4) as u64 + self.filled * 4;
        Memory { structure, references: self.references() * 4, tables: slots - (self.slots.len() * 4) as u64 }
    }

    fn empty(&self) -> u64 {
        self.slots.len() as u64 - self.filled
    }

    fn references(&self) -> u64 {
        self.lists.len() as u64 - self.filled
    }

    fn describe(&self) -> String {
        if self.total.count == 0 {
            return format!("{} left out: no voxel is empty", M::NAME);
        }
        format!(
            "{}: {} bytes a voxel, distances {:.1} on average, {} at most",
            M::NAME,
            size_of::<T>(),
            self.total.sum as f64 / self.total.count as f64,
            self.total.longest
        )
    }
}
