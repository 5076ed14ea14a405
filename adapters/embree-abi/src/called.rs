//! Primitives whose hits the caller decides: user geometries, instances, and triangles with filters or masks of their own.
//!
//! Accelerators know rays and primitives only; what the caller passed along with a ray waits in [`enter`]'s thread-local variable
//! until a primitive is tested.

use crate::part::{Part, Triangles};
use crate::trace::Query;
use glam::DVec3;
use skipgrid::geometry::{Best, Geometry};
use skipgrid::{Aabb, Ray};
use std::cell::Cell;
use std::ptr;
use std::sync::Arc;

thread_local! {
    static QUERY: Cell<*mut Query> = const { Cell::new(ptr::null_mut()) };
}

/// Runs `trace`, whose tests find `query`; queries within queries come from instances.
///
/// The query is not touched but through its address as long as `trace` runs.
pub fn enter<R>(query: *mut Query, trace: impl FnOnce() -> R) -> R {
    /// Puts the outer query back, also when a callback throws.
    struct Leave(*mut Query);
    impl Drop for Leave {
        fn drop(&mut self) {
            QUERY.set(self.0);
        }
    }
    let _leave = Leave(QUERY.replace(query));
    trace()
}

/// Triangles that filters or masks may take away.
#[derive(Debug)]
pub struct FilteredTriangles {
    /// The triangles.
    pub triangles: Arc<Triangles>,
    /// All parts of the scene.
    pub parts: Arc<Vec<Part>>,
}

impl Geometry for FilteredTriangles {
    type Prep = <[skipgrid::Triangle] as Geometry>::Prep;

    fn len(&self) -> u32 {
        Geometry::len(&*self.triangles.corners)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        self.triangles.corners.bounds(prim)
    }

    fn prepare(&self, ray: &Ray) -> Self::Prep {
        self.triangles.corners.prepare(ray)
    }

    fn test(&self, prim: u32, ray: &Ray, prep: &Self::Prep, best: &mut Best) {
        let corners = &self.triangles.corners;
        let mut own = Best::NONE;
        corners.test(prim, ray, prep, &mut own);
        if !own.is_hit() {
            return;
        }
        let t = corners.round(ray, &own);
        if f64::from(t) > best.t() || (f64::from(t) == best.t() && best.prim().is_some_and(|winner| winner <= prim)) {
            return;
        }
        // SAFETY: rays are traced within `enter` alone, whose query lives.
        let accepted = unsafe { Query::offer_triangle(QUERY.get(), self, prim, t, ray) };
        if let Some(t) = accepted {
            best.replace(f64::from(t), 0.0, prim);
        }
    }
}

/// User primitives and instances.
#[derive(Debug)]
pub struct Others {
    /// Which part, and which of its primitives.
    pub list: Vec<(u32, u32)>,
    /// A box for each.
    pub boxes: Vec<Aabb>,
    /// All parts of the scene.
    pub parts: Arc<Vec<Part>>,
}

/// A ray as boxes see it.
#[derive(Debug)]
pub struct Slabs {
    origin: DVec3,
    direction: DVec3,
    inverse: DVec3,
}

impl Slabs {
    /// False only if the ray certainly misses the box between `t_min` and `t_max`. Calls cost more than this test: accelerators hand over
    /// whatever lies near.
    fn may_meet(&self, aabb: &Aabb, t_min: f64, t_max: f64) -> bool {
        let (min, max) = (aabb.min.as_dvec3(), aabb.max.as_dvec3());
        let (mut near, mut far) = (t_min, t_max);
        for axis in 0..3 {
            let (low, high) = (min[axis] - self.origin[axis], max[axis] - self.origin[axis]);
            if self.direction[axis] == 0.0 {
                if low > 0.0 || high < 0.0 {
                    return false;
                }
                continue;
            }
            let (a, b) = (low * self.inverse[axis], high * self.inverse[axis]);
            (near, far) = (near.max(a.min(b)), far.min(a.max(b)));
        }
        // Three roundings of 2^-53 each; the slack is a thousand times as wide.
        near <= far + far.abs() * 2f64.powi(-40)
    }
}

impl Geometry for Others {
    type Prep = Slabs;

    fn len(&self) -> u32 {
        u32::try_from(self.list.len()).unwrap_or(u32::MAX - 1)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        self.boxes[prim as usize]
    }

    fn prepare(&self, ray: &Ray) -> Slabs {
        let direction = ray.direction.as_dvec3();
        Slabs { origin: ray.origin.as_dvec3(), direction, inverse: direction.recip() }
    }

    fn test(&self, prim: u32, ray: &Ray, slabs: &Slabs, best: &mut Best) {
        let t_max = best.t().min(f64::from(ray.t_max));
        if !slabs.may_meet(&self.boxes[prim as usize], f64::from(ray.t_min), t_max) {
            return;
        }
        let (part, primitive) = self.list[prim as usize];
        // SAFETY: rays are traced within `enter` alone, whose query lives.
        let accepted = unsafe { Query::offer_other(QUERY.get(), &self.parts[part as usize], prim, primitive) };
        if let Some(t) = accepted {
            best.replace(f64::from(t), 0.0, prim);
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::Vec3;

    #[test]
    fn boxes_that_are_touched_may_be_met() {
        let set = Others {
            list: vec![(0, 0)],
            boxes: vec![Aabb { min: Vec3::new(1.0, 0.0, 0.0), max: Vec3::new(2.0, 1.0, 1.0) }],
            parts: Arc::default(),
        };
        for (origin, direction, t_max, expected) in [
            (Vec3::new(0.0, 0.5, 0.5), Vec3::X, f64::INFINITY, true),
            (Vec3::new(0.0, 0.5, 0.5), Vec3::X, 1.0, true),
            (Vec3::new(0.0, 0.5, 0.5), Vec3::X, 0.5, false),
            (Vec3::new(0.0, 0.5, 0.5), -Vec3::X, f64::INFINITY, false),
            // Along a face and along an edge.
            (Vec3::new(0.0, 1.0, 0.5), Vec3::X, f64::INFINITY, true),
            (Vec3::new(0.0, 1.0, 1.0), Vec3::X, f64::INFINITY, true),
            (Vec3::new(0.0, 1.5, 0.5), Vec3::X, f64::INFINITY, false),
            // Through a corner alone.
            (Vec3::new(0.0, 1.0, 0.0), Vec3::new(1.0, -1.0, 0.0), f64::INFINITY, true),
            (Vec3::new(1.5, 0.5, 0.5), Vec3::new(0.3, 0.2, -0.7), f64::INFINITY, true),
        ] {
            let slabs = set.prepare(&Ray::new(origin, direction));
            assert_eq!(slabs.may_meet(&set.boxes[0], 0.0, t_max), expected, "{origin} {direction} {t_max}");
        }
    }
}
