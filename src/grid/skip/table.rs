//! A skip table: one slot for each voxel, and the lists of the filled ones.

use super::{Look, Method, Skip, SkipOptions, Slot, Voxels};
use crate::accel::Memory;
use crate::error::{Error, Result};
use crate::grid::cells::Cells;
use crate::grid::occupancy::Occupancy;
use crate::grid::walk::Walk;
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
    /// Sum of all distances, number of distances, the greatest one.
    sum: u64,
    count: u64,
    longest: u32,
    method: PhantomData<M>,
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
        let mut table = Self {
            slots: Vec::with_capacity(voxels as usize),
            lists: Vec::with_capacity(places as usize),
            filled,
            sum: 0,
            count: 0,
            longest: 0,
            method: PhantomData,
        };
        let mut distances = vec![0_u8; planes.len()];
        for (voxel, &filled) in occupancy.filled.iter().enumerate() {
            if filled {
                table.slots.push(T::filled(table.lists.len() as u64));
                let list = cells.list(voxel);
                table.lists.push(list.len() as u32);
                table.lists.extend_from_slice(list);
            } else {
                distances.iter_mut().zip(&planes).for_each(|(d, plane)| *d = options.stored(plane[voxel]));
                let slot = T::empty(&distances);
                for field in 0..distances.len() {
                    let distance = slot.distance(field);
                    table.sum += u64::from(distance);
                    table.longest = table.longest.max(distance);
                }
                table.count += distances.len() as u64;
                table.slots.push(slot);
            }
        }
        Ok(table)
    }

    /// The primitives of the list at `place`.
    #[inline(always)]
    pub(super) fn list(&self, place: usize) -> &[u32] {
        let len = self.lists[place] as usize;
        &self.lists[place + 1..place + 1 + len]
    }
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
            None => Look::Empty(M::safe_until(ray, walk, &self.slots, slot)),
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
        if self.count == 0 {
            return format!("{} left out: no voxel is empty", M::NAME);
        }
        format!(
            "{}: {} bytes a voxel, distances {:.1} on average, {} at most",
            M::NAME,
            size_of::<T>(),
            self.sum as f64 / self.count as f64,
            self.longest
        )
    }
}
