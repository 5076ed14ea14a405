//! Eight primitives at a time: which of them a ray may meet.

use super::frame::Entry;
use super::lanes::{Lanes, Vector};
use crate::geometry::NO_PRIM;

/// A ray as packs see it, in registers.
#[derive(Clone, Copy)]
pub(super) struct PackRay<S> {
    pub origin: Vector<S>,
    pub direction: Vector<S>,
    /// A little less than 0: `s` of a hit is at least that.
    pub least: S,
    /// A little more: what is met beyond it is in the ray's range for certain.
    pub begin: S,
    /// The inverse squared length of the direction.
    pub inverse_square: S,
}

impl<S: Lanes> PackRay<S> {
    /// Spreads the ray over lanes.
    #[inline(always)]
    pub fn new(entry: &Entry) -> Self {
        let [x, y, z] = entry.direction;
        Self {
            origin: Vector::splat(&entry.origin),
            direction: Vector::splat(&entry.direction),
            least: S::splat(-entry.slack),
            begin: S::splat(entry.slack),
            inverse_square: S::splat(1.0 / (x * x + y * y + z * z)),
        }
    }
}

/// What a ray may meet of a pack.
#[derive(Clone, Copy)]
pub(super) struct Seen<S: Lanes> {
    /// Bit `i` is missing only if lane `i` holds no primitive, or one that the ray certainly misses, or meets certainly before
    /// its begin or beyond the end asked for.
    pub survivors: u32,
    /// Where the primitive is certainly met by the ray's line, and first at an `s` within `s - bound ..= s + bound`.
    pub certain: S::Mask,
    pub s: S,
    pub bound: S,
}

/// Eight primitives of one kind.
pub(super) trait Pack: Clone + Send + Sync {
    /// False if nothing is ever certain.
    const CERTAIN: bool = true;

    /// Looks for hits at an `s` of at most `end`.
    fn look<S: Lanes>(&self, ray: &PackRay<S>, end: S) -> Seen<S>;

    /// Indices in the geometry, one for each lane.
    fn prims(&self) -> &[u32; 8];
}

/// Indices alone, for primitives of which nothing is known here: all survive.
#[derive(Clone, Copy, Debug)]
pub(super) struct List {
    prims: [u32; 8],
}

impl List {
    /// At most eight primitives.
    pub fn new(prims: impl IntoIterator<Item = u32>) -> Self {
        Self { prims: padded(prims) }
    }
}

impl Pack for List {
    const CERTAIN: bool = false;

    #[inline(always)]
    fn look<S: Lanes>(&self, _ray: &PackRay<S>, _end: S) -> Seen<S> {
        let mut survivors = 0;
        for (i, &prim) in self.prims.iter().enumerate() {
            survivors |= u32::from(prim != NO_PRIM) << i;
        }
        let zero = S::splat(0.0);
        Seen { survivors, certain: zero.less(zero), s: zero, bound: zero }
    }

    #[inline(always)]
    fn prims(&self) -> &[u32; 8] {
        &self.prims
    }
}

/// Eight indices; lanes that hold none have [`NO_PRIM`].
pub(super) fn padded(prims: impl IntoIterator<Item = u32>) -> [u32; 8] {
    let mut lanes = [NO_PRIM; 8];
    lanes.iter_mut().zip(prims).for_each(|(lane, prim)| *lane = prim);
    lanes
}
