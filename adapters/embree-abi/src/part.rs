//! A geometry as a committed scene sees it, and the triangles of all geometries in one list.

use crate::device::Fault;
use crate::geometry::Geometry;
use crate::scene::Scene;
use crate::types::{Bounds, BoundsArguments, FilterFunction, GeometryType, Hit, INVALID_ID, UserFunction, buffer_type};
use glam::{DAffine3, DVec3, Vec3};
use skipgrid::{Aabb, Ray, Triangle};
use std::ffi::c_void;
use std::sync::Arc;

/// One geometry at the time of the commit.
#[derive(Clone, Debug)]
pub struct Part {
    /// Its number in the scene.
    pub id: u32,
    /// Rays that share no bit with it pass.
    pub mask: u32,
    /// The caller's own pointer.
    pub user: *mut c_void,
    /// Closest hit with a user primitive.
    pub intersect: Option<UserFunction>,
    /// Any hit with a user primitive.
    pub occluded: Option<UserFunction>,
    /// Asked about each closest hit.
    pub intersect_filter: Option<FilterFunction>,
    /// Asked about each hit that hides.
    pub occluded_filter: Option<FilterFunction>,
    /// Filters of arguments are asked without being told to.
    pub filter_from_arguments: bool,
    /// What an instance shows, and the way from the scene's space to its own.
    pub instance: Option<(Arc<Scene>, DAffine3)>,
}

// SAFETY: nothing behind the pointers is touched here.
unsafe impl Send for Part {}
// SAFETY: as above.
unsafe impl Sync for Part {}

impl Part {
    /// The geometry with the number `id`.
    pub fn new(id: u32, geometry: &Geometry) -> Self {
        let state = geometry.state();
        Self {
            id,
            mask: state.mask,
            user: geometry.user(),
            intersect: state.intersect,
            occluded: state.occluded,
            intersect_filter: state.intersect_filter,
            occluded_filter: state.occluded_filter,
            filter_from_arguments: state.filter_from_arguments,
            instance: state.instanced.clone().map(|scene| (scene, state.transform.inverse())),
        }
    }
}

/// Triangles of some geometries, those of the first one first; a quad is two of them.
#[derive(Debug, Default)]
pub struct Triangles {
    /// Corners, world units. One with a corner that does not exist is not finite, so that no ray meets it.
    pub corners: Arc<Vec<Triangle>>,
    /// Where geometries begin, in their order.
    owners: Vec<Owner>,
}

#[derive(Debug)]
struct Owner {
    first: u32,
    part: u32,
    quads: bool,
}

impl Triangles {
    /// Adds the triangles of `geometry`, which is the part `part`. Call before the corners are shared.
    ///
    /// # Errors
    /// There are more triangles than can be told apart.
    pub fn add(&mut self, part: u32, geometry: &Geometry) -> Result<(), Fault> {
        let state = geometry.state();
        let Some(vertices) = state.view(buffer_type::VERTEX, 0) else { return Ok(()) };
        let list = Arc::get_mut(&mut self.corners).expect("nobody shares the corners yet");
        let too_many = || Fault::operation("a scene of more than 2^32 - 2 triangles");
        let first = u32::try_from(list.len()).map_err(|_| too_many())?;
        let quads = geometry.kind == GeometryType::Quad;
        let corner = |index: u32| vertices.point(index as usize).map_or(Vec3::NAN, Vec3::from_array);
        for [a, b, c, d] in state.corners(geometry.kind) {
            if quads {
                // As Embree cuts quads, so that u and v run along the same edges. A corner that is none takes the whole quad away.
                let [a, b, c, d] = [a, b, c, d].map(corner);
                let whole = [a, b, c, d].iter().all(|p| p.is_finite());
                let or_none = |triangle: Triangle| if whole { triangle } else { [Vec3::NAN; 3] };
                list.extend([or_none([a, b, d]), or_none([c, d, b])]);
            } else {
                list.push([a, b, c].map(corner));
            }
        }
        if list.len() > (u32::MAX - 1) as usize {
            return Err(too_many());
        }
        if list.len() > first as usize {
            self.owners.push(Owner { first, part, quads });
        }
        Ok(())
    }

