//! A library that programs load in the place of Embree 4.4 and that traces with skipgrid: what only version 4 has.

#![allow(unsafe_code, non_snake_case, reason = "the functions of a C interface")]

mod refused;

use skipgrid_embree::api::devices::new_device;
use skipgrid_embree::api::geometries::{
    rtcFilterIntersection, rtcFilterOcclusion, rtcGetGeometryTransform, rtcGetGeometryUserData,
};
use skipgrid_embree::api::scenes::rtcGetGeometry;
use skipgrid_embree::asked::Asked;
use skipgrid_embree::device::{Device, last_message};
use skipgrid_embree::geometry::Geometry;
use skipgrid_embree::handle;
use skipgrid_embree::packets::{one, packet};
use skipgrid_embree::scene::Scene;
use skipgrid_embree::types::{Arguments4, FilterArguments, Ray, UserArguments, Version};
use std::ffi::{c_char, c_int, c_void};

/// `rtcNewDevice`.
///
/// # Safety
/// `config` is null or a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C-unwind" fn rtcNewDevice(config: *const c_char) -> *const Device {
    // SAFETY: as the caller promises.
    unsafe { new_device(Version::Four, config) }
}

/// `rtcGetErrorString`.
#[unsafe(no_mangle)]
pub extern "C-unwind" fn rtcGetErrorString(code: u32) -> *const c_char {
    let text = match code {
        0 => c"no error",
        1 => c"unknown error",
        2 => c"invalid argument",
        3 => c"invalid operation",
        4 => c"out of memory",
        5 => c"unsupported processor",
        6 => c"cancelled",
        _ => c"no such error",
    };
    text.as_ptr()
}

/// `rtcGetDeviceLastErrorMessage`: of this thread, until its next error.
#[unsafe(no_mangle)]
pub extern "C-unwind" fn rtcGetDeviceLastErrorMessage(_device: *const Device) -> *const c_char {
    last_message()
}

/// `rtcSetGeometryEnableFilterFunctionFromArguments`.
///
/// # Safety
/// The geometry is null or alive.
#[unsafe(no_mangle)]
pub unsafe extern "C-unwind" fn rtcSetGeometryEnableFilterFunctionFromArguments(
    geometry: *const Geometry,
    enable: bool,
) {
    // SAFETY: as the caller promises.
    if let Some(geometry) = unsafe { handle::get(geometry) } {
        geometry.set(|state| state.filter_from_arguments = enable);
    }
}

/// `rtcGetGeometryUserDataFromScene`.
///
/// # Safety
/// The scene is null or alive.
#[unsafe(no_mangle)]
pub unsafe extern "C-unwind" fn rtcGetGeometryUserDataFromScene(scene: *const Scene, id: u32) -> *mut c_void {
    // SAFETY: as the caller promises.
    unsafe { rtcGetGeometryUserData(rtcGetGeometry(scene, id)) }
}

/// `rtcGetGeometryTransformFromScene`.
///
/// # Safety
/// The scene is null or alive, and there is room for a matrix.
#[unsafe(no_mangle)]
pub unsafe extern "C-unwind" fn rtcGetGeometryTransformFromScene(
    scene: *const Scene,
    id: u32,
    time: f32,
    format: u32,
    matrix: *mut c_void,
) {
    // SAFETY: as the caller promises.
    unsafe { rtcGetGeometryTransform(rtcGetGeometry(scene, id), time, format, matrix) };
}

/// `rtcInvokeIntersectFilterFromGeometry`.
///
/// # Safety
/// As [`rtcFilterIntersection`].
#[unsafe(no_mangle)]
pub unsafe extern "C-unwind" fn rtcInvokeIntersectFilterFromGeometry(
    user: *const UserArguments,
    arguments: *const FilterArguments,
) {
    // SAFETY: as the caller promises.
    unsafe { rtcFilterIntersection(user, arguments) };
}

/// `rtcInvokeOccludedFilterFromGeometry`.
///
/// # Safety
/// As [`rtcFilterOcclusion`].
#[unsafe(no_mangle)]
pub unsafe extern "C-unwind" fn rtcInvokeOccludedFilterFromGeometry(
    user: *const UserArguments,
    arguments: *const FilterArguments,
) {
    // SAFETY: as the caller promises.
    unsafe { rtcFilterOcclusion(user, arguments) };
}

/// `rtcIntersect1` or `rtcOccluded1`, and packets.
macro_rules! rays {
    ($($one:ident, $four:ident, $eight:ident, $sixteen:ident: $closest:literal;)*) => {$(
        rays!(@one $one, $closest);
        rays!(@packet $four, 4, $closest);
        rays!(@packet $eight, 8, $closest);
        rays!(@packet $sixteen, 16, $closest);
    )*};
    (@one $name:ident, $closest:literal) => {
        #[doc = concat!("`", stringify!($name), "`.")]
        ///
        /// # Safety
        /// As Embree demands: handles are alive, pointers good for what they are said to point to.
        #[unsafe(no_mangle)]
        pub unsafe extern "C-unwind" fn $name(scene: *const Scene, ray: *mut Ray, arguments: *const Arguments4) {
            // SAFETY: as the caller promises.
            unsafe { one(scene, ray, &Asked::Four(arguments), $closest) }
        }
    };
    (@packet $name:ident, $n:literal, $closest:literal) => {
        #[doc = concat!("`", stringify!($name), "`.")]
        ///
        /// # Safety
        /// As Embree demands: handles are alive, pointers good for what they are said to point to.
        #[unsafe(no_mangle)]
        pub unsafe extern "C-unwind" fn $name(
            valid: *const c_int,
            scene: *const Scene,
            rays: *mut u32,
            arguments: *const Arguments4,
        ) {
            // SAFETY: as the caller promises.
            unsafe { packet(valid, $n, scene, rays, &Asked::Four(arguments), $closest) }
        }
    };
}

rays! {
    rtcIntersect1, rtcIntersect4, rtcIntersect8, rtcIntersect16: true;
    rtcOccluded1, rtcOccluded4, rtcOccluded8, rtcOccluded16: false;
}
