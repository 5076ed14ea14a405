//! `rtc*Geometry*`, `rtc*Buffer*` and `rtcInterpolate*`.

use super::{c_functions, object};
use crate::buffer::{Buffer, View};
use crate::device::{Callback, Device, Fault};
use crate::geometry::Geometry;
use crate::handle;
use crate::interpolate::{Place, Results, interpolate};
use crate::scene::Scene;
use crate::trace::Query;
use crate::transform::{self, Decomposition};
use crate::types::{BoundsFunction, FilterArguments, FilterFunction, GeometryType, UserArguments, UserFunction};
use std::ffi::{c_int, c_void};
use std::ptr;
use std::sync::Arc;

/// Runs `work` on the geometry of a handle; raises its error, if any.
///
/// # Safety
/// The handle is null or alive.
unsafe fn with(geometry: *const Geometry, work: impl FnOnce(&Geometry) -> Result<(), Fault>) {
    // SAFETY: as the caller promises.
    if let Some(geometry) = unsafe { object(geometry, "a geometry") } {
        geometry.device.check(work(geometry), ());
    }
}

fn only(geometry: &Geometry, kind: GeometryType, what: &str) -> Result<(), Fault> {
    if geometry.kind == kind {
        Ok(())
    } else {
        Err(Fault::operation(format!("{what} of a geometry of type {:?}", geometry.kind)))
    }
}

fn first_time_step(step: u32) -> Result<(), Fault> {
    if step == 0 { Ok(()) } else { Err(Fault::unsupported("motion blur (a time step but the first)")) }
}

/// The arguments of `rtcInterpolate`.
#[derive(Debug)]
#[repr(C)]
pub struct InterpolateArguments {
    geometry: *const Geometry,
    primitive: u32,
    u: f32,
    v: f32,
    kind: u32,
    slot: u32,
    to: [*mut f32; 6],
    count: u32,
}

/// The arguments of `rtcInterpolateN`.
#[derive(Debug)]
#[repr(C)]
pub struct InterpolateManyArguments {
    geometry: *const Geometry,
    valid: *const c_int,
    primitives: *const u32,
    u: *const f32,
    v: *const f32,
    n: u32,
    kind: u32,
    slot: u32,
    to: [*mut f32; 6],
    count: u32,
}

