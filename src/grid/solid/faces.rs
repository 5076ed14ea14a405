//! Which faces a ray may meet in a voxel, and their tests.

use super::marks::Marks;
use crate::accel::Probe;
use crate::geometry::{Best, Face, Geometry, SolidVoxels, TrianglePrep};
use crate::grid::frame::Frame;
use crate::grid::walk::Walk;
use crate::ray::Ray;

/// Solid voxels as the walk needs them. Voxels of the frame are one more along each axis than those of the geometry,
/// because of the border.
#[derive(Clone, Debug)]
pub(super) struct Solid {
    pub voxels: SolidVoxels,
    pub marks: Marks,
    /// Voxels of the frame.
    pub resolution: [u32; 3],
    /// A ray that is nearer than this to a plane that it does not cross now is close to an edge; voxels.
    pub near: f64,
}

/// How the ray came into a voxel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Arrival {
    /// By a step out of a voxel at the surface, whose face was tested, clear of other planes.
    Clear,
    /// By such a step, but close to an edge.
    Close,
    /// From a voxel that was not looked at.
    Unknown,
}

impl Solid {
    /// False if the ray does not move along some axis and is close to a plane of it.
    #[inline]
    pub fn clear_where_still(&self, frame: &Frame, ray: &Ray) -> bool {
        let origin = frame.local(ray.origin.as_dvec3());
        (0..3).all(|axis| ray.direction[axis] != 0.0 || self.apart(origin[axis] - origin[axis].floor()))
    }

    /// True if a position within a voxel, 0 to 1, is clear of both planes.
    #[inline(always)]
    fn apart(&self, position: f64) -> bool {
        position >= self.near && position <= 1.0 - self.near
    }

    /// True if the ray at `t` is clear of the planes of the walk's voxel in all axes along which it moves but one.
    #[inline(always)]
    pub fn clear(&self, walk: &Walk, t: f64, but: usize) -> bool {
        // No early end: three comparisons are cheaper than one branch gone wrong.
        (0..3).fold(true, |clear, axis| {
            let apart = self.apart(within(walk, axis, t));
            clear & (apart | (axis == but) | (walk.speed[axis] == 0.0))
        })
    }

    /// True if the ray comes into the voxel clear of edges; then the face that it came through has been tested, here if need
    /// be.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "what every test takes, and the place")]
    pub fn arrives_clear<P: Probe>(
        &self,
        walk: &Walk,
        t: f64,
        arrival: Arrival,
        ray: &Ray,
        prep: &TrianglePrep,
        best: &mut Best,
        probe: &mut P,
    ) -> bool {
        match arrival {
            Arrival::Clear => true,
            Arrival::Close => false,
            Arrival::Unknown => self.arrives(walk, t, ray, prep, best, probe),
        }
    }

    /// As [`Solid::arrives_clear`], where nothing is known: the ray may be close to one plane, if that lies behind.
    fn arrives<P: Probe>(
        &self,
        walk: &Walk,
        t: f64,
        ray: &Ray,
        prep: &TrianglePrep,
        best: &mut Best,
        probe: &mut P,
    ) -> bool {
        let mut through = None;
        for axis in (0..3).filter(|&axis| walk.speed[axis] > 0.0) {
            let position = within(walk, axis, t);
            if self.apart(position) {
                continue;
            }
            let behind = position < self.near && position <= 1.0 - self.near;
            // A position that is no number fails here.
            if !behind || through.is_some() {
                return false;
            }
            through = Some(axis);
        }
        // The first plane of the frame bounds its border, where no face is.
        if let Some(axis) = through.filter(|&axis| walk.plane[axis] > 1.0) {
            let before = walk.voxel.wrapping_add_signed(-walk.stride[axis]);
            self.between(before, walk.voxel, exit_face(walk, axis), ray, prep, best, probe);
        }
        true
    }

