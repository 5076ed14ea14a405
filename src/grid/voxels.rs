//! The voxels that a ray visits, in order and exactly: the walk of 1987 for those who need no more than that.

mod crossing;

use super::GridOptions;
use crate::error::{Error, Result};
use crate::geometry::Face;
use crate::ray::{Aabb, Ray};
use crossing::{Lines, Time};
use std::cmp::Ordering;
use std::iter::FusedIterator;

/// A box cut into equal voxels, to be walked by rays.
///
/// Plane `k` of an axis lies at `min + k (max - min) / n` exactly, for `k` from 0 to the axis's `n` voxels: it is not
/// rounded. A voxel holds its lower face on each axis and not its upper one, but the last voxel of an axis holds both.
///
/// ```
/// use glam::Vec3;
/// use skipgrid::grid::{Face, VoxelGrid};
/// use skipgrid::{Aabb, Ray};
///
/// let bounds = Aabb { min: Vec3::ZERO, max: Vec3::new(4.0, 2.0, 1.0) };
/// let grid = VoxelGrid::new(bounds, [4, 2, 1])?;
/// let ray = Ray::new(Vec3::new(-1.0, 0.375, 0.5), Vec3::new(1.0, 0.25, 0.0)).with_range(0.0, 4.0);
/// let visits: Vec<_> = grid.voxels(&ray).collect();
/// assert_eq!(visits.iter().map(|v| v.voxel).collect::<Vec<_>>(), [[0, 0, 0], [1, 0, 0], [1, 1, 0], [2, 1, 0], [3, 1, 0]]);
/// assert_eq!((visits[0].entry, visits[0].exit, visits[0].face), (1.0, 2.0, Some(Face::NegX)));
/// assert_eq!((visits[4].entry, visits[4].exit), (4.0, 4.0)); // reached by the last point of the ray
/// # Ok::<(), skipgrid::Error>(())
/// ```
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelGrid {
    bounds: Aabb,
    resolution: [u32; 3],
}

impl VoxelGrid {
    /// `bounds` in world units, cut into `resolution` voxels along x, y and z.
    ///
    /// # Errors
    /// A corner is not finite, the box has no extent along some axis, or a resolution is 0 or above
    /// [`GridOptions::MAX_RESOLUTION`].
    pub fn new(bounds: Aabb, resolution: [u32; 3]) -> Result<Self> {
        for axis in 0..3 {
            let (name, min, max) = (["x", "y", "z"][axis], bounds.min[axis], bounds.max[axis]);
            if !(min.is_finite() && max.is_finite() && min < max) {
                return Err(Error::invalid(format!(
                    "voxel grid lies between {min} and {max} along {name}, but must have two finite ends in order"
                )));
            }
            let n = resolution[axis];
            if !(1..=GridOptions::MAX_RESOLUTION).contains(&n) {
                let most = GridOptions::MAX_RESOLUTION;
                return Err(Error::invalid(format!(
                    "voxel grid resolution along {name} is {n}, but must be 1 to {most}"
                )));
            }
        }
        Ok(Self { bounds, resolution })
    }

    /// The box, world units.
    pub fn bounds(&self) -> Aabb {
        self.bounds
    }

    /// Voxels along x, y and z.
    pub fn resolution(&self) -> [u32; 3] {
        self.resolution
    }

    /// The voxels that `ray` visits, as in exact arithmetic on the f32 values of ray and box.
    ///
    /// The first voxel is the one that holds the first point of the ray in the closed box. From there every plane between
    /// voxels is crossed that the ray meets up to its last point in the box, that point included; each crossing leads to a
    /// neighbour through a face. Planes that are met at the very same parameter are crossed one after the other, z before y
    /// before x, which is what the paper's comparisons do with ties. So:
    ///
    /// - A ray within a plane between voxels visits the voxels on the plane's upper side.
    /// - A voxel that the ray only touches may be visited, with `entry` and `exit` equal: between two crossings at the same
    ///   parameter; at the ray's start on an upper neighbour's face, moving down; at the ray's end, on a plane. No other
    ///   touched voxels are visited.
    /// - A ray that only touches the box visits the voxel that holds the point.
    ///
    /// A ray that [`Ray::intake`] refuses visits nothing. There are at most `nx + ny + nz - 2` voxels, for any bits.
    pub fn voxels(&self, ray: &Ray) -> VoxelVisits {
        VoxelVisits(ray.intake().and_then(|ray| self.start(&ray)))
    }

