//! The walk over solid voxels: a hit is where the ray crosses from empty to solid or back.
//!
//! After an article on branchless DDA voxel tracing. There is no list of primitives: a bit says whether a voxel is solid,
//! another whether it is at the *surface*, which means that the closed voxel touches an exposed face. Voxels elsewhere, in
//! the air or deep inside a body, are walked or leapt through without a test. Departs from the article:
//!
//! - A crossing is only a candidate. The two triangles of the face decide, in exact arithmetic; so answers are those of every
//!   other accelerator over the faces, to the bit, rays along faces, edges and corners included.
//! - Ties are not crossed at once: where a ray passes near an edge, all faces around the voxel are tested.
//! - The grid has a border of one empty voxel, so that its outer faces are crossings like all others.
//!
//! # Why no face is missed
//!
//! Coordinates are voxels of the frame. Let `e` be [`WALK_ERROR`], and `d` how far the planes in f32 lie from whole numbers:
//! at most a quarter, next to nothing in most scenes. The walk promises that at any parameter between the computed `entry`
//! and `exit` of a voxel the exact ray is within `e` of the closed voxel; consecutive voxels share these parameters, so
//! every parameter of the ray in the box belongs to a voxel, or to a leap over voxels off the surface.
//!
//! A face that the ray hits at parameter t while the walk is in voxel v touches the closed voxel v, as `d + e < 1/2`: its
//! plane is one of v's six, and it is off v's column by one voxel at most. So v is at the surface, no hit lies in a voxel
//! that is not, and it is always right to test all faces that touch v: up to 54 squares ([`Solid::around`]).
//!
//! Mostly one face is enough. Let m = 4 (d + 2 e) ([`Solid::near`]); let v be entered through axis i and left through
//! axis j, and let the ray be at least m from both planes of v in all other axes at the entry, and in all axes but j at the
//! exit. Positions between are between those. If i = j the ray is clear of all other planes all the while; it can meet the
//! face of v it enters through and the one it leaves through, each within v's own column. If not:
//!
//! - The planes of the third axis are out of reach, the first plane of j and the second of i too.
//! - On the plane that it leaves through, the ray is within d + e of that plane. It has covered at least the share
//!   1 - (d + e) / m > 3/4 of the way in j and so in i, where it is more than 3/4 m - e > d + e from the first plane: within
//!   v's column. So the face is the one between v and the next voxel.
//! - On the plane that it enters through it has covered at most (d + 2 e) / m < 1/2 of the way, and is m / 2 or more from
//!   the plane of j: within v's column. So the face is the one between v and the voxel before.
//!
//! Hence a face is tested when the ray leaves through it; and when it enters through it where the voxel before was not looked
//! at: at the start, after a leap. The first hit is accepted when the walk has passed it, as in [`super::Grid`].

mod build;
mod faces;
mod marks;
mod sequence;

pub use build::SolidOptions;
pub use sequence::SolidSequence;

use super::frame::Frame;
use super::skip::{Free, Method, Slot, Table, Voxels};
use super::walk::{Start, VoxelWalk, Walk};
use super::walk_branchless::Branchless;
use crate::accel::{Accel, Hit, Memory, Probe, queries_with_probe, scan_all, scan_any};
use crate::geometry::{Best, Geometry};
use crate::ray::{Aabb, Ray, greater};
use faces::{Arrival, Solid};
use marks::Marks;
use std::marker::PhantomData;

/// Solid voxels without lists of primitives.
///
/// `S` is what is known of the space off the surface: [`Unskipped`], or a [`Table`] of distances. `W` is how rays step.
///
/// Memory: two bits a voxel, and what the table says of itself. The voxels themselves are shared with the geometry.
#[derive(Clone, Debug)]
pub struct SolidGrid<S = Unskipped, W = Walk> {
    frame: Frame,
    solid: Solid,
    space: S,
    memory: u64,
    walk: PhantomData<W>,
}

/// What a walk finds in a voxel.
enum Seen {
    /// It touches an exposed face.
    Surface,
    /// It does not, and no voxel does that the ray meets before this parameter.
    Clear(f64),
    /// It does not, and nothing is known of others.
    Near,
}

/// How far a walk `W` may go off the surface.
trait Space<W>: Send + Sync {
    /// What is computed once for each ray.
    type Ray;

    /// Computes it, at the ray's first voxel.
    fn ray(walk: &W) -> Self::Ray;

    /// What is in the walk's voxel.
    fn look(&self, marks: &Marks, walk: &W, ray: &Self::Ray) -> Seen;

    /// Bytes held.
    fn bytes(&self) -> u64;

    /// For people; empty if there is nothing to say.
    fn describe(&self) -> String;
}

/// No table: every voxel is walked.
#[derive(Clone, Copy, Debug)]
pub struct Unskipped;

impl<W: VoxelWalk> Space<W> for Unskipped {
    type Ray = ();

    #[inline(always)]
    fn ray(_walk: &W) {}

    #[inline(always)]
    fn look(&self, marks: &Marks, walk: &W, _ray: &()) -> Seen {
        if marks.surface(walk.voxel()) { Seen::Surface } else { Seen::Near }
    }

    fn bytes(&self) -> u64 {
        0
    }

    fn describe(&self) -> String {
        String::new()
    }
}

impl<M: Method, T: Slot> Space<Walk> for Table<M, T> {
    type Ray = M::Ray;

    #[inline(always)]
    fn ray(walk: &Walk) -> M::Ray {
        M::ray(walk)
    }