    /// True if there is none.
    pub fn is_empty(&self) -> bool {
        self.corners.is_empty()
    }

    fn owner(&self, triangle: u32) -> &Owner {
        &self.owners[self.owners.partition_point(|owner| owner.first <= triangle) - 1]
    }

    /// The part that a triangle belongs to.
    pub fn part(&self, triangle: u32) -> usize {
        self.owner(triangle).part as usize
    }

    /// What Embree says of the point where `ray` meets a triangle, which it does.
    pub fn hit(&self, triangle: u32, ray: &Ray, parts: &[Part]) -> Hit {
        let owner = self.owner(triangle);
        let local = triangle - owner.first;
        let (mut u, mut v, normal) = weights(&self.corners[triangle as usize], ray);
        let primitive = if owner.quads { local / 2 } else { local };
        if owner.quads && local % 2 == 1 {
            (u, v) = (1.0 - u, 1.0 - v);
        }
        let geometry = parts[owner.part as usize].id;
        Hit {
            normal,
            u: u as f32,
            v: v as f32,
            primitive,
            geometry,
            instance: INVALID_ID,
            instance_primitive: INVALID_ID,
        }
    }
}

/// Weights of the second and third corner in the point where the ray meets the triangle, and the normal, not of unit length.
///
/// In f64, and within the triangle: that it is met is known exactly, rounding must not deny it.
fn weights([a, b, c]: &Triangle, ray: &Ray) -> (f64, f64, [f32; 3]) {
    let [a, b, c] = [a, b, c].map(|p| p.as_dvec3());
    let (second, third, direction) = (b - a, c - a, ray.direction.as_dvec3());
    let normal: DVec3 = second.cross(third);
    // Cramer's rule for origin + t direction = a + u second + v third.
    let moment = (ray.origin.as_dvec3() - a).cross(direction);
    let scale = direction.dot(normal).recip();
    let within = |w: f64, most: f64| if w > 0.0 { w.min(most) } else { 0.0 };
    let u = within(-third.dot(moment) * scale, 1.0);
    (u, within(second.dot(moment) * scale, 1.0 - u), normal.as_vec3().to_array())
}

/// The box of a user primitive as its function says, empty if it is no box.
pub fn user_bounds(geometry: &Geometry, primitive: u32) -> Result<Aabb, Fault> {
    let callback = geometry.state().bounds;
    let function = callback.function.ok_or_else(|| Fault::operation("a user geometry without a bounds function"))?;
    let mut bounds = Bounds::EMPTY;
    let arguments =
        BoundsArguments { geometry_user: geometry.user(), primitive, time_step: 0, bounds: &raw mut bounds };
    // SAFETY: the caller set the function for this purpose; what the arguments point to lives during the call.
    unsafe { function(&raw const arguments) };
    let [min, max] = [bounds.lower, bounds.upper].map(|[x, y, z, _]| Vec3::new(x, y, z));
    let fine = min.is_finite() && max.is_finite() && min.cmple(max).all();
    Ok(if fine { Aabb { min, max } } else { Aabb::EMPTY })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weights_are_those_of_the_corners() {
        let triangle = [Vec3::new(1.0, 0.0, 0.0), Vec3::new(3.0, 0.0, 0.0), Vec3::new(1.0, 4.0, 0.0)];
        let ray = Ray::new(Vec3::new(1.5, 1.0, 5.0), -Vec3::Z);
        assert_eq!(weights(&triangle, &ray), (0.25, 0.25, [0.0, 0.0, 8.0]));
        // In a corner.
        let ray = Ray::new(Vec3::new(1.0, 4.0, 5.0), -Vec3::Z);
        assert_eq!(weights(&triangle, &ray), (0.0, 1.0, [0.0, 0.0, 8.0]));
    }
}