    /// The walk at the first voxel of a ray that may miss the box.
    fn start(&self, ray: &Ray) -> Option<Walk> {
        let lines = Lines::new(&self.bounds, self.resolution, ray);
        let (mut start, mut end) = (Time::given(ray.t_min), Time::given(ray.t_max));
        let mut face = None;
        for axis in [2, 1, 0] {
            let n = self.resolution[axis];
            let (first, last, entered) = match lines.sense(axis) {
                Ordering::Greater => (0, n, Face::LOWER[axis]),
                Ordering::Less => (n, 0, Face::UPPER[axis]),
                Ordering::Equal => {
                    let o = ray.origin[axis];
                    if o < self.bounds.min[axis] || o > self.bounds.max[axis] {
                        return None;
                    }
                    continue;
                }
            };
            let (enter, leave) = (lines.crossing(axis, first), lines.crossing(axis, last));
            // Of the faces that are crossed together, the ray enters through the last one in the order of ties; a ray that
            // starts on a face does not cross it.
            let order = lines.order(&enter, &start);
            if order.is_gt() || (order.is_eq() && start.axis().is_some()) {
                (start, face) = (enter, Some(entered));
            }
            if lines.order(&leave, &end).is_lt() {
                end = leave;
            }
        }
        match lines.order(&start, &end) {
            Ordering::Less => {}
            Ordering::Equal => end.t = start.t,
            Ordering::Greater => return None,
        }
        let voxel = [0, 1, 2].map(|axis| lines.voxel(axis, &start));
        let mut walk =
            Walk { lines, resolution: self.resolution, voxel, next: [Time::NEVER; 3], end, entry: start.t, face };
        for axis in 0..3 {
            walk.next[axis] = walk.crossing_ahead(axis);
            if lines.order(&walk.next[axis], &start).is_eq() {
                walk.next[axis].t = start.t;
            }
        }
        Some(walk)
    }
}

/// One voxel of a walk.
///
/// `entry` and `exit` are within 2^-52 of their exact values, relative. They never decrease along the walk, the `exit` of a
/// voxel is the `entry` of the next, and crossings at equal exact parameters have equal ones here.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct VoxelVisit {
    /// Index along x, y and z, from 0.
    pub voxel: [u32; 3],
    /// The ray's parameter where it enters the voxel, or starts in it.
    pub entry: f64,
    /// The ray's parameter where it leaves the voxel, or ends in it; at least `entry`.
    pub exit: f64,
    /// The face of this voxel that the ray crosses at `entry`; `None` if it starts here.
    pub face: Option<Face>,
}

/// The voxels that a ray visits: see [`VoxelGrid::voxels`].
///
/// A step compares rounded parameters. Where their errors leave the order open it is found exactly, which takes an
/// allocation; where nothing is close there is none.
#[derive(Clone, Debug)]
pub struct VoxelVisits(Option<Walk>);

impl Iterator for VoxelVisits {
    type Item = VoxelVisit;

    #[inline]
    fn next(&mut self) -> Option<VoxelVisit> {
        let walk = self.0.as_mut()?;
        let (voxel, entry, face) = (walk.voxel, walk.entry, walk.face);
        if walk.step() {
            return Some(VoxelVisit { voxel, entry, exit: walk.entry, face });
        }
        let exit = walk.end.t.max(entry);
        self.0 = None;
        Some(VoxelVisit { voxel, entry, exit, face })
    }

    fn size_hint(&self) -> (usize, Option<usize>) {
        let Some(walk) = &self.0 else { return (0, Some(0)) };
        let ahead = |axis: usize| match walk.lines.sense(axis) {
            Ordering::Greater => walk.resolution[axis] - 1 - walk.voxel[axis],
            Ordering::Less => walk.voxel[axis],
            Ordering::Equal => 0,
        };
        (1, Some(1 + (0..3).map(|axis| ahead(axis) as usize).sum::<usize>()))
    }
}

impl FusedIterator for VoxelVisits {}

/// A voxel on the way, and where the ray goes next. (The paper's X, Y, Z and tMaxX, tMaxY, tMaxZ.)
#[derive(Clone, Debug)]
struct Walk {
    lines: Lines,
    resolution: [u32; 3],
    voxel: [u32; 3],
    /// The next plane between voxels on each axis.
    next: [Time; 3],
    /// Where the ray ends or leaves the box.
    end: Time,
    /// Where it entered the voxel.
    entry: f64,
    face: Option<Face>,
}

impl Walk {
    /// The next plane between voxels along an axis, counted from the voxel.
    #[inline]
    fn crossing_ahead(&self, axis: usize) -> Time {
        let plane = match self.lines.sense(axis) {
            Ordering::Greater => self.voxel[axis] + 1,
            Ordering::Less => self.voxel[axis],
            Ordering::Equal => 0,
        };
        // The outer planes are the box's own.
        if plane == 0 || plane == self.resolution[axis] { Time::NEVER } else { self.lines.crossing(axis, plane) }
    }

    /// Goes to the next voxel; false if the ray ends before it.
    ///
    /// Where two parameters are found to be equal they are given the same rounded value. Replacing `entry` by a larger
    /// rounded value of an earlier crossing keeps the promise of 2^-52: the exact values are in order.
    #[inline]
    fn step(&mut self) -> bool {
        let mut axis = 2;
        for other in [1, 0] {
            match self.lines.order(&self.next[other], &self.next[axis]) {
                Ordering::Less => axis = other,
                Ordering::Equal => self.next[other].t = self.next[axis].t,
                Ordering::Greater => {}
            }
        }
        match self.lines.order(&self.next[axis], &self.end) {
            Ordering::Less => {}
            Ordering::Equal => self.next[axis].t = self.end.t,
            Ordering::Greater => return false,
        }
        self.entry = self.next[axis].t.max(self.entry);
        if self.lines.sense(axis).is_gt() {
            self.voxel[axis] += 1;
            self.face = Some(Face::LOWER[axis]);
        } else {
            self.voxel[axis] -= 1;
            self.face = Some(Face::UPPER[axis]);
        }
        self.next[axis] = self.crossing_ahead(axis);
        true
    }
}
