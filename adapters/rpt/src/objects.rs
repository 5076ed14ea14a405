//! Objects of rpt as skipgrid sees them: padded boxes in f32, and a test in f64 of the ray that rpt sent.

use glam::{DVec3, Vec3};
use rpt::{Bounded, BoundingBox, HitRecord, glm};
use skipgrid::geometry::Best;
use skipgrid::{Aabb, Error, Geometry, Ray, Result};
use std::cell::Cell;

/// By how much a ray and its rounded copy part within the boxes, and more.
///
/// Local coordinates there are at most 2 and components of directions below 2: rounding to f32 moves the start by 2^-24 along
/// an axis and the end of each unit of `t` by as much, of which there are at most 3. Boxes are rounded by 2^-25. The test of a
/// box, [`Query::meets`], rounds by 9 times 2^-24 along an axis. Together that is less than 2^-20; the rest is for f64.
const PADDING: f64 = 1.0 / (1 << 19) as f64;

/// Objects of rpt, which are hit where their own `intersect` says, to f64.
///
/// Boxes and rounded rays are in local coordinates, so that f32 is as fine as the objects need wherever they are: world is
/// `centre + size * local`, and local boxes lie within -1..=1 before they are padded.
pub struct Objects<T> {
    list: Vec<T>,
    bounds: BoundingBox,
    centre: DVec3,
    size: f64,
    boxes: Vec<Aabb>,
}

fn vec(v: &glm::DVec3) -> DVec3 {
    DVec3::new(v.x, v.y, v.z)
}

/// The greatest power of two that is not above `x`: dividing by it rounds nothing.
fn power_of_two(x: f64) -> f64 {
    f64::from_bits(x.to_bits() & 0x7ff << 52)
}

impl<T: Bounded> Objects<T> {
    /// # Errors
    /// There is no object, or more than 2^32 - 2, or one has a box that is not finite.
    pub fn new(list: Vec<T>) -> Result<Self> {
        let fail = |cause| Err(Error::Invalid { cause });
        if list.is_empty() || list.len() >= u32::MAX as usize {
            return fail(format!("{} objects, where 1 to 2^32 - 2 can be told apart", list.len()));
        }
        let worlds: Vec<[DVec3; 2]> =
            list.iter().map(T::bounding_box).map(|b| [vec(&b.p_min), vec(&b.p_max)]).collect();
        if let Some(i) = worlds.iter().position(|b| !(b[0].is_finite() && b[1].is_finite())) {
            let [min, max] = worlds[i];
            return fail(format!("object {i} of {} has a box that is not finite, from {min} to {max}", list.len()));
        }
        let bounds = list.iter().fold(BoundingBox::default(), |all, object| all.merge(&object.bounding_box()));
        let (low, high) = (vec(&bounds.p_min) / 2.0, vec(&bounds.p_max) / 2.0);
        let centre = low + high;
        // Not so small that f64 could not tell points apart at that place, and not zero.
        let half = (high - low).max_element().max(centre.abs().max_element() * 1e-9).max(1e-300);
        let size = 2.0 * power_of_two(half);
        let local = |v: DVec3, pad: f64| ((v - centre) / size + pad).as_vec3();
        let boxes = worlds.iter().map(|&[min, max]| Aabb { min: local(min, -PADDING), max: local(max, PADDING) });
        Ok(Self { boxes: boxes.collect(), list, bounds, centre, size })
    }

    /// The objects in their order.
    pub fn list(&self) -> &[T] {
        &self.list
    }

    /// Around all objects, world units.
    pub fn bounding_box(&self) -> BoundingBox {
        self.bounds
    }
}

/// A ray of rpt and its rounded copy.
#[derive(Clone, Copy)]
pub struct Query {
    ray: rpt::Ray,
    t_min: f64,
    /// Only times before it are of interest.
    limit: f64,
    /// The time at which the rounded ray starts.
    enter: f64,
    /// Units of its `t` for a unit of time, a power of two.
    scale: f64,
    rounded: Ray,
    /// One over its direction, which is taken to be at least 1e-30 along each axis.
    inverse: Vec3,
}

thread_local! {
    /// What this thread asks: accelerators hand on the rounded ray only.
    static ASKED: Cell<Option<Query>> = const { Cell::new(None) };
}

impl Query {
    /// For times from `t_min` until before `limit`.
    pub fn new<T>(ray: &rpt::Ray, t_min: f64, limit: f64, objects: &Objects<T>) -> Self {
        let (origin, direction) = ((vec(&ray.origin) - objects.centre) / objects.size, vec(&ray.dir) / objects.size);
        // Its greatest component shall be at least 1 and below 2, so that `t` is about a length.
        let scale = power_of_two(direction.abs().max_element());
        let direction = direction / scale;
        // The rounded ray starts where the ray comes within 2 of the centre along each axis, so that small numbers are rounded.
        // A ray that never does hits nothing, wherever it starts. A NaN, from a ray along a plane, is no maximum.
        let starts = (-2.0 * direction.signum() - origin) / direction;
        let enter = starts.to_array().into_iter().fold(t_min * scale, f64::max);
        let (start, direction) = ((origin + direction * enter).as_vec3(), direction.as_vec3());
        let t_max = (limit * scale - enter) as f32;
        let rounded = Ray::new(start, direction).with_range(0.0, t_max.next_up());
        let inverse = Vec3::from(direction.to_array().map(|d| if d.abs() > 1e-30 { 1.0 / d } else { 1e30 }));
        Self { ray: *ray, t_min, limit, enter: enter / scale, scale, rounded, inverse }
    }

    /// What `accel` answers to the rounded ray, tested as the ray itself.
    pub fn ask<R>(&self, accel: impl FnOnce(&Ray) -> R) -> R {
        // Objects may ask accelerators themselves.
        let before = ASKED.replace(Some(*self));
        let answer = accel(&self.rounded);
        ASKED.set(before);
        answer
    }

    /// False only if nothing in the box `aabb` is hit before `limit`, local `t`.
    fn meets(&self, aabb: &Aabb, limit: f64) -> bool {
        let (a, b) = ((aabb.min - self.rounded.origin) * self.inverse, (aabb.max - self.rounded.origin) * self.inverse);
        let (near, far) = (a.min(b).max_element(), a.max(b).min_element());
        near <= far && far >= 0.0 && f64::from(near) <= limit
    }
}

impl<T: Bounded> Geometry for Objects<T> {
    type Prep = Option<Query>;

    fn len(&self) -> u32 {
        self.list.len() as u32 // checked by `new`
    }

    fn bounds(&self, prim: u32) -> Aabb {
        self.boxes[prim as usize]
    }

    fn prepare(&self, _rounded: &Ray) -> Option<Query> {
        ASKED.get()
    }

    /// Hits nothing for rays that do not come from [`Query::ask`].
    fn test(&self, prim: u32, rounded: &Ray, query: &Option<Query>, best: &mut Best) {
        let Some(query) = query.as_ref().filter(|query| query.meets(&self.boxes[prim as usize], best.t())) else {
            return;
        };
        let mut record = HitRecord { time: query.limit, normal: glm::DVec3::zeros() };
        if self.list[prim as usize].intersect(&query.ray, query.t_min, &mut record) {
            // The order of times is kept: none is negative, so that neither step brings two of them together.
            best.offer(rounded, (record.time - query.enter) * query.scale, prim);
        }
    }
}
