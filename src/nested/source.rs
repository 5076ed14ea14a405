//! Primitives as the builder sees them: which cells they meet, in a part's coordinates, and how they are packed.

use super::boxes::Bounds;
use super::frame::{Frame, PADDING};
use super::lanes::Lanes;
use super::pack::{List, Pack};
use super::raster::Window;
use super::spheres::SpherePack;
use super::triangles::TrianglePack;
use crate::geometry::{Sphere, Triangle};
use crate::ray::{Aabb, Cell};
use glam::{DVec3, Vec3};

/// The primitives of a part, by their indices in the geometry.
pub(super) trait Source: Sync {
    type Pack: Pack;

    /// A primitive in the part's coordinates.
    type Local: Copy + Send + Sync;

    /// How far hits may lie outside of a primitive's box, in the part's coordinates.
    const MARGIN: f64 = 0.0;

    /// Puts the primitives `prims` in the place of what is in `locals`.
    fn gather(&self, prims: &[u32], locals: &mut Vec<Self::Local>);

    /// The cells of a window that a primitive meets, padded.
    fn cells<S: Lanes>(&self, local: &Self::Local, window: &Window) -> u64;

    /// At most eight primitives.
    fn pack(&self, prims: &[u32]) -> Self::Pack;
}

/// Writes the primitives of a list, one for each place.
pub(super) type Fetch<'a, T> = dyn Fn(&[u32], &mut [T]) + Sync + 'a;

/// Triangles.
pub(super) struct Triangles<'a> {
    pub frame: Frame,
    pub corners: &'a Fetch<'a, Triangle>,
}

impl Source for Triangles<'_> {
    type Pack = TrianglePack;
    type Local = [[f32; 3]; 3];

    fn gather(&self, prims: &[u32], locals: &mut Vec<Self::Local>) {
        locals.clear();
        let mut some = [[Vec3::ZERO; 3]; 32];
        let (centre, scale) = (self.frame.centre.to_array(), self.frame.scale);
        for prims in prims.chunks(32) {
            let some = &mut some[..prims.len()];
            (self.corners)(prims, some);
            for corners in some {
                let mut local = [[0.0; 3]; 3];
                for i in 0..3 {
                    for axis in 0..3 {
                        local[i][axis] = ((f64::from(corners[i][axis]) - centre[axis]) * scale) as f32;
                    }
                }
                locals.push(local);
            }
        }
    }

    #[inline(always)]
    fn cells<S: Lanes>(&self, local: &Self::Local, window: &Window) -> u64 {
        window.triangle::<S>(local)
    }

    fn pack(&self, prims: &[u32]) -> TrianglePack {
        let mut corners = [[Vec3::ZERO; 3]; 8];
        let corners = &mut corners[..prims.len()];
        (self.corners)(prims, corners);
        let sized = |corners: &Triangle| corners.map(|p| self.frame.sized(p));
        TrianglePack::new(prims.iter().zip(&*corners).map(|(&prim, corners)| (prim, sized(corners))))
    }
}

/// Spheres.
pub(super) struct Spheres<'a> {
    pub frame: Frame,
    pub spheres: &'a Fetch<'a, Sphere>,
}

const NO_SPHERE: Sphere = Sphere { centre: Vec3::ZERO, radius: 0.0 };

impl Source for Spheres<'_> {
    type Pack = SpherePack;
    /// Centre and radius.
    type Local = ([f32; 3], f32);

    fn gather(&self, prims: &[u32], locals: &mut Vec<Self::Local>) {
        locals.clear();
        let mut some = [NO_SPHERE; 32];
        for prims in prims.chunks(32) {
            let some = &mut some[..prims.len()];
            (self.spheres)(prims, some);
            locals.extend(some.iter().map(|s| {
                let centre = self.frame.local(s.centre.as_dvec3()).as_vec3().to_array();
                (centre, (f64::from(s.radius) * self.frame.scale) as f32)
            }));
        }
    }

    #[inline(always)]
    fn cells<S: Lanes>(&self, local: &Self::Local, window: &Window) -> u64 {
        window.sphere::<S>(&local.0, local.1)
    }

    fn pack(&self, prims: &[u32]) -> SpherePack {
        let mut spheres = [NO_SPHERE; 8];
        let spheres = &mut spheres[..prims.len()];
        (self.spheres)(prims, spheres);
        SpherePack::new(prims.iter().zip(&*spheres).map(|(&prim, s)| {
            // As the corner of a triangle, infinite where f32 has it not.
            let radius = self.frame.sized(Vec3::splat(s.radius)).x;
            let centre = if radius.is_finite() { self.frame.sized(s.centre) } else { Vec3::INFINITY };
            (prim, centre, radius)
        }))
    }
}

/// False only if a primitive, by its index in the geometry, has no point in a box.
pub(super) type Overlaps<'a> = dyn Fn(u32, &Cell) -> bool + Sync + 'a;

/// Primitives of which only boxes are known, and what they overlap.
pub(super) struct Others<'a> {
    pub frame: Frame,
    /// By index in the geometry.
    pub boxes: &'a [Aabb],
    pub overlaps: &'a Overlaps<'a>,
}

impl Source for Others<'_> {
    type Pack = List;
    /// The index, and the box in the part's coordinates.
    type Local = (u32, Bounds);
    /// Nothing is known of how their hits are found.
    const MARGIN: f64 = PADDING as f64;

    fn gather(&self, prims: &[u32], locals: &mut Vec<Self::Local>) {
        locals.clear();
        locals.extend(prims.iter().map(|&prim| {
            let Aabb { min, max } = self.boxes[prim as usize];
            (prim, [min, max].map(|p| self.frame.local(p.as_dvec3()).as_vec3().to_array()))
        }));
    }

    fn cells<S: Lanes>(&self, &(prim, [min, max]): &Self::Local, window: &Window) -> u64 {
        let block = window.aabb(&min, &max);
        let mut mask = 0;
        for bit in (0..64).filter(|bit| block >> bit & 1 != 0) {
            let at = [bit & 3, bit >> 2 & 3, bit >> 4];
            let end = |axis: usize, more: usize, sign: f64| {
                let plane = window.low[axis] + (at[axis] + more) as f32 * window.cell[axis];
                f64::from(plane) + sign * f64::from(PADDING)
            };
            let corner =
                |more, sign| self.frame.world(DVec3::new(end(0, more, sign), end(1, more, sign), end(2, more, sign)));
            let cell = Cell { min: corner(0, -1.0), max: corner(1, 1.0) };
            if (self.overlaps)(prim, &cell) {
                mask |= 1 << bit;
            }
        }
        mask
    }

    fn pack(&self, prims: &[u32]) -> List {
        List::new(prims.iter().copied())
    }
}
