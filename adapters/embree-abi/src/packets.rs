//! Many rays in one call: packets of `n` rays field by field, and streams.
//!
//! Each ray is traced by itself on a copy, so that callbacks always see one ray and its hit side by side.

use crate::asked::Asked;
use crate::device::{Fault, raise_without_device};
use crate::handle;
use crate::report;
use crate::scene::Scene;
use crate::trace::Query;
use crate::types::{Hit, INVALID_ID, RAY_WORDS, Ray, Version, hit_words};
use std::ffi::c_int;
use std::ptr;

/// One ray and its hit, side by side.
#[repr(C, align(16))]
struct RayHit {
    ray: Ray,
    hit: Hit,
}

/// The hit that stands behind a ray.
///
/// # Safety
/// `ray` is the ray of an `RTCRayHit`.
pub unsafe fn hit_behind(ray: *mut Ray) -> *mut Hit {
    // SAFETY: as the caller promises.
    unsafe { ray.add(1).cast() }
}

/// Traces one ray in place: its closest hit, or any.
///
/// # Safety
/// As [`Query::closest`]; `ray` is the ray of an `RTCRayHit` if `closest`.
#[inline]
pub unsafe fn one(scene: *const Scene, ray: *mut Ray, asked: &Asked, closest: bool) {
    report::rays(closest, 1);
    // SAFETY: as the caller promises.
    unsafe {
        let Some(scene) = handle::get(scene) else {
            return raise_without_device(&Fault::argument("a scene that is null"));
        };
        scene.with_built(|built| match built {
            None => scene.device.raise(&Fault::operation("rays in a scene that was not committed")),
            Some(built) if closest => Query::closest(built, ray, hit_behind(ray), asked),
            Some(built) => Query::any(built, ray, asked),
        });
    }
}

/// Traces the rays of a packet of `n` whose `valid` is not 0, or all if it is null.
///
/// # Safety
/// As [`one`], of `n` rays field by field, and `n` numbers at `valid`.
pub unsafe fn packet(valid: *const c_int, n: usize, scene: *const Scene, rays: *mut u32, asked: &Asked, closest: bool) {
    for lane in 0..n {
        // SAFETY: as the caller promises.
        unsafe {
            if valid.is_null() || *valid.add(lane) != 0 {
                copied(scene, asked, closest, |field| rays.add(field * n + lane));
            }
        }
    }
}

/// Traces `m` rays, one every `stride` bytes.
///
/// # Safety
/// As [`one`], of each ray.
pub unsafe fn stream(scene: *const Scene, rays: *mut Ray, m: usize, stride: usize, asked: &Asked, closest: bool) {
    for i in 0..m {
        // SAFETY: as the caller promises.
        unsafe { one(scene, rays.byte_add(i * stride), asked, closest) };
    }
}

/// Traces rays whose fields stand in arrays of their own: field `f` of ray `i` at `fields[f] + i`.
///
/// # Safety
/// As [`one`], of `n` rays; `fields` has as many pointers as a ray and, if `closest`, its hit has words.
pub unsafe fn arrays(scene: *const Scene, fields: *const *mut u32, n: usize, asked: &Asked, closest: bool) {
    for lane in 0..n {
        // SAFETY: as the caller promises.
        unsafe { copied(scene, asked, closest, |field| (*fields.add(field)).add(lane)) };
    }
}

/// Traces a copy of the ray whose words are at `place`; words of the hit follow those of the ray.
unsafe fn copied(scene: *const Scene, asked: &Asked, closest: bool, place: impl Fn(usize) -> *mut u32) {
    let nothing = Hit {
        normal: [0.0; 3],
        u: 0.0,
        v: 0.0,
        primitive: INVALID_ID,
        geometry: INVALID_ID,
        instance: INVALID_ID,
        instance_primitive: INVALID_ID,
    };
    let version = match asked {
        Asked::Three(_) => Version::Three,
        Asked::Four(_) => Version::Four,
    };
    // SAFETY: any bits are numbers; the caller of the functions above promises the rest.
    unsafe {
        let mut own = RayHit { ray: std::mem::zeroed(), hit: nothing };
        let words = (&raw mut own).cast::<u32>();
        for field in 0..RAY_WORDS {
            *words.add(field) = *place(field);
        }
        let before = own.ray.tfar;
        one(scene, &raw mut own.ray, asked, closest);
        if own.ray.tfar.to_bits() == before.to_bits() {
            return;
        }
        let tfar = std::mem::offset_of!(Ray, tfar) / 4;
        *place(tfar) = own.ray.tfar.to_bits();
        if closest {
            for field in 0..hit_words(version) {
                *place(RAY_WORDS + field) = *(&raw const own.hit).cast::<u32>().add(field);
            }
        }
    }
}

/// Traces `m` packets of `n` rays, one every `stride` bytes.
///
/// # Safety
/// As [`packet`], of each.
pub unsafe fn packets(
    scene: *const Scene,
    rays: *mut u32,
    n: usize,
    m: usize,
    stride: usize,
    asked: &Asked,
    closest: bool,
) {
    for i in 0..m {
        // SAFETY: as the caller promises.
        unsafe { packet(ptr::null(), n, scene, rays.byte_add(i * stride), asked, closest) };
    }
}