    /// Tests the face through which the ray leaves the walk's voxel along an axis.
    #[inline(always)]
    pub fn leave<P: Probe>(
        &self,
        walk: &Walk,
        axis: usize,
        ray: &Ray,
        prep: &TrianglePrep,
        best: &mut Best,
        probe: &mut P,
    ) {
        if walk.left[axis] > 0 {
            let next = walk.voxel.wrapping_add_signed(walk.stride[axis]);
            self.between(walk.voxel, next, exit_face(walk, axis), ray, prep, best, probe);
        }
    }

    /// Tests the face between two neighbours, `face` of the first, if it is exposed.
    #[inline(always)]
    #[expect(clippy::too_many_arguments, reason = "what every test takes, and the place")]
    fn between<P: Probe>(
        &self,
        from: usize,
        to: usize,
        face: Face,
        ray: &Ray,
        prep: &TrianglePrep,
        best: &mut Best,
        probe: &mut P,
    ) {
        let solid = self.marks.solid(from);
        if solid != self.marks.solid(to) {
            let (voxel, face) = if solid { (from, face) } else { (to, face.opposite()) };
            self.test(self.place(voxel).map(i64::from), face, ray, prep, best, probe);
        }
    }

    /// Tests all exposed faces that touch the closed voxel.
    #[cold]
    #[inline(never)]
    pub fn around<P: Probe>(&self, voxel: usize, ray: &Ray, prep: &TrianglePrep, best: &mut Best, probe: &mut P) {
        let centre = self.place(voxel).map(i64::from);
        let [nx, ny, _] = self.resolution.map(i64::from);
        let solid = |[x, y, z]: [i64; 3]| {
            let inside = [x, y, z].iter().zip(self.resolution).all(|(&c, n)| (0..i64::from(n)).contains(&c));
            inside && self.marks.solid(((z * ny + y) * nx + x) as usize)
        };
        for axis in 0..3 {
            let (u, v) = ((axis + 1) % 3, (axis + 2) % 3);
            for beside in 0..9 {
                let mut column = centre;
                column[u] += beside % 3 - 1;
                column[v] += beside / 3 - 1;
                let at = |offset: i64| {
                    let mut place = column;
                    place[axis] += offset;
                    place
                };
                let row = [-1, 0, 1].map(|offset| solid(at(offset)));
                for (lower, offset) in [(0, -1), (1, 0)] {
                    match (row[lower], row[lower + 1]) {
                        (true, false) => self.test(at(offset), Face::UPPER[axis], ray, prep, best, probe),
                        (false, true) => self.test(at(offset + 1), Face::LOWER[axis], ray, prep, best, probe),
                        _ => {}
                    }
                }
            }
        }
    }

    /// Tests both triangles of an exposed face of a solid voxel, given by its place in the frame.
    #[inline(never)]
    fn test<P: Probe>(
        &self,
        place: [i64; 3],
        face: Face,
        ray: &Ray,
        prep: &TrianglePrep,
        best: &mut Best,
        probe: &mut P,
    ) {
        // Without the border; solid voxels are not in it.
        let voxel = place.map(|c| (c - 1) as u32);
        let Some(first) = self.voxels.prim_of(voxel, face) else {
            unreachable!("a face between a solid and an empty voxel is exposed")
        };
        for prim in [first, first + 1] {
            probe.test();
            self.voxels.test(prim, ray, prep, best);
        }
    }

    /// A voxel's place in the frame.
    fn place(&self, voxel: usize) -> [u32; 3] {
        let [nx, ny, _] = self.resolution.map(|n| n as usize);
        let row = voxel / nx;
        [voxel % nx, row % ny, row / ny].map(|c| c as u32)
    }
}

/// How far the ray is in its voxel along an axis at `t`: 0 on the plane that it comes from, 1 on the one it goes to.
#[inline(always)]
fn within(walk: &Walk, axis: usize, t: f64) -> f64 {
    t * walk.speed[axis] + walk.origin[axis] - (walk.plane[axis] - 1.0)
}

/// The face of its voxel that the ray leaves through along an axis.
#[inline(always)]
fn exit_face(walk: &Walk, axis: usize) -> Face {
    if walk.octant >> axis & 1 != 0 { Face::LOWER[axis] } else { Face::UPPER[axis] }
}
