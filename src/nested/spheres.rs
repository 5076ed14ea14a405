//! Packs of eight spheres.

use super::lanes::{Lanes, Row, Vector};
use super::pack::{Pack, PackRay, Seen, padded};
use glam::DVec3;

/// Eight spheres in a part's coordinates, inflated by [`INFLATION`].
///
/// With `e = 2^-24` and `f` the centre seen from the origin: coordinates are at most 1, so components of `f` are at most 2, off by
/// `1.1 e + e / 2 + 2 e` (origin; centre; difference), and those of the true ray at the point nearest to the centre by `2 e`
/// more. `s = (f . d) / |d|^2` is off by `9 e |f| / |d|`, at most `63 e`, which is `32 e` of the part: that far is the point at `s`
/// from the nearest one. The difference `f - s d` rounds by `6 e` a component. In all a component is off by `12 e`, and the
/// vector by less than `21 e`; with the point's `32 e` across, a ray through the centre of a sphere of radius 0 is found within `39
/// e`. The squared length and the square of the radius round by `5 e` relative to themselves, so a ray that meets the sphere
/// passes within its radius, `39 e`, and `3 e` times the radius: [`INFLATION`] is 64.
///
/// The sphere is met where the inflated one is: half a chord, `sqrt((R^2 - g^2) / |d|^2)`, before or behind `s`, with `63 e` for the
/// rounding of `s`; the chord's own rounding, `10 e R^2` in its square, is less than the inflation adds to that, `128 e R`.
///
/// A hit is certain, and its `s` known, where the line is well within the sphere: if the chord's square is above a sixteenth of
/// that of the inflated radius `R`, which is above `8192 e`. What the inflation, the true line's place and rounding change of
/// the chord's square is below `2 (64 + 24) e R`; the chord changes by half of that over the chord's length, which is above `R / 4`,
/// and over the direction's, which is above 1/2: by less than `704 e`. With the rounding of `s`, [`CHORD_BOUND`] is 1024. The
/// inflation being a 128th of the radius at most, the sphere itself is met.
#[derive(Clone, Copy, Debug)]
pub(super) struct SpherePack {
    centre: [Row; 3],
    /// Of the inflated sphere; -1 where a lane holds none.
    square: Row,
    prims: [u32; 8],
}

const E: f32 = 1.0 / 16_777_216.0;
const INFLATION: f64 = 64.0 * E as f64;
const S_BOUND: f32 = 128.0 * E;
const CHORD_BOUND: f32 = 1024.0 * E;
const LEAST_SQUARE: f32 = 8192.0 * E * (8192.0 * E);

impl SpherePack {
    /// At most eight spheres, as index, centre and radius.
    pub fn new(spheres: impl ExactSizeIterator<Item = (u32, DVec3, f64)> + Clone) -> Self {
        let mut all = [(DVec3::ZERO, -1.0); 8];
        all.iter_mut().zip(spheres.clone()).for_each(|(lane, (_, centre, radius))| {
            *lane = (centre, (radius + INFLATION).powi(2));
        });
        Self {
            centre: [0, 1, 2].map(|axis| Row::of(|i| all[i].0[axis] as f32)),
            square: Row::of(|i| all[i].1 as f32),
            prims: padded(spheres.map(|(prim, ..)| prim)),
        }
    }
}

impl Pack for SpherePack {
    #[inline(always)]
    fn look<S: Lanes>(&self, ray: &PackRay<S>, end: S) -> Seen<S> {
        let f = Vector::<S>::of(&self.centre).minus(&ray.origin);
        let s = f.dot(&ray.direction) * ray.inverse_square;
        let g = f.beyond(S::splat(0.0) - s, &ray.direction);
        let square = S::of(&self.square);
        let within = square - g.dot(&g);
        let zero = S::splat(0.0);
        let chord = (within.max(zero) * ray.inverse_square).sqrt();
        let reach = chord + S::splat(S_BOUND);
        let misses = within.less(zero) | end.less(s - reach) | (s + reach).less(ray.least);
        Seen {
            survivors: !S::bits(misses) & 0xff,
            certain: (square * S::splat(0.0625)).less(within) & S::splat(LEAST_SQUARE).less(square),
            s: s - chord,
            bound: S::splat(CHORD_BOUND),
        }
    }

    #[inline(always)]
    fn prims(&self) -> &[u32; 8] {
        &self.prims
    }
}