c_functions! {
    /// `rtcNewBuffer`.
    fn rtcNewBuffer(device: *const Device, bytes: usize) -> *const Buffer {
        let (Some(seen), Some(owned)) = (object(device, "a device"), handle::share(device)) else { return ptr::null() };
        seen.check(Buffer::new(owned, bytes).map(|buffer| handle::give(Arc::new(buffer))), ptr::null())
    }

    /// `rtcNewSharedBuffer`.
    fn rtcNewSharedBuffer(device: *const Device, data: *mut c_void, bytes: usize) -> *const Buffer {
        let (Some(seen), Some(owned)) = (object(device, "a device"), handle::share(device)) else { return ptr::null() };
        seen.check(Buffer::shared(owned, data.cast(), bytes).map(|buffer| handle::give(Arc::new(buffer))), ptr::null())
    }

    /// `rtcGetBufferData`.
    fn rtcGetBufferData(buffer: *const Buffer) -> *mut c_void {
        object(buffer, "a buffer").map_or(ptr::null_mut(), Buffer::data)
    }

    /// `rtcRetainBuffer`.
    fn rtcRetainBuffer(buffer: *const Buffer) {
        std::mem::forget(handle::share(buffer));
        object(buffer, "a buffer");
    }

    /// `rtcReleaseBuffer`.
    fn rtcReleaseBuffer(buffer: *const Buffer) {
        if !handle::release(buffer) {
            object(buffer, "a buffer");
        }
    }

    /// `rtcNewGeometry`: null for types that are not supported.
    fn rtcNewGeometry(device: *const Device, kind: u32) -> *const Geometry {
        let (Some(seen), Some(owned)) = (object(device, "a device"), handle::share(device)) else { return ptr::null() };
        seen.check(Geometry::new(owned, kind).map(|geometry| handle::give(Arc::new(geometry))), ptr::null())
    }

    /// `rtcRetainGeometry`.
    fn rtcRetainGeometry(geometry: *const Geometry) {
        std::mem::forget(handle::share(geometry));
        object(geometry, "a geometry");
    }

    /// `rtcReleaseGeometry`.
    fn rtcReleaseGeometry(geometry: *const Geometry) {
        if !handle::release(geometry) {
            object(geometry, "a geometry");
        }
    }

    /// `rtcCommitGeometry`: what was shared is read anew by the next commit of a scene.
    fn rtcCommitGeometry(geometry: *const Geometry) {
        with(geometry, |geometry| {
            geometry.changed();
            Ok(())
        });
    }

    /// `rtcEnableGeometry`.
    fn rtcEnableGeometry(geometry: *const Geometry) {
        with(geometry, |geometry| {
            geometry.set(|state| state.enabled = true);
            Ok(())
        });
    }

    /// `rtcDisableGeometry`.
    fn rtcDisableGeometry(geometry: *const Geometry) {
        with(geometry, |geometry| {
            geometry.set(|state| state.enabled = false);
            Ok(())
        });
    }

    /// `rtcSetGeometryTimeStepCount`: one only.
    fn rtcSetGeometryTimeStepCount(geometry: *const Geometry, count: u32) {
        with(geometry, |_| match count {
            0 => Err(Fault::operation("no time step at all")),
            1 => Ok(()),
            _ => Err(Fault::unsupported(&format!("motion blur ({count} time steps)"))),
        });
    }

    /// `rtcSetGeometryTimeRange`: changes nothing without motion.
    fn rtcSetGeometryTimeRange(geometry: *const Geometry, _start: f32, _end: f32) {
        with(geometry, |_| Ok(()));
    }

    /// `rtcSetGeometryVertexAttributeCount`.
    fn rtcSetGeometryVertexAttributeCount(geometry: *const Geometry, count: u32) {
        with(geometry, |geometry| {
            geometry.set(|state| state.attributes = count);
            Ok(())
        });
    }

    /// `rtcSetGeometryMask`: from now on masks count for all rays of the device.
    fn rtcSetGeometryMask(geometry: *const Geometry, mask: u32) {
        with(geometry, |geometry| {
            geometry.device.use_masks();
            geometry.set(|state| state.mask = mask);
            Ok(())
        });
    }

    /// `rtcSetGeometryBuildQuality`: the quality of the scene decides.
    fn rtcSetGeometryBuildQuality(geometry: *const Geometry, quality: u32) {
        with(geometry, |_| if quality <= 3 { Ok(()) } else { Err(Fault::argument(format!("build quality {quality}"))) });
    }

    /// `rtcSetGeometryBuffer`.
    fn rtcSetGeometryBuffer(
        geometry: *const Geometry, kind: u32, slot: u32, format: u32, buffer: *const Buffer, offset: usize, stride: usize, count: usize,
    ) {
        with(geometry, |geometry| {
            let buffer = handle::share(buffer).ok_or_else(|| Fault::argument("a buffer that is null"))?;
            geometry.set_view(kind, slot, View::new(buffer, offset, stride, count, format)?)
        });
    }

    /// `rtcSetSharedGeometryBuffer`.
    fn rtcSetSharedGeometryBuffer(
        geometry: *const Geometry, kind: u32, slot: u32, format: u32, data: *const c_void, offset: usize, stride: usize, count: usize,
    ) {
        with(geometry, |geometry| {
            // The caller promises that the items are there.
            let bytes = stride.checked_mul(count).and_then(|bytes| bytes.checked_add(offset));
            let bytes = bytes.ok_or_else(|| Fault::argument(format!("{count} items every {stride} bytes")))?;
            if count == 0 && data.is_null() {
                let buffer = Buffer::new(geometry.device.clone(), 0)?;
                return geometry.set_view(kind, slot, View::new(Arc::new(buffer), 0, stride, 0, format)?);
            }
            let buffer = Buffer::shared(geometry.device.clone(), data.cast_mut().cast(), bytes)?;
            geometry.set_view(kind, slot, View::new(Arc::new(buffer), offset, stride, count, format)?)
        });
    }

    /// `rtcSetNewGeometryBuffer`.
    fn rtcSetNewGeometryBuffer(
        geometry: *const Geometry, kind: u32, slot: u32, format: u32, stride: usize, count: usize,
    ) -> *mut c_void {
        let Some(geometry) = object(geometry, "a geometry") else { return ptr::null_mut() };
        geometry.device.check(geometry.set_new_buffer(kind, slot, format, stride, count), ptr::null_mut())
    }

    /// `rtcGetGeometryBufferData`.
    fn rtcGetGeometryBufferData(geometry: *const Geometry, kind: u32, slot: u32) -> *mut c_void {
        let Some(geometry) = object(geometry, "a geometry") else { return ptr::null_mut() };
        let found = geometry.state().view(kind, slot).map(View::data);
        let none = || Fault::argument(format!("there is no buffer of type {kind} in slot {slot}"));
        geometry.device.check(found.ok_or_else(none), ptr::null_mut())
    }

    /// `rtcUpdateGeometryBuffer`.
    fn rtcUpdateGeometryBuffer(geometry: *const Geometry, kind: u32, slot: u32) {
        with(geometry, |geometry| {
            if geometry.state().view(kind, slot).is_none() {
                return Err(Fault::argument(format!("there is no buffer of type {kind} in slot {slot}")));
            }
            geometry.changed();
            Ok(())
        });
    }

    /// `rtcSetGeometryIntersectFilterFunction`.
    fn rtcSetGeometryIntersectFilterFunction(geometry: *const Geometry, filter: Option<FilterFunction>) {
        with(geometry, |geometry| {
            geometry.set(|state| state.intersect_filter = filter);
            Ok(())
        });
    }

    /// `rtcSetGeometryOccludedFilterFunction`.
    fn rtcSetGeometryOccludedFilterFunction(geometry: *const Geometry, filter: Option<FilterFunction>) {
        with(geometry, |geometry| {
            geometry.set(|state| state.occluded_filter = filter);
            Ok(())
        });
    }

    /// `rtcSetGeometryUserData`.
    fn rtcSetGeometryUserData(geometry: *const Geometry, user: *mut c_void) {
        with(geometry, |geometry| {
            geometry.set_user(user);
            Ok(())
        });
    }

    /// `rtcGetGeometryUserData`.
    fn rtcGetGeometryUserData(geometry: *const Geometry) -> *mut c_void {
        object(geometry, "a geometry").map_or(ptr::null_mut(), Geometry::user)
    }

    /// `rtcSetGeometryUserPrimitiveCount`.
    fn rtcSetGeometryUserPrimitiveCount(geometry: *const Geometry, count: u32) {
        with(geometry, |geometry| {
            only(geometry, GeometryType::User, "the number of user primitives")?;
            geometry.set(|state| state.user_primitives = count);
            Ok(())
        });
    }

    /// `rtcSetGeometryBoundsFunction`.
    fn rtcSetGeometryBoundsFunction(geometry: *const Geometry, function: Option<BoundsFunction>, user: *mut c_void) {
        with(geometry, |geometry| {
            only(geometry, GeometryType::User, "the bounds function")?;
            geometry.set(|state| state.bounds = Callback { function, user });
            Ok(())
        });
    }

    /// `rtcSetGeometryIntersectFunction`.
    fn rtcSetGeometryIntersectFunction(geometry: *const Geometry, function: Option<UserFunction>) {
        with(geometry, |geometry| {
            only(geometry, GeometryType::User, "the intersect function")?;
            geometry.set(|state| state.intersect = function);
            Ok(())
        });
    }

    /// `rtcSetGeometryOccludedFunction`.
    fn rtcSetGeometryOccludedFunction(geometry: *const Geometry, function: Option<UserFunction>) {
        with(geometry, |geometry| {
            only(geometry, GeometryType::User, "the occluded function")?;
            geometry.set(|state| state.occluded = function);
            Ok(())
        });
    }

    /// `rtcFilterIntersection`.
    fn rtcFilterIntersection(user: *const UserArguments, arguments: *const FilterArguments) {
        Query::filter_from_callback(user, arguments, false);
    }

    /// `rtcFilterOcclusion`.
    fn rtcFilterOcclusion(user: *const UserArguments, arguments: *const FilterArguments) {
        Query::filter_from_callback(user, arguments, true);
    }

    /// `rtcSetGeometryInstancedScene`.
    fn rtcSetGeometryInstancedScene(geometry: *const Geometry, scene: *const Scene) {
        with(geometry, |geometry| {
            only(geometry, GeometryType::Instance, "the scene")?;
            let scene = handle::share(scene).ok_or_else(|| Fault::argument("a scene that is null"))?;
            geometry.set(|state| state.instanced = Some(scene));
            Ok(())
        });
    }

    /// `rtcSetGeometryTransform`.
    fn rtcSetGeometryTransform(geometry: *const Geometry, step: u32, format: u32, matrix: *const c_void) {
        with(geometry, |geometry| {
            only(geometry, GeometryType::Instance, "the transformation")?;
            first_time_step(step)?;
            if matrix.is_null() {
                return Err(Fault::argument("a transformation that is null"));
            }
            let transform = transform::read(matrix.cast(), format)?;
            geometry.set(|state| state.transform = transform);
            Ok(())
        });
    }

    /// `rtcSetGeometryTransformQuaternion`.
    fn rtcSetGeometryTransformQuaternion(geometry: *const Geometry, step: u32, decomposition: *const Decomposition) {
        with(geometry, |geometry| {
            only(geometry, GeometryType::Instance, "the transformation")?;
            first_time_step(step)?;
            let given = decomposition.as_ref().ok_or_else(|| Fault::argument("a transformation that is null"))?;
            geometry.set(|state| state.transform = given.matrix());
            Ok(())
        });
    }

    /// `rtcGetGeometryTransform`.
    fn rtcGetGeometryTransform(geometry: *const Geometry, _time: f32, format: u32, matrix: *mut c_void) {
        with(geometry, |geometry| {
            only(geometry, GeometryType::Instance, "the transformation")?;
            if matrix.is_null() {
                return Err(Fault::argument("a place for a transformation that is null"));
            }
            transform::write(&geometry.state().transform, matrix.cast(), format)
        });
    }

    /// `rtcInterpolate`.
    fn rtcInterpolate(arguments: *const InterpolateArguments) {
        let Some(a) = object(arguments, "arguments") else { return };
        let place = Place { primitive: a.primitive, u: a.u, v: a.v, kind: a.kind, slot: a.slot, count: a.count };
        with(a.geometry, |geometry| interpolate(geometry, place, Results { to: a.to, stride: 1 }));
    }

    /// `rtcInterpolateN`.
    fn rtcInterpolateN(arguments: *const InterpolateManyArguments) {
        let Some(a) = object(arguments, "arguments") else { return };
        let n = a.n as usize;
        for i in (0..n).filter(|&i| a.valid.is_null() || *a.valid.add(i) != 0) {
            let (primitive, u, v) = (*a.primitives.add(i), *a.u.add(i), *a.v.add(i));
            let place = Place { primitive, u, v, kind: a.kind, slot: a.slot, count: a.count };
            let to = a.to.map(|to| if to.is_null() { to } else { to.add(i) });
            with(a.geometry, |geometry| interpolate(geometry, place, Results { to, stride: n }));
        }
    }
}
