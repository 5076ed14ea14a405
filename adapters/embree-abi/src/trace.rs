//! One ray through a committed scene, with everything that the caller hung on it.
//!
//! Hits count where `tnear < t <= tfar`, as Embree's own tests have it.

use crate::asked::{Asked, Terms};
use crate::built::{Built, Filtered};
use crate::called::{self, FilteredTriangles};
use crate::device::Fault;
use crate::part::Part;
use crate::seen::Seen;
use crate::types::{FilterArguments, FilterFunction, Hit, INVALID_ID, Ray, UserArguments, hit_words};
use glam::{DAffine3, DVec3, Vec3};
use std::ffi::c_int;
use std::ptr;

/// A ray on its way through a scene.
#[derive(Debug)]
pub struct Query {
    terms: Terms,
    built: *const Built,
    /// Triangles that were asked about.
    triangles: Seen,
    /// Instances that the ray went through.
    instances: Seen,
}

/// What callbacks of user geometries get, and behind it what [`Query::filter_from_callback`] needs.
#[derive(Debug)]
#[repr(C)]
struct UserCall {
    arguments: UserArguments,
    part: *const Part,
    query: *mut Query,
}

impl Query {
    fn new(built: &Built, terms: Terms) -> Self {
        Self { terms, built, triangles: Seen::default(), instances: Seen::default() }
    }

    /// The closest hit of `ray`, which goes into `hit` and `ray.tfar`.
    ///
    /// # Safety
    /// The pointers are good for the size of what Embree 3 or 4 has there, the functions for being called.
    pub unsafe fn closest(built: &Built, ray: *mut Ray, hit: *mut Hit, asked: &Asked) {
        // SAFETY: as the caller promises.
        unsafe {
            asked.with_terms(built, ray, hit, |terms| {
                let mut query = Query::new(built, terms);
                Query::trace_closest(&raw mut query);
            });
        }
    }

    /// Whether anything meets `ray`; then `ray.tfar` becomes `-inf`.
    ///
    /// # Safety
    /// As [`Query::closest`].
    pub unsafe fn any(built: &Built, ray: *mut Ray, asked: &Asked) {
        // SAFETY: as the caller promises.
        unsafe {
            asked.with_terms(built, ray, ptr::null_mut(), |terms| {
                let mut query = Query::new(built, terms);
                if Query::trace_any(&raw mut query) {
                    (*ray).tfar = f32::NEG_INFINITY;
                }
            });
        }
    }

    /// The segment that accelerators trace, up to `t_max`.
    ///
    /// # Safety
    /// `ray` is good for reading.
    unsafe fn segment(ray: *const Ray, t_max: f32) -> skipgrid::Ray {
        // SAFETY: as the caller promises.
        let ray = unsafe { &*ray };
        let (origin, direction) = (Vec3::from_array(ray.origin), Vec3::from_array(ray.direction));
        skipgrid::Ray { origin, direction, t_min: ray.tnear.next_up(), t_max }
    }

    /// Looks for the closest hit and takes it.
    ///
    /// # Safety
    /// As [`Query::offer_triangle`].
    unsafe fn trace_closest(query: *mut Query) {
        // SAFETY: as the caller promises; no reference to the query or the ray lasts over a callback.
        unsafe {
            let (built, ray, masks) = (&*(*query).built, (*query).terms.ray, (*query).terms.masks);
            let segment = |t_max: f32| Query::segment(ray, t_max);
            if let Some((triangles, accel)) = &built.plain
                && (!masks || (*ray).mask & built.common_mask != 0)
            {
                let segment = segment((*ray).tfar);
                if let Some(found) = accel.closest_hit(&segment) {
                    let hit = triangles.hit(found.prim, &segment, &built.parts);
                    Query::take(query, &hit, found.t);
                }
            }
            if let Some(Filtered { triangles, nearest, asking }) = &built.filtered {
                let segment = segment((*ray).tfar);
                if let Some(found) = nearest.closest_hit(&segment) {
                    let hit = triangles.hit(found.prim, &segment, &built.parts);
                    let part = &built.parts[triangles.part(found.prim)];
                    if Query::accepts(query, part, found.prim, found.t, hit).is_none() {
                        called::enter(query, || asking.closest_hit(&segment));
                    }
                }
            }
            if let Some(others) = &built.others {
                let segment = segment((*ray).tfar);
                called::enter(query, || others.closest_hit(&segment));
            }
        }
    }

