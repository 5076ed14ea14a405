//! Eight primitives at a time: which of them a ray may meet.

use super::crowd::Wall;
use super::lanes::{Lanes, Vector};
use super::sight::Sight;
use super::spheres::SpherePack;
use crate::geometry::NO_PRIM;

/// A ray as packs see it, in registers.
#[derive(Clone, Copy)]
pub(super) struct PackRay<S> {
    pub origin: Vector<S>,
    pub direction: Vector<S>,
    /// Each coordinate of the origin is off by this at most.
    pub fuzz: S,
    /// At or before the `p` of the ray's begin.
    pub least: S,
    /// At or beyond it: what is met beyond this is in the ray's range for certain.
    pub begin: S,
    /// The inverse squared length of the direction: this and the next two are for spheres alone.
    pub inverse_square: S,
    /// [`SpherePack::wider`]: what is added to any radius at a first look, and to its square.
    pub wider: S,
    pub nearer: S,
    /// 0 if the ray has no part before its origin, else minus infinity.
    pub ahead: S,
}

impl<S: Lanes> PackRay<S> {
    /// Spreads the ray over lanes.
    #[inline(always)]
    pub fn new<K: Pack>(sight: &Sight) -> Self {
        let [inverse_square, wider, nearer] = if K::SPHERES {
            let [wider, nearer] = SpherePack::wider(sight.fuzz);
            [1.0 / sight.direction.length_squared(), wider, nearer]
        } else {
            [1.0; 3]
        };
        Self {
            origin: Vector::splat(sight.origin),
            direction: Vector::splat(sight.direction),
            fuzz: S::splat(sight.fuzz),
            least: S::splat(sight.begin[0]),
            begin: S::splat(sight.begin[1]),
            inverse_square: S::splat(inverse_square),
            wider: S::splat(wider),
            nearer: S::splat(nearer),
            ahead: S::splat(if sight.begin[1] >= 0.0 { 0.0 } else { f32::NEG_INFINITY }),
        }
    }
}

/// What a ray may meet of a pack.
#[derive(Clone, Copy)]
pub(super) struct Seen<S: Lanes> {
    /// Bit `i` is missing only if lane `i` holds no primitive, or one that the ray certainly misses, or meets certainly before
    /// its begin or beyond the end asked for.
    pub survivors: u32,
    /// Where the primitive is certainly met by the ray's line, and first within `p - bound ..= p + bound`.
    pub certain: S::Mask,
    pub p: S,
    pub bound: S,
}

impl<S: Lanes> Seen<S> {
    /// Nothing survives.
    #[inline(always)]
    pub fn nothing() -> Self {
        let zero = S::splat(0.0);
        Self { survivors: 0, certain: zero.less(zero), p: zero, bound: zero }
    }
}

/// What f64 knows of a ray and a primitive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Verdict {
    /// It is certainly missed, or met out of range.
    Miss,
    /// It is certainly met, in range and first at a `p` within a bound of this one.
    Hit { p: f64, bound: f64 },
    /// Neither is certain.
    Open,
}

impl Sight {
    /// Of a primitive that the ray's line meets within `bound` of `p`, if at all; `certain` if it does. The answer to a NaN is
    /// open.
    #[inline(always)]
    pub fn judge(&self, p: f64, bound: f64, end: f32, certain: bool) -> Verdict {
        let (from, to) = (p - bound, p + bound);
        if to < f64::from(self.begin[0]) || from > f64::from(end) {
            Verdict::Miss
        } else if certain && from > f64::from(self.begin[1]) && to < f64::from(self.end[0]) {
            Verdict::Hit { p, bound }
        } else {
            Verdict::Open
        }
    }
}

/// Eight primitives of one kind.
pub(super) trait Pack: Clone + Send + Sync {
    /// False if nothing is ever certain.
    const CERTAIN: bool = true;

    /// True if it is one of spheres: these want three numbers more of a ray.
    const SPHERES: bool = false;

    /// Looks for hits at a `p` of at most `end`.
    fn look<S: Lanes>(&self, ray: &PackRay<S>, end: S) -> Seen<S>;

    /// Looks for hits as f32 has them: what survives is taken for a hit at `p`. To measure what exactness costs.
    #[inline(always)]
    fn look_rounded<S: Lanes>(&self, ray: &PackRay<S>, end: S) -> Seen<S> {
        self.look(ray, end)
    }

    /// Looks at one lane again, in f64 and for hits at a `p` of at most `end`.
    fn judge(&self, _lane: usize, _sight: &Sight, _end: f32) -> Verdict {
        Verdict::Open
    }

    /// The lanes of which f64 says the same as [`Verdict::Miss`]; for many at once. To be inlined.
    fn missed(&self, _sight: &Sight, _end: f32) -> u32 {
        0
    }

    /// The corner of a lane that the ray's line certainly passes through, without any rounding.
    fn corner(&self, _lane: usize, _sight: &Sight) -> Option<[f32; 3]> {
        None
    }

    /// The lanes that have this corner.
    fn lanes_at<S: Lanes>(&self, _corner: &[f32; 3]) -> u32 {
        0
    }

    /// The lanes whose planes the ray's line certainly crosses in one point.
    fn crossed(&self, _sight: &Sight) -> u32 {
        0
    }

    /// The corner of a lane that most others have, if there are two or more.
    fn common<S: Lanes>(&self, _lane: usize) -> Option<[f32; 3]> {
        None
    }

    /// The lanes that lie on one side of a wall but for the corner that it goes through: the ray's line certainly misses them.
    fn beside<S: Lanes>(&self, _wall: &Wall) -> u32 {
        0
    }

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
        Seen { survivors, ..Seen::nothing() }
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
