//! Functions of Embree that are not supported: each raises an error that names it. They are here so that programs load at all, and so
//! that nothing is left out silently.

use super::object;
use crate::device::{Device, Fault, raise_without_device};
use crate::geometry::Geometry;
use crate::scene::Scene;
use std::ffi::c_void;

/// A handle that leads to a device.
trait Owned {
    fn device(&self) -> &Device;
}

impl Owned for Device {
    fn device(&self) -> &Device {
        self
    }
}

impl Owned for Geometry {
    fn device(&self) -> &Device {
        &self.device
    }
}

impl Owned for Scene {
    fn device(&self) -> &Device {
        &self.device
    }
}

/// Raises that `what` is not supported on the device of an object.
///
/// # Safety
/// The handle is null or alive.
unsafe fn refuse<T: Owned>(handle: *const T, what: &str) {
    // SAFETY: as the caller promises.
    if let Some(owned) = unsafe { object(handle, "an object") } {
        owned.device().raise(&Fault::unsupported(what));
    }
}

/// Functions whose first argument leads to a device. C callers may pass more arguments than these take.
macro_rules! refused {
    ($($name:ident($type:ty) $(-> $back:ty = $value:expr)?;)*) => {$(
        #[doc = concat!("`", stringify!($name), "`: refused.")]
        ///
        /// # Safety
        /// The handle is null or alive.
        #[unsafe(no_mangle)]
        pub unsafe extern "C-unwind" fn $name(handle: *const $type) $(-> $back)? {
            // SAFETY: as the caller promises.
            unsafe { refuse(handle, stringify!($name)) };
            $($value)?
        }
    )*};
}

refused! {
    rtcGetGeometryFirstHalfEdge(Geometry) -> u32 = u32::MAX;
    rtcGetGeometryFace(Geometry) -> u32 = u32::MAX;
    rtcGetGeometryNextHalfEdge(Geometry) -> u32 = u32::MAX;
    rtcGetGeometryPreviousHalfEdge(Geometry) -> u32 = u32::MAX;
    rtcGetGeometryOppositeHalfEdge(Geometry) -> u32 = u32::MAX;
    rtcSetGeometryDisplacementFunction(Geometry);
    rtcSetGeometryMaxRadiusScale(Geometry);
    rtcSetGeometryPointQueryFunction(Geometry);
    rtcSetGeometrySubdivisionMode(Geometry);
    rtcSetGeometryTessellationRate(Geometry);
    rtcSetGeometryTopologyCount(Geometry);
    rtcSetGeometryVertexAttributeTopology(Geometry);
    rtcPointQuery(Scene) -> bool = false;
    rtcCollide(Scene);
    rtcNewBVH(Device) -> *mut c_void = std::ptr::null_mut();
}

/// Functions of a point query over several points: the scene is the second argument.
macro_rules! refused_points {
    ($($name:ident;)*) => {$(
        #[doc = concat!("`", stringify!($name), "`: refused.")]
        ///
        /// # Safety
        /// The scene is null or alive.
        #[unsafe(no_mangle)]
        pub unsafe extern "C-unwind" fn $name(_valid: *const c_void, scene: *const Scene) -> bool {
            // SAFETY: as the caller promises.
            unsafe { refuse(scene, stringify!($name)) };
            false
        }
    )*};
}

refused_points! {
    rtcPointQuery4;
    rtcPointQuery8;
    rtcPointQuery16;
}

/// Functions of a BVH that the program builds itself: there is none, so that only null can come.
macro_rules! refused_bvh {
    ($($name:ident $(-> $back:ty = $value:expr)?;)*) => {$(
        #[doc = concat!("`", stringify!($name), "`: refused.")]
        #[unsafe(no_mangle)]
        pub extern "C-unwind" fn $name() $(-> $back)? {
            raise_without_device(&Fault::unsupported(stringify!($name)));
            $($value)?
        }
    )*};
}

refused_bvh! {
    rtcBuildBVH -> *mut c_void = std::ptr::null_mut();
    rtcThreadLocalAlloc -> *mut c_void = std::ptr::null_mut();
    rtcMakeStaticBVH;
    rtcRetainBVH;
    rtcReleaseBVH;
}