    /// True if there is any hit that masks and filters let pass.
    ///
    /// # Safety
    /// As [`Query::offer_triangle`].
    unsafe fn trace_any(query: *mut Query) -> bool {
        // SAFETY: as in `trace_closest`.
        unsafe {
            let (built, ray, masks) = (&*(*query).built, (*query).terms.ray, (*query).terms.masks);
            let segment = Query::segment(ray, (*ray).tfar);
            if let Some((_, accel)) = &built.plain
                && (!masks || (*ray).mask & built.common_mask != 0)
                && accel.any_hit(&segment)
            {
                return true;
            }
            if let Some(Filtered { triangles, nearest, asking }) = &built.filtered
                && let Some(found) = nearest.closest_hit(&segment)
            {
                let hit = triangles.hit(found.prim, &segment, &built.parts);
                let part = &built.parts[triangles.part(found.prim)];
                if Query::accepts(query, part, found.prim, found.t, hit).is_some()
                    || called::enter(query, || asking.any_hit(&segment))
                {
                    return true;
                }
            }
            built.others.as_ref().is_some_and(|others| called::enter(query, || others.any_hit(&segment)))
        }
    }

    /// Writes the hit and the end of the ray.
    ///
    /// # Safety
    /// As [`Query::offer_triangle`].
    unsafe fn take(query: *mut Query, hit: &Hit, t: f32) {
        // SAFETY: as the caller promises.
        unsafe {
            let mut hit = *hit;
            hit.instance = *(*query).terms.instance;
            if !(*query).terms.instance_primitive.is_null() {
                hit.instance_primitive = *(*query).terms.instance_primitive;
            }
            let words = hit_words((*query).terms.version);
            ptr::copy_nonoverlapping((&raw const hit).cast::<u32>(), (*query).terms.hit.cast::<u32>(), words);
            (*(*query).terms.ray).tfar = t;
        }
    }

    /// Takes the hit of a triangle if masks and filters let it pass; then where it ends up. Each triangle is asked about once.
    ///
    /// # Safety
    /// As [`Query::offer_triangle`].
    unsafe fn accepts(query: *mut Query, part: &Part, prim: u32, t: f32, mut hit: Hit) -> Option<f32> {
        // SAFETY: as in `trace_closest`.
        unsafe {
            if !(*query).triangles.insert(prim) || Query::masked(query, part) {
                return None;
            }
            hit.instance = *(*query).terms.instance;
            if !(*query).terms.instance_primitive.is_null() {
                hit.instance_primitive = *(*query).terms.instance_primitive;
            }
            let (ray, any) = ((*query).terms.ray, (*query).terms.hit.is_null());
            let before = std::mem::replace(&mut (*ray).tfar, t);
            let own = if any { part.occluded_filter } else { part.intersect_filter };
            if !Query::filters_pass(query, part, own, &mut hit) {
                (*ray).tfar = before;
                return None;
            }
            let t = (*ray).tfar;
            if any {
                // The ray is not changed before all is known.
                (*ray).tfar = before;
            } else {
                Query::take(query, &hit, t);
            }
            Some(t)
        }
    }

    /// True if the geometry is not there for this ray.
    ///
    /// # Safety
    /// As [`Query::offer_triangle`].
    unsafe fn masked(query: *const Query, part: &Part) -> bool {
        // SAFETY: as in `trace_closest`.
        unsafe { (*query).terms.masks && (*(*query).terms.ray).mask & part.mask == 0 }
    }

    /// Asks the geometry's filter, then the caller's.
    ///
    /// # Safety
    /// As [`Query::offer_triangle`].
    unsafe fn filters_pass(query: *mut Query, part: &Part, own: Option<FilterFunction>, hit: &mut Hit) -> bool {
        // SAFETY: as in `trace_closest`.
        unsafe {
            let mut valid: c_int = -1;
            let arguments = FilterArguments {
                valid: &raw mut valid,
                geometry_user: part.user,
                context: (*query).terms.context,
                ray: (*query).terms.ray,
                hit,
                n: 1,
            };
            if let Some(own) = own {
                own(&raw const arguments);
            }
            if let Some(filter) = (*query).terms.filter
                && valid != 0
                && ((*query).terms.filter_everywhere || part.filter_from_arguments)
            {
                filter(&raw const arguments);
            }
            valid != 0
        }
    }

    /// A triangle of the asking structure is met at `t`: takes it if it is the closest that may be. Then where it ends up.
    ///
    /// # Safety
    /// `query` is alive and nobody holds a reference to it.
    pub unsafe fn offer_triangle(
        query: *mut Query,
        set: &FilteredTriangles,
        prim: u32,
        t: f32,
        ray: &skipgrid::Ray,
    ) -> Option<f32> {
        let part = &set.parts[set.triangles.part(prim)];
        let hit = set.triangles.hit(prim, ray, &set.parts);
        // SAFETY: as the caller promises.
        unsafe { Query::accepts(query, part, prim, t, hit) }
    }

