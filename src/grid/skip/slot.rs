//! One voxel of a skip table: the place of its list, or its distances, in the same bytes.
//!
//! Semwal & Kvarnstrom 1997 share a voxel's memory between the pointer to its objects and its distances, because a voxel
//! never needs both: 4 bytes for one distance, 8 bytes for six or seven.

/// Bytes that hold either the place of a list or distances of at least 1.
///
/// A filled voxel is told by a zero in the field of the first distance, which is never 0 in an empty voxel.
pub trait Slot: Copy + Send + Sync + std::fmt::Debug + 'static {
    /// Distances that fit.
    const FIELDS: usize;
    /// Places that fit: 0 to `PLACES - 1`.
    const PLACES: u64;

    /// A filled voxel.
    fn filled(place: u64) -> Self;

    /// An empty voxel with distances 1 to 255; what cannot be represented is rounded down.
    fn empty(distances: &[u8]) -> Self;

    /// The place of the list if the voxel is filled.
    fn place(self) -> Option<usize>;

    /// A distance of an empty voxel, 1 to 255, by its place among those of the method; meaningless in a filled voxel.
    fn distance(self, field: usize) -> u32;
}

/// Four bytes: a place of 31 bits or one distance.
#[derive(Clone, Copy, Debug)]
pub struct One(u32);

impl Slot for One {
    const FIELDS: usize = 1;
    const PLACES: u64 = 1 << 31;

    fn filled(place: u64) -> Self {
        // Checked against `PLACES` by the builder.
        Self((place as u32) << 1)
    }

    fn empty(distances: &[u8]) -> Self {
        Self(u32::from(distances[0]) << 1 | 1)
    }

    #[inline(always)]
    fn place(self) -> Option<usize> {
        (self.0 & 1 == 0).then_some((self.0 >> 1) as usize)
    }

    #[inline(always)]
    fn distance(self, _field: usize) -> u32 {
        self.0 >> 1
    }
}

/// Eight bytes: a place of 56 bits or eight distances.
#[derive(Clone, Copy, Debug)]
pub struct Eight(u64);

impl Slot for Eight {
    const FIELDS: usize = 8;
    const PLACES: u64 = 1 << 56;

    fn filled(place: u64) -> Self {
        Self(place << 8)
    }

    fn empty(distances: &[u8]) -> Self {
        let mut bytes = [1; 8];
        bytes[..distances.len()].copy_from_slice(distances);
        Self(u64::from_le_bytes(bytes))
    }

    #[inline(always)]
    fn place(self) -> Option<usize> {
        (self.0 & 0xff == 0).then_some((self.0 >> 8) as usize)
    }

    #[inline(always)]
    fn distance(self, field: usize) -> u32 {
        (self.0 >> (8 * field)) as u32 & 0xff
    }
}

/// Four bytes: a place of 28 bits or eight distances of four bits each, in half powers of two.
#[derive(Clone, Copy, Debug)]
pub struct Packed(u32);

/// The distances that four bits can hold; 0 is a filled voxel.
const CODES: [u8; 16] = [0, 1, 2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64, 96, 128, 192];

impl Slot for Packed {
    const FIELDS: usize = 8;
    const PLACES: u64 = 1 << 28;

    fn filled(place: u64) -> Self {
        Self((place as u32) << 4)
    }

    fn empty(distances: &[u8]) -> Self {
        let code = |d: u8| CODES.iter().rposition(|&c| c <= d).unwrap_or(1).max(1) as u32;
        let packed = distances.iter().rev().fold(0, |packed, &d| packed << 4 | code(d));
        Self(packed)
    }

    #[inline(always)]
    fn place(self) -> Option<usize> {
        (self.0 & 15 == 0).then_some((self.0 >> 4) as usize)
    }

    #[inline(always)]
    fn distance(self, field: usize) -> u32 {
        u32::from(CODES[(self.0 >> (4 * field)) as usize & 15])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn keeps<T: Slot>(distances: &[u8], round: impl Fn(u8) -> u32) {
        assert_eq!(T::empty(distances).place(), None);
        for (field, &d) in distances.iter().enumerate() {
            assert_eq!(T::empty(distances).distance(field), round(d), "{distances:?}");
        }
    }

    #[test]
    fn slots_keep_places_and_distances() {
        for place in [0, 1, 77, Packed::PLACES - 1] {
            let all = [One::filled(place).place(), Eight::filled(place).place(), Packed::filled(place).place()];
            assert_eq!(all, [Some(place as usize); 3]);
        }
        assert_eq!(One::filled(One::PLACES - 1).place(), Some((One::PLACES - 1) as usize));
        assert_eq!(Eight::filled(Eight::PLACES - 1).place(), Some((Eight::PLACES - 1) as usize));
        for d in 1..=255 {
            keeps::<One>(&[d], u32::from);
            keeps::<Eight>(&[d, 255, 1, 9, d, 3, 2, d], u32::from);
            let down = |d: u8| CODES.iter().map(|&c| u32::from(c)).filter(|&c| c <= u32::from(d)).max().unwrap_or(0);
            keeps::<Packed>(&[d, 255, 1, 9, d, 3, 2, d], down);
        }
    }
}
