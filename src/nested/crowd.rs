//! Where many primitives are near a ray: what is known of all lanes of a pack at once.
//!
//! Bounds of f32 leave all of them open next to a corner that hundreds of triangles share, pack after pack and in each cell around
//! it. Here is what is done then, out of the walk's loops: see [`Lanes::apart`].

use super::lanes::Lanes;
use super::pack::Pack;
use super::sight::{Course, Sight};
use super::simd::Work;
use glam::DVec3;

/// A corner that a ray passes through, without any rounding, and a primitive that it meets there, which was the winner.
/// Other primitives with that corner are met there or are parallel to the ray: with greater indices, they never win, and
/// with smaller ones they do if they are not parallel, as long as the winner is the one that was.
#[derive(Clone, Copy, Debug)]
pub(super) struct Met {
    pub corner: [f32; 3],
    pub prim: u32,
}

/// The plane through a ray and a corner beside it.
///
/// The ray meets a triangle with that corner only if the two others are on different sides of the plane, as in it the
/// triangle has but the corner otherwise, and any other triangle only if its corners are. With `A` the corner, `o` the
/// ray's origin and `d` its direction, the plane's normal is `n = (A - o) x d`, and `n . (q - A)` says on which side a
/// corner `q` is. Its bound shrinks with the ray's distance from the corner, where that of a test from the ray's origin
/// does not.
///
/// With `e = 2^-24`, `u = 2^-53`, `K` the greatest component of `A - o`, those of `d` being 1 at most, `N` that of `n` and
/// `M` that of `q - A`: `n` is off by `2 u K` of the difference and `4 u K` of products and sums in f64, and by `e N` as
/// f32; `q - A` by `e M`. So the product is off by `3 (e N M + e M N + 6 u K M)`, and by `8 e N M` for its products and
/// sums: `14 e N M + 18 u K M`. [`Wall::slack`] is `16 e N + 32 u K`, more than that and its own rounding. What underflows
/// is less than what triangles add for it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wall {
    pub corner: [f32; 3],
    pub normal: [f32; 3],
    /// The bound over `M`.
    pub slack: f32,
}

impl Wall {
    /// `None` if the ray may go through the corner.
    fn new(corner: [f32; 3], sight: &Sight) -> Option<Self> {
        let Course { origin, direction, .. } = sight.course();
        let c = DVec3::from_array(corner.map(f64::from)) - origin;
        let normal = c.cross(direction);
        let (away, size) = (c.abs().max_element(), normal.abs().max_element());
        let error = 32.0 * 0.5 * f64::EPSILON * away;
        (size > error).then(|| Self {
            corner,
            normal: normal.as_vec3().to_array(),
            slack: (16.0 / 16_777_216.0 * size + error) as f32,
        })
    }
}

/// What a ray knows of the crowd that it is in.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Known {
    pub met: Option<Met>,
    pub wall: Option<Wall>,
    /// True if nothing was left of the last pack that was asked.
    pub thick: bool,
}

/// Finds the lanes of a pack that need not be looked at one by one.
pub(super) struct Crowd<'a, K> {
    pub pack: &'a K,
    pub sight: &'a Sight,
    pub end: f32,
    /// The lanes that are open.
    pub open: u32,
    /// The winner so far.
    pub winner: Option<u32>,
    pub known: &'a mut Known,
}

impl<K: Pack> Work for Crowd<'_, K> {
    type Output = u32;

    #[inline(always)]
    fn run<S: Lanes>(self) -> u32 {
        let Self { pack, sight, end, open, winner, known } = self;
        let mut done = Beaten { pack, met: &known.met }.run::<S>();
        if let Some(met) = known.met.as_mut().filter(|met| Some(met.prim) == winner) {
            let earlier = pack.lanes_at::<S>(&met.corner) & open & !done;
            let mut tied = if earlier == 0 { 0 } else { earlier & pack.crossed(sight) };
            if tied != 0 {
                while tied != 0 {
                    met.prim = met.prim.min(pack.prims()[tied.trailing_zeros() as usize & 7]);
                    tied &= tied - 1;
                }
                done |= Beaten { pack, met: &known.met }.run::<S>();
            }
        }
        if let Some(wall) = &known.wall {
            done |= pack.beside::<S>(wall);
        }
        known.thick = done == 0xff;
        if few(open & !done) {
            return done;
        }
        let lane = (open & !done).trailing_zeros() as usize;
        if let Some(wall) = pack.common::<S>(lane).and_then(|corner| Wall::new(corner, sight)) {
            done |= pack.beside::<S>(&wall);
            known.wall = Some(wall);
            known.thick = done == 0xff;
            if few(open & !done) {
                return done;
            }
        }
        done | pack.missed(sight, end)
    }
}

/// Asks of a pack after a crowded one whether nothing of it is left, which takes less time than to look at it; if not, the
/// ray is no longer in the crowd.
pub(super) struct Aside<'a, K> {
    pub pack: &'a K,
    pub known: &'a mut Known,
}

impl<K: Pack> Work for Aside<'_, K> {
    type Output = bool;

    #[inline(always)]
    fn run<S: Lanes>(self) -> bool {
        let Self { pack, known } = self;
        let mut done = known.wall.map_or(0, |wall| pack.beside::<S>(&wall));
        if done != 0xff {
            done |= Beaten { pack, met: &known.met }.run::<S>();
        }
        known.thick = done == 0xff;
        known.thick
    }
}

/// True if so few lanes are open that they are looked at one by one.
#[inline(always)]
pub(super) fn few(open: u32) -> bool {
    open.count_ones() <= 2
}

/// Finds the lanes of a pack that cannot win, as they have a corner that the ray has met.
pub(super) struct Beaten<'a, K> {
    pub pack: &'a K,
    pub met: &'a Option<Met>,
}

impl<K: Pack> Work for Beaten<'_, K> {
    type Output = u32;

    #[inline(always)]
    fn run<S: Lanes>(self) -> u32 {
        let Some(Met { corner, prim }) = self.met else { return 0 };
        let mut later = 0;
        for lane in 0..8 {
            later |= u32::from(self.pack.prims()[lane] >= *prim) << lane;
        }
        later & self.pack.lanes_at::<S>(corner)
    }
}
