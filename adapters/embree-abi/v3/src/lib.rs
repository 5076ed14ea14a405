//! A library that programs load in the place of Embree 3.13 and that traces with skipgrid: what only version 3 has.

#![allow(unsafe_code, non_snake_case, reason = "the functions of a C interface")]

mod mitsuba;

use skipgrid_embree::api::devices::new_device;
use skipgrid_embree::asked::Asked;
use skipgrid_embree::device::Device;
use skipgrid_embree::packets::{arrays, one, packet, packets, stream};
use skipgrid_embree::scene::Scene;
use skipgrid_embree::types::{Context3, Ray, Version};
use std::ffi::{c_char, c_int};

/// `rtcNewDevice`.
///
/// # Safety
/// `config` is null or a C string.
#[unsafe(no_mangle)]
pub unsafe extern "C-unwind" fn rtcNewDevice(config: *const c_char) -> *const Device {
    // SAFETY: as the caller promises.
    unsafe { new_device(Version::Three, config) }
}

/// A function for closest hits and one for any, which differ in name only.
macro_rules! pair {
    ($intersect:ident, $occluded:ident, ($($argument:ident: $type:ty),*), |$context:ident, $closest:ident| $trace:expr) => {
        pair!(@one $intersect, true, ($($argument: $type),*), |$context, $closest| $trace);
        pair!(@one $occluded, false, ($($argument: $type),*), |$context, $closest| $trace);
    };
    (@one $name:ident, $is_closest:literal, ($($argument:ident: $type:ty),*), |$context:ident, $closest:ident| $trace:expr) => {
        #[doc = concat!("`", stringify!($name), "`.")]
        ///
        /// # Safety
        /// As Embree demands: handles are alive, pointers good for what they are said to point to.
        #[unsafe(no_mangle)]
        pub unsafe extern "C-unwind" fn $name($($argument: $type),*) {
            let ($context, $closest) = (&Asked::Three($context), $is_closest);
            // SAFETY: as the caller promises.
            unsafe { $trace }
        }
    };
}

pair!(rtcIntersect1, rtcOccluded1, (scene: *const Scene, context: *mut Context3, ray: *mut Ray), |context, closest| {
    one(scene, ray, context, closest)
});
pair!(
    rtcIntersect4,
    rtcOccluded4,
    (valid: *const c_int, scene: *const Scene, context: *mut Context3, rays: *mut u32),
    |context, closest| packet(valid, 4, scene, rays, context, closest)
);
pair!(
    rtcIntersect8,
    rtcOccluded8,
    (valid: *const c_int, scene: *const Scene, context: *mut Context3, rays: *mut u32),
    |context, closest| packet(valid, 8, scene, rays, context, closest)
);
pair!(
    rtcIntersect16,
    rtcOccluded16,
    (valid: *const c_int, scene: *const Scene, context: *mut Context3, rays: *mut u32),
    |context, closest| packet(valid, 16, scene, rays, context, closest)
);
pair!(
    rtcIntersect1M,
    rtcOccluded1M,
    (scene: *const Scene, context: *mut Context3, rays: *mut Ray, m: u32, stride: usize),
    |context, closest| stream(scene, rays, m as usize, stride, context, closest)
);
pair!(
    rtcIntersect1Mp,
    rtcOccluded1Mp,
    (scene: *const Scene, context: *mut Context3, rays: *const *mut Ray, m: u32),
    |context, closest| for i in 0..m as usize {
        one(scene, *rays.add(i), context, closest);
    }
);
pair!(
    rtcIntersectNM,
    rtcOccludedNM,
    (scene: *const Scene, context: *mut Context3, rays: *mut u32, n: u32, m: u32, stride: usize),
    |context, closest| packets(scene, rays, n as usize, m as usize, stride, context, closest)
);
pair!(
    rtcIntersectNp,
    rtcOccludedNp,
    (scene: *const Scene, context: *mut Context3, fields: *const *mut u32, n: u32),
    |context, closest| arrays(scene, fields, n as usize, context, closest)
);