    /// Lets a user primitive or an instance look at the ray. Then where it is met, if it is met closer than anything before.
    ///
    /// # Safety
    /// As [`Query::offer_triangle`].
    pub unsafe fn offer_other(query: *mut Query, part: &Part, prim: u32, primitive: u32) -> Option<f32> {
        // SAFETY: as the caller promises.
        unsafe {
            if Query::masked(query, part) {
                return None;
            }
            match &part.instance {
                // A ray sees all of an instance at once.
                Some((scene, to_local)) => {
                    if !(*query).instances.insert(prim) {
                        return None;
                    }
                    scene.with_built(|built| Query::through_instance(query, built?, part, to_local))
                }
                None => Query::call_user(query, part, primitive),
            }
        }
    }

    /// Calls a user geometry's function. Then where the ray ends, if that is closer than before.
    ///
    /// # Safety
    /// As [`Query::offer_triangle`].
    unsafe fn call_user(query: *mut Query, part: &Part, primitive: u32) -> Option<f32> {
        // SAFETY: as in `trace_closest`.
        unsafe {
            let (ray, any) = ((*query).terms.ray, (*query).terms.hit.is_null());
            let own = if any { part.occluded } else { part.intersect };
            let Some(function) = own.or((*query).terms.function) else {
                let what = if any { "an occluded" } else { "an intersect" };
                let device = (*(*query).built).device();
                device.raise(&Fault::operation(format!(
                    "geometry {} is a user geometry without {what} function",
                    part.id
                )));
                return None;
            };
            let before = (*ray).tfar;
            let mut valid: c_int = -1;
            let call = UserCall {
                arguments: UserArguments {
                    valid: &raw mut valid,
                    geometry_user: part.user,
                    primitive,
                    context: (*query).terms.context,
                    ray,
                    n: 1,
                    geometry: part.id,
                },
                part,
                query,
            };
            function((&raw const call).cast());
            let after = (*ray).tfar;
            if any {
                // The ray as it was for whoever comes next; a hit ends the search at once.
                (*ray).tfar = before;
                return (after < before).then(|| (*ray).tnear.next_up());
            }
            (after < before).then_some(after)
        }
    }

    /// Traces what an instance shows in its own space. Then where the ray ends, if that is closer than before.
    ///
    /// # Safety
    /// As [`Query::offer_triangle`].
    unsafe fn through_instance(query: *mut Query, built: &Built, part: &Part, to_local: &DAffine3) -> Option<f32> {
        // SAFETY: as in `trace_closest`.
        unsafe {
            if *(*query).terms.instance != INVALID_ID {
                let device = (*(*query).built).device();
                device.raise(&Fault::unsupported("instances within instances"));
                return None;
            }
            let (ray, instance_primitive) = ((*query).terms.ray, (*query).terms.instance_primitive);
            let (origin, direction, before) = ((*ray).origin, (*ray).direction, (*ray).tfar);
            let map = |v: [f32; 3]| DVec3::from_array(v.map(f64::from));
            (*ray).origin = to_local.transform_point3(map(origin)).as_vec3().to_array();
            (*ray).direction = to_local.transform_vector3(map(direction)).as_vec3().to_array();
            *(*query).terms.instance = part.id;
            if !instance_primitive.is_null() {
                *instance_primitive = 0;
            }
            let mut inner = Query::new(built, (*query).terms);
            let any = (*query).terms.hit.is_null();
            let found = if any {
                Query::trace_any(&raw mut inner)
            } else {
                Query::trace_closest(&raw mut inner);
                (*ray).tfar < before
            };
            *(*query).terms.instance = INVALID_ID;
            if !instance_primitive.is_null() {
                *instance_primitive = INVALID_ID;
            }
            ((*ray).origin, (*ray).direction) = (origin, direction);
            found.then(|| if any { (*ray).tnear.next_up() } else { (*ray).tfar })
        }
    }

    /// `rtcFilterIntersection` and its like: a user geometry's function asks the filters about a hit that it found.
    ///
    /// # Safety
    /// `user` is what such a function was called with, and that call has not ended; `arguments` as filters want them.
    pub unsafe fn filter_from_callback(user: *const UserArguments, arguments: *const FilterArguments, any: bool) {
        // SAFETY: as the caller promises; user functions are called by `call_user` alone.
        unsafe {
            let call = user.cast::<UserCall>();
            let (part, query) = (&*(*call).part, (*call).query);
            if let Some(own) = if any { part.occluded_filter } else { part.intersect_filter } {
                own(arguments);
            }
            if let Some(filter) = (*query).terms.filter
                && *(*arguments).valid != 0
                && ((*query).terms.filter_everywhere || part.filter_from_arguments)
            {
                filter(arguments);
            }
        }
    }
}
