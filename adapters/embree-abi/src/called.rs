//! Primitives whose hits the caller decides: user geometries, instances, and triangles with filters or masks of their own.
//!
//! Accelerators know rays and primitives only; what the caller passed along with a ray waits in [`enter`]'s thread-local variable
//! until a primitive is tested.

use crate::part::{Part, Triangles};
use crate::trace::Query;
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

impl Geometry for Others {
    type Prep = ();

    fn len(&self) -> u32 {
        u32::try_from(self.list.len()).unwrap_or(u32::MAX - 1)
    }

    fn bounds(&self, prim: u32) -> Aabb {
        self.boxes[prim as usize]
    }

    fn prepare(&self, _: &Ray) {}

    fn test(&self, prim: u32, _: &Ray, (): &(), best: &mut Best) {
        let (part, primitive) = self.list[prim as usize];
        // SAFETY: rays are traced within `enter` alone, whose query lives.
        let accepted = unsafe { Query::offer_other(QUERY.get(), &self.parts[part as usize], prim, primitive) };
        if let Some(t) = accepted {
            best.replace(f64::from(t), 0.0, prim);
        }
    }
}