    #[inline(always)]
    fn look(&self, _marks: &Marks, walk: &Walk, ray: &M::Ray) -> Seen {
        match self.free(walk, ray) {
            Free::Filled => Seen::Surface,
            Free::Until(t) => Seen::Clear(t),
            Free::Near => Seen::Near,
        }
    }

    fn bytes(&self) -> u64 {
        self.slot_bytes()
    }

    fn describe(&self) -> String {
        Voxels::describe(self)
    }
}

/// A walk that shows where it is.
trait Shown: VoxelWalk {
    fn shown(&self) -> &Walk;
}

impl Shown for Walk {
    #[inline(always)]
    fn shown(&self) -> &Walk {
        self
    }
}

impl Shown for Branchless {
    #[inline(always)]
    fn shown(&self) -> &Walk {
        &self.0
    }
}

#[expect(private_bounds, reason = "walks and tables are those of this module")]
impl<S: Space<W>, W: Shown> SolidGrid<S, W> {
    /// The closest hit, watched by `probe`; `()` watches nothing and costs nothing.
    pub fn closest_hit_with<P: Probe>(&self, ray: &Ray, probe: &mut P) -> Option<Hit> {
        let ray = ray.intake()?;
        let voxels = &self.solid.voxels;
        let best = match W::start(&self.frame, &ray) {
            Start::Miss => return None,
            Start::TooFar => scan_all(voxels, &ray, probe),
            Start::Inside(walk) => self.trace_either(false, &ray, walk, probe),
        };
        best.prim().map(|prim| Hit { t: voxels.round(&ray, &best), prim })
    }

    /// Whether there is any hit, watched by `probe`.
    pub fn any_hit_with<P: Probe>(&self, ray: &Ray, probe: &mut P) -> bool {
        let Some(ray) = ray.intake() else { return false };
        match W::start(&self.frame, &ray) {
            Start::Miss => false,
            Start::TooFar => scan_any(&self.solid.voxels, &ray, probe),
            Start::Inside(walk) => self.trace_either(true, &ray, walk, probe).is_hit(),
        }
    }

    /// [`SolidGrid::trace`], compiled for each query on its own where nobody watches.
    #[inline(always)]
    fn trace_either<P: Probe>(&self, any: bool, ray: &Ray, walk: W, probe: &mut P) -> Best {
        if P::WATCHES { self.trace_watched(any, ray, walk, probe) } else { self.trace(any, ray, walk, probe) }
    }

    #[inline(never)]
    fn trace_watched<P: Probe>(&self, any: bool, ray: &Ray, walk: W, probe: &mut P) -> Best {
        self.trace(any, ray, walk, probe)
    }

    /// From voxel to voxel until the winner, or the first hit if `any` will do, is certain.
    #[inline(always)]
    fn trace<P: Probe>(&self, any: bool, ray: &Ray, mut walk: W, probe: &mut P) -> Best {
        let solid = &self.solid;
        let prep = solid.voxels.prepare(ray);
        let shared = S::ray(&walk);
        let aside = solid.clear_where_still(&self.frame, ray);
        let mut entry = walk.shown().t;
        let mut arrival = Arrival::Unknown;
        let mut best = Best::NONE;
        loop {
            probe.step();
            let exit = walk.exit();
            match self.space.look(&solid.marks, &walk, &shared) {
                Seen::Surface => {
                    let shown = walk.shown();
                    let axis = shown.next_axis();
                    let leaves_clear = aside && solid.clear(shown, exit, axis);
                    let before = best;
                    if leaves_clear && solid.arrives_clear(shown, entry, arrival, ray, &prep, &mut best, probe) {
                        solid.leave(shown, axis, ray, &prep, &mut best, probe);
                    } else {
                        solid.around(shown.voxel, ray, &prep, &mut best, probe);
                    }
                    if best != before {
                        if any {
                            return best;
                        }
                        // As in the grid: passing the winner accepts it.
                        walk.end_at(best.upper());
                    }
                    arrival = if leaves_clear { Arrival::Clear } else { Arrival::Close };
                }
                Seen::Clear(until) => {
                    arrival = Arrival::Unknown;
                    if until > exit {
                        probe.leap();
                    }
                    entry = greater(until, exit);
                    if !walk.leap(entry) {
                        return best;
                    }
                    continue;
                }
                Seen::Near => arrival = Arrival::Unknown,
            }
            entry = exit;
            if !walk.step() {
                return best;
            }
        }
    }
}

impl<S: Space<W>, W: Shown> Accel for SolidGrid<S, W> {
    queries_with_probe!(closest_hit_with, any_hit_with);

    fn bounds(&self) -> Aabb {
        self.solid.voxels.solid_bounds()
    }

    fn memory(&self) -> Memory {
        Memory { structure: self.solid.marks.bytes(), references: 0, tables: self.space.bytes() }
    }

    fn describe(&self) -> String {
        let voxels = &self.solid.voxels;
        let [x, y, z] = voxels.resolution();
        let all = voxels.materials().len() as f64;
        let marks = &self.solid.marks;
        let mut line = format!(
            "{x} x {y} x {z} voxels and a border, {:.1} % solid, {:.1} % at the surface, {} exposed faces without lists",
            100.0 * voxels.solid_voxels() as f64 / all,
            100.0 * marks.surfaces() as f64 / marks.len() as f64,
            voxels.exposed_faces(),
        );
        let inside = marks.inside();
        if inside > 0 {
            line += &format!(", {inside} solid voxels off the surface walked as empty");
        }
        let table = self.space.describe();
        if !table.is_empty() {
            line += &format!(", {table}");
        }
        line
    }
}
