//! Primitives as the builder sees them, in a part's coordinates: which cells they meet, and how they are packed.

use super::frame::{Frame, PADDING};
use super::lanes::Lanes;
use super::pack::{List, Pack};
use super::raster::Window;
use super::spheres::SpherePack;
use super::triangles::TrianglePack;
use crate::geometry::{Sphere, Triangle};
use crate::ray::{Aabb, Cell};
use glam::{DVec3, Vec3};

/// The primitives of a part, numbered from 0.
pub(super) trait Source: Sync {
    type Pack: Pack;

    /// Number of primitives.
    fn len(&self) -> usize;

    /// The box around a primitive, in the part's coordinates.
    fn bounds(&self, i: usize) -> [[f32; 3]; 2];

    /// The cells of a window that a primitive meets, padded.
    fn cells<S: Lanes>(&self, i: usize, window: &Window) -> u64;

    /// At most eight primitives.
    fn pack(&self, list: &[u32]) -> Self::Pack;
}

/// A point in a part's coordinates, as f32 has them.
fn rounded(frame: &Frame, p: glam::Vec3) -> [f32; 3] {
    frame.local(p.as_dvec3()).as_vec3().to_array()
}

/// Triangles.
pub(super) struct Triangles {
    pub frame: Frame,
    pub prims: Vec<u32>,
    pub corners: Vec<Triangle>,
    local: Vec<[[f32; 3]; 3]>,
}

impl Triangles {
    /// With their indices in the geometry.
    pub fn new(frame: Frame, prims: Vec<u32>, corners: Vec<Triangle>) -> Self {
        let local = corners.iter().map(|t| t.map(|p| rounded(&frame, p))).collect();
        Self { frame, prims, corners, local }
    }
}

impl Source for Triangles {
    type Pack = TrianglePack;

    fn len(&self) -> usize {
        self.prims.len()
    }

    fn bounds(&self, i: usize) -> [[f32; 3]; 2] {
        let [p, q, r] = self.local[i];
        [[0, 1, 2].map(|a| p[a].min(q[a]).min(r[a])), [0, 1, 2].map(|a| p[a].max(q[a]).max(r[a]))]
    }

    #[inline(always)]
    fn cells<S: Lanes>(&self, i: usize, window: &Window) -> u64 {
        window.triangle::<S>(&self.local[i])
    }

    fn pack(&self, list: &[u32]) -> TrianglePack {
        TrianglePack::new(
            list.iter().map(|&i| (self.prims[i as usize], self.corners[i as usize].map(|p| self.frame.sized(p)))),
        )
    }
}

/// Spheres.
pub(super) struct Spheres {
    pub prims: Vec<u32>,
    /// Centre and radius in the part's coordinates.
    balls: Vec<(DVec3, f64)>,
    /// As packs have them.
    sized: Vec<(Vec3, f32)>,
}

impl Spheres {
    /// With their indices in the geometry.
    pub fn new(frame: Frame, prims: Vec<u32>, spheres: &[Sphere]) -> Self {
        let balls =
            spheres.iter().map(|s| (frame.local(s.centre.as_dvec3()), f64::from(s.radius) * frame.scale)).collect();
        let sized =
            spheres.iter().map(|s| (frame.sized(s.centre), (f64::from(s.radius) * frame.scale) as f32)).collect();
        Self { prims, balls, sized }
    }

    /// As f32 has them.
    fn ball(&self, i: usize) -> ([f32; 3], f32) {
        let (centre, radius) = self.balls[i];
        (centre.as_vec3().to_array(), radius as f32)
    }
}

impl Source for Spheres {
    type Pack = SpherePack;

    fn len(&self) -> usize {
        self.prims.len()
    }

    fn bounds(&self, i: usize) -> [[f32; 3]; 2] {
        let (centre, radius) = self.ball(i);
        [centre.map(|x| x - radius), centre.map(|x| x + radius)]
    }

    #[inline(always)]
    fn cells<S: Lanes>(&self, i: usize, window: &Window) -> u64 {
        let (centre, radius) = self.ball(i);
        window.sphere::<S>(&centre, radius)
    }

    fn pack(&self, list: &[u32]) -> SpherePack {
        SpherePack::new(list.iter().map(|&i| {
            let (centre, radius) = self.sized[i as usize];
            (self.prims[i as usize], centre, radius)
        }))
    }
}

/// False only if a primitive, by its index in the geometry, has no point in a box.
pub(super) type Overlaps<'a> = dyn Fn(u32, &Cell) -> bool + Sync + 'a;

/// Primitives of which only boxes are known, and what they overlap.
pub(super) struct Others<'a> {
    pub frame: Frame,
    pub prims: Vec<u32>,
    bounds: Vec<[[f32; 3]; 2]>,
    overlaps: &'a Overlaps<'a>,
}

impl<'a> Others<'a> {
    /// With their indices in the geometry.
    pub fn new(frame: Frame, prims: Vec<u32>, bounds: &[Aabb], overlaps: &'a Overlaps<'a>) -> Self {
        let bounds = bounds.iter().map(|b| [rounded(&frame, b.min), rounded(&frame, b.max)]).collect();
        Self { frame, prims, bounds, overlaps }
    }
}

impl Source for Others<'_> {
    type Pack = List;

    fn len(&self) -> usize {
        self.prims.len()
    }

    fn bounds(&self, i: usize) -> [[f32; 3]; 2] {
        self.bounds[i]
    }

    fn cells<S: Lanes>(&self, i: usize, window: &Window) -> u64 {
        let [min, max] = self.bounds[i];
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
            if (self.overlaps)(self.prims[i], &cell) {
                mask |= 1 << bit;
            }
        }
        mask
    }

    fn pack(&self, list: &[u32]) -> List {
        List::new(list.iter().map(|&i| self.prims[i as usize]))
    }
}
