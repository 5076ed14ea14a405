//! `rtc*Device*`: but `rtcNewDevice`, whose version is that of the library.

use super::{c_functions, object};
use crate::device::{Callback, Device, Fault, raise_without_device, take_error};
use crate::handle;
use crate::types::{ErrorCode, ErrorFunction, MemoryMonitor, Version};
use std::ffi::{CStr, c_char, c_void};
use std::ptr;
use std::sync::Arc;

/// `rtcNewDevice`, through the interface of `version`.
///
/// # Safety
/// `config` is null or a C string.
pub unsafe fn new_device(version: Version, config: *const c_char) -> *const Device {
    // SAFETY: as the caller promises.
    let config = if config.is_null() { "".into() } else { unsafe { CStr::from_ptr(config) }.to_string_lossy() };
    match Device::new(version, &config) {
        Ok(device) => handle::give(Arc::new(device)),
        Err(fault) => {
            raise_without_device(&fault);
            ptr::null()
        }
    }
}

/// The value of a property, by its number.
fn property(device: &Device, number: u32) -> Result<isize, Fault> {
    let [major, minor, patch] = match device.version() {
        Version::Three => [3, 13, 5],
        Version::Four => [4, 4, 0],
    };
    Ok(match number {
        0 => 10_000 * major + 100 * minor + patch,
        1 => major,
        2 => minor,
        3 => patch,
        // Packets of 4, 8, 16 and streams; masks, filters; rays that are none hit nothing.
        32..=35 | 64 | 66 | 67 => 1,
        // Triangles, quads, user geometries; join-commit, commits of several scenes at once.
        96 | 97 | 100 | 129 | 130 => 1,
        // SYCL; culling; compact polygons; subdivision, curves, points; the internal tasking system.
        36 | 63 | 65 | 68 | 98 | 99 | 101 | 128 => 0,
        // Embree's own regression tests and counters, by number: there is none.
        1_000_000..4_000_000 => 0,
        _ => return Err(Fault::argument(format!("device property {number}"))),
    })
}

c_functions! {
    /// `rtcRetainDevice`.
    fn rtcRetainDevice(device: *const Device) {
        std::mem::forget(handle::share(device));
        object(device, "a device");
    }

    /// `rtcReleaseDevice`.
    fn rtcReleaseDevice(device: *const Device) {
        if !handle::release(device) {
            object(device, "a device");
        }
    }

    /// `rtcGetDeviceProperty`.
    fn rtcGetDeviceProperty(device: *const Device, number: u32) -> isize {
        object(device, "a device").map_or(0, |device| device.check(property(device, number), 0))
    }

    /// `rtcSetDeviceProperty`: Embree has it for tests of its own.
    fn rtcSetDeviceProperty(device: *const Device, number: u32, _value: isize) {
        if let Some(device) = object(device, "a device") {
            device.raise(&Fault::argument(format!("device property {number} cannot be set")));
        }
    }

    /// `rtcGetDeviceError`.
    fn rtcGetDeviceError(device: *const Device) -> ErrorCode {
        take_error(device)
    }

    /// `rtcSetDeviceErrorFunction`.
    fn rtcSetDeviceErrorFunction(device: *const Device, function: Option<ErrorFunction>, user: *mut c_void) {
        if let Some(device) = object(device, "a device") {
            device.set_error_function(Callback { function, user });
        }
    }

    /// `rtcSetDeviceMemoryMonitorFunction`.
    fn rtcSetDeviceMemoryMonitorFunction(device: *const Device, function: Option<MemoryMonitor>, user: *mut c_void) {
        if let Some(device) = object(device, "a device") {
            device.set_memory_monitor(Callback { function, user });
        }
    }
}
