//! The names that Mitsuba 3's own copy of Embree 3 has: those of C++ functions in the namespace `mitsuba`.
//!
//! Names as in its wheels for Linux: `nm -D --undefined-only libmitsuba.so`, where all of them are listed.

use skipgrid_embree::api::{devices, geometries, scenes};
use skipgrid_embree::device::Device;
use skipgrid_embree::geometry::Geometry;
use skipgrid_embree::scene::Scene;
use skipgrid_embree::types::{BoundsFunction, Context3, ErrorFunction, FilterFunction, Ray, UserFunction};
use std::ffi::{c_char, c_int, c_void};

/// The function of a module under another name.
macro_rules! also_known {
    ($($symbol:literal: $($path:ident)::* ($($argument:ident: $type:ty),*) $(-> $back:ty)?;)*) => {$(
        const _: () = {
            #[unsafe(export_name = $symbol)]
            unsafe extern "C-unwind" fn also_known($($argument: $type),*) $(-> $back)? {
                // SAFETY: as the caller promises.
                unsafe { $($path)::*($($argument),*) }
            }
        };
    )*};
}

also_known! {
    "_ZN7mitsuba11rtcNewSceneEPNS_11RTCDeviceTyE":
        scenes::rtcNewScene(device: *const Device) -> *const Scene;
    "_ZN7mitsuba12rtcNewDeviceEPKc":
        super::rtcNewDevice(config: *const c_char) -> *const Device;
    "_ZN7mitsuba12rtcOccluded1EPNS_10RTCSceneTyEPNS_19RTCIntersectContextEPNS_6RTCRayE":
        super::rtcOccluded1(scene: *const Scene, context: *mut Context3, ray: *mut Ray);
    "_ZN7mitsuba12rtcOccluded4EPKiPNS_10RTCSceneTyEPNS_19RTCIntersectContextEPNS_7RTCRay4E":
        super::rtcOccluded4(valid: *const c_int, scene: *const Scene, context: *mut Context3, rays: *mut u32);
    "_ZN7mitsuba12rtcOccluded8EPKiPNS_10RTCSceneTyEPNS_19RTCIntersectContextEPNS_7RTCRay8E":
        super::rtcOccluded8(valid: *const c_int, scene: *const Scene, context: *mut Context3, rays: *mut u32);
    "_ZN7mitsuba13rtcIntersect1EPNS_10RTCSceneTyEPNS_19RTCIntersectContextEPNS_9RTCRayHitE":
        super::rtcIntersect1(scene: *const Scene, context: *mut Context3, ray: *mut Ray);
    "_ZN7mitsuba13rtcIntersect4EPKiPNS_10RTCSceneTyEPNS_19RTCIntersectContextEPNS_10RTCRayHit4E":
        super::rtcIntersect4(valid: *const c_int, scene: *const Scene, context: *mut Context3, rays: *mut u32);
    "_ZN7mitsuba13rtcIntersect8EPKiPNS_10RTCSceneTyEPNS_19RTCIntersectContextEPNS_10RTCRayHit8E":
        super::rtcIntersect8(valid: *const c_int, scene: *const Scene, context: *mut Context3, rays: *mut u32);
    "_ZN7mitsuba13rtcOccluded16EPKiPNS_10RTCSceneTyEPNS_19RTCIntersectContextEPNS_8RTCRay16E":
        super::rtcOccluded16(valid: *const c_int, scene: *const Scene, context: *mut Context3, rays: *mut u32);
    "_ZN7mitsuba14rtcCommitSceneEPNS_10RTCSceneTyE":
        scenes::rtcCommitScene(scene: *const Scene);
    "_ZN7mitsuba14rtcIntersect16EPKiPNS_10RTCSceneTyEPNS_19RTCIntersectContextEPNS_11RTCRayHit16E":
        super::rtcIntersect16(valid: *const c_int, scene: *const Scene, context: *mut Context3, rays: *mut u32);
    "_ZN7mitsuba14rtcNewGeometryEPNS_11RTCDeviceTyENS_15RTCGeometryTypeE":
        geometries::rtcNewGeometry(device: *const Device, kind: u32) -> *const Geometry;
    "_ZN7mitsuba15rtcReleaseSceneEPNS_10RTCSceneTyE":
        scenes::rtcReleaseScene(scene: *const Scene);
    "_ZN7mitsuba16rtcSetSceneFlagsEPNS_10RTCSceneTyENS_13RTCSceneFlagsE":
        scenes::rtcSetSceneFlags(scene: *const Scene, flags: u32);
    "_ZN7mitsuba17rtcAttachGeometryEPNS_10RTCSceneTyEPNS_13RTCGeometryTyE":
        scenes::rtcAttachGeometry(scene: *const Scene, geometry: *const Geometry) -> u32;
    "_ZN7mitsuba17rtcCommitGeometryEPNS_13RTCGeometryTyE":
        geometries::rtcCommitGeometry(geometry: *const Geometry);
    "_ZN7mitsuba17rtcDetachGeometryEPNS_10RTCSceneTyEj":
        scenes::rtcDetachGeometry(scene: *const Scene, id: u32);
    "_ZN7mitsuba18rtcJoinCommitSceneEPNS_10RTCSceneTyE":
        scenes::rtcJoinCommitScene(scene: *const Scene);
    "_ZN7mitsuba18rtcReleaseGeometryEPNS_13RTCGeometryTyE":
        geometries::rtcReleaseGeometry(geometry: *const Geometry);
    "_ZN7mitsuba22rtcSetGeometryUserDataEPNS_13RTCGeometryTyEPv":
        geometries::rtcSetGeometryUserData(geometry: *const Geometry, user: *mut c_void);
    "_ZN7mitsuba23rtcSetGeometryTransformEPNS_13RTCGeometryTyEjNS_9RTCFormatEPKv":
        geometries::rtcSetGeometryTransform(geometry: *const Geometry, step: u32, format: u32, matrix: *const c_void);
    "_ZN7mitsuba23rtcSetSceneBuildQualityEPNS_10RTCSceneTyENS_15RTCBuildQualityE":
        scenes::rtcSetSceneBuildQuality(scene: *const Scene, quality: u32);
    "_ZN7mitsuba25rtcSetDeviceErrorFunctionEPNS_11RTCDeviceTyEPFvPvNS_8RTCErrorEPKcES2_":
        devices::rtcSetDeviceErrorFunction(device: *const Device, function: Option<ErrorFunction>, user: *mut c_void);
    "_ZN7mitsuba26rtcSetSharedGeometryBufferEPNS_13RTCGeometryTyENS_13RTCBufferTypeEjNS_9RTCFormatEPKvmmm":
        geometries::rtcSetSharedGeometryBuffer(geometry: *const Geometry, kind: u32, slot: u32, format: u32, data: *const c_void, offset: usize, stride: usize, count: usize);
    "_ZN7mitsuba27rtcSetGeometryTimeStepCountEPNS_13RTCGeometryTyEj":
        geometries::rtcSetGeometryTimeStepCount(geometry: *const Geometry, count: u32);
    "_ZN7mitsuba28rtcSetGeometryBoundsFunctionEPNS_13RTCGeometryTyEPFvPKNS_26RTCBoundsFunctionArgumentsEEPv":
        geometries::rtcSetGeometryBoundsFunction(geometry: *const Geometry, function: Option<BoundsFunction>, user: *mut c_void);
    "_ZN7mitsuba28rtcSetGeometryInstancedSceneEPNS_13RTCGeometryTyEPNS_10RTCSceneTyE":
        geometries::rtcSetGeometryInstancedScene(geometry: *const Geometry, scene: *const Scene);
    "_ZN7mitsuba30rtcSetGeometryOccludedFunctionEPNS_13RTCGeometryTyEPFvPKNS_29RTCOccludedFunctionNArgumentsEE":
        geometries::rtcSetGeometryOccludedFunction(geometry: *const Geometry, function: Option<UserFunction>);
    "_ZN7mitsuba31rtcSetGeometryIntersectFunctionEPNS_13RTCGeometryTyEPFvPKNS_30RTCIntersectFunctionNArgumentsEE":
        geometries::rtcSetGeometryIntersectFunction(geometry: *const Geometry, function: Option<UserFunction>);
    "_ZN7mitsuba32rtcSetGeometryUserPrimitiveCountEPNS_13RTCGeometryTyEj":
        geometries::rtcSetGeometryUserPrimitiveCount(geometry: *const Geometry, count: u32);
    "_ZN7mitsuba36rtcSetGeometryOccludedFilterFunctionEPNS_13RTCGeometryTyEPFvPKNS_27RTCFilterFunctionNArgumentsEE":
        geometries::rtcSetGeometryOccludedFilterFunction(geometry: *const Geometry, filter: Option<FilterFunction>);
    "_ZN7mitsuba37rtcSetGeometryIntersectFilterFunctionEPNS_13RTCGeometryTyEPFvPKNS_27RTCFilterFunctionNArgumentsEE":
        geometries::rtcSetGeometryIntersectFilterFunction(geometry: *const Geometry, filter: Option<FilterFunction>);
}
